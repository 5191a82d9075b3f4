//! What a page tells the app when it begins there: what draws it, and how the GPU comes to compute.

use tilescope_core::Variant;

use super::engine::ON_CPU;
use super::{FullScreen, Notice, State};
use crate::device::{Device, Engine};
use crate::embedding::Embedding;

/// How the app begins on a page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PageStart {
    /// What draws.
    pub display: String,
    /// Why, if there is a reason to tell.
    pub reason: String,
    /// Who samples.
    pub engine: Engine,
    /// A part of the window that is shown alone.
    pub embedding: Option<Embedding>,
    /// Whether the system wishes that nothing moves by itself.
    pub reduced_motion: bool,
    /// Whether the browser lets the page have the full screen.
    pub full_screen: bool,
}

impl State {
    /// Begins on a page: the GPU is opened and tested, and serves from then on where it passes. One that computes on the CPU
    /// is not tested unless it was asked for.
    pub fn begin_on_page(&mut self, start: &PageStart) {
        self.gpu.display = Some(start.display.clone());
        self.window.embedding = start.embedding;
        self.prefer_reduced_motion(start.reduced_motion);
        if !start.full_screen {
            let why = "The browser does not let this page have the full screen.";
            self.window.full_screen = FullScreen::Refused(why);
        }
        if !start.reason.is_empty() {
            self.messages.notice = Some(Notice {
                text: start.reason.clone(),
                is_error: true,
            });
        }
        self.form.engine = start.engine;
        if start.engine != Engine::Cpu && matches!(self.gpu.device, Device::Unknown) {
            self.test_device(start.engine == Engine::Gpu);
        }
    }

    /// Returns why the engine at hand samples, and what draws, where the app itself has chosen.
    #[must_use]
    pub fn chosen(&self) -> Option<String> {
        let display = self.gpu.display.as_ref()?;
        let engine = match &self.gpu.device {
            _ if self.form.engine == Engine::Cpu => {
                "The CPU engine samples in a worker, as chosen.".to_owned()
            }
            Device::Unknown => {
                let failure = self.gpu.failure.as_deref();
                let text = format!(
                    "The CPU engine samples in a worker. {}",
                    failure.unwrap_or_default()
                );
                text.trim_end().to_owned()
            }
            Device::Testing(_) => {
                "The CPU engine samples in a worker while the GPU is opened and tested.".to_owned()
            }
            Device::Ready(_)
                if self.device_takes(self.form.engine)
                    && self.form.draft.parameters.variant == Variant::AsPrinted =>
            {
                "The CPU engine samples in a worker: it alone runs Algorithm 4 as printed."
                    .to_owned()
            }
            Device::Ready(_) if self.device_takes(self.form.engine) => {
                "The GPU samples: it passed its test against the CPU.".to_owned()
            }
            Device::Ready(_) => {
                format!("The CPU engine samples in a worker. {ON_CPU}")
            }
            Device::Refused(reason) => {
                format!("The CPU engine samples in a worker, as no GPU can. {reason}")
            }
        };
        Some(format!("{engine} {display} draws."))
    }
}
