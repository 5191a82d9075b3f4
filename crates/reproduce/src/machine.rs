//! The machine that a result comes from. It never measures anything.

use std::fs;
use std::thread;

use serde::{Deserialize, Serialize};
use tilescope_core::InstructionSet;

use crate::engines::gpus;

/// A machine, as far as rates depend on it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// The processor's name, where the system tells it.
    pub processor: String,
    /// Threads that the engines used.
    pub threads: usize,
    /// Threads that the machine runs at once.
    pub cores: usize,
    /// Operating system and architecture.
    pub system: String,
    /// The instruction set that the parallel engine uses.
    pub instructions: String,
    /// Names of its GPUs, without those that compute on the processor.
    pub gpus: Vec<String>,
}

impl Machine {
    /// Returns this machine.
    #[must_use]
    pub fn this() -> Self {
        Self {
            processor: processor().unwrap_or_else(|| "unknown processor".to_owned()),
            threads: rayon::current_num_threads(),
            cores: thread::available_parallelism().map_or(1, usize::from),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            instructions: InstructionSet::best().name().to_owned(),
            gpus: gpus().iter().map(|gpu| gpu.name.clone()).collect(),
        }
    }

    /// Returns one line that describes it.
    #[must_use]
    pub fn line(&self) -> String {
        let gpus = if self.gpus.is_empty() {
            "no GPU".to_owned()
        } else {
            self.gpus.join(", ")
        };
        format!(
            "{}, {} of {} threads, {}, {gpus}, {}",
            self.processor, self.threads, self.cores, self.instructions, self.system
        )
    }
}

fn processor() -> Option<String> {
    let text = fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    let name = line.split_once(':')?.1.trim();
    (!name.is_empty()).then(|| name.to_owned())
}
