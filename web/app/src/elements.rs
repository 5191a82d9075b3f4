//! The elements that stand for a frame of egui's tree: which nodes have one, of which role, with which parts, and where.

use std::collections::HashMap;

use egui::accesskit::{Action, HasPopup, Live, Node, NodeId, Role, Toggled};
use serde::Serialize;

/// Values are rounded to so many parts of one, since those of egui's numbers in `f32` have digits without meaning.
const PARTS: f64 = 1e6;

/// An element that the page shows for a node.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Element {
    /// What it is, by the names that `tree.js` has for it.
    pub role: &'static str,
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
    /// "true", "false" or "mixed", as in ARIA; empty for elements that cannot be on.
    #[serde(skip_serializing_if = "str::is_empty")]
    on: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub expanded: Option<bool>,
    /// What it opens, as in ARIA.
    #[serde(skip_serializing_if = "str::is_empty")]
    opens: &'static str,
    #[serde(skip_serializing_if = "is_false")]
    disabled: bool,
    #[serde(skip_serializing_if = "is_false")]
    fixed: bool,
    #[serde(skip_serializing_if = "is_false")]
    focusable: bool,
    /// Whether it has actions for the next value and the one before; otherwise arrows are the program's, as they are on the canvas.
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
    /// The numbers of rows and columns of a table, those that are not drawn included.
    #[serde(skip_serializing_if = "Option::is_none")]
    size: Option<[usize; 2]>,
    /// The index of a row in its table, or that of a cell in its row, from 1 as in ARIA.
    #[serde(skip_serializing_if = "Option::is_none")]
    index: Option<usize>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
const fn is_false(value: &bool) -> bool {
    !*value
}

/// The elements of a frame.
#[derive(Default)]
pub struct Elements {
    /// All of them by number.
    pub all: HashMap<u32, Element>,
    /// Those at the top, in reading order.
    pub top: Vec<u32>,
}

impl Elements {
    /// Returns the elements for the nodes below `root`. Each node has a number; `zoom` is how many pixels of the page a
    /// point of the window has.
    pub fn of(
        nodes: &HashMap<NodeId, &Node>,
        root: NodeId,
        numbers: &HashMap<NodeId, u32>,
        zoom: f64,
    ) -> Self {
        let mut walk = Walk {
            numbers,
            nodes,
            zoom,
            elements: HashMap::new(),
        };
        let mut top = Vec::new();
        if let Some(root) = nodes.get(&root) {
            walk.add(root.children(), Place::default(), &mut top);
        }
        Self {
            all: walk.elements,
            top,
        }
    }
}

/// Where the children of a node are shown.
#[derive(Clone, Copy, Default)]
struct Place {
    /// The corner from which their places count, in points of the window.
    x: f64,
    y: f64,
    /// The list, menu or table that they stand in, if they do.
    list: &'static str,
}

/// A walk through the tree of a frame.
struct Walk<'a> {
    numbers: &'a HashMap<NodeId, u32>,
    nodes: &'a HashMap<NodeId, &'a Node>,
    /// How many pixels of the page a point of the window has.
    zoom: f64,
    elements: HashMap<u32, Element>,
}

impl Walk<'_> {
    /// Adds the elements of nodes to those of their parent.
    fn add(&mut self, ids: &[NodeId], place: Place, siblings: &mut Vec<u32>) {
        for id in ids {
            let (Some(node), Some(number)) = (self.nodes.get(id), self.numbers.get(id)) else {
                continue;
            };
            let role = role_of(node, place.list);
            // Text runs, the letters of their parent's text with places of their own, have no elements.
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
                let inner = within(node, role, place);
                self.add(node.children(), inner, &mut element.children);
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
                // If a list is open, the element counts as expanded. If no list is open, an element that can open one
                // counts as collapsed, unless egui says itself whether the element is expanded.
                if is_open || (!element.opens.is_empty() && element.expanded.is_none()) {
                    element.expanded = Some(is_open);
                }
            }
            self.elements.insert(*number, element);
        }
    }

    /// Returns the smallest place around the places of children, and makes these count from its corner. `None` if no
    /// child has a place. egui has no place for menus and lists, so that they get theirs here.
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
        let number_of = |id: &NodeId| self.numbers.get(id).copied();
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
            // At least one pixel along each side, chosen, not measured: so no element is without an extent.
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
            size: node.row_count().zip(node.column_count()).map(Into::into),
            // The program's tables give rows an index of the row alone, and cells one of the column alone.
            index: (node.row_index().or(node.column_index())).map(|index| index + 1),
        }
    }
}

/// Returns where the children of a node are shown.
fn within(node: &Node, role: &'static str, place: Place) -> Place {
    let corner = node.bounds().map(|bounds| (bounds.x0, bounds.y0));
    let (x, y) = corner.unwrap_or((place.x, place.y));
    let list = match role {
        "menu" | "listbox" | "table" | "grid" => role,
        // A row has the cells of its table.
        "row" => place.list,
        _ => "",
    };
    Place { x, y, list }
}

/// Returns whether other elements stand within those of a role.
fn holds_others(role: &str) -> bool {
    matches!(
        role,
        "menu" | "listbox" | "dialog" | "group" | "tooltip" | "table" | "grid" | "row"
    )
}

/// Returns the role of a node within a list or menu, by the names that `tree.js` has for roles. It is empty for groups
/// without a name, for labels without a text, and for nodes of all other kinds.
fn role_of(node: &Node, list: &str) -> &'static str {
    let is_named = node.label().is_some() || !node.labelled_by().is_empty();

    match node.role() {
        Role::Row if matches!(list, "table" | "grid") => "row",
        Role::Cell | Role::GridCell if list == "grid" => "gridcell",
        Role::Cell | Role::GridCell => "cell",
        Role::ColumnHeader => "columnheader",
        Role::RowHeader => "rowheader",
        Role::Table => "table",
        Role::Grid => "grid",
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
            // Outside menus and lists all of these are pressed, also rows outside a table.
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
