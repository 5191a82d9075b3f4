//! The list of the objects in view: a list box without a picture of its own, for screen readers and for the keyboard. Up and
//! down choose an object, and it is selected as by the pointer; Enter opens the inspector.

use egui::accesskit::{Action, Role};
use egui::{Key, Modifiers, Rect, Response, Sense, Ui, UiBuilder, vec2};
use tilescope_canvas::objects::{Object, Objects, show_chosen};
use tilescope_drawing::palette::Palette;
use tilescope_drawing::subject::Subject;
use tilescope_ui::language::Worded;
use tilescope_ui::widgets::Known;
use tilescope_workbench::command::{Command, ViewCommand, Which};

use super::input;

/// The list of one picture.
pub struct ObjectList<'a> {
    /// The picture.
    pub which: Which,
    /// Its name, in the language of the window.
    pub name: &'a str,
    /// Where it lies in the window.
    pub rect: Rect,
    /// What it shows.
    pub subject: &'a Subject<'a>,
    /// The colours of the look.
    pub palette: &'static Palette,
    /// Whether nothing is listed, for the time being.
    pub is_empty: bool,
}

impl ObjectList<'_> {
    /// Shows the list, and selects the object that was chosen.
    pub fn show(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let id = ui.scope_id().with(("objects", self.name));
        let response = ui.interact(self.rect, id, Sense::focusable_noninteractive());
        let name = format!("{}: {}", self.name, ui.words("Objects in view"));
        let has_node = ui.ctx().accesskit_node_builder(id, |node| {
            node.set_role(Role::ListBox);
            node.set_label(name);
        });
        response.known_as(format_args!("objects-{}", which_key(self.which)));

        // Without a screen reader and without the focus the list has no reader.
        if self.is_empty || (has_node.is_none() && !response.has_focus()) {
            return;
        }
        let objects = Objects::of(self.subject, self.rect);
        let selected = objects.selected(self.subject);
        self.add_options(ui, &response, &objects, selected, commands);
        if response.has_focus() {
            self.keys(ui, &response, &objects, selected, commands);
        }
    }

    /// Adds the options to the tree, and carries out the actions on them.
    fn add_options(
        &self,
        ui: &mut Ui,
        list: &Response,
        objects: &Objects,
        selected: Option<usize>,
        commands: &mut Vec<Command>,
    ) {
        // The options have places, so that magnifiers follow them, but they take no part in the layout.
        let within = UiBuilder::new()
            .max_rect(self.rect)
            .accessibility_parent(list.id)
            .id_salt(("options", self.name));
        let ui = &mut ui.new_child(within);

        for (index, object) in objects.listed.iter().enumerate() {
            let id = list.id.with(object.key);
            let option = ui.interact(self.place_of(object), id, Sense::hover());
            let text = ui.words(&object.text);
            let is_selected = selected == Some(index);
            ui.ctx().accesskit_node_builder(id, |node| {
                node.set_role(Role::ListBoxOption);
                node.set_label(text.as_str());
                // A web page reads the first of these from its mirror of the tree, screen readers of a system the
                // second.
                node.set_toggled(is_selected.into());
                node.set_selected(is_selected);
                node.add_action(Action::Click);
            });

            if is_selected {
                // The list keeps the focus while screen readers follow the choice.
                ui.ctx().accesskit_node_builder(list.id, |node| {
                    node.set_active_descendant(id.accesskit_id());
                });
                if list.has_focus() {
                    show_chosen(ui, self.rect, self.subject, object, &text, self.palette);
                }
            }
            if ui.input(|input| input.has_accesskit_action_request(option.id, Action::Click)) {
                list.request_focus();
                self.pick(object, commands);
                commands.push(Command::View(self.which, ViewCommand::Inspect));
            }
        }

        // Only the nearest objects of each kind are listed. Further lines say how many others are in view.
        for (index, more) in objects.more.iter().enumerate() {
            let id = list.id.with(("more", index));
            // Such a line is about all of the canvas, and stands for no place of its own: it has a point in the corner.
            let corner = Rect::from_min_size(self.rect.min, vec2(1.0, 1.0));
            ui.interact(corner, id, Sense::hover());
            let text = ui.words(more);
            ui.ctx().accesskit_node_builder(id, |node| {
                node.set_role(Role::ListBoxOption);
                node.set_label(text);
                // It is read, and there is nothing to select.
                node.set_disabled();
            });
        }
    }

    /// Chooses by up and down, and opens the inspector by Enter.
    fn keys(
        &self,
        ui: &Ui,
        list: &Response,
        objects: &Objects,
        selected: Option<usize>,
        commands: &mut Vec<Command>,
    ) {
        input::keep_arrows(ui, list);

        let count = objects.listed.len();
        let press = |key| ui.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key));
        // Several presses may fall into one slow frame.
        let (down, up) = (press(Key::ArrowDown), press(Key::ArrowUp));
        let target = match selected {
            Some(at) => (at + down).saturating_sub(up),
            // Without a selection, the first press down leads to object 0, and the first press up to the last object.
            // So presses are counted from `count`, of which the remainder is 0, and the first press down is not
            // counted.
            None => (down + count).saturating_sub(up + usize::from(down > 0)) % count.max(1),
        };

        // Beyond the last object there is none, and the last one stays.
        if down + up > 0
            && let Some(object) = objects.listed.get(target.min(count.max(1) - 1))
        {
            self.pick(object, commands);
        }
        if press(Key::Enter) > 0 && selected.is_some() {
            commands.push(Command::View(self.which, ViewCommand::Inspect));
        }
    }

    fn pick(&self, object: &Object, commands: &mut Vec<Command>) {
        let pick = ViewCommand::Pick(object.selection);
        commands.push(Command::View(self.which, pick));
    }

    /// Returns where an object lies in the window.
    fn place_of(&self, object: &Object) -> Rect {
        let camera = &self.subject.camera;
        let middle = camera.screen_from_domain(self.rect, object.place);
        let side = (2.0 * object.reach * camera.scale) as f32;
        // A screen reader marks what it reads: a mark smaller than a finger would not be found.
        Rect::from_center_size(middle, vec2(side, side).max(MIN_MARK)).intersect(self.rect)
    }
}

/// The least size of the place of an object, in screen points.
const MIN_MARK: egui::Vec2 = vec2(16.0, 16.0);

const fn which_key(which: Which) -> &'static str {
    match which {
        Which::First => "a",
        Which::Second => "b",
    }
}
