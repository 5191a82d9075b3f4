//! Exports in the state: the commands of the export sheet, and whether an export may begin. Begin with
//! [`Exports::prospect`], which says what would be exported or why nothing can be, and [`Exports::job`]. `outcome.rs` starts
//! the export and shows the notice at its end. While a question of a lesson is open, `state.rs` refuses
//! all commands of the sheet before they arrive here.

use std::ops::Range;
use std::sync::Arc;

use tilescope_core::Stage;
use tilescope_debugger::SavedScene;
use tilescope_drawing::brushed::BrushedCause;
use tilescope_drawing::picture::{Legend, MomentView, PictureView};
use tilescope_formats::{Format, check_solid_format};
use tilescope_session::jobs::Job;
use tilescope_session::layers::Layers;
use tilescope_session::selection::Selection;
use tilescope_session::session::Session;
use tilescope_session::words::{counted, grouped, sentence};

use super::effects::{Context, Effect};
use super::{RunView, State, Time};
use crate::appearance::Appearance;
use crate::export::beside::too_much;
use crate::export::frames::{Count, Key, count, every_at_first, frames};
use crate::export::picture::{MAX_DRAWN, size_refusal};
use crate::export::{
    ExportCommand, ExportContent, ExportForm, ExportJob, ExportKind, ExportRefusal, MAX_FRAMES,
    NumberField,
};
use crate::files::Delivery;
use crate::scene_view::view_of_scene;

/// The export sheet, and the running export.
#[derive(Default)]
pub struct Exports {
    /// The sheet, if open.
    pub sheet: Option<ExportForm>,
    /// The number of frames of the sheet's animation.
    frames: Option<Count>,
    /// The running export, if there is one.
    pub work: Option<Job<Outcome>>,
    /// The system's file dialog for it, if open.
    #[cfg(not(target_arch = "wasm32"))]
    pub browsing: Option<Job<Option<std::path::PathBuf>>>,
}

/// When the window closes, a running export is cancelled. Its thread would end with the process, before it removed the
/// unfinished file.
#[cfg(not(target_arch = "wasm32"))]
impl Drop for Exports {
    fn drop(&mut self) {
        if let Some(job) = self.work.take() {
            job.cancel();
            // The outcome is of no use any more.
            let _ = job.wait();
        }
    }
}

/// The input of an export: the parts of the state that it shows.
#[derive(Clone, Copy)]
pub struct ExportSource<'a> {
    /// The run that the panels show.
    pub run: &'a RunView,
    /// Playback, whose loop an animation can show.
    pub time: &'a Time,
    /// The appearance of moments.
    pub appearance: &'a Appearance,
    /// The causes of the brush, if visible.
    pub causes: Option<&'a BrushedCause>,
    /// The caption of the scene that is shown, if it has one.
    pub caption: Option<&'a str>,
}

impl Exports {
    /// Applies a command of the sheet.
    pub(super) fn apply(
        &mut self,
        command: ExportCommand,
        source: ExportSource<'_>,
        delivery: Delivery,
        context: &mut Context,
    ) {
        if let Some(form) = &mut self.sheet {
            // Scenes may have come or gone since the sheet was opened.
            form.scenes = source.scenes().len();
        }

        match command {
            ExportCommand::Open(kind) => {
                // Only one sheet is open at a time, and an older notice is about something else.
                context.ask(Effect::CloseFileSheet);
                context.ask(Effect::CloseNotice);
                self.sheet.get_or_insert_default().scenes = source.scenes().len();
                self.choose(kind, source);
            }

            ExportCommand::Close => self.sheet = None,
            ExportCommand::Choose(kind) => self.choose(kind, source),
            ExportCommand::Clock(clock) => {
                if let Some(form) = &mut self.sheet {
                    form.clock = clock;
                    // The ticks between frames were proposed for another clock.
                    self.propose_every(source);
                }
            }
            ExportCommand::WholeRun(whole) => {
                if let Some(form) = &mut self.sheet {
                    // The passage of a plane is offered in place of both parts of the run.
                    (form.whole_run, form.passage) = (whole, false);
                    self.propose_every(source);
                }
            }

            #[cfg(not(target_arch = "wasm32"))]
            ExportCommand::Browse => {
                if let Some(why) = crate::files::dialog::refusal() {
                    return context.tell_error(why);
                }
                let form = self.sheet.as_ref();
                let browse = |form| crate::export::browse::browse(form, &context.wake);
                // Without a sheet a dialog that is already open stays.
                self.browsing = form.map(browse).or_else(|| self.browsing.take());
            }

            ExportCommand::Write => self.start(source, delivery, context),
            ExportCommand::Cancel => {
                if let Some(job) = &self.work {
                    job.cancel();
                }
            }

            // All other commands change a field of the sheet.
            command => {
                if let Some(form) = &mut self.sheet {
                    fill_in(form, command);
                }
            }
        }

        self.count_frames(source);
    }

    fn choose(&mut self, kind: ExportKind, source: ExportSource<'_>) {
        if let Some(form) = &mut self.sheet {
            form.choose(kind);
            if kind == ExportKind::Animation && form.every.is_empty() {
                self.propose_every(source);
            }
        }
    }

    /// Proposes the number of ticks between frames.
    fn propose_every(&mut self, source: ExportSource<'_>) {
        if let (Some(form), Some(session)) = (&mut self.sheet, &source.run.session)
            && let Some(range) = source.range(form)
        {
            form.every = every_at_first(session, &range, form.clock).to_string();
        }
    }

    /// Returns a short description of the export, or why it cannot be written.
    pub fn prospect(&self, source: ExportSource<'_>) -> Result<String, ExportRefusal> {
        let (Some(form), Some(session)) = (&self.sheet, &source.run.session) else {
            return Err(ExportRefusal::NoSession);
        };

        // The kind is checked before the name of the file, since a name does not help where there is nothing to export. The
        // name gives the format, which for a set in space needs a third coordinate.
        let refusal = source.kind_refusal(form.kind);
        let of_name = || form.name_refusal().or_else(|| lacks_third(form, session));
        if let Some(refusal) = refusal.or_else(of_name) {
            return Err(refusal);
        }

        match form.kind {
            kind if source.shows_balls(kind) => source.balls_prospect(form),
            ExportKind::Animation if source.shows_passage(form) => source.passage_prospect(form),
            ExportKind::Animation if source.is_stipple() => source.making_prospect(form),
            ExportKind::Result | ExportKind::Samples if source.is_stipple() => {
                // The sheet has fields for colours only if the format is SVG. A wrong colour does not refuse another format.
                if form.draws_samples() {
                    form.ink.look()?;
                }
                Ok(match form.kind {
                    ExportKind::Result => counted(session.summary.count, "dot", "dots"),
                    _ => source.moment_name(),
                })
            }
            ExportKind::Result => Ok(counted(session.summary.count, "sample", "samples")),
            ExportKind::Samples => Ok(source.moment_name()),
            ExportKind::Picture if form.ink.on_paper && source.is_stipple() => {
                form.ink.look()?;
                let columns = grouped(form.columns()? as usize);
                let moment = source.moment_name();
                if !form.has_columns() {
                    return Ok(moment);
                }
                Ok(format!("{moment}, {columns} pixels wide"))
            }
            ExportKind::Picture => {
                let (shown, scale) = checked_view(form, source)?;
                let pictures = 1;
                check_measured(form, session, pictures)?;
                let size = size_text(&shown.view, scale);
                Ok(format!("{}, {size}", source.moment_name()))
            }
            ExportKind::Scenes => {
                let (shown, scale) = checked_scenes(form, source)?;
                check_measured(form, session, shown.len())?;
                let pictures = counted(shown.len(), "picture", "pictures");
                let left_out = form.scenes.saturating_sub(shown.len());
                let remark = match left_out {
                    0 => String::new(),
                    count => format!("; {count} of other runs are left out"),
                };
                // There is a first picture: without one, `checked_scenes` has refused.
                let size = shown.first().map(|first| size_text(&first.view, scale));
                Ok(format!("{pictures}, {}{remark}", size.unwrap_or_default()))
            }
            ExportKind::Animation => {
                let (shown, scale) = checked_view(form, source)?;
                let size = size_text(&shown.view, scale);
                let frames = self.frame_count(form, source)?;
                check_measured(form, session, frames)?;
                // A delay counts hundredths of a second.
                let secs = frames as f64 * f64::from(form.delay()?) / 100.0;
                Ok(format!(
                    "{frames} frames of at most {MAX_FRAMES}, {size}, {secs:.1} s"
                ))
            }
        }
    }

    /// Returns the number of frames of the animation. It is counted anew only if something has changed since the last count.
    fn frame_count(
        &self,
        form: &ExportForm,
        source: ExportSource<'_>,
    ) -> Result<usize, ExportRefusal> {
        let key = frames_key(form, source)?;
        match &self.frames {
            Some(known) if known.key == key => known.frames.clone(),
            _ => {
                let (_, range, clock, every) = key;
                count(source.session()?, &range, clock, every)
            }
        }
    }

    /// Counts the frames of the animation if their number may have changed; counting lines walks over all
    /// events.
    pub(super) fn count_frames(&mut self, source: ExportSource<'_>) {
        let animation = |form: &&ExportForm| form.kind == ExportKind::Animation;
        let Some(form) = self.sheet.as_ref().filter(animation) else {
            return;
        };
        if let Ok(key) = frames_key(form, source)
            && self.frames.as_ref().is_none_or(|known| known.key != key)
        {
            let frames = self.frame_count(form, source);
            self.frames = Some(Count { key, frames });
        }
    }

    /// Returns the export that the sheet describes.
    pub fn job(&self, source: ExportSource<'_>) -> Result<ExportJob, ExportRefusal> {
        // `prospect` finds every reason to refuse an export.
        self.prospect(source)?;

        let (Some(form), Some(session)) = (&self.sheet, &source.run.session) else {
            return Err(ExportRefusal::NoSession);
        };

        let content = match form.kind {
            kind if source.shows_balls(kind) => ExportContent::Balls {
                shown: source.balls(form)?,
                delay: (kind == ExportKind::Animation)
                    .then(|| form.delay())
                    .transpose()?,
            },
            ExportKind::Animation if source.shows_passage(form) => ExportContent::Passage {
                shown: source.passage(form)?,
                delay: form.delay()?,
            },
            ExportKind::Animation if source.is_stipple() => ExportContent::Making {
                look: form.ink.look()?,
                columns: source.making_columns(form)?,
                delay: form.delay()?,
            },
            // The result of the run is exported without a moment.
            ExportKind::Result | ExportKind::Samples => ExportContent::Samples {
                moment: (source.run.moment()).filter(|_| form.kind == ExportKind::Samples),
                precision: form.precision,
                look: (source.is_stipple() && form.draws_samples())
                    .then(|| form.ink.look())
                    .transpose()?,
            },
            ExportKind::Picture if form.ink.on_paper && source.is_stipple() => {
                ExportContent::Dots {
                    moment: source.run.moment().ok_or(ExportRefusal::NoSession)?,
                    look: form.ink.look()?,
                    columns: form.columns()?,
                }
            }
            ExportKind::Picture => {
                let (shown, scale) = checked_view(form, source)?;
                ExportContent::Picture {
                    shown,
                    causes: source.causes.map(|found| found.cause.clone()),
                    scale,
                }
            }
            ExportKind::Scenes => {
                let (shown, scale) = checked_scenes(form, source)?;
                ExportContent::Scenes { shown, scale }
            }
            ExportKind::Animation => {
                let (shown, scale) = checked_view(form, source)?;
                let (_, range, clock, every) = frames_key(form, source)?;
                ExportContent::Animation {
                    cursors: frames(session, &range, clock, every)?,
                    view: shown.view,
                    scale,
                    delay: form.delay()?,
                    clock,
                    every,
                }
            }
        };

        Ok(ExportJob {
            path: form.file(),
            session: tilescope_session::task::SessionRef(Arc::clone(session)),
            content,
        })
    }

    /// Returns the fraction of the running export that is done.
    #[must_use]
    pub fn fraction(&self) -> Option<f32> {
        self.work.as_ref().map(Job::fraction)
    }
}

impl<'a> ExportSource<'a> {
    /// Returns the input of an export of what a window shows.
    #[must_use]
    pub fn of(state: &'a State) -> Self {
        let run = &state.runs.first;
        Self {
            run,
            time: &state.time,
            appearance: &state.appearance,
            causes: state.analysis.causes(run, &state.window),
            caption: state.scenes.caption(run),
        }
    }
}

impl ExportSource<'_> {
    fn session(&self) -> Result<&Arc<Session>, ExportRefusal> {
        self.run.session.as_ref().ok_or(ExportRefusal::NoSession)
    }

    /// Returns whether a stipple is exported, which is drawn as dots on paper.
    #[must_use]
    pub fn is_stipple(&self) -> bool {
        self.run.shows_stipple()
    }

    /// Returns why no export of a kind is possible now, whatever the sheet says.
    #[must_use]
    pub fn kind_refusal(&self, kind: ExportKind) -> Option<ExportRefusal> {
        let (Some(session), Some(moment)) = (&self.run.session, self.run.moment()) else {
            return Some(ExportRefusal::NoSession);
        };
        // An animation shows events. The sets that never have any come first, as their refusals say why.
        match kind {
            // A set in space has its plane or its balls to move.
            ExportKind::Animation if session.solid.is_some() => None,
            ExportKind::Animation if session.combination.is_some() => {
                Some(ExportRefusal::Combination)
            }
            ExportKind::Animation if session.nested.is_some() => Some(ExportRefusal::Nested),
            // The dots of a stipple appear in the order of their arrival.
            ExportKind::Animation if session.stipple().is_some() => None,
            ExportKind::Animation if session.recording().is_none() => Some(ExportRefusal::NoEvents),
            ExportKind::Samples if !moment.has_samples(session) => Some(ExportRefusal::NoSamples),
            ExportKind::Scenes if self.scenes().is_empty() => Some(ExportRefusal::NoScenes),
            // Results and pictures can be made of any session, and the other kinds have what they need.
            _ => None,
        }
    }

    /// Returns the range of cursors of an animation: the whole run if that was chosen, the loop, or otherwise the stage.
    #[must_use]
    pub fn range(&self, form: &ExportForm) -> Option<Range<usize>> {
        let session = self.run.session.as_ref()?;
        if form.whole_run {
            let (_, len) = self.run.cursor()?;
            return Some(0..len);
        }
        let end = session.stage_end(self.run.stage)?;
        let start = match self.run.stage.checked_sub(1) {
            Some(before) => session.stage_end(before)?,
            None => 0,
        };
        let range = self.time.playback.range.clone();
        Some(range.unwrap_or(start..end))
    }

    fn scenes(&self) -> &[SavedScene] {
        let debugger = self.run.debugger.as_ref();
        debugger.map_or(&[], |debugger| &debugger.scenes)
    }

    /// Returns the legend of the layers at a stage; of all stages for an animation.
    fn legend(&self, kind: ExportKind, stage: Stage) -> Legend {
        let layers = match self.appearance.chosen_layers {
            Some(layers) => layers,
            None if kind == ExportKind::Animation => Layers::of_any_stage(),
            None => Layers::of_stage_in(self.run.kind(), stage),
        };
        Legend {
            layers,
            kind: self.run.kind(),
            octaves: (self.run.session.as_ref()).and_then(|session| session.octaves()),
        }
    }

    /// Returns the view of a picture, as on the canvas, with the caption of the scene shown and without a legend. Animations
    /// show the run's domain even while the canvas shows the pattern.
    pub fn view(&self, kind: ExportKind, print: bool) -> Result<PictureView, ExportRefusal> {
        if !self.run.viewport.is_positive() {
            return Err(ExportRefusal::NoCanvas);
        }

        // An animation shows the run's domain. While the canvas shows the pattern, the camera from before that is the one for the
        // domain.
        let camera = match self.run.before_pattern {
            Some((camera, _)) if kind == ExportKind::Animation => camera,
            _ => self.run.camera,
        };
        let size = self.run.viewport.size();

        Ok(PictureView {
            camera,
            size: [size.x, size.y].map(f64::from),
            chosen_layers: self.appearance.chosen_layers,
            colouring: self.appearance.colouring,
            // An animation has moments at which a selected sample is not there.
            selection: match kind {
                ExportKind::Animation => Selection::Nothing,
                _ => self.run.selection(),
            },
            dark: self.appearance.look.is_dark(),
            print,
            caption: self.caption.unwrap_or_default().to_owned(),
            // `checked_view` sets legend and analysis.
            legend: None,
            analysis: false,
            // In an animation a plane that is not pinned follows the events.
            plane: match (kind, self.run.follows_events()) {
                (ExportKind::Animation, Some(true)) => None,
                _ => self.run.plane(),
            },
        })
    }

    /// Returns the moment in a few words.
    pub(crate) fn moment_name(&self) -> String {
        if let Some((count, all)) = self.run.prefix().zip(self.run.session.as_ref()) {
            let (one, many) = if self.is_stipple() {
                ("dot", "dots")
            } else {
                ("sample", "samples")
            };
            let all = counted(all.summary.count, one, many);
            return format!("The first {} of {all}", grouped(count));
        }
        let stage = self.run.current_stage().map(|stage| stage.to_string());
        let sentence = tilescope_session::words::sentence(&stage.unwrap_or_default());
        let name = sentence.trim_end_matches('.');

        match self.run.cursor() {
            Some((at, all)) => format!("{name}, event {} of {}", grouped(at), grouped(all)),
            None => name.to_owned(),
        }
    }
}

/// Returns the moment and the view of the sheet's picture, and its scale.
fn checked_view(
    form: &ExportForm,
    source: ExportSource<'_>,
) -> Result<(MomentView, f64), ExportRefusal> {
    let moment = source.run.moment().ok_or(ExportRefusal::NoSession)?;
    let mut view = source.view(form.kind, form.print)?;
    view.legend = form.legend.then(|| source.legend(form.kind, moment.stage));
    view.analysis = form.analysis;
    let shown = MomentView { moment, view };
    let scale = checked_scale(form, source, &shown.view)?;
    Ok((shown, scale))
}

/// Returns the moments and views of the scenes, and the scale of their pictures. Scenes whose moments this run does not have are
/// left out.
fn checked_scenes(
    form: &ExportForm,
    source: ExportSource<'_>,
) -> Result<(Vec<MomentView>, f64), ExportRefusal> {
    let (Some(session), Some(debugger)) = (&source.run.session, &source.run.debugger) else {
        return Err(ExportRefusal::NoSession);
    };
    let canvas = source.view(form.kind, form.print)?;
    let scenes = source.scenes().iter();
    let mut shown: Vec<MomentView> = scenes
        .filter_map(|scene| view_of_scene(session, debugger, scene, canvas.size, canvas.dark))
        .collect();

    // The scale is the same for all scenes, but each picture must be within the limits. Without a scene there is nothing to export.
    let mut scale = Err(ExportRefusal::NoScenes);
    for MomentView { moment, view } in &mut shown {
        view.print = form.print;
        view.analysis = form.analysis;
        // The legend of a scene has the layers that this scene shows.
        let layers = view.layers(session.kind(), moment.stage);
        view.legend = form.legend.then(|| Legend {
            layers,
            ..source.legend(form.kind, moment.stage)
        });
        scale = Ok(checked_scale(form, source, view)?);
    }
    Ok((shown, scale?))
}

/// Returns the scale of a sheet. Refuses a picture that is too large or would draw too many samples.
fn checked_scale(
    form: &ExportForm,
    source: ExportSource<'_>,
    view: &PictureView,
) -> Result<f64, ExportRefusal> {
    let (low, high) = view.camera.visible(source.run.viewport);
    // A session without a moment to show yet has no samples to draw.
    let samples = (source.run.shown()).map_or(0, |shown| shown.count_within(low, high));
    if samples > MAX_DRAWN {
        return Err(ExportRefusal::TooManySamples(samples));
    }

    let scale = if form.has_scale() { form.scale()? } else { 1.0 };
    let animated = form.kind == ExportKind::Animation;
    size_refusal(view, scale, animated).map_or(Ok(scale), Err)
}

/// Refuses the analysis of too many pictures of a session.
fn check_measured(
    form: &ExportForm,
    session: &Session,
    pictures: usize,
) -> Result<(), ExportRefusal> {
    if form.analysis && session.solid.is_some() {
        return Err(ExportRefusal::SolidAnalysis);
    }
    let refusal = too_much(session, pictures).filter(|_| form.analysis);
    refusal.map_or(Ok(()), Err)
}

/// Returns why the format of a sheet cannot hold the set, if that is in space.
fn lacks_third(form: &ExportForm, session: &Session) -> Option<ExportRefusal> {
    // Pictures show a plane of the set, and need no third coordinate.
    session.solid.as_ref().filter(|_| form.kind.is_set())?;
    let format = Format::from_path(&form.file())?;
    let refused = check_solid_format(format).err()?;
    Some(ExportRefusal::NotInSpace(sentence(&refused.to_string())))
}

/// Returns the size of a picture in words.
fn size_text(view: &PictureView, scale: f64) -> String {
    let [width, height] = view.pixels(scale).map(grouped);
    format!("{width} x {height} pixels")
}

fn frames_key(form: &ExportForm, source: ExportSource<'_>) -> Result<Key, ExportRefusal> {
    let generation = source.session()?.generation;
    let range = source.range(form).ok_or(ExportRefusal::NoEvents)?;
    Ok((generation, range, form.clock, form.every()?))
}

/// Changes a field of the sheet.
fn fill_in(form: &mut ExportForm, command: ExportCommand) {
    match command {
        ExportCommand::Path(path) => {
            form.path = path;
            form.look();
            form.asked = false;
        }
        ExportCommand::Precision(precision) => form.precision = precision,
        // The sheet offers ink on paper in place of both colours of `print`.
        ExportCommand::Print(print) => (form.print, form.ink.on_paper) = (print, false),
        ExportCommand::Ink(command) => form.ink.apply(command),
        ExportCommand::Type(NumberField::Columns, text) => form.columns = text,
        ExportCommand::Legend(legend) => form.legend = legend,
        ExportCommand::Passage(passage) => form.passage = passage,
        ExportCommand::Analysis(analysis) => form.analysis = analysis,
        ExportCommand::Type(NumberField::Scale, text) => form.scale = text,
        ExportCommand::Type(NumberField::Every, text) => form.every = text,
        ExportCommand::Type(NumberField::Delay, text) => form.delay = text,
        // `Exports::apply` carries out the others. `Browse` comes here on a page, which has no dialog to open.
        _ => {}
    }
}

mod balls;
mod making;
mod outcome;
pub use outcome::{ExportTask, Outcome};
