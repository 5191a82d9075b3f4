//! Keyboard shortcuts: which actions were pressed in a frame, which keys are kept from the browser, and text typed for
//! the action list before its field has the focus. Returns commands; nothing is changed here.

use egui::{Event, Key, KeyboardShortcut, Modifiers, Popup};

use super::{Action, COMMAND, NONE, SHIFT, actions, found};
use tilescope_workbench::command::{Command, WindowCommand};
use tilescope_workbench::finder::Finder;
use tilescope_workbench::state::State;

/// Returns a press as shortcuts write it: on many keyboards plus shares a key with the equals sign, and plus or the
/// question mark needs Shift.
fn meant(key: Key, modifiers: Modifiers) -> (Key, Modifiers) {
    match key {
        // Shift is needed for it on most keyboards.
        Key::Questionmark if modifiers == SHIFT => (key, NONE),
        Key::Plus | Key::Equals if modifiers == SHIFT || modifiers.is_none() => (Key::Plus, NONE),
        _ => (key, modifiers),
    }
}

/// Returns whether a sheet covers the window.
const fn has_sheet(state: &State) -> bool {
    state.files().has_sheet() || state.window().help.is_some()
}

const fn is_function(key: Key) -> bool {
    matches!(
        key,
        Key::F2 | Key::F4 | Key::F5 | Key::F8 | Key::F9 | Key::F10 | Key::F11
    )
}

/// Returns the current shortcuts of a command.
#[must_use]
pub fn keys_of(state: &State, command: &Command) -> Option<KeyboardShortcut> {
    let mut all = actions(state).into_iter();
    all.find(|action| action.command == *command)?.shortcut
}

/// Returns a shortcut as keyboards show it: signs by themselves, other keys by their names.
#[must_use]
pub fn shortcut_text(ctx: &egui::Context, shortcut: &KeyboardShortcut) -> String {
    let text = ctx.format_shortcut(shortcut);
    let name = shortcut.logical_key.name();
    // egui writes these keys as words.
    let sign = match shortcut.logical_key {
        Key::Period => ".",
        Key::Plus => "+",
        Key::Minus => "\u{2212}",
        Key::Questionmark => "?",
        Key::Comma => ",",
        _ => return text,
    };
    match text.strip_suffix(name) {
        Some(modifiers) => format!("{modifiers}{sign}"),
        // On a Mac egui writes signs itself.
        None => text,
    }
}

/// Returns whether a key, by its browser name, is a shortcut whatever has the focus, so that the page keeps it from the
/// browser: function keys, and letters with Ctrl except those of the clipboard.
#[must_use]
pub fn takes_key(state: &State, name: &str, modifiers: Modifiers) -> bool {
    let key = Key::from_name(name).or_else(|| Key::from_name(&name.to_uppercase()));
    let Some(key) = key.filter(|key| is_function(*key) || modifiers.command) else {
        return false;
    };
    let is_taken = |action: &Action| {
        // A frame keeps no key from its page for a command that it does not carry out.
        let here = state.window().embedding.is_none() || action.command.rules().in_frame;
        here && action.keys().any(|shortcut| {
            shortcut.logical_key == key && modifiers.matches_exact(shortcut.modifiers)
        })
    };
    !matches!(key, Key::C | Key::V | Key::X) && actions(state).iter().any(is_taken)
}

/// Issues the actions whose shortcuts were pressed in this frame, in order: a slow frame may hold several, and what a
/// key does depends on those before it. While text is typed, only function keys and keys with Ctrl count, and under a
/// sheet only keys with Ctrl. Returns whether there were any.
pub fn press_keys(ctx: &egui::Context, state: &mut State) -> bool {
    let is_typing = ctx.text_edit_focused();
    let has_focus = ctx.memory(|memory| memory.focused().is_some());
    let on_canvas = crate::panes::has_focus(ctx);
    let has_popup = Popup::is_any_open(ctx);

    // Events from `typed_ahead.from` on belong to the list of actions. Each press carries the modifiers of its moment,
    // since a slow frame may hold presses and releases of several.
    let typed_ahead = ahead(ctx, state);
    let presses: Vec<(Key, Modifiers)> = ctx.input(|input| {
        let end = typed_ahead
            .as_ref()
            .map_or(input.events.len(), |typed| typed.from);
        input.events[..end].iter().filter_map(press).collect()
    });

    let mut any = false;
    for (key, held) in presses {
        // A field takes the text that is typed.
        let is_text = is_typing && !held.command && !is_function(key);
        // Escape closes an open menu or list.
        let closes_popup = key == Key::Escape && has_popup;
        // Space and Enter press a button that has the focus. Enter with a modifier is a shortcut: Ctrl+Enter runs.
        let presses_button =
            has_focus && !on_canvas && (key == Key::Space || (key == Key::Enter && held.is_none()));
        // Left and right step through time elsewhere. On a canvas that has the focus they move the picture, as up and
        // down do.
        let moves_picture =
            on_canvas && matches!(key, Key::ArrowLeft | Key::ArrowRight) && held.is_none();
        if is_text || closes_popup || presses_button || moves_picture {
            continue;
        }
        // An open sheet covers the window, takes text and is closed by Escape.
        if has_sheet(state) && !held.command {
            continue;
        }
        let Some((command, modifiers)) = meant_by(key, held, state) else {
            continue;
        };
        ctx.input_mut(|input| input.consume_key(modifiers, key));
        state.apply(command);
        any = true;
    }

    for command in typed_ahead.map_or_else(Vec::new, |typed| typed.commands(state)) {
        state.apply(command);
        any = true;
    }
    any
}

/// Returns what a press does in the current state, and the modifiers of its shortcut.
fn meant_by(key: Key, held: Modifiers, state: &State) -> Option<(Command, Modifiers)> {
    let is_listed = state.window().finder.is_some();
    actions(state).into_iter().find_map(|action| {
        let shortcut = action.keys().find(|shortcut| {
            shortcut.logical_key == key && held.matches_exact(shortcut.modifiers)
        })?;
        // While the list of actions is open, text is typed into it: only the key that closes the list counts.
        let counts = !is_listed || action.command == Command::Window(WindowCommand::ToggleFinder);
        let is_here = state.window().embedding.is_none() || action.command.rules().in_frame;
        let can = action.refusal.is_none() && counts && is_here;
        can.then_some((action.command, shortcut.modifiers))
    })
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

/// Text typed for the list of actions before its field has the focus: a slow frame may hold both the shortcut that opens
/// the list and the text typed after it.
struct Ahead {
    /// The index of the first event that belongs to the list.
    from: usize,
    text: String,
    is_entered: bool,
    is_closed: bool,
}

/// Takes from the frame's input the text that is meant for the list of actions, and returns it; `None` if there is none.
fn ahead(ctx: &egui::Context, state: &State) -> Option<Ahead> {
    // A sheet takes the text itself, and an embedded window has no list of actions.
    if has_sheet(state) || state.window().embedding.is_some() {
        return None;
    }
    let is_typing = ctx.text_edit_focused();
    let open = state.window().finder.as_ref();
    ctx.input_mut(|input| {
        // The index of the first event that is for the list of actions.
        let from = match open {
            // The field has the focus by now, and takes the text itself.
            Some(_) if is_typing => return None,
            Some(_) => 0,
            None => {
                let opens = |event: &Event| {
                    press(event)
                        .is_some_and(|(key, held)| key == Key::K && held.matches_exact(COMMAND))
                };
                // The text follows the key that opens the list.
                input.events.iter().position(opens)? + 1
            }
        };

        let mut typed = Ahead {
            from,
            text: open.map_or_else(String::new, |open| open.text.clone()),
            is_entered: false,
            is_closed: false,
        };

        for event in &input.events[from..] {
            match event {
                // Text after Enter or Escape is not added, and dropped below: it was typed for a list that these keys
                // have dealt with.
                _ if typed.is_entered || typed.is_closed => {}
                Event::Text(text) => typed.text.push_str(text),
                event if press(event) == Some((Key::Enter, NONE)) => typed.is_entered = true,
                event if press(event) == Some((Key::Escape, NONE)) => typed.is_closed = true,
                _ => {}
            }
        }

        // The list was open, and this frame has typed nothing into it. Its field, which asks for the focus when it is
        // shown, will take the other keys.
        if !typed.is_closed && open.is_some_and(|open| open.text == typed.text) {
            return None;
        }

        // The events are consumed, so that no other widget reacts to them. Those before `from` are not for the list, and stay.
        let mut count = 0;
        let end_keys = [
            typed.is_entered.then_some((Key::Enter, NONE)),
            typed.is_closed.then_some((Key::Escape, NONE)),
        ];
        input.events.retain(|event| {
            count += 1;
            let is_end = (end_keys.iter().flatten()).any(|key| press(event) == Some(*key));
            count <= from || !(is_end || matches!(event, Event::Text(_)))
        });
        Some(typed)
    })
}

impl Ahead {
    /// Returns the commands of the keys that were pressed before the field of the list had the focus: to close the
    /// list, to carry out the first action that the text finds, or to give the list the text. There is none if the
    /// list stays open and has no text.
    fn commands(self, state: &State) -> Vec<Command> {
        if self.is_closed {
            return vec![Command::Window(WindowCommand::CloseFinder)];
        }
        // Without text the list is as it was, and Enter has no action to carry out.
        if self.text.trim().is_empty() {
            return Vec::new();
        }
        let finder = Finder {
            text: self.text,
            choice: 0,
        };
        let first = found(&finder, state).into_iter().next();
        // Enter carries out no unavailable action, and the list stays open with the text.
        match first.filter(|action| self.is_entered && action.refusal.is_none()) {
            Some(action) => vec![Command::Window(WindowCommand::CloseFinder), action.command],
            None => vec![Command::Window(WindowCommand::FinderText(finder.text))],
        }
    }
}
