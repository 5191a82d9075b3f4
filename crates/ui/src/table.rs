//! Tables for screen readers. A panel draws its rows as it likes; here they become rows and cells of AccessKit's tree, which
//! are read one by one, along a row and down a column. Begin with [`table`].

use egui::{Id, Rangef, Rect, Response, Role, Sense, Ui, UiBuilder};

/// A cell of a row: its text, and where it lies in the row.
pub struct SpokenCell {
    /// The text, in the language of the window.
    pub text: String,
    /// From where to where it is drawn, in screen points.
    pub across: Rangef,
    /// What it is: `Role::Cell`, or the head of a column or of the row.
    pub role: Role,
}

impl SpokenCell {
    /// Returns a cell.
    pub fn new(role: Role, text: impl Into<String>, across: Rangef) -> Self {
        Self {
            text: text.into(),
            across,
            role,
        }
    }
}

/// Shows a table: `add` shows its rows, and perhaps an area that scrolls them. `size` is its numbers of rows and columns,
/// those that are not drawn included; `role` is `Role::Table`, or `Role::Grid` where rows can be chosen.
pub fn table<R>(
    ui: &mut Ui,
    name: &str,
    size: [usize; 2],
    role: Role,
    add: impl FnOnce(&mut Ui) -> R,
) -> R {
    let builder = UiBuilder::new()
        .id_salt(("table", name))
        .accessibility_role(role)
        .accessibility_label(name);
    let shown = ui.scope_builder(builder, |ui| {
        let id = ui.unique_id();
        ui.ctx().accesskit_node_builder(id, |node| {
            node.set_row_count(size[0]);
            node.set_column_count(size[1]);
        });
        add(ui)
    });
    shown.inner
}

/// Makes a widget of a table a row, the one of this index, from 0, and adds its cells. The name that the widget has already
/// stays: it is what the row says as a whole.
pub fn spoken_row(
    ui: &mut Ui,
    row: &Response,
    index: usize,
    cells: impl IntoIterator<Item = SpokenCell>,
) {
    let has_node = ui.ctx().accesskit_node_builder(row.id, |node| {
        node.set_role(Role::Row);
        node.set_row_index(index);
    });
    // A row has a node only while a screen reader is at work. Otherwise nothing would read its cells.
    if has_node.is_none() {
        return;
    }

    let within = UiBuilder::new()
        .max_rect(row.rect)
        .accessibility_parent(row.id)
        .id_salt(("cells", row.id));
    let ui = &mut ui.new_child(within);
    for (column, cell) in cells.into_iter().enumerate() {
        let id = Id::unique((row.id, "cell", column));
        let rect = Rect::from_x_y_ranges(cell.across, row.rect.y_range());
        // Only a widget has a node in the tree, with its place on the screen: this one does nothing else.
        ui.interact(rect, id, Sense::hover());
        ui.ctx().accesskit_node_builder(id, |node| {
            node.set_role(cell.role);
            node.set_label(cell.text);
            node.set_column_index(column);
        });
    }
}
