//! Announcements for screen readers where they do not follow the focus of the window's AccessKit tree, as while a page's focus
//! is on its canvas: name, role, state and value of the focused widget, whenever one of them changes. They are taken from
//! that same tree.

use egui::accesskit::{Node, NodeId, Role, Toggled, TreeUpdate};
use egui::{Context, FullOutput, Plugin};

/// An announcement, as texts for a screen reader.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Spoken {
    /// The text that changed; empty after a text field was left and nothing else changed.
    pub text: String,
    /// The name of the text field that has the keyboard; empty if there is none.
    pub field: String,
}

/// The function that receives the announcements.
type Callback = Box<dyn Fn(&Spoken) + Send + Sync>;

/// Derives announcements from the tree after each frame.
pub struct Speaker {
    callback: Callback,
    before: Option<SpokenFocus>,
    /// Whether playback runs. Values may change in every frame then, and only moves of the focus are announced.
    pub is_playing: bool,
}

impl Speaker {
    /// Creates one that passes announcements to `callback`.
    #[must_use]
    pub fn new(callback: impl Fn(&Spoken) + Send + Sync + 'static) -> Self {
        Self {
            callback: Box::new(callback),
            before: None,
            is_playing: false,
        }
    }

    /// Announces the changes since the tree of the frame before.
    fn follow(&mut self, tree: &TreeUpdate) {
        let now = SpokenFocus::of(tree);
        let spoken = now.as_ref().and_then(|now| now.since(self.before.as_ref()));

        // If the focus has not moved, only a part of its description, such as its value, has changed.
        let is_same_focus = match (&now, &self.before) {
            (Some(now), Some(before)) => now.focus == before.focus,
            _ => false,
        };
        let writes =
            |focus: &Option<SpokenFocus>| focus.as_ref().is_some_and(|focus| focus.is_field);
        let is_left = now.is_none() && writes(&self.before);
        self.before = now;

        // The announcement says to the page that no text field has the focus any more.
        if is_left {
            (self.callback)(&Spoken::default());
        }
        // During playback only moves of the focus are announced.
        if let Some(spoken) = spoken.filter(|_| !(is_same_focus && self.is_playing)) {
            (self.callback)(&spoken);
        }
    }
}

impl Plugin for Speaker {
    fn debug_name(&self) -> &'static str {
        "speaker"
    }

    fn setup(&mut self, ctx: &Context) {
        ctx.enable_accesskit();
    }

    fn output_hook(&mut self, _: &Context, output: &mut FullOutput) {
        if let Some(tree) = &output.platform_output.accesskit_update {
            self.follow(tree);
        }
    }
}

/// What a screen reader says of the focused widget.
#[derive(Clone, Debug, PartialEq, Eq)]
struct SpokenFocus {
    focus: NodeId,
    is_field: bool,
    name: String,
    role: &'static str,
    state: String,
    value: String,
    /// The selected row of the list that the focused field filters.
    chosen: String,
}

impl SpokenFocus {
    /// Returns the description of the focused node; `None` for the window itself, and for a node that the tree lacks.
    fn of(tree: &TreeUpdate) -> Option<Self> {
        let root = tree.tree.as_ref().map(|tree| tree.root);
        // The root has the focus when no widget has it.
        if root == Some(tree.focus) {
            return None;
        }
        let node = find(tree, tree.focus)?;
        let chosen = node.active_descendant().and_then(|id| find(tree, id));

        Some(Self {
            focus: tree.focus,
            is_field: matches!(node.role(), Role::TextInput | Role::MultilineTextInput),
            name: name(tree, node),
            role: role(node.role()),
            state: state(node),
            value: value(node),
            chosen: chosen.map_or_else(String::new, |node| name(tree, node)),
        })
    }

    /// Returns the parts that differ from the previous frame, if any do; all parts if the focus has moved.
    fn since(&self, before: Option<&Self>) -> Option<Spoken> {
        let parts = |spoken: &Self| {
            let texts: [&str; 5] = [
                &spoken.name,
                spoken.role,
                &spoken.state,
                &spoken.value,
                &spoken.chosen,
            ];
            texts.map(str::to_owned)
        };

        // After the focus has moved, all old parts count as empty, so that every part is new.
        let old = before
            .filter(|before| before.focus == self.focus)
            .map(parts)
            .unwrap_or_default();
        let new: Vec<String> = parts(self)
            .into_iter()
            .zip(old)
            // A part that has become empty is not announced, as there is nothing to say.
            .filter(|(now, old)| now != old && !now.is_empty())
            .map(|(now, _)| now)
            .collect();

        let field = if self.is_field {
            self.name.as_str()
        } else {
            ""
        };

        (!new.is_empty()).then(|| Spoken {
            text: new.join(", "),
            field: field.to_owned(),
        })
    }
}

fn find(tree: &TreeUpdate, id: NodeId) -> Option<&Node> {
    let found = tree.nodes.iter().find(|(one, _)| *one == id);
    found.map(|(_, node)| node)
}

/// Returns the node's own name, or else that of its label.
fn name(tree: &TreeUpdate, node: &Node) -> String {
    if let Some(label) = node.label() {
        return label.to_owned();
    }
    let labels = node.labelled_by().iter().filter_map(|id| find(tree, *id));
    let texts = labels.filter_map(|label| label.value().or(label.label()));
    texts.collect::<Vec<_>>().join(" ")
}

/// Returns the word for a role; nothing for one that needs no word.
const fn role(role: Role) -> &'static str {
    match role {
        Role::Button | Role::DefaultButton => "button",
        Role::CheckBox => "check box",
        Role::RadioButton => "radio button",
        Role::ComboBox => "drop-down list",
        Role::ListBox => "list",
        Role::TextInput | Role::MultilineTextInput => "text field",
        Role::SpinButton => "number field",
        Role::Slider => "slider",
        Role::Link => "link",
        Role::Canvas | Role::Image => "picture",
        Role::Row | Role::ListBoxOption => "row",
        _ => "",
    }
}

fn state(node: &Node) -> String {
    let toggled = match (node.role(), node.toggled()) {
        (Role::CheckBox, Some(Toggled::True)) => "checked",
        (Role::CheckBox, Some(Toggled::False)) => "not checked",
        (Role::CheckBox, Some(Toggled::Mixed)) => "partly checked",
        (_, Some(Toggled::True)) => "selected",
        _ => "",
    };
    match (toggled, node.is_disabled()) {
        (toggled, false) => toggled.to_owned(),
        ("", true) => "unavailable".to_owned(),
        (toggled, true) => format!("{toggled}, unavailable"),
    }
}

fn value(node: &Node) -> String {
    let is_field = matches!(node.role(), Role::TextInput | Role::MultilineTextInput);
    match (node.value(), node.numeric_value()) {
        (Some(""), _) if is_field => "empty".to_owned(),
        (Some(text), _) => text.to_owned(),
        (None, Some(number)) => format!("{}", (number * 1e6).round() / 1e6),
        (None, None) => String::new(),
    }
}
