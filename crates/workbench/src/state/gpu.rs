//! The choice of the engine, opening and testing the GPU, and both in words. `state/engine.rs` makes runs with them.

use std::sync::Arc;

use tilescope_core::{Parameters, TilingMethod, Variant};
use tilescope_gpu::{Choice, Gpu, GpuError};
use tilescope_session::jobs::Job;
use tilescope_session::layers::SessionKind;
use tilescope_session::limits::MAX_PASSES_ON_A_PAGE;
use tilescope_session::session::Failure;
use tilescope_session::words::{grouped, sentence};

use super::effects::Context;
use super::{PageStart, RunView};
use crate::command::GpuCommand;
use crate::device::{Device, EngineChoice, Tried, open_and_test};
use crate::draft::Draft;

/// Why an emulated GPU is used only if chosen by the user.
const ON_CPU: &str = "The browser's GPU computes on the CPU itself, which takes longer.";

/// The choice of the engine, and the state of the GPU.
#[derive(Default)]
pub struct GpuState {
    /// The engine that the user chose.
    pub engine: EngineChoice,
    /// The device that samples.
    pub device: Device,
    /// Why the last GPU run or test failed, if one did.
    pub failure: Option<String>,
    /// The description of the graphics that draw the window, on a page only. There a GPU that has passed its test makes runs
    /// without being chosen.
    pub(super) display: Option<String>,
    /// A part of the name of the adapter to open; `None` for the fastest.
    adapter: Option<String>,
}

impl GpuState {
    /// Applies a command to the choice of engine or of adapter. No run begins.
    pub(super) fn apply(&mut self, command: GpuCommand, context: &Context) {
        match command {
            GpuCommand::Engine(engine) => self.choose_engine(engine, context),
            GpuCommand::NameAdapter(name) => {
                self.adapter = name;
                // The adapter of this name is opened and tested when the GPU is chosen again.
                self.device = Device::Unknown;
                if self.engine == EngineChoice::Gpu {
                    self.engine = EngineChoice::Auto;
                }
            }
        }
    }

    /// Starts on a page: opens and tests the GPU, which samples from then on if it passes. One that computes on
    /// the CPU is tested only if it was requested.
    pub(super) fn begin_on_page(&mut self, start: &PageStart, context: &Context) {
        self.display = Some(start.display.clone());
        self.engine = start.engine;
        if start.engine != EngineChoice::Cpu && matches!(self.device, Device::Unknown) {
            self.test(start.engine == EngineChoice::Gpu, context);
        }
    }

    /// Chooses the engine. The GPU is opened and tested first, unless it was already.
    fn choose_engine(&mut self, engine: EngineChoice, context: &Context) {
        if engine == EngineChoice::Gpu {
            match self.device {
                Device::Refused(_) => return,
                Device::Unknown => {
                    let even_software = true;
                    self.test(even_software, context);
                }
                Device::Testing(_) | Device::Ready(_) => {}
            }
        }
        self.engine = engine;
    }

    /// Opens the GPU and tests it; one that computes on the CPU only if `software` is true, as its test is
    /// slow.
    fn test(&mut self, software: bool, context: &Context) {
        let choice = Choice {
            name: self.adapter.clone(),
            software,
            ..Choice::default()
        };
        let job = Job::start_future(&context.wake, |_| open_and_test(choice));
        self.device = Device::Testing(job);
    }

    /// Takes the outcome of a test, once there is one.
    pub(super) fn poll(&mut self, context: &mut Context) {
        if let Device::Testing(job) = &self.device
            && let Some(outcome) = job.poll()
        {
            self.finish_test(outcome, context);
        }
    }

    /// Waits for a running test.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn settle(&mut self, context: &mut Context) {
        if let Device::Testing(job) = &self.device {
            let outcome = job.wait();
            self.finish_test(outcome, context);
        }
    }

    /// Takes the outcome of a test. If the device failed and was chosen, the choice is taken back: the CPU samples.
    pub(super) fn finish_test(
        &mut self,
        outcome: Result<Result<Tried, GpuError>, String>,
        context: &mut Context,
    ) {
        if let Ok(Err(GpuError::SoftwareOnly { .. })) = outcome {
            // The test refused an emulated GPU. If the user has chosen the GPU meanwhile, even an emulated one is tested.
            if self.engine == EngineChoice::Gpu {
                let even_software = true;
                self.test(even_software, context);
            } else {
                self.device = Device::Unknown;
                self.failure = Some(ON_CPU.to_owned());
            }
            return;
        }

        self.device = Device::from_test(outcome);
        if self.engine == EngineChoice::Gpu
            && let Some(reason) = self.device.refusal()
        {
            let text = format!("The GPU cannot be used. {reason} The CPU engine samples instead.");
            self.engine = EngineChoice::Auto;
            context.tell_error(text);
        }
    }

    /// Notes that a device failed in a run, and returns the notice.
    pub(super) fn failed(&mut self, Failure { name, error }: Failure) -> String {
        self.device.failed(&error);
        if !matches!(self.device, Device::Ready(_)) {
            self.engine = EngineChoice::Auto;
        }
        let why = sentence(&error.to_string());
        self.failure = Some(format!("{name} failed. {why}"));
        format!(
            "{name} failed. {why} The CPU engine made this session instead; the points are the same."
        )
    }

    /// Returns whether a ready device samples if `engine` is chosen.
    #[must_use]
    pub fn gpu_samples(&self, engine: EngineChoice) -> bool {
        let is_gpu = |gpu: &Arc<Gpu>| !gpu.report().is_software;
        match engine {
            EngineChoice::Gpu => self.device.ready().is_some(),
            EngineChoice::Auto => self.display.is_some() && self.device.ready().is_some_and(is_gpu),
            EngineChoice::Cpu => false,
        }
    }

    /// Returns the device that makes a run. Algorithm 4 as printed runs on the CPU, whatever was chosen. So do exact tilings,
    /// unless the GPU was chosen, as their rates on graphics cards have not been measured. On a page, KDRT takes a GPU that has
    /// passed its test even if it was not chosen.
    pub(super) fn for_run(
        &self,
        parameters: &Parameters,
        engine: EngineChoice,
    ) -> Option<Arc<Gpu>> {
        let serves = match parameters.method {
            TilingMethod::Exact => engine == EngineChoice::Gpu,
            TilingMethod::Kdrt => parameters.variant == Variant::Staged,
        } && self.gpu_samples(engine);
        self.device.ready().filter(|_| serves).map(Arc::clone)
    }

    /// Returns whether a run of `parameters` is an exact tiling that the CPU makes, because the GPU was not chosen.
    fn leaves_exact(&self, parameters: &Parameters) -> bool {
        parameters.method == TilingMethod::Exact && self.engine != EngineChoice::Gpu
    }

    /// Returns whether another engine made the run shown than the one that makes the next. False if the CPU alone makes
    /// the set shown, or if the next are nested levels or a set in a field or a shape: then there is no engine to
    /// choose.
    #[must_use]
    pub fn differs(&self, run: &RunView, draft: &Draft) -> bool {
        let Some(session) = &run.session else {
            return false;
        };
        let is_tiling = matches!(session.kind(), SessionKind::Run | SessionKind::Exact);
        let is_of_shape = session.ground.is_some();
        let has_choice = is_tiling && !is_of_shape && session.has_recipe();
        if !has_choice || draft.levels.is_some() || draft.ground.is_asked() || draft.is_in_space() {
            return false;
        }
        let next = self.for_run(&draft.parameters, self.engine);
        next.is_some() != session.engine.starts_with("GPU")
    }

    /// Returns why the passes cannot be inspected now, or `None` if they can.
    #[must_use]
    pub fn passes_refusal(&self, run: &RunView) -> Option<String> {
        let Some(session) = &run.session else {
            return Some("There is no session yet.".to_owned());
        };

        if session.combination.is_some() {
            let text =
                "This is a combination of sets, made on the CPU; the passes are those of a run.";
            return Some(text.to_owned());
        }
        if session.has_own_disks() {
            let text = "This set was made by darts on the CPU; the passes are those of a run.";
            return Some(text.to_owned());
        }
        if session.ground.is_some() {
            let text =
                "This shape was tiled on the CPU; the passes are those of a run in a rectangle.";
            return Some(text.to_owned());
        }
        if session.nested.is_some() {
            let text = "These are nested levels, made on the CPU; the passes are those of a run.";
            return Some(text.to_owned());
        }
        if session.own.is_some() {
            let text = "This session's pattern comes from a file; passes can be inspected only with a generated pattern.";
            return Some(text.to_owned());
        }

        // Algorithm 4 as printed has no passes, either. It is refused later, when its passes are to begin.

        // The passes of the GPU are compared with the same passes computed by the CPU. On a page the thread that draws
        // the window computes those of the CPU, and the window would stand still for long in a large run.
        if cfg!(target_arch = "wasm32") && session.summary.count > MAX_PASSES_ON_A_PAGE {
            let most = grouped(MAX_PASSES_ON_A_PAGE);
            return Some(format!(
                "A page shows the passes of runs of up to {most} samples; the native program has no such limit."
            ));
        }

        self.device.not_ready()
    }

    /// Returns why no run can start yet, or `None` if it can: the chosen device is being tested.
    pub(super) fn waiting(&self) -> Option<String> {
        let waits = matches!(self.device, Device::Testing(_)) && self.engine == EngineChoice::Gpu;
        self.device.description().filter(|_| waits)
    }

    /// Describes the engine of the next run, which is of `parameters`: in a line, and in full. `None` if the name of the choice
    /// says it already.
    #[must_use]
    pub fn engine_text(&self, parameters: &Parameters) -> Option<(String, String)> {
        let is_automatic_on_page = self.engine == EngineChoice::Auto && self.display.is_some();
        let gpu_samples = self.gpu_samples(self.engine);

        let line: &str = match &self.device {
            // Two kinds of runs are made by the CPU even if a device is ready, so that they come before the others.
            Device::Ready(_) if gpu_samples && self.leaves_exact(parameters) => {
                "CPU, for exact tilings: choose the GPU to use it."
            }
            Device::Ready(_) if gpu_samples && parameters.variant == Variant::AsPrinted => {
                "CPU: it alone runs Algorithm 4 as printed."
            }
            Device::Ready(tried) if gpu_samples => {
                &format!("GPU: self-test passed, on {}.", tried.gpu.report().name)
            }
            Device::Testing(_) if self.engine == EngineChoice::Gpu => "GPU: being tested.",
            Device::Testing(_) if is_automatic_on_page => "CPU, until the GPU is tested.",
            Device::Ready(_) if is_automatic_on_page => "CPU: this GPU is emulated, and slower.",
            Device::Refused(_) if is_automatic_on_page => "CPU: there is no GPU to use here.",
            Device::Unknown if is_automatic_on_page && self.failure.is_some() => {
                "CPU: the GPU failed."
            }
            // In all other states the name of the choice says it already.
            _ => return None,
        };

        // On a page the engine has a sentence, to which a device that is ready adds its test. Elsewhere only the device is described.
        let device = self.device.description();
        let all = match (self.engine_sentence(parameters), device) {
            (Some(why), Some(test)) if self.device.ready().is_some() => format!("{why} {test}"),
            (Some(why), _) => why,
            (None, device) => device?,
        };

        Some((line.to_owned(), all))
    }

    /// Returns a sentence on a page, and `None` elsewhere: the engine of the next run, which is of `parameters`, why it is this
    /// one, and the graphics that draw the window.
    #[must_use]
    pub fn engine_sentence(&self, parameters: &Parameters) -> Option<String> {
        let display = self.display.as_ref()?;
        let gpu_samples = self.gpu_samples(self.engine);

        let why: &str = match &self.device {
            _ if self.engine == EngineChoice::Cpu => ", as chosen.",
            Device::Unknown => match &self.failure {
                Some(failure) => &format!(". {failure}"),
                None => ".",
            },
            Device::Testing(_) => " while the GPU is opened and tested.",
            Device::Ready(_) if gpu_samples && self.leaves_exact(parameters) => {
                ": a GPU makes exact tilings only if it is chosen."
            }
            Device::Ready(_) if gpu_samples && parameters.variant == Variant::AsPrinted => {
                ": it alone runs Algorithm 4 as printed."
            }
            Device::Ready(_) if gpu_samples => {
                let engine = "The GPU samples: it passed its test against the CPU.";
                return Some(format!("{engine} {display} draws."));
            }
            Device::Ready(_) => &format!(". {ON_CPU}"),
            Device::Refused(reason) => &format!(", as no GPU can. {reason}"),
        };
        Some(format!(
            "The CPU engine samples in a worker{why} {display} draws."
        ))
    }
}
