//! The wording of the window. Other tests find widgets by id, so that a change of wording changes this file alone. An
//! asterisk stands for any text.

use egui_kittest::Harness;
use egui_kittest::kittest::NodeT;
use serde_json::json;
use tilescope_app::App;
use tilescope_core::{Boundary, Parameter, Search, Stage};
use tilescope_debugger::{Direction, Target};
use tilescope_gpu::layout::Name;
use tilescope_session::look::Look;
use tilescope_session::selection::Selection;
use tilescope_workbench::Command;
use tilescope_workbench::analysis::AnalysisCommand;
use tilescope_workbench::clock::Clock;
use tilescope_workbench::command::{
    AppearanceCommand, DebugCommand, FormCommand, GpuCommand, TimeCommand, ViewCommand, Which,
    WindowCommand,
};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::device::EngineChoice;
use tilescope_workbench::draft::Choice;
use tilescope_workbench::export::{ExportCommand, ExportKind, NumberField};
use tilescope_workbench::files::{FileCommand, Purpose};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::passes::{PassCommand, PassSide};
use tilescope_workbench::scenes::SceneCommand;

use crate::analysis_panel::noise;
use crate::sessions::pattern;
use crate::support::sessions::{apply, folder, go, path_text};
use crate::support::{find, node, opened_at, session, settle};

/// A window, and the texts that differ from what is expected.
struct Wording {
    harness: Harness<'static, App>,
    otherwise: Vec<String>,
}

impl Wording {
    fn opened() -> Self {
        Self::opened_at([1440.0, 900.0])
    }

    fn opened_at(size: [f32; 2]) -> Self {
        Self {
            harness: opened_at(size),
            otherwise: Vec::new(),
        }
    }

    fn after<const N: usize>(&mut self, commands: [Command; N]) -> &mut Self {
        for command in commands {
            apply(&mut self.harness, command);
        }
        self
    }

    fn typed(&mut self, fields: &[(Parameter, &str)]) -> &mut Self {
        for &(field, text) in fields {
            apply(
                &mut self.harness,
                Command::Form(FormCommand::Type(field, text.to_owned())),
            );
        }
        self
    }

    /// Checks texts of widgets by id; all differences are reported together at the end.
    fn shows(&mut self, table: &[(&str, &str)]) -> &mut Self {
        for &(id, expected) in table {
            let node = find(&self.harness, id).map(|node| node.accesskit_node());
            let said = node.map(|node| node.label().or(node.value()).unwrap_or_default());
            if !said.as_ref().is_some_and(|said| fits(said, expected)) {
                let line = format!("{id}\n  expected: {expected}\n  said:     {said:?}");
                self.otherwise.push(line);
            }
        }
        self
    }

    fn end(&self) {
        assert!(self.otherwise.is_empty(), "{}", self.otherwise.join("\n"));
    }
}

/// Returns whether a text matches; an asterisk stands for any text.
fn fits(said: &str, expected: &str) -> bool {
    let Some((before, rest)) = expected.split_once('*') else {
        return said == expected;
    };
    let Some(said) = said.strip_prefix(before) else {
        return false;
    };
    let starts = said.char_indices().map(|(at, _)| at);
    starts.chain([said.len()]).any(|at| fits(&said[at..], rest))
}

#[test]
fn asterisks_match_any_text() {
    for (said, expected, is_fit) in [
        ("one two three", "one two three", true),
        ("one two three", "one * three", true),
        ("one two three", "*two*", true),
        ("one two three", "one two", false),
        ("one two three", "*four*", false),
        ("one \u{2026} three", "*three", true),
    ] {
        assert_eq!(fits(said, expected), is_fit, "{said}, {expected}");
    }
}

fn export(command: ExportCommand) -> Command {
    Command::Export(command)
}

fn typed(entry: NumberField, text: &str) -> Command {
    export(ExportCommand::Type(entry, text.to_owned()))
}

#[test]
fn the_window_and_its_export_sheet() {
    let mut window = Wording::opened();
    window.shows(&[
        ("verdict", "Verdict: verified"),
        (
            "status",
            "Finish: 11,050 tiled*= 10,041 samples, in canonical order.",
        ),
        ("counts", "10,041 samples   event 45,961 of 45,961"),
        ("engine-used", "engine: CPU"),
        ("run", "Run"),
        ("time-first-stage", "First stage (Home)"),
        ("time-step-back", "Stage back (Left)"),
        ("time-toggle-play", "Play (Space)"),
        ("time-step-forward", "Stage forward (Right)"),
        ("time-last-stage", "Last stage (End)"),
        ("moment", "Moment"),
        ("clock", "Clock"),
        ("speed", "Speed"),
        ("fit", "Fit the domain (F)"),
        ("export", "Export\u{2026}"),
        ("toggle-theme", "Light theme"),
        ("canvas", "Canvas of samples"),
        ("stage.eliminate", "Eliminate"),
        ("layer.disks", "Disks"),
        ("radius", "Radius"),
        ("seed", "Seed"),
    ]);
    window.after([Command::Appearance(AppearanceCommand::Look(Look::Light))]);
    window.shows(&[("toggle-theme", "Dark theme")]);
    let session = session(&window.harness);
    let first = |stage: &Stage| *stage == Stage::Iterate(1);
    let index = session.stages.iter().position(first).unwrap();
    window.after([Command::Time(TimeCommand::ShowStage(index))]);
    window.shows(&[
        ("status", "Iteration 1: *"),
        ("verdict", "Verdict: final result verified"),
    ]);
    let event = Command::Time(TimeCommand::Clock(Clock::Event));
    window.after([event]);
    window.shows(&[("time-step-forward", "Event forward (Right)")]);
    window.after([Command::Time(TimeCommand::Clock(Clock::Stage))]);
    the_export_sheet(&mut window);
    window.end();
}

/// The sheet, and the list of actions behind it.
fn the_export_sheet(window: &mut Wording) {
    window.after([
        Command::Time(TimeCommand::FirstStage),
        export(ExportCommand::Open(ExportKind::Animation)),
    ]);
    window.shows(&[
        ("export.prospect", "*is empty: there is nothing to animate*"),
        ("export.result", "Result"),
        ("export.samples", "Samples of this moment"),
        ("export.picture", "Picture"),
        ("export.animation", "Animation"),
        ("export.write", "Write animation"),
    ]);
    let every = |text| typed(NumberField::Every, text);
    window.after([Command::Time(TimeCommand::LastStage), every("0")]);
    window.shows(&[("export.prospect", "*whole number from 1 to 10,000,000*")]);
    window.after([every("1"), typed(NumberField::Delay, "5")]);
    window.shows(&[("export.prospect", "The delay is \"5\" ms*")]);
    window.after([
        typed(NumberField::Delay, "40"),
        typed(NumberField::Scale, "9"),
    ]);
    window.shows(&[(
        "export.prospect",
        "The scale is \"9\"; it must be a number from 0.5 to 8.",
    )]);
    let lines = export(ExportCommand::Clock(Clock::Line));
    window.after([typed(NumberField::Scale, "2"), lines]);
    window.shows(&[
        ("export.line", "lines"),
        ("export.prospect", "* frames of at most 600, *"),
    ]);
    window.after([export(ExportCommand::Open(ExportKind::Result))]);
    window.shows(&[
        ("export.prospect", "10,041 samples.*"),
        ("export.write", "Write file and certificate"),
    ]);
    window.after([export(ExportCommand::Path("set.jpeg".to_owned()))]);
    window.shows(&[("export.format", "*The extension chooses the format: *")]);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("moment.png");
    let path = export(ExportCommand::Path(path_text(&path)));
    let write = || export(ExportCommand::Write);
    window.after([
        export(ExportCommand::Open(ExportKind::Picture)),
        path.clone(),
    ]);
    window.shows(&[
        ("export.write", "Write picture"),
        ("export.format", "Format: PNG. Folder: *"),
        ("export.prospect", "* pixels.*"),
    ]);
    window.after([write()]);
    window.shows(&[("notice", "Wrote the picture to *")]);
    window.after([
        export(ExportCommand::Open(ExportKind::Picture)),
        path,
        write(),
    ]);
    window.shows(&[
        (
            "export.taken",
            "moment.png exists already and would be replaced.",
        ),
        ("export.write", "Replace moment.png?"),
    ]);
    window.after([
        export(ExportCommand::Close),
        Command::Time(TimeCommand::FirstStage),
        Command::Window(WindowCommand::ToggleFinder),
    ]);
    window.shows(&[
        ("find-action", "Find an action"),
        ("action.go-time-step-forward", "Tick forward"),
        (
            "action.file-export-open-samples",
            "Export samples of this moment\u{2026}",
        ),
        (
            "action.file-export-open-picture",
            "Export picture of this moment\u{2026}",
        ),
        (
            "action.file-export-open-animation",
            "Export animation\u{2026}",
        ),
        ("action.file-export-cancel", "Cancel the export"),
        ("action.file-file-sheet-save", "Save session\u{2026}"),
    ]);
}

#[test]
fn parameters_engines_and_verdicts() {
    // High enough for the whole form, as a choice opens only where it is in sight.
    let mut window = Wording::opened_at([1440.0, 1000.0]);
    window.typed(&[(Parameter::Radius, "0")]);
    window.shows(&[("refusal-radius", "*must be a finite number above 0*")]);
    window.typed(&[(Parameter::Radius, "0.5")]);
    window.shows(&[(
        "refusal-radius",
        "The width is 2 r long; it must be at least 10 r: choose a smaller radius.",
    )]);
    // Cancelled before it is finished.
    window.typed(&[(Parameter::Radius, "0.0005")]);
    window.harness.state_mut().state.apply(Command::Run);
    window.after([Command::Cancel(Which::First)]);
    window.shows(&[(
        "notice",
        "Cancelled during stage *. The previous session is kept.",
    )]);
    window.after([Command::Gpu(GpuCommand::NameAdapter(Some(
        "no such adapter".to_owned(),
    )))]);
    window.after([Command::Gpu(GpuCommand::Engine(EngineChoice::Gpu))]);
    window.shows(&[("notice", "*The GPU cannot be used.*")]);
    node(&window.harness, "engine").click();
    window.harness.run();
    window.shows(&[("engine.auto", "auto (CPU)"), ("engine.gpu", "GPU")]);
    window.harness.key_press(egui::Key::Escape);
    window.after([Command::Form(FormCommand::Choose(Choice::Parameter(
        Parameter::Search,
        json!(Search::TwoRadii),
    )))]);
    window.typed(&[(Parameter::Leaf, "6"), (Parameter::Radius, "0.004")]);
    window.after([Command::Run]);
    window.shows(&[("verdict", "Verdict: not maximal")]);
    window.end();
}

#[test]
fn two_runs_and_the_debugger() {
    let mut window = Wording::opened();
    window.typed(&[(Parameter::Radius, "0.02"), (Parameter::Leaf, "8")]);
    window.after([
        Command::Run,
        Command::Window(WindowCommand::OpenPanel(Panel::Compare)),
        Command::Compare(CompareCommand::Start(ComparePreset::Typed)),
    ]);
    window.shows(&[
        (
            "parting-0",
            "Nowhere: every event is the same, sample by sample, to the bit.",
        ),
        ("canvas-a", "Canvas of run A"),
        ("canvas-b", "Canvas of run B"),
        ("compare.next-seed", "the next seed"),
        ("compare.engine", "the other engine"),
        ("compare.go", "Go there in both"),
        ("compare.keep", "my next run (keeps this one as B)"),
    ]);
    let state = &window.harness.state().state;
    let preset = ComparePreset::Engine;
    let refusal = (state.runs()).preset_refusal(preset, state.form(), state.gpu());
    assert!(refusal.expect("a reason").contains("Choose the GPU"));
    window.after([Command::Compare(CompareCommand::Start(
        ComparePreset::NextSeed,
    ))]);
    window.shows(&[("run-a", "Run A: seed 1*"), ("run-b", "Run B: seed 2*")]);
    window.after([
        Command::Compare(CompareCommand::Keep),
        Command::Form(FormCommand::Choose(Choice::Parameter(
            Parameter::Boundary,
            json!(Boundary::Bounded),
        ))),
        Command::Run,
    ]);
    window.shows(&[
        (
            "compare.refusal",
            "The domains differ: positions cannot be compared.",
        ),
        ("run-a", "Run A: boundary bounded*"),
    ]);
    window.after([Command::Compare(CompareCommand::Close)]);
    let target = TimeCommand::RunTo(Target::Violation, Direction::Forwards);
    window.after([
        Command::Time(TimeCommand::FirstStage),
        Command::Time(target),
    ]);
    window.shows(&[("notice", "*no violated invariant*")]);
    let query = |text: &str| Command::Debug(DebugCommand::Query(text.to_owned()));
    window.after([
        Command::Window(WindowCommand::OpenPanel(Panel::Events)),
        query("insert colour=3"),
    ]);
    window.shows(&[("found-events", "*there is no \"colour\"*")]);
    window.after([query("")]);
    window.shows(&[
        ("find-events", "Find events"),
        ("event-0", "Event 1: begin: blocks"),
    ]);
    window.after([Command::Window(WindowCommand::OpenPanel(Panel::Inspector))]);
    window.shows(&[(
        "inspector.hint",
        "Click a sample, or any place, to read what happened there.",
    )]);
    let pick = ViewCommand::Pick(Selection::Sample(40));
    window.after([Command::View(Which::First, pick)]);
    window.shows(&[("history", "History: * events")]);
    window.after([Command::Window(WindowCommand::OpenPanel(Panel::Scenes))]);
    window.shows(&[("no-scenes", "Press B to make a scene of this moment and its view. PageDown and PageUp step through them.")]);
    window.after([Command::Scene(SceneCommand::Add)]);
    let listings = Command::Window(WindowCommand::OpenPanel(Panel::Pseudocode));
    let jump = |at| Command::Time(TimeCommand::Jump(at));
    window.after([Command::Debug(DebugCommand::Watch(
        "inserted + 1".to_owned(),
    ))]);
    window.shows(&[
        ("scene-1", "1  *"),
        ("scene-1.moment", "event *"),
        ("scene-1.caption", "Caption of scene 1"),
    ]);
    window.after([listings]);
    window.shows(&[("eliminate.5.breakpoint", "Breakpoint on line eliminate.5")]);
    window.after([
        jump(3_000),
        Command::Window(WindowCommand::OpenPanel(Panel::Watches)),
    ]);
    window.shows(&[("watch-1.value", "= *"), ("add-watch", "Add a watch")]);
    window.end();
}

#[test]
fn sessions_and_patterns() {
    let mut window = Wording::opened();
    window.typed(&[(Parameter::Radius, "0.02"), (Parameter::Leaf, "8")]);
    window.after([Command::Run]);
    let folder = folder("sentences");
    let path = folder.join("one.json");
    window.after([Command::File(FileCommand::Sheet(Purpose::Save))]);
    window.shows(&[("file.go", "Save"), ("file.browse", "Browse\u{2026}")]);
    go(&mut window.harness, Purpose::Save, &path);
    let saved = format!("Session saved to {}.", path_text(&path));
    window.shows(&[("notice", &saved)]);
    window.typed(&[(Parameter::Seed, "2")]);
    window.after([Command::Run]);
    go(&mut window.harness, Purpose::Save, &path);
    window.shows(&[
        ("file.question", "There is such a file already."),
        ("file.go", "Replace the file"),
    ]);
    window.after([Command::File(FileCommand::Sheet(Purpose::Open))]);
    window.shows(&[("file.go", "Open")]);
    window.after([Command::File(FileCommand::Close)]);
    let own = pattern(&mut window.harness, &folder);
    go(&mut window.harness, Purpose::Pattern, &own);
    window.shows(&[("notice", "*The next run clips from*")]);
    window.after([Command::Window(WindowCommand::OpenPanel(Panel::Parameters))]);
    window.shows(&[
        ("own-pattern", "The pattern comes from *own.csv: * samples."),
        ("generated-pattern", "Use a generated pattern"),
    ]);
    window.after([Command::Run]);
    let path = folder.join("with-pattern.json");
    go(&mut window.harness, Purpose::Save, &path);
    std::fs::remove_file(&own).unwrap();
    go(&mut window.harness, Purpose::Open, &path);
    window.shows(&[("notice", "*own.csv cannot be loaded*")]);
    window.end();
}

#[test]
fn the_analysis() {
    let mut window = Wording {
        harness: crate::analysis_panel::analysing(),
        otherwise: Vec::new(),
    };
    window.shows(&[
        (
            "analysis.status",
            "Event *, finish: * samples, 0 conflicts, 0 open places.",
        ),
        ("analysis.number-samples", "Samples: *, reference 27,8*"),
        (
            "chart.P",
            "Chart: Radial mean power P(\u{3bd}) over frequency*reference: highest*",
        ),
        ("chart.g", "Chart: Pair correlation g*"),
        ("chart.periodogram", "Periodogram, frequencies up to *"),
        (
            "analysis.reference",
            "reference: dart throwing, 200 r periodic, 27,8*",
        ),
        (
            "brush.status",
            "Drag over a chart or the periodogram, or enter a range here: *",
        ),
        ("brush.distance", "Distances"),
        ("brush.distance.to", "Brush: Distances to"),
        ("analysis.hold", "Compare with a file\u{2026}"),
        ("analysis.clear", "Clear"),
    ]);
    let path = noise("sentences-against");
    go(&mut window.harness, Purpose::Against, &path);
    window.shows(&[
        (
            "analysis.file",
            "file: noise.csv (unit square assumed), judged at r = 0.02",
        ),
        ("chart.P", "* noise.csv: highest*"),
        ("analysis.number-samples", "Samples: *, file 900"),
    ]);
    window.typed(&[(Parameter::Radius, "0.03")]);
    window.after([Command::Run]);
    window.shows(&[(
        "analysis.unjudged",
        "The file was judged at r = 0.02, and this run's r is 0.03: compare with it again.",
    )]);
    window.typed(&[(Parameter::Width, "2")]);
    window.after([Command::Run]);
    let domains = "*a domain of 1 \u{d7} 1 periodic, and this run's domain is 2 \u{d7} 1 periodic*";
    window.shows(&[("analysis.refusal", domains)]);
    window.after([Command::Analysis(AnalysisCommand::Clear)]);
    go(&mut window.harness, Purpose::Against, &path);
    window.shows(&[("notice", domains)]);
    let jump = Command::Time(TimeCommand::Jump(1_500));
    window.after([Command::File(FileCommand::Close), jump]);
    window.shows(&[("analysis.status", "Event 1,500, tile: *")]);
    window.end();
}

/// Goes to the first pass of this name, and to one of its buffers.
fn go_to(window: &mut Wording, name: &str, buffer: Name) {
    let passes = || {
        window
            .harness
            .state()
            .state
            .runs()
            .first
            .passes
            .as_ref()
            .unwrap()
    };
    let entries = passes().entries();
    let index = entries.iter().position(|entry| entry.report.name == name);
    let index = index.expect("such a pass");
    window.after([Command::Passes(PassCommand::Select(index))]);
    let visit = window
        .harness
        .state()
        .state
        .runs()
        .first
        .passes
        .as_ref()
        .unwrap()
        .visit();
    let tables = &visit.expect("a visit").buffers;
    let index = tables.iter().position(|table| table.name == buffer);
    let index = index.expect("such a buffer");
    window.after([Command::Passes(PassCommand::Buffer(index))]);
}

#[test]
fn passes_on_a_device() {
    let mut window = Wording::opened();
    window.typed(&[(Parameter::Radius, "0.02")]);
    window.after([
        Command::Run,
        Command::Gpu(GpuCommand::Engine(EngineChoice::Gpu)),
    ]);
    window.shows(&[("engine-status", "*self-test passed*")]);
    window.after([Command::Run]);
    window.shows(&[
        ("engine-used", "engine: GPU (*"),
        ("verdict", "Verdict: verified"),
    ]);
    let pass = |command| Command::Passes(command);
    let filter = |text: &str| Command::Passes(PassCommand::Filter(text.to_owned()));
    window.after([Command::OpenPasses]);
    go_to(&mut window, "tile", Name::Places);
    window.after([pass(PassCommand::ShowCanvas)]);
    window.shows(&[(
        "on-canvas",
        "On the canvas: pass 7 tile, buffer places, after: * rows, *",
    )]);
    window.after([pass(PassCommand::Side(PassSide::Before))]);
    window.shows(&[(
        "on-canvas",
        "*buffer places, before: no pass has written it yet",
    )]);
    window.after([pass(PassCommand::Side(PassSide::After)), filter("row<10")]);
    window.shows(&[("on-canvas", "*after: 10 rows, 10 changed")]);
    window.after([filter("")]);
    go_to(&mut window, "tile", Name::Starts);
    window.shows(&[(
        "on-canvas",
        "*buffer starts, after: no row changed; a filter shows others",
    )]);
    go_to(&mut window, "tile", Name::Counters);
    window.shows(&[(
        "on-canvas",
        "*buffer counters, after: its rows are numbers, not places",
    )]);
    // While the panel is shown there is no canvas.
    window.after([Command::Window(WindowCommand::OpenPanel(Panel::Passes))]);
    go_to(&mut window, "tile", Name::Origins);
    window.shows(&[
        ("passes.summary", "* are equal to the CPU, 0 differ*"),
        ("passes.previous", "Previous pass"),
        ("passes.next", "Next pass"),
        ("passes.show-canvas", "Show canvas"),
        ("passes.on-canvas", "On the canvas"),
        ("buffer.origins", "Buffer origins: *"),
        (
            "row-0",
            "Row 0, changed, image 0, pattern index 0 \u{2192}*",
        ),
    ]);
    window.after([filter("row<10")]);
    window.shows(&[("filtered", "10 of *")]);
    window.after([filter("picture>1")]);
    window.shows(&[("filtered", "No column is called \"picture\"*")]);
    window.after([filter(""), pass(PassCommand::Select(2))]);
    window.shows(&[("pass-3", "Pass 3: count, not comparable (intermediate)")]);
    window.after([pass(PassCommand::Last)]);
    let passes = window.harness.state().state.runs().first.passes.as_ref();
    let last = format!("pass-{}", passes.expect("passes").entries().len());
    window.shows(&[
        ("passes.place", "pass * of *, stage Finish"),
        (&last, "Pass *, equal to the CPU"),
    ]);
    window.after([pass(PassCommand::Previous)]);
    window.shows(&[(
        "passes.way",
        "Reached by a new run from the beginning: the device only steps forwards.",
    )]);
    node(&window.harness, "passes.try").click();
    window.harness.step();
    settle(&mut window.harness);
    window.shows(&[(
        "passes.fault",
        "What if: word 0 of * becomes 0 after pass *.",
    )]);
    window.end();
}
