//! Recordings of exact tilings: what each event claims is compared with what all samples and darts before it say, looked at
//! one by one.

use tilescope_core::{
    Arrival, Fate, Origin, Parameters, PatternDarts, PatternHistory, PlacedDart, Point, R,
    RunEvent, Stage, TilingMethod, Unobserved, Verdict, exact_sample,
};
use tilescope_debugger::{
    DEFAULT_BUDGET, Event, EventKind, NONE, Recording, Session, Status, arrival_text, grouped, why,
    why_here,
};

use crate::support::{record, restored, variants};

/// The darts of a run's pattern, where its blocks have them.
struct Thrown {
    recording: Recording,
    darts: PatternDarts,
    history: PatternHistory,
}

impl Thrown {
    fn of(parameters: &Parameters) -> Self {
        let spec = &parameters.pattern;
        Self {
            recording: record(parameters, DEFAULT_BUDGET),
            darts: PatternDarts::of_spec(spec).unwrap(),
            history: PatternHistory::of_spec(spec, &mut Unobserved).unwrap(),
        }
    }

    /// Returns the dart of a sample.
    fn of_sample(&self, id: u32) -> PlacedDart {
        let run = self.recording.run();
        let place = run.samples.points[id as usize];
        match run.samples.origins[id as usize] {
            Origin::Tiled { pattern, .. } => PlacedDart {
                arrival: self.history.arrival(pattern),
                source: self.history.pattern().samples()[pattern as usize],
                place,
            },
            Origin::Inserted { iteration, .. } => {
                let levels = if iteration == 1 {
                    0..2
                } else {
                    iteration..iteration + 1
                };
                self.at(place, levels)
            }
        }
    }

    /// Returns the first dart of some levels at a place of the domain.
    fn at(&self, place: Point, mut levels: std::ops::Range<u32>) -> PlacedDart {
        let run = self.recording.run();
        let holds = |block: &tilescope_core::stages::blocks::Block| block.rect.contains(place);
        let block = run.blocks.leaves.iter().position(holds).unwrap();
        let (rect, start) = (run.blocks.leaves[block].rect, run.tiles[block].start);
        let side = run.pattern.domain().width();
        let wrapped = |at: i32, min: i32, start: i32| (start + R + at - min).rem_euclid(side);
        let source = Point::new(
            wrapped(place.x, rect.min.x, start.x),
            wrapped(place.y, rect.min.y, start.y),
        );
        let first = |level: u32| {
            let side = R >> level;
            let cell = Point::new(source.x & -side, source.y & -side);
            let darts = self.darts.of_cell(level, cell);
            darts
                .filter(|(_, at)| *at == source)
                .map(|(arrival, _)| arrival)
                .min()
        };
        let arrival: Option<Arrival> = levels.find_map(first);
        PlacedDart {
            arrival: arrival.expect("a dart at the place of an event"),
            source,
            place,
        }
    }

    /// Returns the earliest sample that is there at a cursor, covers a dart and is earlier, or `NONE`.
    fn first_blocker(&self, dart: &PlacedDart, cursor: usize) -> u32 {
        let recording = &self.recording;
        let ids = 0..recording.run().samples.len() as u32;
        let there = ids.filter(|&id| recording.status(id, cursor).is_valid());
        let covering = there.filter(|&id| {
            let at = recording.point(id).unwrap();
            recording.domain().covers(at, dart.place)
        });
        let earlier = covering.map(|id| (self.of_sample(id), id));
        let first = earlier.filter(|(other, _)| other < dart).min();
        first.map_or(NONE, |(_, id)| id)
    }

    /// Returns the level of an iteration's darts, the first of which has two.
    fn levels(iteration: u32) -> std::ops::Range<u32> {
        if iteration == 1 {
            0..2
        } else {
            iteration..iteration + 1
        }
    }

    /// Returns what is wrong with what an event claims, if anything is.
    fn wrong(&self, index: usize, run_event: RunEvent) -> Option<String> {
        let levels = || Self::levels(self.recording.context(index).iteration);
        let blocked = |dart: &PlacedDart, claimed: u32| {
            let first = self.first_blocker(dart, index);
            (first != claimed).then(|| format!("{run_event:?}: {first} covers it first"))
        };
        match run_event {
            RunEvent::Keep { sample, .. } => blocked(&self.of_sample(sample), NONE),
            RunEvent::Eliminate { sample, by } => blocked(&self.of_sample(sample), by),
            RunEvent::Dart { point, verdict, .. } => {
                let by = match verdict {
                    Verdict::Covered { by } => by,
                    _ => NONE,
                };
                let dart = self.at(point, levels());
                // What falls is compared with what is earlier than its level.
                let is_thrown = matches!(run_event, RunEvent::Dart { ranked: false, .. });
                match verdict {
                    Verdict::Accepted if is_thrown => None,
                    _ => blocked(&dart, by),
                }
            }
            RunEvent::Wake { point, behind } => self.wrong_wake(point, behind),
            _ => None,
        }
    }

    /// A woken dart was refused in the pattern, first by a sample that is missing.
    fn wrong_wake(&self, place: Point, behind: u32) -> Option<String> {
        let (dart, pattern) = (self.at(place, 0..2), self.history.pattern());
        let covering = (0..)
            .zip(pattern.samples())
            .filter(|(_, sample)| pattern.domain().covers(**sample, dart.source));
        let first = covering
            .map(|(id, _)| id)
            .min_by_key(|id| self.history.arrival(*id));
        let (first, run) = (first.expect("the pattern is maximal"), self.recording.run());
        if self.history.arrival(first) >= dart.arrival {
            return Some(format!("{place:?} is a sample of the pattern"));
        }
        match run.samples.origins.get(behind as usize) {
            Some(Origin::Tiled { pattern, .. }) if *pattern == first => None,
            None if behind == NONE => None,
            other => Some(format!("{place:?} waits behind {first}, not {other:?}")),
        }
    }
}

/// Every claim of a recording holds, arrivals follow each other in their order, and the end is the unrecorded engine's.
#[test]
fn every_event_of_an_exact_tiling_is_true() {
    for parameters in &variants()[6..] {
        let darts = Thrown::of(parameters);
        let recording = &darts.recording;
        let mut last: Option<PlacedDart> = None;
        let mut kinds = std::collections::BTreeSet::new();
        for (index, event) in recording.tape().from(0) {
            let run_event = event.run_event().unwrap();
            assert_eq!(darts.wrong(index, run_event), None, "event {index}");

            let iteration = recording.context(index).iteration;
            let arrives = match run_event {
                RunEvent::Keep { sample, .. } | RunEvent::Eliminate { sample, .. } => {
                    Some(darts.of_sample(sample))
                }
                RunEvent::Dart {
                    point,
                    ranked: true,
                    ..
                } => Some(darts.at(point, Thrown::levels(iteration))),
                _ => None,
            };
            if let Some(next) = arrives {
                assert!(last < Some(next), "event {index} comes too late");
                last = Some(next);
                kinds.insert(event.kind().name());
            }
        }
        assert_eq!(kinds.len(), 3, "{kinds:?}");

        let history = &darts.history;
        let run = exact_sample(parameters, history, &mut Unobserved).unwrap();
        assert_eq!(recording.run().points(), run.points());
        assert_eq!(recording.run().summary(), run.summary());
        assert_eq!(recording.run().blocks, run.blocks);
    }
}

/// The control: a claim that names another sample, or none, is found to be wrong.
#[test]
fn false_claims_are_found() {
    let darts = Thrown::of(&variants()[6]);
    let mut found = 0;
    for (index, event) in darts.recording.tape().from(0) {
        let lies = match event.run_event() {
            Some(RunEvent::Keep { sample, .. }) => vec![RunEvent::Eliminate { sample, by: 0 }],
            Some(RunEvent::Eliminate { sample, by }) => vec![
                RunEvent::Keep {
                    sample,
                    rest: false,
                },
                RunEvent::Eliminate { sample, by: by + 1 },
            ],
            Some(RunEvent::Dart {
                point,
                z,
                ranked: true,
                verdict,
            }) => {
                let other = match verdict {
                    Verdict::Accepted => Verdict::Covered { by: 0 },
                    _ => Verdict::Accepted,
                };
                vec![RunEvent::Dart {
                    point,
                    z,
                    ranked: true,
                    verdict: other,
                }]
            }
            Some(RunEvent::Wake { point, behind }) if behind != NONE => {
                vec![RunEvent::Wake {
                    point,
                    behind: behind + 1,
                }]
            }
            _ => vec![],
        };
        for lie in lies {
            assert!(darts.wrong(index, lie).is_some(), "{lie:?}");
            found += 1;
        }
    }
    assert!(found > 500, "{found}");
}

/// The chain of causes of a sample that the pattern lacks leads through its dart to what is missing, and to its block.
#[test]
fn causes_lead_from_a_dart_to_what_it_outlived() {
    let recording = record(&variants()[6], DEFAULT_BUDGET);
    let kind = |index: &usize| recording.event(*index).unwrap().kind();
    let mut through_losses = 0;
    for (index, event) in recording.tape().from(0) {
        let chain = why::causes(&recording, index);
        assert!(chain.is_sorted_by(|a, b| a > b) && chain.iter().all(|&cause| cause < index));
        let kinds: Vec<EventKind> = chain.iter().map(kind).collect();
        match event.run_event() {
            Some(RunEvent::Insert { .. }) => {
                assert_eq!(kinds[0], EventKind::Dart);
                assert!(
                    matches!(kinds[1], EventKind::Wake | EventKind::Dart),
                    "{kinds:?}"
                );
                through_losses += usize::from(kinds.contains(&EventKind::Eliminate));
            }
            Some(RunEvent::Eliminate { by, .. }) => {
                assert_eq!(
                    Some(chain[0] as u32),
                    recording.life(by).map(|life| life.kept)
                );
            }
            Some(RunEvent::Dart {
                verdict: Verdict::Covered { by },
                ..
            }) => {
                assert!(recording.event(chain[0]).unwrap().touches(by));
            }
            _ => {}
        }
    }
    assert!(through_losses > 0);
}

#[test]
fn its_stages_are_levels_and_each_sample_arrives_once() {
    let recording = record(&variants()[7], DEFAULT_BUDGET);
    let stages = recording.run().stages();
    let begins = [
        Stage::Pattern,
        Stage::Blocks,
        Stage::Tile,
        Stage::Iterate(1),
    ];
    assert_eq!(stages[..4], begins);
    assert!(!stages.contains(&Stage::Eliminate));
    assert_eq!(stages.last(), Some(&Stage::Finish));

    let mut arrivals = vec![0; recording.run().samples.len()];
    for event in recording.tape().iter() {
        if let EventKind::Keep | EventKind::Eliminate | EventKind::Insert = event.kind() {
            arrivals[event.samples()[0] as usize] += 1;
        }
    }
    assert!(arrivals.iter().all(|&count| count == 1));
    let lost = recording.run().samples.fates.iter();
    let lost = lost
        .filter(|fate| matches!(fate, Fate::Eliminated { .. }))
        .count();
    assert!(lost > 10);
    let statuses = (0..arrivals.len() as u32).map(|id| recording.status(id, recording.len()));
    assert_eq!(
        statuses
            .filter(|status| *status == Status::Eliminated)
            .count(),
        lost
    );
    assert!(recording.tape().iter().any(Event::is_detail));
}

#[test]
fn a_saved_session_of_an_exact_tiling_comes_back() {
    let recording = std::sync::Arc::new(record(&variants()[6], DEFAULT_BUDGET));
    let mut debugger = tilescope_debugger::Debugger::new(recording, DEFAULT_BUDGET);
    debugger.jump(1_000);
    let text = debugger.session().to_json().unwrap();
    // Programs that know no exact tiling refuse it.
    assert!(text.contains("\"version\": 3"));
    let session = Session::from_json(&text).unwrap();
    let again = restored(&session).unwrap();
    assert_eq!(again.state(), debugger.state());
    assert_eq!(again.session(), session);
}

#[test]
fn why_a_sample_is_there_is_one_line_with_its_arrival_and_who_came_first() {
    let parameters = Parameters {
        radius: 0.02,
        method: TilingMethod::Exact,
        ..Parameters::default()
    };
    let thrown = Thrown::of(&parameters.as_exact());
    let recording = &thrown.recording;
    let run = recording.run();
    let mut seen = [0; 4];

    for id in 0..run.samples.len() as u32 {
        // The arrival is compared with the one that is found by looking through the darts.
        let arrival = thrown.of_sample(id).arrival;
        assert_eq!(run.arrival_of(id), Some(arrival), "{id}");

        let line = why_here(recording, id).unwrap();
        let when = arrival_text(arrival);
        assert!(
            line.starts_with(&format!("sample {} ({when}): ", grouped(id.into()))),
            "{line}"
        );
        assert!(!line.contains('\n') && line.len() < 160, "{line}");
        let (origin, fate) = (
            run.samples.origins[id as usize],
            run.samples.fates[id as usize],
        );
        if let Origin::Tiled { block, .. } = origin {
            assert!(
                line.contains(&format!("): tiled from block {block}; ")),
                "{line}"
            );
        }
        let other = |by: u32| format!("sample {} (", grouped(by.into()));
        let (part, kind) = match (origin, fate) {
            (_, Fate::Eliminated { by }) => (format!("; lost, since {}", other(by)), 0),
            (Origin::Tiled { .. }, _) => ("; ".to_owned(), 1),
            (Origin::Inserted { iteration: 1, .. }, _) => {
                ("): woken, as its first blocker".to_owned(), 2)
            }
            (Origin::Inserted { .. }, _) => ("): thrown where a loss".to_owned(), 3),
        };
        assert!(line.contains(&part), "{line}");
        seen[kind] += 1;

        // A sample to which others were lost says so, and no other does.
        let lost = run
            .samples
            .fates
            .iter()
            .filter(|fate| **fate == Fate::Eliminated { by: id });
        let count = lost.count();
        if kind > 0 {
            assert_eq!(
                line.contains("refused sample") || line.contains(" samples"),
                count > 0,
                "{line}"
            );
        }
    }
    assert!(seen.iter().all(|count| *count > 5), "{seen:?}");

    // Negative controls: a sample that there is not, and a run by the other method.
    assert_eq!(why_here(recording, run.samples.len() as u32), None);
    let kdrt = Parameters {
        method: TilingMethod::Kdrt,
        ..parameters
    };
    assert_eq!(why_here(&record(&kdrt, DEFAULT_BUDGET), 0), None);
}
