//! The menus of the bar: they fit into the window, their submenus open, and switches that are on have a check mark.

use egui::accesskit::Toggled;
use egui::{Rect, Vec2, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tilescope_app::App;
use tilescope_app::actions::{Action, Menu, actions};
use tilescope_session::layers::Layer;
use tilescope_session::selection::Selection;
use tilescope_ui::widgets::Kebab;
use tilescope_workbench::Command;
use tilescope_workbench::command::{TimeCommand, ViewCommand, Which, WindowCommand};
use tilescope_workbench::layout::Panel;

use crate::support::{author, find, node, opened, opened_at, settle};

fn click(harness: &mut Harness<'_, App>, id: &str) {
    node(harness, id).click();
    harness.run();
}

/// Returns the ids of the entries on the screen, and checks that they lie in the window.
fn entries(harness: &Harness<'_, App>, size: [f32; 2]) -> Vec<String> {
    let window = Rect::from_min_size(pos2(0.0, 0.0), Vec2::from(size));
    let all = harness.query_all_by(|node| {
        let id = node.author_id().unwrap_or_default();
        id.starts_with("entry.") || id.starts_with("submenu.")
    });
    let all = all.map(|entry| {
        let id = author(&entry).unwrap_or_default();
        assert!(window.contains_rect(entry.rect()), "{id} is out of sight");
        id
    });
    all.collect()
}

fn submenus(all: &[Action], menu: Menu) -> Vec<String> {
    let nested = all.iter().filter(|action| action.menu == menu);
    let mut ids: Vec<String> = nested
        .filter_map(|action| Some(format!("submenu.{}", Kebab(action.submenu?))))
        .collect();
    ids.dedup();
    ids
}

#[test]
fn every_entry_is_in_sight_without_scrolling() {
    for size in [[1600.0, 1000.0], [1280.0, 720.0]] {
        let mut harness = opened_at(size);
        // A selected sample and a next line have entries of their own.
        for command in [
            Command::View(Which::First, ViewCommand::Pick(Selection::Sample(40))),
            Command::Time(TimeCommand::Jump(20_000)),
        ] {
            harness.state_mut().state.apply(command);
        }
        settle(&mut harness);
        let all = actions(&harness.state().state);
        for menu in Menu::ALL {
            let mut seen = Vec::new();
            for submenu in std::iter::once(None).chain(submenus(&all, menu).into_iter().map(Some)) {
                click(&mut harness, &format!("menu.{}", Kebab(menu)));
                if let Some(submenu) = submenu {
                    click(&mut harness, &submenu);
                }
                seen.extend(entries(&harness, size));
                while !entries(&harness, size).is_empty() {
                    harness.key_press(egui::Key::Escape);
                    harness.run();
                }
            }
            for action in all.iter().filter(|action| action.menu == menu) {
                let id = format!("entry.{}", action.id());
                assert!(seen.contains(&id), "{id} is in no menu at {size:?}");
            }
        }
    }
}

#[test]
fn switches_that_are_on_are_marked() {
    let mut harness = opened();
    let layer = Layer::Tree;
    let entry = format!("entry.view-appearance-toggle-layer-{}", Kebab(layer));
    for is_on in [false, true] {
        click(&mut harness, "menu.view");
        click(&mut harness, "submenu.layers");
        let shown = harness.state().state.appearance().layers(None).has(layer);
        assert_eq!(shown, is_on);
        let toggled = node(&harness, &entry).accesskit_node().toggled();
        assert_eq!(toggled, Some(Toggled::from(is_on)));
        click(&mut harness, &entry);
        assert!(find(&harness, &entry).is_none(), "the menu closes");
    }
    // The last entries react, too: they are not scrolled out of sight.
    let before = harness.state().state.window().layout.clone();
    harness
        .state_mut()
        .state
        .apply(Command::Window(WindowCommand::OpenPanel(Panel::Legend)));
    for step in [
        "menu.view",
        "submenu.panels",
        "entry.view-window-reset-layout",
    ] {
        click(&mut harness, step);
    }
    assert_eq!(harness.state().state.window().layout, before);
    // Others have no mark.
    click(&mut harness, "menu.view");
    let entry = node(&harness, "entry.view-view-first-fit").accesskit_node();
    assert_eq!(entry.toggled(), None);
}
