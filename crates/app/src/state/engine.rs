//! The commands that choose who samples, and what becomes of a device.

use std::sync::Arc;

use tilescope_core::{Parameters, Variant};
use tilescope_gpu::{Choice, Gpu, GpuError};

use super::{State, Which};
use crate::clock::Clock;
use crate::device::{Device, Engine, Tried, open_and_test};
use crate::layout::Panel;
use crate::passes::{OnCanvas, PassCommand, Passes};
use tilescope_session::errand;
use tilescope_session::jobs::Job;
use tilescope_session::limits::MOST_PASSES_ON_A_PAGE;
use tilescope_session::look::Look;
use tilescope_session::recipe::Recipe;
use tilescope_session::sampling::Sampling;
use tilescope_session::session::{Failure, Session};
use tilescope_session::words::sentence;

/// Why a GPU that is none does not sample by itself.
pub(super) const ON_CPU: &str = "The browser's GPU computes on the CPU itself, which takes longer.";

impl State {
    /// Chooses who samples. The GPU is opened and tested first, unless it was already.
    pub(super) fn choose_engine(&mut self, engine: Engine) {
        if engine == Engine::Gpu {
            match self.gpu.device {
                Device::Refused(_) => return,
                Device::Unknown => self.test_device(true),
                Device::Testing(_) | Device::Ready(_) => {}
            }
        }
        self.form.engine = engine;
    }

    /// Names the adapter to be opened with the next choice of the GPU.
    pub(super) fn name_adapter(&mut self, name: Option<String>) {
        self.gpu.adapter = name;
        self.gpu.device = Device::Unknown;
        if self.form.engine == Engine::Gpu {
            self.form.engine = Engine::Auto;
        }
    }

    /// Opens the GPU and tests it; one that computes on the CPU only if `software` is wanted, as its test takes long.
    pub(super) fn test_device(&mut self, software: bool) {
        let choice = Choice {
            name: self.gpu.adapter.clone(),
            software,
            limits: None,
        };
        self.gpu.device = Device::Testing(Job::start_future(&self.jobs.wake, |_| {
            open_and_test(choice)
        }));
    }

    /// Takes the verdict of a device's test. One that failed is left for the CPU.
    pub(super) fn finish_test(&mut self, outcome: Result<Result<Tried, GpuError>, String>) {
        if let Ok(Err(GpuError::SoftwareOnly { .. })) = outcome {
            // It was not wanted when the test began, but may have been chosen since.
            if self.form.engine == Engine::Gpu {
                self.test_device(true);
            } else {
                self.gpu.device = Device::Unknown;
                self.gpu.failure = Some(ON_CPU.to_owned());
            }
            return;
        }
        self.gpu.device = Device::from_test(outcome);
        if self.form.engine == Engine::Gpu
            && let Some(reason) = self.gpu.device.refusal()
        {
            let text = format!("The GPU cannot serve. {reason} The CPU engine samples instead.");
            self.form.engine = Engine::Auto;
            self.tell(text, true);
        }
    }

    /// Starts a run of `recipe` by `engine`.
    pub(super) fn start_sampling(&mut self, which: Which, recipe: Recipe, engine: Engine) {
        self.jobs.generation += 1;
        let generation = self.jobs.generation;
        let job = match self.device_for_run(&recipe.parameters, engine) {
            Some(gpu) => Job::start_future(&self.jobs.wake, move |monitor| async move {
                tilescope_session::sampling::on_gpu(gpu, &recipe, generation, &monitor).await
            }),
            None => errand::start(&self.jobs.wake, Sampling { recipe, generation }),
        };
        self.on(which, |run, _| run.sampling = Some(job));
    }

    /// Returns whether a device that is ready samples where `engine` is chosen.
    pub(crate) fn device_takes(&self, engine: Engine) -> bool {
        let is_gpu = |gpu: &Arc<Gpu>| !gpu.report().is_software;
        match engine {
            Engine::Gpu => self.gpu.device.ready().is_some(),
            Engine::Auto => {
                self.gpu.display.is_some() && self.gpu.device.ready().is_some_and(is_gpu)
            }
            Engine::Cpu => false,
        }
    }

    /// Algorithm 4 as printed is for the CPU, whoever is chosen.
    fn device_for_run(&self, parameters: &Parameters, engine: Engine) -> Option<Arc<Gpu>> {
        let serves = self.device_takes(engine) && parameters.variant == Variant::Staged;
        self.gpu.device.ready().filter(|_| serves).map(Arc::clone)
    }

    /// Returns what there is to say of the engine that samples next: a line, and all of it. Nothing where the choice alone
    /// says who samples, and why.
    #[must_use]
    pub fn engine_said(&self) -> Option<(&'static str, String)> {
        let is_free = self.form.engine == Engine::Auto && self.gpu.display.is_some();
        let takes = self.device_takes(self.form.engine);
        let line = match &self.gpu.device {
            Device::Ready(_)
                if takes && self.form.draft.parameters.variant == Variant::AsPrinted =>
            {
                "CPU: it alone runs Algorithm 4 as printed."
            }
            Device::Ready(_) if takes => "GPU: self-test passed.",
            Device::Testing(_) if self.form.engine == Engine::Gpu => "GPU: being tested.",
            Device::Testing(_) if is_free => "CPU, until the GPU is tested.",
            Device::Ready(_) if is_free => "CPU: this GPU is emulated, and slower.",
            Device::Refused(_) if is_free => "CPU: there is no GPU to use here.",
            Device::Unknown if is_free && self.gpu.failure.is_some() => "CPU: the GPU failed.",
            _ => return None,
        };
        let test = self
            .gpu
            .device
            .said()
            .filter(|_| self.gpu.device.ready().is_some());
        let all: Vec<String> = self.chosen().into_iter().chain(test).collect();
        let all = if all.is_empty() {
            self.gpu.device.said()?
        } else {
            all.join(" ")
        };
        Some((line, all))
    }

    /// Shows a session and says if the CPU had to stand in for the GPU.
    pub(super) fn show_made(&mut self, which: Which, mut session: Session) {
        let failure = session.failure.take();
        let is_run = session.combination.is_none();
        let differs = is_run && session.has_stages() && session.recording().is_none();
        let engine = session.engine.clone();
        if is_run {
            self.show_in(which, session);
        } else {
            self.show_combination(which, session);
        }
        if differs {
            let text = format!(
                "The run of {engine} differs from the CPU's run with the same parameters. It is shown as it is, without events. \
                 The passes of the GPU show where the two part."
            );
            self.tell_of(which, text, true);
        }
        if let Some(Failure { name, error }) = failure {
            self.gpu.device.failed(&error);
            if !matches!(self.gpu.device, Device::Ready(_)) {
                self.form.engine = Engine::Auto;
            }
            let why = sentence(&error.to_string());
            self.gpu.failure = Some(format!("{name} failed. {why}"));
            let text = format!(
                "{name} failed. {why} The CPU engine made this session instead; the points are the same."
            );
            self.tell_of(which, text, true);
        }
    }

    /// Waits for the test of a device.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn settle_device(&mut self) {
        if let Device::Testing(job) = &self.gpu.device {
            let outcome = job.wait();
            self.finish_test(outcome);
        }
    }

    /// Returns why the passes cannot be looked at now, or `None` if they can.
    #[must_use]
    pub fn passes_refusal(&self) -> Option<String> {
        let Some(session) = &self.runs.first.session else {
            return Some("There is no session yet.".to_owned());
        };
        if session.combination.is_some() {
            return Some(
                "This is a combination of sets, made on the CPU; the passes are those of a run."
                    .to_owned(),
            );
        }
        if session.own.is_some() {
            return Some(
                "This session's pattern comes from a file; the passes can be looked at with a generated pattern."
                    .to_owned(),
            );
        }
        if cfg!(target_arch = "wasm32") && session.summary.count > MOST_PASSES_ON_A_PAGE {
            return Some(format!(
                "A page shows the passes of runs of up to {} samples; the native program has no such limit.",
                tilescope_session::words::grouped(MOST_PASSES_ON_A_PAGE)
            ));
        }
        match &self.gpu.device {
            Device::Ready(_) => None,
            Device::Unknown => {
                Some("Choose the GPU as the engine first: it is opened and tested then.".to_owned())
            }
            device => device.said(),
        }
    }

    pub(super) fn open_passes(&mut self) {
        if self.passes_refusal().is_some() {
            return;
        }
        let (Some(gpu), Some(session)) = (self.gpu.device.ready(), &self.runs.first.session) else {
            return;
        };
        match Passes::new(gpu, &session.run().parameters, &self.jobs.wake) {
            Ok(passes) => self.runs.first.passes = Some(passes),
            Err(refusal) => self.tell(sentence(&refusal), true),
        }
    }

    /// Has time run as before once there are no passes for it to run by.
    pub(super) const fn follow_passes(&mut self) {
        if self.runs.first.passes.is_none() {
            self.time.playback.clock = self.time.playback.clock_of_events();
        }
    }

    /// Returns what the canvas shows of the GPU's buffers: something only while the panel of passes can be seen, time
    /// runs by passes, or the timeline stands where it stood when the passes were dealt with last.
    #[must_use]
    pub fn buffers_on_canvas(&self) -> Option<OnCanvas<'_>> {
        let passes = self.runs.first.passes.as_ref()?;
        let is_seen = self.window.shows(Panel::Passes) && self.appearance.look != Look::Projector;
        let is_then = passes.moment() == Some(self.runs.first.moment());
        let is_meant = is_seen || is_then || self.time.playback.clock == Clock::Pass;
        passes.on_canvas().filter(|_| is_meant)
    }

    pub(super) fn apply_to_passes(&mut self, command: PassCommand) {
        let shows_canvas = command == PassCommand::ShowCanvas;
        self.on(Which::First, |run, context| {
            run.apply_to_passes(command, context);
        });
        if shows_canvas && self.runs.first.passes.is_some() {
            self.show_buffers();
        }
    }

    /// Brings the canvas into view; time runs by passes from now on. A selected row of theirs is flown to.
    fn show_buffers(&mut self) {
        self.time.playback.choose(Clock::Pass);
        self.window.open_panel(Panel::Canvas);
        self.on(Which::First, |run, context| {
            let place = run.passes.as_ref().and_then(Passes::picked_place);
            if let Some(place) = place {
                run.fly_to(place, 12.0, context);
            }
        });
    }
}
