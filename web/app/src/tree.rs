//! The tree of the window's controls for the page, which mirrors it as elements: `page/tree.js`. egui describes the whole
//! window after each frame. The page gets what has changed since, and what is done to its elements comes back as requests.

use std::collections::HashMap;

use egui::accesskit::{
    Action, ActionData, ActionRequest, HasPopup, Live, Node, NodeId, Role, Toggled, TreeId,
    TreeUpdate,
};
use egui::{Context, Event, FullOutput, Key, Modifiers, Plugin, RawInput};
use js_sys::Date;
use serde::Serialize;

use crate::hooks;

/// Changes are sent at most once in so many seconds, except those of the focus and those that answer a request. While a
/// run plays its numbers change in each frame, and no screen reader could follow.
const SENDS_SECS: f64 = 0.25;

/// Values are rounded to so many parts of one, since those of egui's numbers in `f32` have digits without meaning.
const PARTS: f64 = 1e6;

/// An element that the page shows for a node.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
struct Element {
    /// What it is, by the names that `tree.js` has for it.
    role: &'static str,
    #[serde(skip_serializing_if = "String::is_empty")]
    name: String,
    /// The elements whose texts are its name, in the place of `name`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    labels: Vec<u32>,
    #[serde(skip_serializing_if = "String::is_empty")]
    description: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    value: Option<String>,
    #[serde(skip_serializing_if = "String::is_empty")]
    hint: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    number: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    least: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    most: Option<f64>,
    /// "true", "false" or "mixed", as in ARIA; empty for what cannot be on.
    #[serde(skip_serializing_if = "str::is_empty")]
    on: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    expanded: Option<bool>,
    /// What it opens, as in ARIA.
    #[serde(skip_serializing_if = "str::is_empty")]
    opens: &'static str,
    #[serde(skip_serializing_if = "is_false")]
    disabled: bool,
    #[serde(skip_serializing_if = "is_false")]
    fixed: bool,
    #[serde(skip_serializing_if = "is_false")]
    focusable: bool,
    /// Whether it can be told to take the next value; otherwise arrows are the program's, as they are on the canvas.
    #[serde(skip_serializing_if = "is_false")]
    steps: bool,
    #[serde(skip_serializing_if = "is_false")]
    live: bool,
    /// Left, top, width and height in pixels of the page, from the parent's corner.
    #[serde(skip_serializing_if = "Option::is_none")]
    place: Option<[i32; 4]>,
    /// The row that is chosen while the focus stays here.
    #[serde(skip_serializing_if = "Option::is_none")]
    active: Option<u32>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    children: Vec<u32>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
const fn is_false(value: &bool) -> bool {
    !*value
}

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
    nodes: HashMap<u32, NodeId>,
    last_number: u32,
    elements: HashMap<u32, Element>,
    top: Vec<u32>,
    focus: u32,
    sent_secs: f64,
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
        // The browser's focus is not on the canvas then, and eframe would count the window as left.
        input.focused |= self.holds_focus;
        self.answers |= !self.asked.is_empty();

        // egui takes either a request for the focus or the keys of a frame, so that keys after one wait for the next frame.
        let is_focus = |event: &Event| matches!(event, Event::AccessKitActionRequest(request) if request.action == Action::Focus);
        let mut has_focus = false;
        let is_late = |event: &Event| {
            has_focus |= is_focus(event);
            has_focus && matches!(event, Event::Key { .. })
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
        // Nobody else reads it: eframe ignores it, and the speaker comes first.
        let Some(update) = output.platform_output.accesskit_update.take() else {
            return;
        };

        let has_moved = self.numbers.get(&update.focus).copied().unwrap_or_default() != self.focus;
        let now_secs = Date::now() / 1e3;
        let due_secs = self.sent_secs + SENDS_SECS - now_secs;
        if due_secs > 0.0 && !has_moved && !self.answers {
            ctx.request_repaint_after(std::time::Duration::from_secs_f64(due_secs));
            return;
        }

        self.answers = false;
        if self.send(&update, f64::from(ctx.zoom_factor())) {
            self.sent_secs = now_secs;
        }
    }
}

impl Tree {
    /// Carries out what was done to an element of the page, in the next frame.
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
                Ok(number) => (Action::SetValue, Some(ActionData::NumericValue(number))),
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

        // egui closes a list when the pointer has chosen from it, and otherwise only by this key.
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
        // Letters come as small ones, and egui knows them as capitals.
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

    /// Sends what has changed to the page; returns whether there was anything.
    fn send(&mut self, update: &TreeUpdate, zoom: f64) -> bool {
        let is_first = self.sent_secs == 0.0;
        let nodes: HashMap<NodeId, &Node> = (update.nodes.iter())
            .map(|(id, node)| (*id, node))
            .collect();
        self.keep_numbers(update, &nodes);

        let mut walk = Walk {
            tree: self,
            nodes: &nodes,
            zoom,
            elements: HashMap::new(),
        };
        let mut top = Vec::new();
        if let Some(root) = update.tree.as_ref().and_then(|tree| nodes.get(&tree.root)) {
            walk.add(root.children(), Place::default(), &mut top);
        }
        let elements = walk.elements;

        // A request for the focus may name a node that has no element.
        let focus = self.numbers.get(&update.focus).copied();
        let focus = focus.filter(|number| elements.contains_key(number));
        let focus = focus.unwrap_or_default();

        let changed = (elements.iter())
            .filter(|(number, element)| self.elements.get(number) != Some(element))
            .map(|(number, element)| (*number, element));
        let mut changed: Vec<(u32, &Element)> = changed.collect();
        // The order is the same in every run, so that it can be tested.
        changed.sort_unstable_by_key(|(number, _)| *number);
        let gone = self
            .elements
            .keys()
            .filter(|number| !elements.contains_key(number));
        let gone: Vec<u32> = gone.copied().collect();

        let is_changed =
            !changed.is_empty() || !gone.is_empty() || top != self.top || focus != self.focus;
        if is_changed || is_first {
            let changes = Changes {
                all: is_first,
                language: &self.language,
                top: (top != self.top).then_some(&top),
                elements: changed,
                gone,
                focus,
            };
            hooks::tree(&serde_json::to_string(&changes).unwrap_or_default());
        }

        self.elements = elements;
        self.top = top;
        self.focus = focus;
        is_changed || is_first
    }

    /// Gives numbers to new nodes, and forgets those of nodes that are gone.
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

/// Where the children of a node are shown.
#[derive(Clone, Copy, Default)]
struct Place {
    /// The corner from which their places count, in points of the window.
    x: f64,
    y: f64,
    /// The list or menu that they stand in, if they do.
    list: &'static str,
}

/// A walk through the tree of a frame.
struct Walk<'a> {
    tree: &'a Tree,
    nodes: &'a HashMap<NodeId, &'a Node>,
    /// How many pixels of the page a point of the window has.
    zoom: f64,
    elements: HashMap<u32, Element>,
}

impl Walk<'_> {
    /// Adds the elements of nodes to those of their parent.
    fn add(&mut self, ids: &[NodeId], place: Place, siblings: &mut Vec<u32>) {
        for id in ids {
            let (Some(node), Some(number)) = (self.nodes.get(id), self.tree.numbers.get(id)) else {
                continue;
            };
            let role = role(node, place.list);
            // Text runs are the letters of their parent's text, with places of their own.
            if node.role() == Role::TextRun {
                continue;
            }
            // Without a role of its own a node only groups others.
            if role.is_empty() {
                self.add(node.children(), place, siblings);
                continue;
            }

            siblings.push(*number);
            let mut element = self.element(node, role, place);
            if holds_others(role) {
                let within = within(node, role, place);
                self.add(node.children(), within, &mut element.children);
                if element.place.is_none() {
                    element.place = self.surround(&element.children);
                }
                // A sheet without a title is named by what it begins with.
                if role == "dialog" && element.name.is_empty() && element.labels.is_empty() {
                    element.labels.extend(element.children.first());
                }
            } else {
                // A list that a button has opened stands in egui's tree below the button, and on the page beside it.
                let before = siblings.len();
                let beside = Place { list: "", ..place };
                self.add(node.children(), beside, siblings);
                let is_open = (siblings[before..].iter())
                    .filter_map(|child| self.elements.get(child))
                    .any(|child| matches!(child.role, "menu" | "listbox" | "dialog"));
                // What is known to open something says whether it is open, and so does what has something open.
                if is_open || (!element.opens.is_empty() && element.expanded.is_none()) {
                    element.expanded = Some(is_open);
                }
            }
            self.elements.insert(*number, element);
        }
    }

    /// Returns the place around those of children, which then count from its corner. egui has no place for menus and lists.
    fn surround(&mut self, children: &[u32]) -> Option<[i32; 4]> {
        let places = children
            .iter()
            .filter_map(|child| self.elements.get(child)?.place);
        let ends = places.map(|[x, y, width, height]| [x, y, x + width, y + height]);
        let [left, top, right, bottom] = ends.reduce(|a, b| {
            [
                a[0].min(b[0]),
                a[1].min(b[1]),
                a[2].max(b[2]),
                a[3].max(b[3]),
            ]
        })?;

        for child in children {
            let element = self.elements.get_mut(child);
            if let Some(place) = element.and_then(|element| element.place.as_mut()) {
                place[0] -= left;
                place[1] -= top;
            }
        }
        Some([left, top, right - left, bottom - top])
    }

    /// Returns the element of a node, without its children.
    fn element(&self, node: &Node, role: &'static str, place: Place) -> Element {
        let number_of = |id: &NodeId| self.tree.numbers.get(id).copied();
        let labels: Vec<u32> = match node.label() {
            Some(_) => Vec::new(),
            None => node.labelled_by().iter().filter_map(number_of).collect(),
        };
        let rounded = |value: f64| (value * PARTS).round() / PARTS;
        let pixels = |length: f64| (length * self.zoom).round() as i32;

        Element {
            role,
            name: node.label().unwrap_or_default().to_owned(),
            labels,
            // Tooltips of buttons without a text repeat the name.
            description: (node.description().filter(|text| node.label() != Some(text)))
                .unwrap_or_default()
                .to_owned(),
            value: node.value().map(str::to_owned),
            hint: node.placeholder().unwrap_or_default().to_owned(),
            number: node.numeric_value().map(rounded),
            least: node.min_numeric_value().map(rounded),
            most: node.max_numeric_value().map(rounded),
            on: match node.toggled() {
                None => "",
                Some(Toggled::True) => "true",
                Some(Toggled::False) => "false",
                Some(Toggled::Mixed) => "mixed",
            },
            expanded: node.is_expanded(),
            opens: match (role, node.has_popup()) {
                ("combobox", _) | (_, Some(HasPopup::Listbox)) => "listbox",
                (_, Some(HasPopup::Dialog)) => "dialog",
                (_, Some(_)) => "menu",
                (_, None) => "",
            },
            disabled: node.is_disabled(),
            fixed: node.is_read_only(),
            focusable: node.supports_action(Action::Focus),
            steps: node.supports_action(Action::Increment)
                || node.supports_action(Action::Decrement),
            live: node.live().is_some_and(|live| live != Live::Off),
            place: node.bounds().map(|bounds| {
                [
                    pixels(bounds.x0 - place.x),
                    pixels(bounds.y0 - place.y),
                    pixels(bounds.width()).max(1),
                    pixels(bounds.height()).max(1),
                ]
            }),
            active: node.active_descendant().as_ref().and_then(number_of),
            children: Vec::new(),
        }
    }
}

/// Returns where the children of a node are shown.
fn within(node: &Node, role: &'static str, place: Place) -> Place {
    let corner = node.bounds().map(|bounds| (bounds.x0, bounds.y0));
    let (x, y) = corner.unwrap_or((place.x, place.y));
    let list = match role {
        "menu" | "listbox" => role,
        _ => "",
    };
    Place { x, y, list }
}

/// Returns whether other elements stand within those of a role.
fn holds_others(role: &str) -> bool {
    matches!(role, "menu" | "listbox" | "dialog" | "group" | "tooltip")
}

/// Returns the role of a node within a list or menu, by the names that `tree.js` has for roles; empty for what groups
/// others without a name, and for what nothing can be said of.
fn role(node: &Node, list: &str) -> &'static str {
    let is_named = node.label().is_some() || !node.labelled_by().is_empty();
    match node.role() {
        Role::Button
        | Role::DefaultButton
        | Role::DisclosureTriangle
        | Role::Row
        | Role::ListBoxOption
        | Role::MenuItem
        | Role::Tab => match (list, node.toggled()) {
            ("menu", None) => "menuitem",
            ("menu", Some(_)) => "menuitemcheckbox",
            ("listbox", _) => "option",
            // Rows are pressed, and they have no table around them.
            _ => "button",
        },
        Role::CheckBox if list == "menu" => "menuitemcheckbox",
        Role::CheckBox | Role::Switch => "checkbox",
        Role::RadioButton => "radio",
        Role::Link => "link",
        Role::Slider => "range",
        Role::SpinButton if node.numeric_value().is_some() => "number",
        // Some fields for numbers also take other texts.
        Role::SpinButton | Role::TextInput | Role::PasswordInput | Role::SearchInput => "text",
        Role::MultilineTextInput => "area",
        Role::ComboBox => "combobox",
        Role::ListBox => "listbox",
        Role::Menu => "menu",
        Role::Dialog | Role::AlertDialog | Role::Window => "dialog",
        Role::Tooltip => "tooltip",
        Role::Heading => "heading",
        Role::Image | Role::Canvas => "img",
        Role::ProgressIndicator => "progressbar",
        Role::Label if node.value().is_some_and(|text| !text.trim().is_empty()) => "label",
        // What can be pressed and has a name is a button, whatever egui's widget is.
        Role::Unknown if is_named && node.supports_action(Action::Click) => "button",
        Role::Pane | Role::GenericContainer if is_named => "group",
        _ => "",
    }
}
