//! Brushing: the pairs found are exactly those at the brushed distances, samples' shares add up to the power of
//! the brushed ring, and both belong to the current moment.

use std::collections::BTreeSet;
use std::ops::ControlFlow;

use glam::DVec2;
use serde_json::json;
use tilescope_analysis::measures::{Periodogram, Spectrum};
use tilescope_analysis::{Boundary, Region};
use tilescope_core::Boundary as Border;
use tilescope_core::Parameter;
use tilescope_drawing::brushed::{BrushedCause, Cause};
use tilescope_workbench::analysis::AnalysisCommand;
use tilescope_workbench::analysis::brush::{Brush, BrushAxis};
use tilescope_workbench::command::{FormCommand, TimeCommand, WindowCommand};
use tilescope_workbench::draft::Choice;
use tilescope_workbench::layout::Panel;
use tilescope_workbench::{Command, State};

use crate::exporting::opened;

fn analysing() -> State {
    let mut state = opened();
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Analysis)));
    state.settle();
    state
}

fn brush(state: &mut State, axis: BrushAxis, from: f64, to: f64) {
    let brush = Brush::between(axis, from, to);
    state.apply(Command::Analysis(AnalysisCommand::Brush(brush)));
    state.settle();
}

fn causes(state: &State) -> Option<&BrushedCause> {
    state.analysis().causes(&state.runs().first, state.window())
}

fn cause(state: &State) -> &Cause {
    &causes(state).expect("causes").cause
}

/// The samples that cover their disks, by id, with their positions in r.
fn standing(state: &State) -> Vec<(u32, DVec2)> {
    let shown = state.runs().first.shown().unwrap();
    let all = 0..shown.session.run().samples.len() as u32;
    let ids = all.filter(|id| shown.covers(*id));
    ids.map(|id| (id, shown.session.position(id))).collect()
}

/// All pairs of samples at the distances, found by brute force.
fn brute_force(state: &State, [least, most]: [f64; 2]) -> BTreeSet<[u32; 2]> {
    let session = state.runs().first.session.as_ref().unwrap();
    let (size, periodic) = (session.size_radii(), session.run().domain.is_periodic());
    let samples = standing(state);
    let mut pairs = BTreeSet::new();
    for (k, (a, from)) in samples.iter().enumerate() {
        for (b, to) in &samples[k + 1..] {
            let straight = (to - from).abs();
            let offset = if periodic {
                straight.min(size - straight)
            } else {
                straight
            };
            let distance = offset.x.hypot(offset.y);
            if least <= distance && distance < most {
                pairs.insert([*a.min(b), *a.max(b)]);
            }
        }
    }
    pairs
}

fn found_pairs(state: &State) -> BTreeSet<[u32; 2]> {
    let Cause::Pairs { total, pairs } = cause(state) else {
        panic!("not pairs");
    };
    assert_eq!(*total, pairs.len() as u64);
    let session = state.runs().first.session.as_ref().unwrap();
    for pair in pairs {
        // The offset leads to an image of the second sample.
        let [from, to] = pair.ids.map(|id| session.position(id));
        let turns = (from + pair.offset - to) / session.size_radii();
        assert!(turns.abs_diff_eq(turns.round(), 1e-9), "{pair:?}");
    }
    let ids = pairs.iter().map(|pair| pair.ids);
    ids.map(|[a, b]| [a.min(b), a.max(b)]).collect()
}

#[test]
fn pairs_equal_those_of_brute_force() {
    for border in [Border::Periodic, Border::Bounded] {
        let mut state = opened();
        state.apply(Command::Form(FormCommand::Choose(Choice::Parameter(
            Parameter::Boundary,
            json!(border),
        ))));
        state.apply(Command::Form(FormCommand::Type(
            Parameter::Height,
            "0.7".to_owned(),
        )));
        state.apply(Command::Run);
        state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Analysis)));
        state.settle();
        for (cursor, range) in [
            (usize::MAX, [1.0, 1.05]),
            (usize::MAX, [2.0, 2.01]),
            (usize::MAX, [0.0, 0.99]),
            (2_600, [0.0, 0.999_9]),
        ] {
            state.apply(Command::Time(TimeCommand::Jump(cursor)));
            brush(&mut state, BrushAxis::Distance, range[0], range[1]);
            let expected = brute_force(&state, range);
            assert_eq!(
                found_pairs(&state),
                expected,
                "{border:?} {cursor} {range:?}"
            );
            if cursor == usize::MAX {
                assert_eq!(expected.is_empty(), range[1] < 1.0);
            } else {
                assert!(!expected.is_empty(), "conflicts in the middle of the run");
            }
            let message = state.analysis().brush_text(&state.runs().first);
            let count = tilescope_session::words::grouped(expected.len());
            assert!(message.starts_with(&format!("{count} pair")), "{message}");
        }
    }
}

#[test]
fn shares_add_up_to_the_power_and_belong_to_covering_samples() {
    let mut state = analysing();
    for cursor in [usize::MAX, 1_500] {
        state.apply(Command::Time(TimeCommand::Jump(cursor)));
        brush(&mut state, BrushAxis::Frequency, 0.9, 1.3);
        let samples = standing(&state);
        let [width, height] = state
            .runs()
            .first
            .session
            .as_ref()
            .unwrap()
            .size_radii()
            .to_array();
        let region = Region {
            width,
            height,
            boundary: Boundary::Periodic,
        };
        let points: Vec<[f64; 2]> = samples
            .iter()
            .map(|(_, position)| position.to_array())
            .collect();
        let window = Spectrum::window(points.len() as f64, region);
        let go_on = |_| ControlFlow::Continue(());
        let periodogram = Periodogram::of(&points, region, &window, &go_on).unwrap();
        let root = (points.len() as f64).sqrt();
        let inside = window.frequencies().filter(|k| {
            let nu = periodogram.length(*k) / root;
            (0.9..1.3).contains(&nu)
        });
        let powers: Vec<f64> = inside.filter_map(|k| periodogram.at(k)).collect();
        let mean = powers.iter().sum::<f64>() / powers.len() as f64;
        let Cause::Shares {
            frequencies,
            mean_power,
            shares,
            strongest,
        } = cause(&state)
        else {
            panic!("not shares");
        };
        assert_eq!(*frequencies, powers.len() as u64);
        assert!((mean_power - mean).abs() < 1e-6 * mean);
        let known: Vec<u32> = (0..shares.len() as u32)
            .filter(|id| shares[*id as usize].is_finite())
            .collect();
        let stands: Vec<u32> = samples.iter().map(|(id, _)| *id).collect();
        assert_eq!(known, stands);
        let each = shares.iter().filter(|share| share.is_finite());
        let sum: f64 = each.clone().map(|share| f64::from(*share)).sum();
        // Shares are relative to noise, so their mean is the mean power.
        assert!((sum / points.len() as f64 - mean).abs() < 1e-3 * mean);
        let off = |share: &&f32| (**share - *mean_power as f32).abs() > *strongest;
        let beyond = each.filter(off).count();
        assert!(beyond <= points.len() / 20 + 1, "{beyond}");
    }
}

#[test]
fn causes_follow_the_moment_and_end_with_the_brush_and_the_panel() {
    let mut state = analysing();
    brush(&mut state, BrushAxis::Distance, 1.0, 1.1);
    let first = found_pairs(&state);
    state.apply(Command::Time(TimeCommand::Jump(3_000)));
    assert!(
        causes(&state).is_none(),
        "causes of another moment are not shown"
    );
    assert_eq!(
        state.analysis().brush_text(&state.runs().first),
        "Searching\u{2026}"
    );
    state.settle();
    assert_ne!(found_pairs(&state), first);
    assert!(causes(&state).is_some());
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Parameters)));
    assert!(causes(&state).is_none());
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Analysis)));
    state.apply(Command::Analysis(AnalysisCommand::Brush(None)));
    state.settle();
    assert!(causes(&state).is_none());
}

#[test]
fn impossible_searches_are_explained_and_empty_brushes_ignored() {
    // In a domain of less than ten r, two samples five r apart may have two nearest images.
    let mut state = opened();
    state.apply(Command::Form(FormCommand::Choose(Choice::Parameter(
        Parameter::Boundary,
        json!(Border::Bounded),
    ))));
    for (field, text) in [(Parameter::Radius, "0.13"), (Parameter::Leaf, "6")] {
        state.apply(Command::Form(FormCommand::Type(field, text.to_owned())));
    }
    assert_eq!(state.form().refusal(state.gpu()), None);
    state.apply(Command::Run);
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Analysis)));
    state.settle();
    assert!(state.runs().first.session.as_ref().unwrap().size_radii()[0] < 9.0);
    brush(&mut state, BrushAxis::Distance, 1.0, 5.0);
    assert!(causes(&state).is_none());
    let message = state.analysis().brush_text(&state.runs().first);
    assert!(message.contains("largest distance of a pair"), "{message}");
    brush(&mut state, BrushAxis::Distance, 1.0, 3.0);
    assert_eq!(found_pairs(&state), brute_force(&state, [1.0, 3.0]));
    brush(&mut state, BrushAxis::Frequency, 0.0, 0.01);
    assert_eq!(
        state.analysis().brush_text(&state.runs().first),
        "No frequency lies in the ring."
    );
    assert_eq!(Brush::between(BrushAxis::Distance, 2.0, 2.0), None);
    assert_eq!(
        Brush::between(BrushAxis::Distance, f64::NAN, f64::NAN),
        None
    );
    let reversed = Brush::between(BrushAxis::Frequency, 9.0, -1.0);
    assert_eq!(reversed, Brush::between(BrushAxis::Frequency, 0.0, 2.5));
}
