//! The passes of runs on a device: visited, compared with the CPU, filtered, exported. Needs an adapter; a software one
//! is enough.

use std::sync::{Arc, OnceLock, RwLock};

use tilescope_core::{Boundary, Insertion, Parameters, PatternSpec, Stage, TilingMethod};
use tilescope_gpu::layout::Name;
use tilescope_gpu::{Choice, Gpu};
use tilescope_session::jobs::Wake;
use tilescope_workbench::passes::table::BufferTable;
use tilescope_workbench::passes::{Badge, Fault, PassCommand, PassLine, PassSide, Passes};

fn gpu() -> &'static Arc<Gpu> {
    static GPU: OnceLock<Arc<Gpu>> = OnceLock::new();
    GPU.get_or_init(|| {
        let choice = Choice {
            software: true,
            ..Choice::default()
        };
        let opened = pollster::block_on(Gpu::open(&choice));
        Arc::new(opened.expect("these tests need a GPU adapter; a software one will do"))
    })
}

fn small() -> Parameters {
    Parameters {
        radius: 0.02,
        ..Parameters::default()
    }
}

fn begun(parameters: &Parameters) -> Passes {
    gated(parameters, &Arc::default())
}

/// Returns passes whose background work blocks at its next progress report while `gate` is locked.
fn gated(parameters: &Parameters, gate: &Arc<RwLock<()>>) -> Passes {
    let gate = Arc::clone(gate);
    let wake: Wake = Arc::new(move || drop(gate.read()));
    Passes::new(gpu(), parameters, &wake).expect("a small run")
}

fn opened(parameters: &Parameters) -> Passes {
    let mut passes = begun(parameters);
    passes.settle();
    passes
}

fn last_index(passes: &Passes) -> usize {
    passes.entries().len() - 1
}

fn go(passes: &mut Passes, command: PassCommand) {
    passes.apply(command);
    passes.settle();
}

#[test]
fn every_stage_of_two_variants_and_of_exact_tiling_ends_equal_to_the_cpu() {
    let periodic = small();
    let uniform = Parameters {
        boundary: Boundary::Bounded,
        insertion: Insertion::Uniform,
        ..small()
    };
    let exact = Parameters {
        method: TilingMethod::Exact,
        radius: 0.06,
        leaf: 8.0,
        pattern: PatternSpec {
            side: 20.0,
            ..PatternSpec::default()
        },
        ..Parameters::default()
    };
    for parameters in [periodic, uniform, exact] {
        let passes = opened(&parameters);
        assert_eq!(passes.notice(), None);
        let entries = passes.entries();
        let ends = |k: usize| {
            let next = entries.get(k + 1);
            next.is_none_or(|next| next.report.stage != entries[k].report.stage)
        };
        for (k, entry) in entries.iter().enumerate() {
            let expected = if ends(k) {
                Badge::Equal
            } else {
                Badge::Intermediate
            };
            assert_eq!(entry.badge, expected, "pass {k} of {parameters:?}");
        }
        let equal = entries.iter().filter(|e| e.badge == Badge::Equal).count();
        assert!(equal >= 5, "{equal} stages");
        let stages = passes.lines().iter();
        let stages = stages.filter(|line| matches!(line, PassLine::Stage { .. }));
        assert_eq!(stages.count(), equal);
    }
}

#[test]
fn times_are_measured_or_absent() {
    let passes = opened(&small());
    let timed = passes.entries().iter();
    let timed = timed.filter(|entry| entry.report.seconds.is_some()).count();
    if passes.has_timestamps() {
        assert!(timed > passes.entries().len() / 2);
    } else {
        assert_eq!(timed, 0);
    }
}

#[test]
fn going_back_replays_and_shows_the_same_tables() {
    let mut passes = opened(&small());
    assert_eq!(passes.selected(), Some(0));
    assert!(passes.select_stage(Stage::Tile));
    passes.settle();
    assert_eq!(passes.position(), Some((Stage::Tile, true)));
    let tile = passes.visit().expect("a visit").clone();
    assert!(!tile.buffers.is_empty());
    assert!(tile.buffers.iter().any(|table| table.changed_count() > 0));
    go(&mut passes, PassCommand::Next);
    let next = passes.visit().expect("a visit").clone();
    assert!(next.pass == tile.pass + 1 && !next.replayed);
    assert!(next.buffers != tile.buffers);
    go(&mut passes, PassCommand::Previous);
    let again = passes.visit().expect("a visit");
    assert!(again.replayed);
    for (again, first) in again.buffers.iter().zip(&tile.buffers) {
        assert_eq!((again.name, again.rows()), (first.name, first.rows()));
        assert!(contents(again) == contents(first), "{:?}", first.name);
    }
    let at = passes.selected();
    assert!(!passes.select_stage(Stage::Iterate(99)));
    assert_eq!(passes.selected(), at);
}

/// Returns both sides of a table. Lists that many invocations append to are sorted, since their order varies.
fn contents(table: &BufferTable) -> [Vec<Vec<i64>>; 2] {
    let lists = [Name::Heads, Name::List, Name::Unsure, Name::Proposals];
    [PassSide::Before, PassSide::After].map(|side| {
        let rows = 0..table.rows();
        let mut rows: Vec<_> = rows.map(|row| table.side(side, row).to_vec()).collect();
        if lists.contains(&table.name) {
            rows.sort_unstable();
        }
        rows
    })
}

#[test]
fn buffers_after_a_pass_equal_those_before_the_next() {
    let mut passes = opened(&small());
    let mut after = std::collections::BTreeMap::new();
    for pass in 0..12 {
        go(&mut passes, PassCommand::Select(pass));
        let visit = passes.visit().expect("a visit");
        for table in &visit.buffers {
            let rows = |side| -> Vec<Vec<i64>> {
                let rows = 0..table.rows();
                rows.map(|row| table.side(side, row).to_vec()).collect()
            };
            // Counters and arguments are cleared between passes; in all other tables the values before a pass are those
            // after the previous one.
            let clears = [Name::Counters, Name::Arguments, Name::Heads, Name::Sums];
            if let Some(known) = after.insert(table.name, rows(PassSide::After))
                && !clears.contains(&table.name)
            {
                assert!(
                    known == rows(PassSide::Before),
                    "{:?} before pass {pass}",
                    table.name
                );
            }
        }
    }
    assert!(after.contains_key(&Name::Places));
}

#[test]
fn a_word_set_behind_a_pass_is_found_and_undone() {
    let mut passes = opened(&small());
    let last = last_index(&passes);
    go(&mut passes, PassCommand::Last);
    let table = passes.visit().and_then(|visit| {
        let mut tables = visit.buffers.iter();
        tables.find(|table| table.name == Name::Result)
    });
    let x = table.expect("the result").after(0)[0];
    let fault = Fault {
        after: last,
        buffer: Name::Result,
        index: 0,
        word: x as u32 ^ 1,
    };
    go(&mut passes, PassCommand::Fault(Some(fault)));
    assert_eq!(passes.fault(), Some(fault));
    let Badge::Differs(difference) = &passes.entries()[last].badge else {
        panic!("{:?}", passes.entries()[last].badge);
    };
    assert_eq!((difference.list, difference.index), ("result", Some(0)));
    assert!(
        passes.entries()[last]
            .badge
            .text()
            .starts_with("differs from CPU: result at 0")
    );
    let earlier = &passes.entries()[..last];
    assert!(
        earlier
            .iter()
            .all(|e| !matches!(e.badge, Badge::Differs(_)))
    );
    let visit = passes.visit().expect("a visit");
    let result = visit.buffers.iter().find(|t| t.name == Name::Result);
    assert_eq!(result.expect("the result").after(0)[0], x ^ 1);
    go(&mut passes, PassCommand::Fault(None));
    assert_eq!(passes.entries()[last].badge, Badge::Equal);
}

#[test]
fn a_visit_can_be_cancelled_and_taken_up_again() {
    let gate = Arc::default();
    let mut passes = gated(&small(), &gate);
    passes.settle();
    let closed = gate.write().expect("the gate");
    passes.apply(PassCommand::Last);
    assert!(passes.activity().is_some());
    passes.apply(PassCommand::Cancel);
    drop(closed);
    passes.settle();
    assert!(passes.visit().is_none() && passes.activity().is_none());
    assert!(passes.notice().expect("a notice").contains("Cancelled"));
    go(&mut passes, PassCommand::Last);
    assert_eq!(passes.visit().map(|visit| visit.pass), passes.selected());
    assert_eq!(passes.notice(), None);
}

#[test]
fn the_listing_can_be_cancelled_and_begun_again() {
    let gate = Arc::default();
    let closed = RwLock::write(&gate).expect("the gate");
    let mut passes = gated(&small(), &gate);
    passes.apply(PassCommand::Cancel);
    drop(closed);
    passes.settle();
    assert!(passes.entries().len() <= 1);
    assert!(passes.notice().expect("a notice").contains("incomplete"));
    go(&mut passes, PassCommand::Again);
    assert_eq!(passes.notice(), None);
    let last = &passes.entries()[last_index(&passes)];
    assert_eq!(
        (last.report.stage, &last.badge),
        (Stage::Finish, &Badge::Equal)
    );
}

#[test]
fn the_last_of_many_selections_is_visited() {
    let mut passes = begun(&small());
    assert!(passes.select_stage(Stage::Eliminate));
    passes.settle();
    assert_eq!(passes.position(), Some((Stage::Eliminate, true)));
    for pass in [3, 9, 1, 7] {
        passes.apply(PassCommand::Select(pass));
    }
    passes.settle();
    assert_eq!(passes.visit().map(|visit| visit.pass), Some(7));
    passes.apply(PassCommand::Select(usize::MAX));
    assert_eq!(passes.selected(), Some(7));
}

/// Returns the passes at the end of tiling, with the places shown.
fn at_places() -> Passes {
    let mut passes = opened(&small());
    passes.select_stage(Stage::Tile);
    passes.settle();
    let index = passes.visit().and_then(|visit| {
        let mut tables = visit.buffers.iter();
        tables.position(|table| table.name == Name::Places)
    });
    go(&mut passes, PassCommand::Buffer(index.expect("places")));
    passes
}

#[test]
fn rows_are_filtered_and_a_filter_that_cannot_be_read_shows_all() {
    let mut passes = at_places();
    let all = passes.shown().rows().len();
    passes.apply(PassCommand::Filter("z>1".to_owned()));
    let error = passes.shown().error().expect("an error").to_string();
    assert!(error.contains("\"z\""));
    assert_eq!(passes.shown().rows().len(), all);
    passes.apply(PassCommand::Filter("changed, x>100".to_owned()));
    assert!(passes.shown().error().is_none());
    let table = passes.shown().table(passes.visit()).expect("a table");
    let rows = passes.shown().rows();
    assert!(!rows.is_empty() && rows.len() < table.changed_count());
    assert!(rows.iter().all(|&row| table.after(row as usize)[0] > 100));
}

#[test]
fn the_file_holds_the_rows_shown() {
    let mut passes = at_places();
    passes.apply(PassCommand::Filter("changed, x>100".to_owned()));
    let folder = std::env::temp_dir().join(format!("tilescope-passes-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    assert!(passes.path().ends_with("-places.csv"));
    let path = folder.join(passes.path());
    let table = passes.shown().table(passes.visit()).expect("a table");
    let cells = |&row: &u32| {
        let (before, after) = (table.before(row as usize), table.after(row as usize));
        [&[i64::from(row), 1], before, after].concat()
    };
    let expected: Vec<Vec<i64>> = passes.shown().rows().iter().map(cells).collect();
    go(&mut passes, PassCommand::Path(path.display().to_string()));
    go(&mut passes, PassCommand::Export);
    assert!(passes.export_result().expect("a sentence").is_ok());
    let text = std::fs::read_to_string(&path).expect("the file");
    let mut lines = text.lines();
    let head = "row,changed,x before,y before,fate before,x after,y after,fate after";
    assert_eq!(lines.next(), Some(head));
    let numbers = |line: &str| line.split(',').map(|n| n.parse().unwrap()).collect();
    let read: Vec<Vec<i64>> = lines.map(numbers).collect();
    assert!(read == expected && !read.is_empty());
    assert_eq!(std::fs::read_dir(&folder).expect("the folder").count(), 1);
    let nowhere = folder.join("none").join("a.csv").display().to_string();
    go(&mut passes, PassCommand::Path(nowhere));
    go(&mut passes, PassCommand::Export);
    assert!(passes.export_result().expect("a sentence").is_err());
    std::fs::remove_dir_all(&folder).expect("the folder goes");
}

#[test]
fn a_run_that_is_too_large_is_refused_with_the_limit() {
    let wake: Wake = Arc::new(|| {});
    let large = Parameters {
        radius: 0.0005,
        ..Parameters::default()
    };
    let refusal = Passes::new(gpu(), &large, &wake).err().expect("a refusal");
    assert!(refusal.contains("500,000 samples"), "{refusal}");
}
