//! Compares the places of buffer rows with the sequential engine: samples, links, candidates, cells and blocks lie at
//! the same positions as on the CPU. Needs an adapter; a software one will do.

use std::collections::BTreeSet;
use std::sync::Arc;

use tilescope_core::{
    Boundary, Fate, Insertion, Parameters, Pattern, Point, Rect, Run, Sequential, Stage, Unobserved,
};
use tilescope_gpu::layout::Name;
use tilescope_gpu::{BufferRows, RowLocator, RowPlace, RowPlaces, Stepper, Unplaced};

use crate::support::device::gpu;

type Place = (i32, i32);

fn small(boundary: Boundary, insertion: Insertion) -> Parameters {
    Parameters {
        radius: 0.02,
        leaf: 9.0,
        boundary,
        insertion,
        ..Parameters::default()
    }
}

const ENDS: [Boundary; 2] = [Boundary::Periodic, Boundary::Bounded];

/// A run on the device and on the CPU, both at the end of the same stage.
struct Both {
    stepper: Stepper,
    cpu: Sequential,
    stage: Stage,
}

impl Both {
    fn new(parameters: &Parameters) -> Self {
        let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
        let stepper = Stepper::new(Arc::clone(gpu()), parameters, &pattern, Stage::Blocks);
        Self {
            stepper: pollster::block_on(stepper).unwrap(),
            cpu: Sequential::new(parameters, pattern).unwrap(),
            stage: Stage::Blocks,
        }
    }

    /// Runs to the end of a stage.
    fn go(mut self, stage: Stage) -> Self {
        while pollster::block_on(self.stepper.step()).unwrap() != Some(stage) {}
        while self.cpu.next().is_some_and(|next| next <= stage) {
            self.cpu.step(&mut Unobserved).unwrap();
        }
        self.stage = stage;
        self
    }

    /// Runs passes up to and including the one of this name.
    fn behind(mut self, pass: &str) -> Self {
        loop {
            let report = pollster::block_on(self.stepper.step_pass()).unwrap();
            let report = report.expect("such a pass");
            self.stage = report.stage;
            if report.name == pass {
                return self;
            }
        }
    }

    fn run(&self) -> &Run {
        self.cpu.run()
    }

    fn table(&self, name: Name) -> BufferRows {
        pollster::block_on(self.stepper.table(name, u64::MAX)).unwrap()
    }

    fn locator(&self) -> RowLocator {
        pollster::block_on(self.stepper.row_locator(self.stage)).unwrap()
    }

    fn places(&self, name: Name) -> RowPlaces {
        self.locator().locate(name, &self.table(name))
    }

    /// Returns all places of a buffer, row by row.
    fn all(&self, name: Name) -> Vec<RowPlace> {
        all(&self.places(name), self.table(name).rows.len())
    }

    /// Returns the points among them that lie in the domain, sorted.
    fn inside(&self, name: Name) -> Vec<Place> {
        let mut inside = points(&self.all(name));
        inside.retain(|&p| self.holds(p));
        inside.sort_unstable();
        inside
    }

    fn holds(&self, (x, y): Place) -> bool {
        self.run().domain.rect().contains(Point::new(x, y))
    }

    /// Returns the samples of the CPU that satisfy `wanted`, sorted.
    fn samples(&self, wanted: impl Fn(Fate) -> bool) -> Vec<Place> {
        let samples = &self.run().samples;
        let fated = samples.points.iter().zip(&samples.fates);
        let mut places: Vec<Place> = fated
            .filter(|(_, fate)| wanted(**fate))
            .map(|(p, _)| (p.x, p.y))
            .filter(|&p| self.holds(p))
            .collect();
        places.sort_unstable();
        places
    }
}

fn all(places: &RowPlaces, rows: usize) -> Vec<RowPlace> {
    (0..rows).flat_map(|row| places.of(row).to_vec()).collect()
}

fn points(places: &[RowPlace]) -> Vec<Place> {
    let point = |spot: &RowPlace| match *spot {
        RowPlace::Point(p) => Some((p.x, p.y)),
        _ => None,
    };
    places.iter().filter_map(point).collect()
}

fn rects(places: &[RowPlace]) -> Vec<Rect> {
    let rect = |spot: &RowPlace| match *spot {
        RowPlace::Rect(rect) => Some(rect),
        _ => None,
    };
    places.iter().filter_map(rect).collect()
}

fn corners(rect: &Rect) -> [Place; 2] {
    [(rect.min.x, rect.min.y), (rect.max.x, rect.max.y)]
}

fn set<T: Ord>(items: impl IntoIterator<Item = T>) -> BTreeSet<T> {
    items.into_iter().collect()
}

#[test]
fn tiled_samples_lie_where_the_cpu_tiled_them() {
    for boundary in ENDS {
        let both = Both::new(&small(boundary, Insertion::Circumcentre)).go(Stage::Tile);
        let expected = both.samples(|_| true);
        assert!(expected.len() > 1_000, "{}", expected.len());
        // Each once in the domain; every image in the halo, wrapped, at the place of one of them.
        assert_eq!(both.inside(Name::Places), expected);
        assert_eq!(both.inside(Name::Origins), expected);
        let locator = both.locator();
        let wrapped: Vec<RowPlace> = both.all(Name::Places);
        let wrapped: Vec<RowPlace> = wrapped.into_iter().map(|s| locator.wrapped(s)).collect();
        let wrapped = set(points(&wrapped).into_iter().filter(|&p| both.holds(p)));
        assert_eq!(wrapped, set(expected));
    }
}

#[test]
fn a_frame_elsewhere_and_a_row_left_out_give_other_places() {
    let both = Both::new(&small(Boundary::Periodic, Insertion::Circumcentre)).go(Stage::Tile);
    let (locator, table) = (both.locator(), both.table(Name::Places));
    let places = |locator: &RowLocator, table: &BufferRows| {
        let places = all(&locator.locate(Name::Places, table), table.rows.len());
        let wrapped: Vec<RowPlace> = places.into_iter().map(|s| locator.wrapped(s)).collect();
        set(points(&wrapped))
    };
    let expected = set(both.samples(|_| true));
    assert_eq!(places(&locator, &table), expected);
    let fields = both.table(Name::Frame);
    for field in ["origin_x", "stride"] {
        let index = fields.columns.iter().position(|column| column == field);
        let (index, value) = (index.unwrap(), fields.rows[0][index.unwrap()]);
        let set = |value| both.stepper.set_word(Name::Frame, index as u64, value);
        set((value + 1) as u32);
        assert_ne!(places(&both.locator(), &table), expected, "{field}");
        set(value as u32);
    }
    assert_eq!(places(&both.locator(), &table), expected);
    let mut shifted = table.clone();
    shifted.rows.remove(0);
    assert_ne!(places(&locator, &shifted), expected);
}

#[test]
fn rows_behind_the_end_of_their_list_have_no_place() {
    let both = Both::new(&small(Boundary::Periodic, Insertion::Circumcentre)).go(Stage::Iterate(1));
    let counters = both.table(Name::Counters);
    let counter = |name: &str| {
        let place = counters.columns.iter().position(|column| column == name);
        counters.rows[0][place.expect("such a counter")] as usize
    };
    for (name, count) in [
        (Name::Places, counter("tiled")),
        (Name::List, counter("open")),
        (Name::Unsure, counter("unsure")),
        (Name::Proposals, counter("proposals")),
    ] {
        let (places, total) = (both.places(name), both.table(name).rows.len());
        assert!(0 < count && count < total, "{name:?}: {count} of {total}");
        assert!((0..count).all(|row| places.of(row).len() == 1), "{name:?}");
        assert!(
            (count..total + 9).all(|row| places.of(row).is_empty()),
            "{name:?}"
        );
    }
}

#[test]
fn survivors_and_who_eliminated_whom_are_those_of_the_cpu() {
    for boundary in ENDS {
        let both = Both::new(&small(boundary, Insertion::Circumcentre)).go(Stage::Eliminate);
        let kept = both.samples(|fate| fate == Fate::Kept);
        assert_eq!(both.inside(Name::Grid), kept);
        let places = both.places(Name::Grid);
        let table = both.table(Name::Grid);
        for (row, values) in table.rows.iter().enumerate() {
            let of = places.of(row);
            assert_eq!(of.len(), 1 + values[0] as usize);
            let cell = rects(of)[0];
            let holds = |&(x, y): &Place| cell.contains(Point::new(x, y));
            assert!(points(of).iter().all(holds));
        }
        let samples = &both.run().samples;
        let place = |id: usize| (samples.points[id].x, samples.points[id].y);
        let expected = samples
            .fates
            .iter()
            .enumerate()
            .filter_map(|(id, fate)| match fate {
                Fate::Eliminated { by } => Some([place(id), place(*by as usize)]),
                _ => None,
            });
        let locator = both.locator();
        let links = both
            .all(Name::By)
            .into_iter()
            .filter_map(|spot| match spot {
                RowPlace::Link([from, _]) if both.holds((from.x, from.y)) => {
                    let RowPlace::Link([from, to]) = spot else {
                        return None;
                    };
                    let RowPlace::Point(to) = locator.wrapped(RowPlace::Point(to)) else {
                        return None;
                    };
                    Some([(from.x, from.y), (to.x, to.y)])
                }
                _ => None,
            });
        assert_eq!(set(links), set(expected));
    }
}

#[test]
fn candidates_and_the_result_lie_where_the_cpu_has_them() {
    for boundary in ENDS {
        let parameters = small(boundary, Insertion::Circumcentre);
        let both = Both::new(&parameters).go(Stage::Iterate(1));
        let candidates = both.run().iterations[0].candidates.iter();
        let expected = set(candidates.map(|c| (c.point.x, c.point.y)));
        assert!(!expected.is_empty());
        assert_eq!(set(both.inside(Name::Proposals)), expected);
        assert!(both.places(Name::Result).unplaced() == Some(Unplaced::Unwritten));
        let both = Both::new(&parameters).go(Stage::Finish);
        let run = both.run();
        let places = run.result.iter().map(|&id| run.samples.points[id as usize]);
        let expected: Vec<Place> = places.map(|p| (p.x, p.y)).collect();
        assert_eq!(points(&both.all(Name::Result)), expected);
        assert_eq!(points(&both.all(Name::Tags)), expected);
    }
}

#[test]
fn images_are_the_blocks_and_tiles_know_who_reaches_them() {
    for boundary in ENDS {
        let both = Both::new(&small(boundary, Insertion::Circumcentre)).go(Stage::Tile);
        let domain = both.run().domain.rect();
        let inside = |rect: &&Rect| {
            let [(left, low), (right, high)] = corners(rect);
            left >= 0 && low >= 0 && right <= domain.max.x && high <= domain.max.y
        };
        let images = rects(&both.all(Name::Images));
        let images = set(images.iter().filter(inside).map(corners));
        let leaves = &both.run().blocks.leaves;
        assert_eq!(images, set(leaves.iter().map(|leaf| corners(&leaf.rect))));
        let tiles = (both.table(Name::TileImages), both.places(Name::TileImages));
        let (origins, places) = (both.table(Name::Origins), both.places(Name::Places));
        let pieces = (both.table(Name::Pieces), both.places(Name::Pieces));
        let contains = |places: &[RowPlace], p: Point| rects(places).iter().any(|r| r.contains(p));
        let mut looked = 0;
        for row in (0..origins.rows.len()).step_by(97) {
            let [RowPlace::Point(p)] = *places.of(row) else {
                continue;
            };
            let image = origins.rows[row][0];
            let tile = (0..tiles.0.rows.len()).find(|&k| contains(tiles.1.of(k), p));
            let list = &tiles.0.rows[tile.expect("a tile")];
            assert!(list[1..=list[0] as usize].contains(&image));
            let of_image = |k: &usize| pieces.0.rows[*k][0] == image;
            let mut reaching = (0..pieces.0.rows.len()).filter(of_image);
            assert!(reaching.any(|k| contains(pieces.1.of(k), p)));
            looked += 1;
        }
        assert!(looked > 20);
    }
}

#[test]
fn active_cells_are_those_of_the_level() {
    for boundary in ENDS {
        let parameters = small(boundary, Insertion::Uniform);
        let both = Both::new(&parameters).go(Stage::Iterate(2));
        let domain = both.run().domain.rect();
        for (level, iteration) in both.run().iterations.iter().take(2).enumerate() {
            let mut device = Both::new(&parameters).behind("throw");
            for _ in 0..level {
                device = device.behind("throw");
            }
            let cut = |side: i32, at: i32, end: i32| (at + side).min(end);
            let expected = iteration.cells.iter().map(|cell| {
                let (Point { x, y }, side) = (cell.min, cell.side);
                [
                    (x, y),
                    (cut(side, x, domain.max.x), cut(side, y, domain.max.y)),
                ]
            });
            let cells = rects(&device.all(Name::Active));
            let cells = cells
                .iter()
                .map(corners)
                .filter(|[low, _]| both.holds(*low));
            let (cells, expected) = (set(cells), set(expected));
            assert!(!expected.is_empty());
            assert_eq!(cells, expected, "level {level}");
        }
        let both = Both::new(&parameters).behind("split");
        let side = |name| rects(&both.all(name)).iter().map(Rect::width).max();
        let sides = [side(Name::Active), side(Name::NextActive)].map(Option::unwrap);
        assert_eq!(sides[0], 2 * sides[1]);
    }
}

#[test]
fn contested_cells_hold_the_samples_that_are_undecided() {
    let both = Both::new(&small(Boundary::Periodic, Insertion::Circumcentre)).go(Stage::Tile);
    let cells = rects(&both.all(Name::Heads));
    let listed = set(cells.iter().map(corners));
    let (table, places) = (both.table(Name::Places), both.places(Name::Places));
    let mut undecided = 0;
    let starts = both.places(Name::Starts);
    let all_cells = rects(&all(&starts, both.table(Name::Starts).rows.len()));
    let cell_of = |p: Point| {
        let side = all_cells[0].width();
        let low = |at: i32, from: i32| at - (at - from).rem_euclid(side);
        let min = Point::new(low(p.x, all_cells[0].min.x), low(p.y, all_cells[0].min.y));
        [(min.x, min.y), (min.x + side, min.y + side)]
    };
    for row in 0..table.rows.len() {
        if let ([RowPlace::Point(p)], 0) = (places.of(row), table.rows[row][2]) {
            assert!(listed.contains(&cell_of(*p)), "row {row}");
            undecided += 1;
        }
    }
    assert!(undecided > 100);
    // The same buffer has a row for every cell afterwards.
    let both = Both::new(&small(Boundary::Periodic, Insertion::Circumcentre)).go(Stage::Iterate(1));
    let heads = both.places(Name::Heads);
    assert!(heads.are_cells() && !both.places(Name::List).are_cells());
    assert_eq!(rects(heads.of(0)), [all_cells[0]]);
}

#[test]
fn numbers_have_no_places_and_say_so() {
    let both = Both::new(&small(Boundary::Bounded, Insertion::Circumcentre)).behind("blocks");
    for (name, why) in [
        (Name::Frame, Unplaced::Numbers),
        (Name::Counters, Unplaced::Numbers),
        (Name::Arguments, Unplaced::Numbers),
        (Name::Sums, Unplaced::Numbers),
        (Name::Pattern, Unplaced::Pattern),
        (Name::Places, Unplaced::Unwritten),
        (Name::Grid, Unplaced::Unwritten),
    ] {
        let places = both.places(name);
        assert_eq!(places.unplaced(), Some(why), "{name:?}");
        assert!(places.of(0).is_empty());
    }
    for name in [Name::Images, Name::Pieces, Name::TileImages] {
        let places = both.places(name);
        assert!(places.unplaced().is_none() && !places.of(0).is_empty());
    }
}
