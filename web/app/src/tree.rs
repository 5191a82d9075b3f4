//! The tree of the window's controls for the page, which mirrors it as elements: `page/tree.js`. egui describes the whole
//! window after each frame. The page gets the changes, and sends requests when a person uses one of its elements.

use std::collections::HashMap;

use egui::accesskit::{Action, ActionData, ActionRequest, Node, NodeId, TreeId, TreeUpdate};
use egui::{Context, Event, FullOutput, Key, Modifiers, Plugin, RawInput};
use js_sys::Date;
use serde::Serialize;

use crate::elements::{Element, Elements};
use crate::hooks;

/// Changes are looked for at most once in so many seconds, unless the focus has moved or the frame answers a request. While
/// a run plays its numbers change in each frame, and no screen reader could follow.
const LOOKS_SECS: f64 = 0.25;

/// Changes of the tree, for the page.
#[derive(Serialize)]
struct Changes<'a> {
    /// Whether the page must forget the elements that it has.
    all: bool,
    /// The language of the texts.
    language: &'a str,
    /// The elements at the top, in reading order; `None` if they have not changed.
    #[serde(skip_serializing_if = "Option::is_none")]
    top: Option<&'a [u32]>,
    /// New and changed elements by number.
    elements: Vec<(u32, &'a Element)>,
    /// The elements that are no longer there.
    gone: Vec<u32>,
    /// The element with egui's focus; 0 if there is none.
    focus: u32,
}

/// The elements that the page has, and what it asks for.
#[derive(Default)]
pub struct Tree {
    /// The language of the window's texts.
    pub language: String,
    /// Whether the page's focus is on one of the elements, so that keys come from there.
    holds_focus: bool,
    /// The numbers under which the page has nodes. Those of egui do not fit into JavaScript's numbers.
    numbers: HashMap<NodeId, u32>,
    /// The nodes by these numbers.
    nodes: HashMap<u32, NodeId>,
    /// The greatest number that was given; none is given twice.
    last_number: u32,
    /// The elements as the page has them.
    elements: HashMap<u32, Element>,
    /// Those at the top, in reading order.
    top: Vec<u32>,
    /// The element that the page was told has the focus; 0 for none.
    focus: u32,
    /// The node of egui's focus at the last look; the whole window if nothing has it.
    focused: Option<NodeId>,
    /// When that look was, in seconds of the browser's clock.
    looked_secs: f64,
    /// Requests and keys of the page for the next frame.
    asked: Vec<Event>,
    /// Whether the frame has taken requests, so that what it changes is sent at once.
    answers: bool,
}

impl Plugin for Tree {
    fn debug_name(&self) -> &'static str {
        "tree"
    }

    fn setup(&mut self, ctx: &Context) {
        ctx.enable_accesskit();
    }

    fn input_hook(&mut self, ctx: &Context, input: &mut RawInput) {
        // While an element of the page has the browser's focus, the canvas has not, and eframe would count the window
        // as left.
        input.focused |= self.holds_focus;
        self.answers |= !self.asked.is_empty();

        // In one frame egui takes either a request for the focus or keys. So keys that follow such a request wait for
        // the next frame.
        let is_focus = |event: &Event| match event {
            Event::AccessKitActionRequest(request) => request.action == Action::Focus,
            _ => false,
        };
        let mut follows_focus = false;
        let is_late = |event: &Event| {
            follows_focus |= is_focus(event);
            follows_focus && matches!(event, Event::Key { .. })
        };
        let first_late = self.asked.iter().position(is_late);
        let late = first_late.map(|at| self.asked.split_off(at));
        input.events.append(&mut self.asked);
        if let Some(late) = late {
            self.asked = late;
            ctx.request_repaint();
        }
    }

    fn output_hook(&mut self, ctx: &Context, output: &mut FullOutput) {
        // The update may be taken: eframe's page ignores it, and the speaker's hook runs before this one.
        let Some(update) = output.platform_output.accesskit_update.take() else {
            return;
        };

        let has_moved = self.focused != Some(update.focus);
        let now_secs = Date::now() / 1e3;
        let due_secs = self.looked_secs + LOOKS_SECS - now_secs;
        if due_secs > 0.0 && !has_moved && !self.answers {
            ctx.request_repaint_after(std::time::Duration::from_secs_f64(due_secs));
            return;
        }

        self.answers = false;
        self.focused = Some(update.focus);
        self.looked_secs = now_secs;
        self.send(&update, f64::from(ctx.zoom_factor()));
    }
}

impl Tree {
    /// Passes a request of an element of the page to the program, which carries it out in the next frame.
    pub fn ask(&mut self, number: u32, action: &str, text: Option<String>) {
        let Some(&target_node) = self.nodes.get(&number) else {
            return;
        };
        let (action, data) = match (action, text) {
            ("focus", _) => (Action::Focus, None),
            ("click", _) => (Action::Click, None),
            ("increment", _) => (Action::Increment, None),
            ("decrement", _) => (Action::Decrement, None),
            ("show", _) => (Action::ScrollIntoView, None),
            ("number", Some(text)) => match text.parse() {
                Ok(typed) => (Action::SetValue, Some(ActionData::NumericValue(typed))),
                // A number that is being typed need not be one yet.
                Err(_) => return,
            },
            ("text", Some(text)) => (Action::SetValue, Some(ActionData::Value(text.into()))),
            _ => return,
        };
        self.asked
            .push(Event::AccessKitActionRequest(ActionRequest {
                action,
                target_tree: TreeId::ROOT,
                target_node,
                data,
            }));

        // egui closes a list by itself only when the pointer has chosen from it. After a choice by a request, Escape
        // closes the list.
        let element = self.elements.get(&number);
        let is_chosen = action == Action::Click && element.is_some_and(|it| it.role == "option");
        let is_open = |it: &Element| it.role == "combobox" && it.expanded == Some(true);
        if is_chosen && self.elements.values().any(is_open) {
            self.press("Escape", "Escape", Modifiers::NONE);
        }
    }

    /// Presses a key, by the browser's names, in the next frame.
    pub fn press(&mut self, name: &str, code: &str, modifiers: Modifiers) {
        let physical_key = Key::from_name(code);
        // Letters come as small ones, and egui has them as capitals.
        let key = Key::from_name(name).or_else(|| Key::from_name(&name.to_uppercase()));
        let Some(key) = key.or(physical_key) else {
            return;
        };
        let event = |pressed| Event::Key {
            key,
            physical_key,
            pressed,
            repeat: false,
            modifiers,
        };
        self.asked.extend([event(true), event(false)]);
    }

    /// Takes whether the page's focus is on one of the elements.
    pub fn hold_focus(&mut self, holds: bool) {
        self.holds_focus = holds;
    }

    /// Sends the changes since the last call to the page, if there are any.
    fn send(&mut self, update: &TreeUpdate, zoom: f64) {
        // At the first call the page may still have elements of a program that was replaced after its display was lost.
        // So the page is told to drop all elements. After a call without elements it is told so again, and has none to
        // drop.
        let is_first = self.elements.is_empty();
        let nodes: HashMap<NodeId, &Node> = (update.nodes.iter())
            .map(|(id, node)| (*id, node))
            .collect();
        self.keep_numbers(update, &nodes);

        let root = update.tree.as_ref().map(|tree| tree.root);
        let elements = root.map_or_else(Elements::default, |root| {
            Elements::of(&nodes, root, &self.numbers, zoom)
        });
        let Elements { all, top } = elements;

        // A request for the focus may name a node that has no element.
        let numbered = self.numbers.get(&update.focus).copied();
        let focus = numbered
            .filter(|number| all.contains_key(number))
            .unwrap_or_default();

        let changed = (all.iter())
            .filter(|(number, element)| self.elements.get(number) != Some(element))
            .map(|(number, element)| (*number, element));
        let mut changed: Vec<(u32, &Element)> = changed.collect();
        // The order is the same in every run, so that it can be tested.
        changed.sort_unstable_by_key(|(number, _)| *number);
        let gone = self
            .elements
            .keys()
            .filter(|number| !all.contains_key(number));
        let gone: Vec<u32> = gone.copied().collect();

        let is_changed =
            !changed.is_empty() || !gone.is_empty() || top != self.top || focus != self.focus;
        if is_changed {
            let changes = Changes {
                all: is_first,
                language: &self.language,
                top: (top != self.top).then_some(&top),
                elements: changed,
                gone,
                focus,
            };
            // Numbers, texts and lists always have JSON.
            hooks::tree(&serde_json::to_string(&changes).unwrap_or_default());
        }

        self.elements = all;
        self.top = top;
        self.focus = focus;
    }

    /// Gives numbers to new nodes, and drops those of nodes that are gone.
    fn keep_numbers(&mut self, update: &TreeUpdate, nodes: &HashMap<NodeId, &Node>) {
        self.numbers.retain(|id, _| nodes.contains_key(id));
        self.nodes.retain(|_, id| nodes.contains_key(id));
        for (id, _) in &update.nodes {
            if !self.numbers.contains_key(id) {
                self.last_number += 1;
                self.numbers.insert(*id, self.last_number);
                self.nodes.insert(self.last_number, *id);
            }
        }
    }
}
