//! The machine that results come from, and its GPUs.

use std::fs;
use std::sync::LazyLock;
use std::thread;

use pollster::block_on;
use serde::{Deserialize, Serialize};
use tilescope_core::InstructionSet;
use tilescope_gpu::AdapterReport;

/// A machine, as far as rates depend on it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// The processor's name, where the system states it.
    pub processor: String,
    /// Threads that the engines used.
    pub threads: usize,
    /// Hardware threads of the machine.
    pub cores: usize,
    /// Operating system and architecture.
    pub system: String,
    /// The instruction set that the parallel engine uses.
    pub instructions: String,
    /// Names of its GPUs, without those that compute on the processor.
    pub gpus: Vec<String>,
}

impl Machine {
    /// Returns the machine on which the program runs.
    #[must_use]
    pub fn this() -> Self {
        Self {
            processor: processor().unwrap_or_else(|| "unknown processor".to_owned()),
            threads: rayon::current_num_threads(),
            cores: thread::available_parallelism().map_or(1, usize::from),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            instructions: InstructionSet::best().name().to_owned(),
            gpus: GPUS.iter().map(|gpu| gpu.name.clone()).collect(),
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

/// All adapters, listed once: they do not change while a reproduction runs.
static ADAPTERS: LazyLock<Vec<AdapterReport>> =
    LazyLock::new(|| block_on(tilescope_gpu::adapters()));

/// The adapters that are GPUs, one of each name.
pub static GPUS: LazyLock<Vec<AdapterReport>> = LazyLock::new(|| {
    let hardware = ADAPTERS.iter().filter(|one| !one.is_software);
    let mut found: Vec<AdapterReport> = Vec::new();
    // Adapters are in the order of their kinds, so that those of one name need not be neighbours.
    for adapter in hardware {
        if found.iter().all(|one| one.name != adapter.name) {
            found.push(adapter.clone());
        }
    }
    found
});

/// Returns why no GPU is timed, or `None` if one is.
pub fn no_gpu() -> Option<String> {
    if !GPUS.is_empty() {
        return None;
    }
    let mut names: Vec<&str> = ADAPTERS.iter().map(|one| one.name.as_str()).collect();
    names.dedup();
    let none = "no GPU on this machine";
    Some(match names.join(", ") {
        names if names.is_empty() => none.to_owned(),
        names => format!("{none}; {names} runs on the CPU, so its times say nothing about a GPU"),
    })
}
