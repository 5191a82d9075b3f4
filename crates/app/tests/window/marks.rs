//! Marks of a whole domain on a small canvas do not hide what they mark.

use egui::Color32;
use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_core::Stage;
use tilescope_drawing::palette::DARK;
use tilescope_session::layers::Layer;
use tilescope_workbench::Command;
use tilescope_workbench::command::{AppearanceCommand, TimeCommand};

use crate::support::{opened_at, session, settle};

/// Returns how many pixels of the canvas are nearer to one of `colors` than to `other` and the background.
fn pixels(harness: &mut Harness<'_, App>, colors: &[Color32], other: Color32) -> usize {
    let rect = harness.state().state.runs().first.viewport;
    let image = harness.render().expect("a picture");
    let far = |a: &[u8], b: Color32| -> i32 {
        let parts = a.iter().zip(b.to_array());
        parts
            .take(3)
            .map(|(&a, b)| (i32::from(a) - i32::from(b)).pow(2))
            .sum()
    };
    let is_one = |pixel: &[u8]| {
        let nearest = colors.iter().map(|&color| far(pixel, color)).min();
        let rest = [other, DARK.domain, DARK.sample].map(|color| far(pixel, color));
        nearest.is_some_and(|nearest| rest.iter().all(|&rest| nearest < rest))
    };
    let (low, high) = (rect.min, rect.max);
    let rows = low.y as u32..high.y as u32;
    let columns = low.x as u32..high.x as u32;
    rows.flat_map(|y| columns.clone().map(move |x| (x, y)))
        .filter(|&(x, y)| is_one(&image.get_pixel(x, y).0))
        .count()
}

#[test]
fn detectors_of_a_whole_domain_on_a_phone_leave_conflicts_and_gaps_to_be_seen() {
    let mut harness = opened_at([390.0, 844.0]);
    let stages = session(&harness);
    let index = stages
        .stages
        .iter()
        .position(|&stage| stage == Stage::Eliminate);
    let eliminated = Command::Time(TimeCommand::ShowStage(index.expect("the stage")));
    harness.state_mut().state.apply(eliminated);
    harness
        .state_mut()
        .state
        .apply(Command::Appearance(AppearanceCommand::ToggleLayer(
            Layer::Samples,
        )));
    settle(&mut harness);
    let count =
        |harness: &mut Harness<'_, App>| pixels(harness, &[DARK.conflict, DARK.gap], DARK.detector);
    let with = count(&mut harness);
    let detectors = pixels(&mut harness, &[DARK.detector], DARK.conflict);
    harness
        .state_mut()
        .state
        .apply(Command::Appearance(AppearanceCommand::ToggleLayer(
            Layer::Detectors,
        )));
    settle(&mut harness);
    let without = count(&mut harness);
    assert!(without > 500, "{without} pixels of conflicts and gaps");
    assert!(
        with * 10 >= without * 6,
        "{with} of {without} pixels are left"
    );
    assert!(detectors > 500, "{detectors} pixels of detectors");
}
