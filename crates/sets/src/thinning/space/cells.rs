//! The points of a cloud in space in cubic cells, sorted by cell and, in a cell, by rank.
//!
//! Only cells with points exist, so that the memory follows the points and not the box around them.

use rayon::prelude::*;

use super::super::turns::Turns;
use super::SpaceCloud;

/// A cell is wider than the radius by this share: positions in up to 2^29 cells along an axis are rounded by less.
const MARGIN: f64 = 1.0 / (1 << 16) as f64;

/// Cells that a thread connects at a time. Chosen, not measured.
const CHUNK: usize = 1 << 12;

/// No cell.
const NONE: u32 = u32::MAX;

/// A cell's place in its row, its row, and its plane. From 1 on, so that subtracting one gives a number, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct CellPlace {
    plane: u32,
    row: u32,
    column: u32,
}

/// The cells that have points, in order, and which of their points are decided.
#[derive(Debug)]
pub(super) struct SpaceCells {
    places: Vec<CellPlace>,
    /// In each of the nine rows around a cell, its own among them, the first of the up to three cells that are near it.
    rows: Vec<[u32; 9]>,
    pub points: Vec<[f64; 3]>,
    pub ranks: Vec<u32>,
    /// The index of each point in the cloud.
    indices: Vec<u32>,
    pub turns: Turns,
}

impl SpaceCells {
    /// Sorts the points of a cloud, whose lowest corner is `low`, into cells in which points that are near lie at most one cell
    /// apart.
    pub fn new(cloud: &SpaceCloud<'_>, low: [f64; 3]) -> Self {
        let inverse = 1.0 / (cloud.radius * (1.0 + MARGIN));
        let place = |index: u32| {
            let point = cloud.points[index as usize];
            let [column, row, plane] =
                [0, 1, 2].map(|axis| ((point[axis] - low[axis]) * inverse) as u32 + 1);
            CellPlace { plane, row, column }
        };
        let count = cloud.points.len() as u32;
        // An entry has no index. Ranks differ, so that each index is found from its rank after the entries are sorted.
        let mut entries: Vec<(CellPlace, u32)> = (0..count)
            .into_par_iter()
            .map(|index| {
                (
                    place(index),
                    cloud.ranks.map_or(index, |ranks| ranks[index as usize]),
                )
            })
            .collect();
        // Ranks differ, so that there is one sorted order alone, on any number of threads.
        entries.par_sort_unstable();

        // From here on a cell is known by its number among those that have points.
        let (mut places, mut starts): (Vec<CellPlace>, Vec<u32>) = (Vec::new(), Vec::new());
        for (at, (place, _)) in (0..).zip(&entries) {
            if places.last() != Some(place) {
                places.push(*place);
                starts.push(at);
            }
        }
        starts.push(count);

        let ranks: Vec<u32> = entries.into_par_iter().map(|(_, rank)| rank).collect();
        let indices = match cloud.ranks {
            None => ranks.clone(),
            Some(of_index) => {
                let of_rank = inverted(of_index);
                ranks
                    .par_iter()
                    .map(|&rank| of_rank[rank as usize])
                    .collect()
            }
        };
        Self {
            rows: rows(&places),
            points: (indices.par_iter())
                .map(|&index| cloud.points[index as usize])
                .collect(),
            ranks,
            indices,
            turns: Turns::new(starts),
            places,
        }
    }

    /// Returns how many cells there are.
    pub fn count(&self) -> u32 {
        self.places.len() as u32
    }

    /// Replaces `around` by the cells in which points near those of a cell may lie, the cell itself first: most points are refused,
    /// and most of these by a point of their own cell.
    pub fn look_around(&self, cell: u32, around: &mut Vec<u32>) {
        around.clear();
        around.push(cell);
        let own = self.places[cell as usize];
        for &first in &self.rows[cell as usize] {
            if first == NONE {
                continue;
            }
            let there = self.places[first as usize];
            let in_row = |place: &CellPlace| {
                (place.plane, place.row) == (there.plane, there.row)
                    && place.column <= own.column + 1
            };
            // A row's cells follow each other in the order of all.
            let cells = first..self.count();
            around.extend(
                cells
                    .take_while(|&at| in_row(&self.places[at as usize]))
                    .filter(|&at| at != cell),
            );
        }
    }

    /// Returns for each point of the cloud whether it is kept, once all are decided.
    pub fn flags(&self) -> Vec<bool> {
        let mut kept = vec![false; self.points.len()];
        self.turns.flag(&self.indices, &mut kept);
        kept
    }
}

/// Returns which index has each rank.
fn inverted(ranks: &[u32]) -> Vec<u32> {
    let mut indices = vec![0; ranks.len()];
    for (index, &rank) in (0..).zip(ranks) {
        indices[rank as usize] = index;
    }
    indices
}

/// Returns for each of some sorted cells the first near one in each of the nine rows around it.
fn rows(places: &[CellPlace]) -> Vec<[u32; 9]> {
    // Rows are numbered by planes, three to a plane: from the plane below and the row before on.
    let around = |place: &CellPlace, number: usize| CellPlace {
        plane: place.plane + number as u32 / 3 - 1,
        row: place.row + number as u32 % 3 - 1,
        column: place.column - 1,
    };
    let connect = |chunk: &[CellPlace]| -> Vec<[u32; 9]> {
        // For cells in their order the first near ones of a row come in order, too: each is looked for from the last one on.
        let mut firsts: [usize; 9] = std::array::from_fn(|number| {
            let from = around(&chunk[0], number);
            places.partition_point(|place| *place < from)
        });

        let of_cell = |place: &CellPlace| {
            std::array::from_fn(|number| {
                let (from, at) = (around(place, number), &mut firsts[number]);
                while places.get(*at).is_some_and(|place| *place < from) {
                    *at += 1;
                }
                // The row may have none of the three cells that are near.
                let last = CellPlace {
                    column: place.column + 1,
                    ..from
                };
                let found = places.get(*at).is_some_and(|place| *place <= last);
                if found { *at as u32 } else { NONE }
            })
        };
        chunk.iter().map(of_cell).collect()
    };
    places.par_chunks(CHUNK).flat_map_iter(connect).collect()
}
