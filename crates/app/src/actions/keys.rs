//! The keys of actions: which of them were pressed in a frame, which a browser is not to take for itself, and what is typed
//! for the list of all actions before it can take it. It does nothing: it returns commands.

use egui::{Event, Key, Modifiers};

use super::{Action, COMMAND, NONE, Palette, SHIFT, actions};
use crate::command::Command;
use crate::embedding::Embedding;
use crate::state::State;

/// Returns a press as it is meant: plus is on the key of the equals sign on many keyboards, with Shift or without.
fn meant(key: Key, modifiers: Modifiers) -> (Key, Modifiers) {
    match key {
        Key::Plus | Key::Equals if modifiers == SHIFT || modifiers.is_none() => (Key::Plus, NONE),
        _ => (key, modifiers),
    }
}

const fn is_function(key: Key) -> bool {
    matches!(key, Key::F2 | Key::F5 | Key::F9 | Key::F10 | Key::F11)
}

/// Returns whether a key, by its name in browsers, is one that means something here whatever has the focus, so that a browser
/// is not to take it for itself: function keys, and letters with Ctrl but those of the clipboard.
#[must_use]
pub fn takes_key(state: &State, name: &str, modifiers: Modifiers) -> bool {
    let key = Key::from_name(name).or_else(|| Key::from_name(&name.to_uppercase()));
    let Some(key) = key.filter(|key| is_function(*key) || modifiers.command) else {
        return false;
    };
    let is_taken = |action: &Action| {
        let here = state.embedding.is_none() || Embedding::takes(&action.command);
        let shortcut = action.shortcut.filter(|_| here);
        shortcut.is_some_and(|shortcut| {
            shortcut.logical_key == key && modifiers.matches_exact(shortcut.modifiers)
        })
    };
    !matches!(key, Key::C | Key::V | Key::X) && actions(state).iter().any(is_taken)
}

/// Returns the commands whose keys were pressed in this frame. While text is typed, only keys with Ctrl and function keys
/// count.
pub fn pressed(ctx: &egui::Context, state: &State) -> Vec<Command> {
    let typing = ctx.text_edit_focused();
    // A focused button takes the space key for itself, the canvas does not.
    let pointed = ctx.memory(|memory| memory.focused().is_some());
    let listed = state.palette.is_some();
    let on_canvas = crate::canvas::has_focus(ctx);
    // Each press comes with the modifiers of its own moment: a slow frame may hold presses and releases of several.
    let asked = ahead(ctx, state);
    let presses: Vec<(Key, Modifiers)> = ctx.input(|input| {
        let end = asked
            .as_ref()
            .map_or(input.events.len(), |asked| asked.from);
        input.events[..end].iter().filter_map(press).collect()
    });
    let mut commands = Vec::new();
    if presses.is_empty() && asked.is_none() {
        return commands;
    }
    ctx.input_mut(|input| {
        for action in actions(state)
            .into_iter()
            .filter(|action| action.refusal.is_none())
        {
            let Some(shortcut) = action.shortcut else {
                continue;
            };
            if listed && action.command != Command::TogglePalette {
                continue;
            }
            let (modifiers, key) = (shortcut.modifiers, shortcut.logical_key);
            // What lies on top comes first: Escape closes it, and letters are meant for it.
            if state.has_sheet() && !modifiers.command {
                continue;
            }
            let free = !typing || modifiers.command || is_function(key);
            let is_tick = matches!(key, Key::ArrowLeft | Key::ArrowRight) && modifiers.is_none();
            let is_taken = pointed && !on_canvas;
            if !free || (key == Key::Space && is_taken) || (is_tick && on_canvas) {
                continue;
            }
            let same =
                |&&(other, held): &&(Key, Modifiers)| other == key && held.matches_exact(modifiers);
            for _ in presses.iter().filter(same) {
                input.consume_key(modifiers, key);
                commands.push(action.command.clone());
            }
        }
    });
    if let Some(asked) = asked {
        commands.extend(asked.commands(state));
    }
    commands
}

fn press(event: &Event) -> Option<(Key, Modifiers)> {
    match *event {
        Event::Key {
            key,
            pressed: true,
            modifiers,
            ..
        } => Some(meant(key, modifiers)),
        _ => None,
    }
}

/// What is typed for the list of all actions before its field can take it: where frames are slow, one holds the keys that
/// open the list and all that is typed then.
struct Ahead {
    /// The first event that is meant for the list.
    from: usize,
    text: String,
    is_entered: bool,
}

fn ahead(ctx: &egui::Context, state: &State) -> Option<Ahead> {
    if state.has_sheet() || state.embedding.is_some() {
        return None;
    }
    let typing = ctx.text_edit_focused();
    let open = state.palette.as_ref();
    ctx.input_mut(|input| {
        let from = match open {
            Some(_) if typing => return None,
            Some(_) => 0,
            None => {
                let opens = |event: &Event| {
                    press(event)
                        .is_some_and(|(key, held)| key == Key::K && held.matches_exact(COMMAND))
                };
                input.events.iter().position(opens)? + 1
            }
        };
        let mut asked = Ahead {
            from,
            text: open.map_or_else(String::new, |open| open.text.clone()),
            is_entered: false,
        };
        for event in &input.events[from..] {
            match event {
                Event::Text(text) if !asked.is_entered => asked.text.push_str(text),
                event if press(event) == Some((Key::Enter, NONE)) => asked.is_entered = true,
                _ => {}
            }
        }
        if open.is_some_and(|open| open.text == asked.text) {
            return None;
        }
        // Nobody else takes it.
        let (mut place, is_entered) = (0, asked.is_entered);
        input.events.retain(|event| {
            place += 1;
            let enters = is_entered && press(event) == Some((Key::Enter, NONE));
            place <= from || !(enters || matches!(event, Event::Text(_)))
        });
        Some(asked)
    })
}

impl Ahead {
    fn commands(self, state: &State) -> Vec<Command> {
        if self.text.trim().is_empty() {
            return Vec::new();
        }
        let palette = Palette {
            text: self.text,
            choice: 0,
        };
        let found = palette.found(state).into_iter().next();
        match found.filter(|action| self.is_entered && action.refusal.is_none()) {
            Some(action) => vec![Command::TogglePalette, action.command],
            None => vec![Command::PaletteText(palette.text)],
        }
    }
}
