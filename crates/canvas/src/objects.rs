//! The objects in view, as a list for those who do not see the picture or use no pointer: gaps, active cubes, samples and blocks,
//! those nearest to the middle of the view first, each described as the tag beside the pointer describes it.

use egui::{Rect, Ui};
use glam::DVec2;
use tilescope_core::{Stage, Standing};
use tilescope_drawing::MIN_DISK_SCALE;
use tilescope_drawing::made::Made;
use tilescope_drawing::palette::Palette;
use tilescope_drawing::subject::Subject;
use tilescope_session::octaves::counted_cells;
use tilescope_session::selection::Selection;
use tilescope_session::units::{position, radii};
use tilescope_session::words::counted;

use crate::hover;

/// The list has at most this number of objects of a kind. A list of hundreds is too long to be read aloud,
/// and zooming in brings the others.
pub const MAX_OF_KIND: usize = 12;
/// More samples in view are not looked through for the nearest ones: that would take longer than a millisecond in each frame.
const MAX_LOOKED_AT: usize = 20_000;

/// An object of the list.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// A key that stays while the object does: its kind, and its number or, of a gap, its rank.
    pub key: (&'static str, usize),
    /// What it is, in English.
    pub text: String,
    /// Where it lies, in r.
    pub place: DVec2,
    /// How far it reaches, in r, as far as the list marks it on the screen.
    pub reach: f64,
    /// What selects it.
    pub selection: Selection,
}

/// The objects in view.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Objects {
    /// Those that are listed: gaps, active cubes that a plane cuts, samples, blocks.
    pub listed: Vec<Object>,
    /// How many active cells of each octave there are, and how many others of each kind are in view, in English; a kind that is
    /// listed as a whole has no entry.
    pub more: Vec<String>,
}

impl Objects {
    /// Returns those of a moment in the view of a canvas at `rect`; none of the pattern, whose picture shows no objects of the
    /// run.
    #[must_use]
    pub fn of(subject: &Subject<'_>, rect: Rect) -> Self {
        let mut objects = Self::default();
        if subject.shown.stage == Stage::Pattern {
            return objects;
        }
        let view = View::of(subject, rect);
        view.add_gaps(&mut objects);
        view.add_cubes(&mut objects);
        objects.more.extend(view.octaves());
        view.add_samples(&mut objects);
        view.add_blocks(&mut objects);
        objects
    }

    /// Returns the index of the object that is selected.
    #[must_use]
    pub fn selected(&self, subject: &Subject<'_>) -> Option<usize> {
        let selection = match (subject.selected, subject.place) {
            (Some(id), _) => Selection::Sample(id),
            (None, Some(place)) => Selection::Place(place),
            (None, None) => return None,
        };
        (self.listed.iter()).position(|object| object.selection == selection)
    }

    /// Adds the nearest of `found`, and says how many others there are; `kind` has the words for one other and for several.
    fn add(&mut self, mut found: Vec<Near>, kind: [&str; 2], object: impl Fn(&Near) -> Object) {
        // By their numbers where they are equally near, so that the order does not change from frame to frame.
        let order = |a: &Near, b: &Near| a.away.total_cmp(&b.away).then(a.number.cmp(&b.number));
        let others = found.len().saturating_sub(MAX_OF_KIND);
        if others > 0 {
            // Only the nearest ones are sorted: thousands of samples may be in view.
            found.select_nth_unstable_by(MAX_OF_KIND, order);
            found.truncate(MAX_OF_KIND);
        }
        found.sort_unstable_by(order);
        self.listed.extend(found.iter().map(object));

        if others > 0 {
            let [one, several] = kind;
            self.more.push(counted(others, one, several));
        }
    }
}

/// An object in view, before it is described.
struct Near {
    number: usize,
    place: DVec2,
    /// The square of its distance from the middle of the view, in r.
    away: f64,
}

/// The visible part of the plane.
struct View<'a> {
    subject: &'a Subject<'a>,
    low: DVec2,
    high: DVec2,
}

impl<'a> View<'a> {
    fn of(subject: &'a Subject<'a>, rect: Rect) -> Self {
        // The y axis of the domain points upwards.
        let low = subject.camera.domain_from_screen(rect, rect.left_bottom());
        let high = subject.camera.domain_from_screen(rect, rect.right_top());
        Self { subject, low, high }
    }

    /// Returns an object at a place, if it is in view.
    fn near(&self, number: usize, place: DVec2) -> Option<Near> {
        let is_seen = place.cmpge(self.low) & place.cmple(self.high);
        let middle = self.subject.camera.center;
        is_seen.all().then(|| Near {
            number,
            place,
            away: place.distance_squared(middle),
        })
    }

    fn add_gaps(&self, objects: &mut Objects) {
        let (subject, shown) = (self.subject, &self.subject.shown);
        // They are searched for only where they can be told apart: the search is of the whole domain.
        if !hover::has_gaps(subject) || !is_fine(subject) {
            return;
        }
        let gaps = subject.geometry.gaps(shown);
        // On a page the functions of gaps are in the part of the program that is loaded later. Without a gap none of
        // them is called below, and that part need not be there.
        if gaps.is_empty() {
            return;
        }
        let size = shown.session.size_radii();

        let found = gaps.iter().enumerate().filter_map(|(number, gap)| {
            // A gap across the border of a periodic domain has places beyond it, where nothing can be selected.
            let place = gap.deepest.0.rem_euclid(size);
            self.near(number, place)
        });
        objects.add(
            found.collect(),
            ["more gap in view", "more gaps in view"],
            |near| {
                let gap = &gaps[near.number];
                // The place of the gap that lies farthest from all samples, and how far it does: the disk around it has
                // no sample.
                let (_, distance) = gap.deepest;
                Object {
                    key: ("gap", near.number),
                    text: located(&hover::gap_text(gap), near.place),
                    place: near.place,
                    reach: distance,
                    selection: Selection::Place(near.place),
                }
            },
        );
    }

    fn add_samples(&self, objects: &mut Objects) {
        let (subject, shown) = (self.subject, &self.subject.shown);
        let index = &shown.session.index;
        // Where symbols overlap no sample can be pointed at in the picture, and none is listed.
        if !is_fine(subject) || index.count_in(self.low, self.high) > MAX_LOOKED_AT {
            return;
        }

        let mut found = Vec::new();
        // Only samples whose middle is in view are listed.
        let around_view = 0.0;
        index.visit(self.low, self.high, around_view, |seen| {
            if shown.standing(seen.id) != Standing::Absent {
                found.extend(self.near(seen.id as usize, seen.position));
            }
        });
        let kind = ["more sample in view", "more samples in view"];
        objects.add(found, kind, |near| {
            let id = near.number as u32;
            let [_, description] = hover::sample(subject, id);
            Object {
                key: ("sample", near.number),
                text: located(&description, near.place),
                place: near.place,
                // Disks of this radius do not overlap in a set of one radius.
                reach: 0.5,
                selection: Selection::Sample(id),
            }
        });
    }

    /// Adds the active cubes of a throw that the plane through a set in space cuts, as the picture has them: as squares.
    fn add_cubes(&self, objects: &mut Objects) {
        let shown = &self.subject.shown;
        let in_plane = shown.session.solid.as_ref().zip(shown.plane);
        let (Some((solid, plane)), Stage::Iterate(number)) = (in_plane, shown.stage) else {
            return;
        };
        let Some(throw) = shown.session.iteration(number) else {
            return;
        };

        // All cubes of a throw have one side.
        let side = throw.cells.first().map_or(0, |cell| cell.side);
        let reach = 0.5 * radii(side);
        let found = solid.cubes_cut(number, side, plane).filter_map(|index| {
            let cell = throw.cells.get(index)?;
            self.near(index, position(cell.min) + DVec2::splat(reach))
        });

        let kind = ["more active cube in view", "more active cubes in view"];
        objects.add(found.collect(), kind, |near| {
            let text = format!(
                "Active cube of side {}, cut by the plane",
                tilescope_debugger::fraction(side)
            );
            Object {
                key: ("cube", near.number),
                text: located(&text, near.place),
                place: near.place,
                reach,
                selection: Selection::Place(near.place),
            }
        });
    }

    /// Returns how many active cells of each octave throw darts at the moment, in the whole domain; nothing where they have no
    /// octaves. Single cells are nothing to select, and are not listed.
    fn octaves(&self) -> Vec<String> {
        let shown = &self.subject.shown;
        let counts = shown.session.cells_by_octave(shown.stage);
        let octaves = counts.unwrap_or_default().into_iter().enumerate();
        octaves
            .filter(|&(_, count)| count > 0)
            .map(|(octave, count)| counted_cells(count, octave))
            .collect()
    }

    fn add_blocks(&self, objects: &mut Objects) {
        let (subject, shown) = (self.subject, &self.subject.shown);
        let leaves = &shown.session.run().blocks.leaves[..Made::at(shown).leaves];
        let found = leaves.iter().enumerate().filter_map(|(number, leaf)| {
            let middle = hover::middle_of(&leaf.rect);
            self.near(number, middle)
        });

        let kind = match shown.session.combination {
            Some(_) => ["more piece in view", "more pieces in view"],
            None => ["more block in view", "more blocks in view"],
        };
        objects.add(found.collect(), kind, |near| {
            let [_, description] = hover::block_of(subject, near.number);
            Object {
                key: ("block", near.number),
                text: located(&description, near.place),
                place: near.place,
                // The middle of the block is marked, not all of it. Chosen, not measured.
                reach: 1.0,
                selection: Selection::Place(near.place),
            }
        });
    }
}

/// Returns whether symbols of samples do not overlap, so that one of them can be pointed at.
fn is_fine(subject: &Subject<'_>) -> bool {
    subject.camera.scale * subject.shown.spacing() >= MIN_DISK_SCALE
}

/// Returns a description with the place of its object, in r.
fn located(text: &str, place: DVec2) -> String {
    format!("{text}, at ({:.1}, {:.1}) r", place.x, place.y)
}

/// Draws the description of an object of the list beside it: `text`, in the language of the window.
pub fn show_chosen(
    ui: &Ui,
    rect: Rect,
    subject: &Subject<'_>,
    object: &Object,
    text: &str,
    palette: &Palette,
) {
    let at = subject.camera.screen_from_domain(rect, object.place);
    hover::chosen(ui, rect, at, text, palette);
}
