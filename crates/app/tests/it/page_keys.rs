//! Shortcuts on a page, where the browser has shortcuts of its own.

use std::collections::HashMap;
use std::sync::Arc;

use egui::{Key, Modifiers};
use tilescope_app::actions::{actions, takes_key};
use tilescope_workbench::State;
use tilescope_workbench::files::Delivery;
use tilescope_workbench::state::Settings;

fn on_page() -> State {
    let mut state = State::new(Arc::new(|| {}));
    state.settle();
    state.restore(Settings {
        delivery: Some(Delivery::Download),
        ..Settings::default()
    });
    state
}

#[test]
fn browsers_keep_the_keys_by_which_they_are_used() {
    let state = on_page();
    let plain = Modifiers::NONE;
    for name in ["F1", "F3", "F5", "F6", "F7", "F11", "F12"] {
        for modifiers in [plain, Modifiers::SHIFT, Modifiers::ALT, Modifiers::CTRL] {
            assert!(!takes_key(&state, name, modifiers), "{modifiers:?} {name}");
        }
    }
    for name in ["r", "t", "w", "n", "p", "f", "c", "v", "x", "Tab"] {
        assert!(!takes_key(&state, name, Modifiers::COMMAND), "Ctrl+{name}");
    }
    for name in ["F8", "F10"] {
        assert!(takes_key(&state, name, plain), "{name}");
        assert!(takes_key(&state, name, Modifiers::SHIFT), "Shift+{name}");
    }
    assert!(takes_key(&state, "k", Modifiers::COMMAND));
    // The native window has no page.
    let mut native = on_page();
    native.restore(Settings {
        delivery: Some(Delivery::Disk),
        ..Settings::default()
    });
    for name in ["F5", "F11"] {
        assert!(takes_key(&native, name, plain), "{name}");
    }
}

#[test]
fn no_two_actions_have_the_same_keys() {
    let mut state = on_page();
    for delivery in [Delivery::Download, Delivery::Disk] {
        state.restore(Settings {
            delivery: Some(delivery),
            ..Settings::default()
        });
        let mut taken = HashMap::new();
        for action in actions(&state) {
            let Some(keys) = action.shortcut else {
                continue;
            };
            // Escape leaves whatever mode is active.
            if keys.logical_key != Key::Escape {
                let other = taken.insert(keys, action.name.clone());
                assert_eq!(other, None, "{} has the keys of another", action.name);
            }
        }
    }
}
