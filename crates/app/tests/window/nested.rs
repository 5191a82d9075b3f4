//! Nested levels in the window: their choice among the parameters, the slider over the prefix, and the canvas.

use egui_kittest::Harness;
use egui_kittest::kittest::NodeT;
use tilescope_app::App;
use tilescope_core::Parameter;
use tilescope_session::layers::{Colouring, Layer};
use tilescope_workbench::Command;
use tilescope_workbench::command::{AppearanceCommand, FormCommand, TimeCommand, WindowCommand};
use tilescope_workbench::draft::Choice;
use tilescope_workbench::layout::Panel;

use crate::canvas::{apply, drawn};
use crate::support::{find, is_disabled, node, session, settle, text};

/// A window with four levels of some 1,700 samples, drawn by instancing or as meshes.
fn made(instanced: bool) -> Harness<'static, App> {
    let mut harness = drawn([1_400.0, 900.0], instanced);
    for command in [
        Command::Form(FormCommand::Type(Parameter::Radius, "0.02".to_owned())),
        Command::Form(FormCommand::Choose(Choice::Levels(Some(4)))),
        Command::Run,
    ] {
        apply(&mut harness, command);
    }
    harness
}

fn prefix(harness: &Harness<'_, App>) -> usize {
    harness.state().state.runs().first.prefix().expect("levels")
}

#[test]
fn keys_clicks_and_a_typed_number_move_the_prefix_and_its_verdict_names_it() {
    let mut harness = made(false);
    let ends = session(&harness).ends();
    let slider = node(&harness, "moment").accesskit_node();
    assert_eq!(slider.label().as_deref(), Some("Samples shown"));
    assert_eq!(slider.numeric_value(), Some(ends[3] as f64));
    for (id, count) in [("stage.level-0", ends[0]), ("stage.level-2", ends[2])] {
        node(&harness, id).click();
        harness.run();
        settle(&mut harness);
        assert_eq!(prefix(&harness), count);
        let verdict = text(&harness, "verdict");
        let named = tilescope_session::words::grouped(count);
        assert_eq!(verdict, format!("Verdict: first {named}: verified"));
    }
    for (key, count) in [
        (egui::Key::ArrowLeft, ends[1]),
        (egui::Key::Home, ends[0]),
        (egui::Key::End, ends[3]),
    ] {
        harness.key_press(key);
        harness.run();
        settle(&mut harness);
        assert_eq!(prefix(&harness), count, "{key:?}");
    }
    let field = node(&harness, "prefix").accesskit_node();
    assert_eq!(field.label().as_deref(), Some("Samples shown"));
    node(&harness, "prefix").click();
    harness.run();
    harness.event(egui::Event::Text("345".to_owned()));
    harness.run();
    harness.key_press(egui::Key::Enter);
    harness.run();
    settle(&mut harness);
    assert_eq!(prefix(&harness), 345);
    let said = text(&harness, "status");
    let is_said = said.starts_with("The first 345 of ") && said.ends_with(" Verified.");
    assert!(is_said, "{said}");
}

#[test]
fn the_parameters_ask_for_levels_and_their_choices() {
    let mut harness = made(false);
    for id in ["levels", "exactly", "within"] {
        assert!(find(&harness, id).is_some(), "{id}");
    }
    let none = Command::Form(FormCommand::Choose(Choice::Levels(None)));
    apply(&mut harness, none);
    assert!(find(&harness, "exactly").is_none() && find(&harness, "within").is_none());
    assert!(text(&harness, "run-remark").contains("nested levels"));
}

#[test]
fn legend_layers_and_levels_are_those_of_nested_levels() {
    let mut harness = made(false);
    for panel in [Panel::Legend, Panel::Statistics] {
        let command = Command::Window(WindowCommand::OpenPanel(panel));
        apply(&mut harness, command);
    }
    assert!(find(&harness, "layer.disks").is_some() && find(&harness, "layer.gaps").is_none());
    node(&harness, "row.level-1").click();
    harness.run();
    settle(&mut harness);
    assert_eq!(prefix(&harness), session(&harness).ends()[1]);
    let legend = Command::Window(WindowCommand::OpenPanel(Panel::Legend));
    apply(&mut harness, legend);
    assert!(find(&harness, "colour.level").is_some() && find(&harness, "colour.block").is_none());
    node(&harness, "colour.age").click();
    harness.run();
    assert_eq!(harness.state().state.appearance().colouring, Colouring::Age);
    assert!(find(&harness, "ages").is_some());
    assert!(!is_disabled(&harness, "prefix"));
}

/// The pixels of the canvas.
fn pixels(harness: &mut Harness<'_, App>) -> Vec<[u8; 4]> {
    // What is thinned out while the prefix moves is complete in the next frame.
    harness.step();
    harness.step();
    let image = harness.render().expect("a picture");
    let rect = harness.state().state.runs().first.viewport.shrink(1.0);
    let columns = rect.left() as u32..rect.right() as u32;
    let rows = rect.top() as u32..rect.bottom() as u32;
    rows.flat_map(|y| columns.clone().map(move |x| (x, y)))
        .map(|(x, y)| image.get_pixel(x, y).0)
        .collect()
}

/// The mean difference of two pictures.
fn difference(a: &[[u8; 4]], b: &[[u8; 4]]) -> f64 {
    let of =
        |(a, b): (&[u8; 4], &[u8; 4])| (0..3).map(|k| f64::from(a[k].abs_diff(b[k]))).sum::<f64>();
    a.iter().zip(b).map(of).sum::<f64>() / a.len() as f64
}

#[test]
fn the_canvas_shows_the_prefix_alone_by_instancing_as_by_meshes() {
    let (mut on_gpu, mut as_meshes) = (made(true), made(false));
    let ends = session(&on_gpu).ends();
    for disks in [false, true] {
        let mut pictures = Vec::new();
        for count in [3, ends[0], ends[1] + 40, ends[3]] {
            let shot = |harness: &mut Harness<'_, App>| {
                apply(harness, Command::Time(TimeCommand::Jump(count)));
                pixels(harness)
            };
            let (a, b) = (shot(&mut on_gpu), shot(&mut as_meshes));
            pictures.push((a, b));
        }
        for (k, (a, b)) in pictures.iter().enumerate() {
            let near = difference(a, b);
            let others = pictures.iter().enumerate().filter(|(other, _)| *other != k);
            let far = others.map(|(_, other)| difference(a, &other.1));
            let far = far.fold(f64::INFINITY, f64::min);
            assert!(near < 0.5 * far, "{k}, {disks}: {near} and {far}");
        }
        for harness in [&mut on_gpu, &mut as_meshes] {
            let command = AppearanceCommand::ToggleLayer(Layer::Disks);
            apply(harness, Command::Appearance(command));
        }
    }
}
