//! The state driven by commands, without a window.

mod lesson_fields;
mod lesson_levels;
mod lesson_told;
mod lessons;
mod talk;
mod time;

use std::sync::Arc;

use emath::Rect;
use serde_json::json;
use tilescope_core::{Parameter, Parameters, Search, Stage};
use tilescope_drawing::camera::{Camera, MIN_SCALE};
use tilescope_session::layers::Layer;
use tilescope_session::session::Session;
use tilescope_session::verification::{Witness, WitnessMark, WitnessShape};

use super::*;
use crate::command::{AppearanceCommand, FormCommand, GpuCommand, TimeCommand, ViewCommand, Which};
use crate::compare::{CompareCommand, ComparePreset};
use crate::device::EngineChoice;
use crate::draft::Choice;
use crate::export::{ExportCommand, ExportKind};
use crate::view::SavedView;

pub(super) fn settled() -> State {
    let mut state = State::new(Arc::new(|| {}));
    state.apply(Command::View(
        Which::First,
        ViewCommand::Viewport(Rect::from_min_size(
            emath::pos2(0.0, 0.0),
            emath::vec2(800.0, 800.0),
        )),
    ));
    state.settle();
    state
}

fn type_in(state: &mut State, field: Parameter, text: &str) {
    state.apply(Command::Form(FormCommand::Type(field, text.to_owned())));
}

#[test]
fn the_default_session_is_finished_and_verified() {
    let state = settled();
    let session = state.runs.first.session.as_ref().unwrap();
    assert!((9_800..10_200).contains(&session.summary.count));
    assert_eq!(state.runs.first.current_stage(), Some(Stage::Finish));
    assert!(state.runs.first.verdict().unwrap().report.valid());
}

#[test]
fn stages_stop_at_both_ends() {
    let mut state = settled();
    let last = state.runs.first.stage;
    state.apply(Command::Time(TimeCommand::StepForward));
    assert_eq!(state.runs.first.stage, last);
    state.apply(Command::Time(TimeCommand::StepBack));
    assert_eq!(state.runs.first.stage, last - 1);
    state.apply(Command::Time(TimeCommand::FirstStage));
    state.apply(Command::Time(TimeCommand::StepBack));
    assert_eq!(
        (state.runs.first.stage, state.runs.first.current_stage()),
        (0, Some(Stage::Pattern))
    );
    state.apply(Command::Time(TimeCommand::LastStage));
    assert_eq!(state.runs.first.stage, last);
}

#[test]
fn playing_ends_at_the_last_stage() {
    let mut state = settled();
    let stages = state.runs.first.stage;
    state.apply(Command::Time(TimeCommand::Speed(1.0)));
    state.apply(Command::Time(TimeCommand::TogglePlay));
    assert_eq!(state.runs.first.stage, 0);
    for _ in 0..stages {
        state.advance(crate::clock::Clock::Stage.tick_secs());
    }
    assert_eq!(state.runs.first.current_stage(), Some(Stage::Finish));
    assert!(!state.time.playback.is_playing());
}

#[test]
fn a_bad_draft_is_not_run() {
    let mut state = settled();
    type_in(&mut state, Parameter::Radius, "-3");
    assert!(state.form.refusal(&state.gpu).unwrap().contains("-3"));
    state.apply(Command::Run);
    assert!(state.runs.first.sampling.is_none());
    // A script or a page that asked for the run is told why there is none.
    let notice = state.messages.notice.clone().unwrap();
    assert!(
        notice.is_error && notice.text.starts_with("Radius: "),
        "{}",
        notice.text
    );
    state.apply(Command::Form(FormCommand::Reset));
    assert_eq!(state.form.refusal(&state.gpu), None);
    state.apply(Command::Form(FormCommand::Count("abc".to_owned())));
    assert!(
        state
            .form
            .refusal(&state.gpu)
            .unwrap()
            .starts_with("Samples: ")
    );
}

#[test]
fn a_cancelled_run_keeps_the_session_and_shows_a_notice() {
    let mut state = settled();
    let before = state.runs.first.session.as_ref().unwrap().generation;
    type_in(&mut state, Parameter::Radius, "0.0005");
    state.apply(Command::Run);
    assert_eq!(
        state.runs.first.session.as_ref().unwrap().generation,
        before
    );
    state.apply(Command::Cancel(Which::First));
    state.settle();
    assert_eq!(
        state.runs.first.session.as_ref().unwrap().generation,
        before
    );
    assert!(
        state
            .messages
            .notice
            .as_ref()
            .unwrap()
            .text
            .contains("Cancelled")
    );
    state.apply(Command::DismissNotice);
    assert!(state.messages.notice.is_none());
}

#[test]
fn a_failing_verdict_leads_to_its_witness() {
    let mut state = settled();
    type_in(&mut state, Parameter::Leaf, "6");
    type_in(&mut state, Parameter::Radius, "0.004");
    state.apply(Command::Form(FormCommand::Choose(Choice::Parameter(
        Parameter::Search,
        json!(Search::TwoRadii),
    ))));
    state.apply(Command::Run);
    state.settle();
    let report = &state.runs.first.verdict().unwrap().report;
    assert!(report.conflict_free() && !report.maximal());
    state.apply(Command::View(
        Which::First,
        ViewCommand::FlyToWitness(Witness::Verdict),
    ));
    let Some(WitnessMark { shape, is_valid }) = state.runs.first.witness_mark else {
        panic!("a gap is the witness");
    };
    let WitnessShape::Circle(center, radius) = shape else {
        panic!("a gap is a circle");
    };
    assert!(radius > 1.0 && !is_valid);
    while state.advance(0.1) {}
    assert!(state.runs.first.camera.center.abs_diff_eq(center, 1e-9));
}

#[test]
fn a_valid_set_shows_its_extremes() {
    // Lengths are in r: the nearest samples are a little more than 1 apart, and the largest hole is a little smaller.
    let is_nearest_pair = |mark: WitnessMark| {
        let is_pair = matches!(mark.shape, WitnessShape::Pair(_, d) if (1.0..1.01).contains(&d));
        is_pair && mark.is_valid
    };
    let is_largest_hole = |mark: WitnessMark| {
        let is_hole =
            matches!(mark.shape, WitnessShape::Circle(_, r) if (0.9..=1.0001).contains(&r));
        is_hole && mark.is_valid
    };

    let mut state = settled();
    state.apply(Command::View(
        Which::First,
        ViewCommand::FlyToWitness(Witness::Verdict),
    ));
    let mark = state.runs.first.witness_mark;
    assert!(mark.is_some_and(is_nearest_pair), "{mark:?}");
    state.apply(Command::View(
        Which::First,
        ViewCommand::FlyToWitness(Witness::LargestHole),
    ));
    let mark = state.runs.first.witness_mark;
    assert!(mark.is_some_and(is_largest_hole), "{mark:?}");
}

#[test]
fn an_export_names_its_file_and_certificate() {
    let folder = std::env::temp_dir().join(format!("tilescope-app-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("set.ply");
    let mut state = settled();
    state.apply(Command::Export(ExportCommand::Open(ExportKind::Result)));
    state.apply(Command::Export(ExportCommand::Path(
        path.to_string_lossy().into_owned(),
    )));
    state.apply(Command::Export(ExportCommand::Write));
    state.settle();
    let notice = state.messages.notice.clone().unwrap();
    assert!(!notice.is_error, "{}", notice.text);
    assert!(notice.text.contains("set.ply.certificate.json"));
    assert!(path.exists() && state.files.exports.sheet.is_none());
    state.apply(Command::Export(ExportCommand::Open(ExportKind::Result)));
    let nowhere = folder.join("missing").join("set.csv");
    state.apply(Command::Export(ExportCommand::Path(
        nowhere.to_string_lossy().into_owned(),
    )));
    state.apply(Command::Export(ExportCommand::Write));
    state.settle();
    assert!(state.messages.notice.clone().unwrap().is_error && state.files.exports.sheet.is_some());
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn samples_that_are_not_there_yet_are_not_pointed_at() {
    let mut state = settled();
    let id = state.runs.first.session.as_ref().unwrap().run().iterations[0]
        .inserted
        .start;
    state.apply(Command::View(Which::First, ViewCommand::GoToSample(id)));
    assert_eq!(state.runs.first.selected, Some(id));
    state.apply(Command::View(Which::First, ViewCommand::Hover(Some(id))));
    state.apply(Command::Time(TimeCommand::ShowStage(2)));
    assert_eq!(
        (state.runs.first.selected, state.runs.first.hovered),
        (Some(id), None)
    );
}

#[test]
fn layers_and_theme_toggle() {
    let mut state = settled();
    let before = (
        state.appearance.layers(None).has(Layer::Gaps),
        state.appearance.look,
    );
    state.apply(Command::Appearance(AppearanceCommand::ToggleLayer(
        Layer::Gaps,
    )));
    state.apply(Command::Appearance(AppearanceCommand::ToggleTheme));
    assert_ne!(state.appearance.layers(None).has(Layer::Gaps), before.0);
    assert_ne!(state.appearance.look, before.1);
}

#[test]
fn the_pattern_is_fitted_and_the_camera_returns() {
    let mut state = settled();
    state.apply(Command::View(
        Which::First,
        ViewCommand::FlyTo([3.0, 90.0].into(), 5.0),
    ));
    while state.advance(0.1) {}
    let camera = state.runs.first.camera;
    state.apply(Command::Time(TimeCommand::FirstStage));
    assert_eq!(state.runs.first.current_stage(), Some(Stage::Pattern));
    let middle = state
        .runs
        .first
        .session
        .as_ref()
        .unwrap()
        .run()
        .pattern
        .domain()
        .size()[0]
        / 2.0;
    assert!((state.runs.first.camera.center[0] - middle).abs() < 1e-9);
    assert!(state.runs.first.camera.scale < camera.scale);
    state.apply(Command::Time(TimeCommand::StepForward));
    assert_eq!(state.runs.first.camera, camera);
}

#[test]
fn a_large_session_keeps_the_result_alone_and_is_the_same_set() {
    let mut state = settled();
    type_in(&mut state, Parameter::Radius, "0.0011");
    state.apply(Command::Run);
    state.settle();
    let session = state.runs.first.session.as_ref().unwrap();
    assert!(!session.has_stages());
    assert_eq!(
        session.stages,
        [Stage::Pattern, Stage::Blocks, Stage::Finish]
    );
    assert!(state.runs.first.verdict().unwrap().report.valid());
    let pattern = std::sync::Arc::clone(&session.run().pattern);
    let engine = tilescope_core::Sequential::new(&session.run().parameters, pattern).unwrap();
    let whole = engine.finish(&mut tilescope_core::Unobserved).unwrap();
    assert_eq!(session.run().points(), whole.points());
    assert_eq!(session.summary, whole.summary());
    // Origins of samples equal those of the other engine.
    for (&mine, &theirs) in session.run().result.iter().zip(&whole.result).step_by(97) {
        use tilescope_core::Origin::{Inserted, Tiled};
        let (a, b) = (&session.run().samples.origins, &whole.samples.origins);
        match (a[mine as usize], b[theirs as usize]) {
            (Inserted { iteration: a, .. }, Inserted { iteration: b, .. }) => assert_eq!(a, b),
            (a @ Tiled { .. }, b) => assert_eq!(a, b),
            (a, b) => panic!("{a:?} and {b:?}"),
        }
    }
}

/// Chooses the GPU, which must be there, if only as the software adapter llvmpipe.
fn on_the_gpu() -> State {
    let mut state = settled();
    state.apply(Command::Gpu(GpuCommand::Engine(EngineChoice::Gpu)));
    state.settle();
    assert!(
        state.gpu.device.ready().is_some(),
        "a GPU adapter is needed (Debian and Ubuntu: apt-get install mesa-vulkan-drivers): {:?}",
        state.gpu.device.description()
    );
    state
}

#[test]
fn a_missing_gpu_leaves_the_cpu_with_a_reason() {
    let mut state = settled();
    state.apply(Command::Gpu(GpuCommand::NameAdapter(Some(
        "no such adapter".to_owned(),
    ))));
    state.apply(Command::Gpu(GpuCommand::Engine(EngineChoice::Gpu)));
    assert!(state.form.refusal(&state.gpu).unwrap().contains("tested"));
    state.settle();
    assert_eq!(state.gpu.engine, EngineChoice::Auto);
    let notice = state.messages.notice.clone().unwrap();
    assert!(
        notice.is_error && notice.text.contains("o GPU adapter"),
        "{}",
        notice.text
    );
    state.apply(Command::Gpu(GpuCommand::Engine(EngineChoice::Gpu)));
    assert_eq!(state.gpu.engine, EngineChoice::Auto);
    assert_eq!(state.form.refusal(&state.gpu), None);
    state.apply(Command::Run);
    state.settle();
    assert_eq!(state.runs.first.session.as_ref().unwrap().engine, "CPU");
    // Another name may be chosen.
    state.apply(Command::Gpu(GpuCommand::NameAdapter(None)));
    assert_eq!(state.gpu.device.refusal(), None);
}

#[test]
fn a_device_lost_in_a_run_is_reported_and_the_cpu_makes_the_session() {
    let mut state = settled();
    state.gpu.engine = EngineChoice::Gpu;
    let monitor = tilescope_session::jobs::Job::start(&state.runs.jobs.wake, |monitor| {
        Session::sample(&tilescope_core::Parameters::default().into(), 2, monitor)
    });
    let mut session = monitor.wait().unwrap().unwrap();
    session.failure = Some(tilescope_session::session::Failure {
        name: "Some GPU".to_owned(),
        error: tilescope_gpu::GpuError::DeviceLost {
            reason: "the driver was reset".to_owned(),
        },
    });
    state.show(Which::First, session);
    state.settle();
    let notice = state.messages.notice.clone().unwrap();
    assert!(notice.is_error && notice.text.contains("Some GPU failed. The device was lost"));
    assert!(notice.text.contains("CPU"));
    assert_eq!(state.gpu.engine, EngineChoice::Auto);
    assert!(state.runs.first.verdict().unwrap().report.valid());
}

#[test]
fn a_gpu_run_that_differs_is_shown_without_events_and_reported() {
    let mut state = settled();
    let mut run = state.runs.first.session.as_ref().unwrap().run().clone();
    run.samples.points[7].x += 1;
    let mut session = Session::from_run(run, 9);
    session.engine = "GPU (some card)".to_owned();
    state.show(Which::First, session);
    let notice = state.messages.notice.clone().unwrap();
    assert!(notice.is_error && notice.text.contains("GPU (some card) differs from the CPU"));
    assert!(state.runs.first.debugger.is_none() && state.runs.first.cursor().is_none());
    state.apply(Command::Time(TimeCommand::ShowStage(2)));
    assert_eq!(state.runs.first.current_stage(), Some(Stage::Tile));
}

#[test]
fn a_domain_and_its_pattern_never_shrink_to_a_speck() {
    let mut state = settled();
    let middle = state.runs.first.viewport.center();
    for stage in [state.runs.first.stage, 0] {
        state.apply(Command::Time(TimeCommand::ShowStage(stage)));
        state.apply(Command::View(Which::First, ViewCommand::Fit));
        while state.advance(0.5) {}
        let fitted = state.runs.first.camera.scale;
        let is_seen =
            |state: &State| (0.2..0.3).contains(&(state.runs.first.camera.scale / fitted));
        for _ in 0..40 {
            state.apply(Command::View(Which::First, ViewCommand::Zoom(middle, 0.5)));
        }
        assert!(is_seen(&state), "{}", state.runs.first.camera.scale);
        state.apply(Command::View(Which::First, ViewCommand::Zoom(middle, 1e12)));
        assert!(state.runs.first.camera.scale <= tilescope_drawing::camera::MAX_SCALE);
        state.apply(Command::View(
            Which::First,
            ViewCommand::FlyTo([10.0, 10.0].into(), 1e9),
        ));
        while state.advance(0.5) {}
        assert!(is_seen(&state), "{}", state.runs.first.camera.scale);
        // A camera from a link, a session or a page that embeds the window.
        let mut view = SavedView::of(&state);
        view.camera = Camera::checked([10.0, 10.0].into(), MIN_SCALE);
        assert!(view.camera.is_some());
        state.look_as(&view);
        // A view's camera shows the domain; the pattern is fitted.
        let is_fitted = state.runs.first.camera == state.runs.first.fitting();
        let is_pattern = state.runs.first.current_stage() == Some(Stage::Pattern);
        assert_eq!(is_fitted, is_pattern);
        assert!(
            is_pattern || is_seen(&state),
            "{}",
            state.runs.first.camera.scale
        );
        // A window that was enlarged.
        state.apply(Command::View(
            Which::First,
            ViewCommand::Viewport(state.runs.first.viewport.expand(400.0)),
        ));
        assert!(state.runs.first.camera.scale > 0.4 * fitted);
        state.apply(Command::View(
            Which::First,
            ViewCommand::Viewport(state.runs.first.viewport.expand(-400.0)),
        ));
    }
}

#[test]
fn a_gpu_that_computes_on_the_cpu_is_tested_only_when_it_is_chosen() {
    let mut state = settled();
    state.gpu.display = Some("WebGL 2".to_owned());
    let found = || {
        let name = "SwiftShader".to_owned();
        Ok(Err(tilescope_gpu::GpuError::SoftwareOnly { name }))
    };
    state.with(|state, context| state.gpu.finish_test(found(), context));
    assert_eq!(state.gpu.device.word(), "unknown");
    let why = state
        .gpu
        .engine_sentence(&Parameters::default())
        .expect("why");
    assert!(why.contains("computes on the CPU itself"), "{why}");
    // The user chose it while the browser was looking for an adapter.
    state.gpu.engine = EngineChoice::Gpu;
    state.with(|state, context| state.gpu.finish_test(found(), context));
    assert_eq!(state.gpu.device.word(), "testing");
}

#[test]
fn live_runs_start_at_once_stay_at_the_stage_and_are_one_step() {
    let mut state = settled();
    let form = |state: &mut State, command| {
        state.apply(Command::Form(command));
        state.settle();
    };
    let seed = |state: &State| {
        let session = state.runs.first.session.as_ref().unwrap();
        session.run().parameters.seed
    };
    form(&mut state, FormCommand::Nudge(Parameter::Seed, 1));
    assert_eq!(seed(&state), 1, "without live runs nothing starts");
    form(&mut state, FormCommand::Nudge(Parameter::Seed, -1));
    form(&mut state, FormCommand::Live(true));
    state.apply(Command::Time(TimeCommand::ShowStage(2)));
    for expected in 2..5 {
        form(&mut state, FormCommand::Nudge(Parameter::Seed, 1));
        assert_eq!(seed(&state), expected);
        assert_eq!(state.runs.first.current_stage(), Some(Stage::Tile));
    }
    // Too many samples to start by themselves, and what cannot be run.
    form(&mut state, FormCommand::Count("200000".to_owned()));
    form(
        &mut state,
        FormCommand::Type(Parameter::Radius, "wide".to_owned()),
    );
    assert_eq!(seed(&state), 4);
    assert!(state.runs.first.sampling.is_none());
    while state.past.history.can_undo() && seed(&state) == 4 {
        state.apply(Command::Undo);
        state.settle();
    }
    assert_eq!(seed(&state), 1, "the three runs are one step");
}

/// Tests that need a graphics driver.
mod device {
    use super::*;

    #[test]
    fn the_gpu_is_tested_when_it_is_chosen_and_its_session_has_the_same_stages() {
        let mut state = on_the_gpu();
        assert_eq!(state.gpu.engine, EngineChoice::Gpu);
        let description = state.gpu.device.description().unwrap();
        assert!(description.contains("self-test passed"), "{description}");
        let before = state.runs.first.session.clone().unwrap();
        assert_eq!(before.engine, "CPU");
        state.apply(Command::Run);
        state.settle();
        let session = state.runs.first.session.as_ref().unwrap();
        let name = state.gpu.device.name().unwrap();
        assert_eq!(session.engine, format!("GPU ({name})"));
        assert_eq!(state.messages.notice, None);
        assert_eq!(session.stages, before.stages);
        assert_eq!(session.summary, before.summary);
        assert_eq!(session.conflicts, before.conflicts);
        let (mine, theirs) = (session.run(), before.run());
        assert_eq!(mine.points(), theirs.points());
        assert_eq!(mine.samples, theirs.samples);
        assert_eq!(mine.iterations, theirs.iterations);
    }

    #[test]
    fn a_large_session_on_the_gpu_keeps_the_result_alone() {
        let mut state = on_the_gpu();
        type_in(&mut state, Parameter::Radius, "0.0011");
        state.apply(Command::Run);
        state.settle();
        let session = state.runs.first.session.clone().unwrap();
        assert!(!session.has_stages() && session.engine.starts_with("GPU"));
        assert!(state.runs.first.verdict().unwrap().report.valid());
        state.apply(Command::Gpu(GpuCommand::Engine(EngineChoice::Cpu)));
        state.apply(Command::Run);
        state.settle();
        let of_cpu = state.runs.first.session.as_ref().unwrap();
        assert_eq!(of_cpu.engine, "CPU");
        assert_eq!(of_cpu.run().samples, session.run().samples);
        assert_eq!(of_cpu.summary, session.summary);
    }

    #[test]
    fn exact_tilings_on_the_gpu_have_the_events_of_the_cpu() {
        let mut state = on_the_gpu();
        let exact = json!(tilescope_core::TilingMethod::Exact);
        let choice = Choice::Parameter(Parameter::Method, exact);
        state.apply(Command::Form(FormCommand::Choose(choice)));
        type_in(&mut state, Parameter::Radius, "0.02");
        state.apply(Command::Run);
        state.settle();
        let session = state.runs.first.session.clone().unwrap();
        assert!(session.is_exact() && session.engine.starts_with("GPU"));
        // The stages are those of the CPU's recording, which is shown only if its samples are the device's.
        assert!(session.has_stages() && state.messages.notice.is_none());

        // Without a GPU by name the CPU makes exact tilings, also where a GPU is at hand.
        for engine in [EngineChoice::Auto, EngineChoice::Cpu] {
            state.apply(Command::Gpu(GpuCommand::Engine(engine)));
            state.apply(Command::Run);
            state.settle();
            let of_cpu = state.runs.first.session.as_ref().unwrap();
            assert_eq!(of_cpu.engine, "CPU");
            assert_eq!(of_cpu.run().points(), session.run().points());
            assert_eq!(of_cpu.summary, session.summary);
        }
    }

    #[test]
    fn algorithm_4_as_printed_runs_on_the_cpu_whatever_is_chosen() {
        let mut state = on_the_gpu();
        state.apply(Command::Form(FormCommand::Choose(Choice::Parameter(
            Parameter::Variant,
            json!(tilescope_core::Variant::AsPrinted),
        ))));
        state.apply(Command::Run);
        state.settle();
        assert_eq!(state.runs.first.session.as_ref().unwrap().engine, "CPU");
    }
}

#[test]
fn a_pattern_from_a_file_is_not_in_the_link() {
    let mut state = settled();
    let spec = tilescope_core::PatternSpec {
        side: 30.0,
        seed: 99,
        ..Default::default()
    };
    let pattern = tilescope_core::Pattern::of_spec(&spec, &mut tilescope_core::Unobserved).unwrap();
    let (path, digest) = ("own.csv".to_owned(), "0".repeat(16));
    let file = tilescope_debugger::PatternFile { path, digest };
    state.form.own_pattern = Some(tilescope_session::recipe::OwnPattern {
        file,
        pattern: Arc::clone(&pattern),
    });
    state.apply(Command::Run);
    state.settle();
    let link = state.link();
    assert_eq!(link.left_out, ["the pattern, which comes from a file"]);
    // The link's parameters describe another run, which is sampled.
    state.open_link(&link.fragment);
    assert!(state.runs.first.sampling.is_some() && state.form.own_pattern.is_none());
}

#[test]
fn errors_of_run_b_name_run_b() {
    let mut state = settled();
    let start = CompareCommand::Start(ComparePreset::NextSeed);
    state.apply(Command::Compare(start));
    state.settle();

    let (side, _) = state.runs.second.as_mut().expect("a second run");
    let cancelled = tilescope_core::SampleError::Cancelled { stage: Stage::Tile };
    let wake: Wake = Arc::new(|| {});
    side.sampling = Some(Job::start(&wake, move |_| Err(cancelled.into())));
    state.settle();

    let notice = state.messages.notice.as_ref().expect("a notice");
    assert!(notice.text.starts_with("Run B: "), "{}", notice.text);
    let seed = |which| {
        let run = state.runs.get(which).expect("a run");
        run.session
            .as_ref()
            .expect("its session")
            .run()
            .parameters
            .seed
    };
    assert_eq!([seed(Which::First), seed(Which::Second)], [1, 2]);
}
