//! The commands of the export sheet, what an export of this state is made of, and what becomes of it.

use std::ops::Range;
use std::sync::Arc;
use tilescope_session::selection::Selection;

use tilescope_session::words::{counted, grouped};

use super::State;
use crate::export::frames::{Count, Key, count, every_at_first, frames};
use crate::export::picture::MOST_DRAWN;
use crate::export::{
    Content, Entry, ExportCommand, ExportForm, Kind, MOST_FRAMES, Order, Refusal, View,
};

impl State {
    pub(super) fn apply_to_export(&mut self, command: ExportCommand) {
        match command {
            ExportCommand::Open(kind) => {
                self.files.sheet = None;
                self.files.export.get_or_insert_default();
                self.choose_export(kind);
            }
            ExportCommand::Close => self.files.export = None,
            ExportCommand::Choose(kind) => self.choose_export(kind),
            ExportCommand::Clock(clock) => {
                if let Some(form) = &mut self.files.export {
                    form.clock = clock;
                    self.propose_every();
                }
            }
            #[cfg(not(target_arch = "wasm32"))]
            ExportCommand::Browse => {
                if let Some(form) = &self.files.export {
                    self.files.browsing =
                        Some(crate::export::browse::browse(form, &self.jobs.wake));
                }
            }
            ExportCommand::Write => self.start_export(),
            ExportCommand::Cancel => {
                if let Some(job) = &self.files.exporting {
                    job.cancel();
                }
            }
            command => {
                if let Some(form) = &mut self.files.export {
                    fill_in(form, command);
                }
            }
        }
        self.count_frames();
    }

    fn choose_export(&mut self, kind: Kind) {
        if let Some(form) = &mut self.files.export {
            form.choose(kind);
            if kind == Kind::Animation && form.every.is_empty() {
                self.propose_every();
            }
        }
    }

    /// Fills in how many ticks lie between frames.
    fn propose_every(&mut self) {
        let range = self.export_range();
        if let (Some(form), Some(session), Some(range)) =
            (&mut self.files.export, &self.runs.first.session, range)
        {
            form.every = every_at_first(session, &range, form.clock).to_string();
        }
    }

    /// Returns why nothing of a kind can be exported now, whatever the sheet says.
    #[must_use]
    pub fn kind_refusal(&self, kind: Kind) -> Option<Refusal> {
        let (Some(session), Some(moment)) = (&self.runs.first.session, self.runs.first.moment())
        else {
            return Some(Refusal::NoSession);
        };
        match kind {
            Kind::Animation if session.combination.is_some() => Some(Refusal::Combination),
            Kind::Animation if session.recording().is_none() => Some(Refusal::NoEvents),
            Kind::Samples if !moment.has_samples(session) => Some(Refusal::NoSamples),
            _ => None,
        }
    }

    /// Returns the cursors between which an animation goes: those of the loop, else those of the stage.
    #[must_use]
    pub fn export_range(&self) -> Option<Range<usize>> {
        let session = self.runs.first.session.as_ref()?;
        let end = session.stage_end(self.runs.first.stage)?;
        let start = match self.runs.first.stage.checked_sub(1) {
            Some(before) => session.stage_end(before)?,
            None => 0,
        };
        let range = self.time.playback.range.clone();
        Some(range.unwrap_or(start..end))
    }

    /// Returns what of the plane a picture shows: what the canvas shows. Animations are of the run's domain, also
    /// while the canvas shows the pattern.
    pub fn export_view(&self, kind: Kind) -> Result<View, Refusal> {
        if !self.runs.first.viewport.is_positive() {
            return Err(Refusal::NoCanvas);
        }
        let camera = match self.runs.first.before_pattern {
            Some((camera, _)) if kind == Kind::Animation => camera,
            _ => self.runs.first.camera,
        };
        let size = self.runs.first.viewport.size();
        Ok(View {
            camera,
            size: [size.x, size.y].map(f64::from),
            layers: self.appearance.layers,
            colouring: self.appearance.colouring,
            selection: match kind {
                Kind::Animation => Selection::Nothing,
                _ => self.runs.first.selection(),
            },
            dark: tilescope_drawing::palette::Palette::of(self.appearance.look).dark,
            print: self.files.export.as_ref().is_some_and(|form| form.print),
        })
    }

    /// Returns what the sheet asks for, in a few words, or why it cannot be written.
    pub fn export_prospect(&self) -> Result<String, Refusal> {
        let (Some(form), Some(session)) = (&self.files.export, &self.runs.first.session) else {
            return Err(Refusal::NoSession);
        };
        let refusal = self.kind_refusal(form.kind).or_else(|| form.name_refusal());
        if let Some(refusal) = refusal {
            return Err(refusal);
        }
        match form.kind {
            Kind::Result => Ok(counted(session.summary.count, "sample", "samples")),
            Kind::Samples => Ok(self.moment_name()),
            Kind::Picture => {
                let size = self.checked_view(form)?.1;
                Ok(format!("{}, {size}", self.moment_name()))
            }
            Kind::Animation => {
                let size = self.checked_view(form)?.1;
                let frames = self.frame_count(form)?;
                let secs = frames as f64 * f64::from(form.delay()?) / 100.0;
                Ok(format!(
                    "{frames} frames of at most {MOST_FRAMES}, {size}, {secs:.1} s"
                ))
            }
        }
    }

    /// Returns the moment in a few words.
    #[must_use]
    pub fn moment_name(&self) -> String {
        let stage = self.current_stage().map(|stage| stage.to_string());
        let stage = tilescope_session::words::sentence(&stage.unwrap_or_default());
        let stage = stage.trim_end_matches('.');
        match self.cursor() {
            Some((at, all)) => format!("{stage}, event {} of {}", grouped(at), grouped(all)),
            None => stage.to_owned(),
        }
    }

    /// Returns the view of a sheet with its scale and, in words, its size.
    fn checked_view(&self, form: &ExportForm) -> Result<((View, f64), String), Refusal> {
        let session = self.runs.first.session.as_ref().ok_or(Refusal::NoSession)?;
        let view = self.export_view(form.kind)?;
        let (low, high) = view.camera.visible(self.runs.first.viewport);
        let samples = session.index.count_in(low, high);
        if samples > MOST_DRAWN {
            return Err(Refusal::TooManySamples { samples });
        }
        let scale = if form.has_scale() { form.scale()? } else { 1.0 };
        let animated = form.kind == Kind::Animation;
        if let Some(refusal) = view.size_refusal(scale, animated) {
            return Err(refusal);
        }
        let [width, height] = view.pixels(scale).map(grouped);
        Ok(((view, scale), format!("{width} x {height} pixels")))
    }

    fn frames_key(&self, form: &ExportForm) -> Result<Key, Refusal> {
        let session = self.runs.first.session.as_ref().ok_or(Refusal::NoSession)?;
        let range = self.export_range().ok_or(Refusal::NoEvents)?;
        Ok((session.generation, range, form.clock, form.every()?))
    }

    fn frame_count(&self, form: &ExportForm) -> Result<usize, Refusal> {
        let key = self.frames_key(form)?;
        let session = self.runs.first.session.as_ref().ok_or(Refusal::NoSession)?;
        match &self.files.frames {
            Some(known) if known.key == key => known.frames.clone(),
            _ => count(session, &key.1, key.2, key.3),
        }
    }

    /// Counts the frames of the animation in the sheet, should that have changed: lines take a walk over events.
    pub(super) fn count_frames(&mut self) {
        let animation = |form: &&ExportForm| form.kind == Kind::Animation;
        let Some(form) = self.files.export.as_ref().filter(animation) else {
            return;
        };
        let Ok(key) = self.frames_key(form) else {
            return;
        };
        if self
            .files
            .frames
            .as_ref()
            .is_none_or(|known| known.key != key)
        {
            let frames = self.frame_count(form);
            self.files.frames = Some(Count { key, frames });
        }
    }

    /// Returns what the sheet asks for.
    pub fn export_order(&self) -> Result<Order, Refusal> {
        self.export_prospect()?;
        let (Some(form), Some(session), Some(moment)) = (
            &self.files.export,
            &self.runs.first.session,
            self.runs.first.moment(),
        ) else {
            return Err(Refusal::NoSession);
        };
        let content = match form.kind {
            Kind::Result | Kind::Samples => Content::Samples {
                moment: (form.kind == Kind::Samples).then_some(moment),
                precision: form.precision,
            },
            Kind::Picture => {
                let (view, scale) = self.checked_view(form)?.0;
                Content::Picture {
                    moment,
                    view,
                    causes: self.causes().map(|found| found.cause.clone()),
                    scale,
                }
            }
            Kind::Animation => {
                let (view, scale) = self.checked_view(form)?.0;
                let (_, range, clock, every) = self.frames_key(form)?;
                Content::Animation {
                    cursors: frames(session, &range, clock, every)?,
                    view,
                    scale,
                    delay: form.delay()?,
                    clock,
                    every,
                }
            }
        };
        Ok(Order {
            path: form.file().to_owned(),
            session: tilescope_session::errand::Lent(Arc::clone(session)),
            content,
        })
    }

    /// Returns how far the export at work has come.
    #[must_use]
    pub fn export_fraction(&self) -> Option<f32> {
        self.files
            .exporting
            .as_ref()
            .map(tilescope_session::jobs::Job::fraction)
    }
}

fn fill_in(form: &mut ExportForm, command: ExportCommand) {
    match command {
        ExportCommand::Path(path) => {
            form.path = path;
            form.look();
            form.asked = false;
        }
        ExportCommand::Precision(precision) => form.precision = precision,
        ExportCommand::Print(print) => form.print = print,
        ExportCommand::Type(Entry::Scale, text) => form.scale = text,
        ExportCommand::Type(Entry::Every, text) => form.every = text,
        ExportCommand::Type(Entry::Delay, text) => form.delay = text,
        _ => {}
    }
}

mod outcome;
pub use outcome::Delivering;
pub use outcome::Outcome;
