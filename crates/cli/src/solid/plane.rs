//! A plane through a set in space: each ball that it meets is a disk in it. A place of the plane is covered exactly if it lies
//! in one of the disks.

use std::fmt::{self, Write};
use std::path::Path;

use anyhow::{Result, ensure};
use tilescope_analysis::{Number, Region, SolidRegion};
use tilescope_formats::{Format, write_whole};

use crate::options::SetArguments;
use crate::paths::{InFile, named};
use crate::{EXIT_FINE, output};

use super::{hinted, is_in_space, overrides};

/// The names of the axes.
const AXES: [char; 3] = ['x', 'y', 'z'];

/// A plane at right angles to an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slice {
    /// The number of the axis.
    axis: usize,
    /// Where the plane meets it, in domain units.
    place: f64,
}

impl Slice {
    /// Reads `z=5`.
    pub fn parse(text: &str) -> Result<Self, String> {
        let wrong = || format!("{text:?} is no plane; one is written as z=5, x=0.5 or y=2");
        let (axis, place) = text.split_once('=').ok_or_else(wrong)?;
        let axis = AXES.iter().position(|name| axis == name.to_string());
        let place: f64 = place.parse().map_err(|_| wrong())?;
        axis.filter(|_| place.is_finite())
            .map(|axis| Self { axis, place })
            .ok_or_else(wrong)
    }

    /// Returns the numbers of the two axes of the plane, in their order.
    fn axes(self) -> [usize; 2] {
        match self.axis {
            0 => [1, 2],
            1 => [0, 2],
            _ => [0, 1],
        }
    }
}

impl fmt::Display for Slice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {}", AXES[self.axis], Number(self.place))
    }
}

/// The disks in which a plane meets the balls of a set.
pub struct PlaneDisks {
    /// The rectangle of the domain in the plane.
    pub region: Region,
    /// The middles of the disks.
    pub middles: Vec<[f64; 2]>,
    /// The radius of each.
    pub radii: Vec<f64>,
    /// How far each sample lies above the plane; below it, less than 0.
    depths: Vec<f64>,
    /// The radius of the balls.
    radius: f64,
    /// How many samples the set has.
    pub samples: usize,
    /// Where the lower corner of the rectangle lies in the file.
    pub origin: [f64; 2],
}

impl PlaneDisks {
    /// Returns how far each sample lies above the plane, in radii of the balls.
    pub fn above(&self) -> Vec<f64> {
        let in_radii = |depth| depth / self.radius;
        self.depths.iter().map(in_radii).collect()
    }
}

/// Reads a set in space and returns the disks of a plane.
pub fn read(file: &Path, set: &SetArguments, slice: Slice) -> Result<PlaneDisks> {
    ensure!(
        is_in_space(set, file),
        "{}: --slice takes a plane of a set in space, and this one has no third side: neither its certificate nor --depth \
         states one",
        named(file)
    );
    // Disks show what the set is, valid or not: only its certificate has to be that of the file.
    let given = overrides(set, file)?;
    let read = tilescope_formats::read_solid(file, &given, set.depth)
        .map_err(hinted)
        .in_file(file)?;
    disks(&read.points, read.region, read.radius, (slice, read.origin))
}

/// Returns the disks in which a plane meets the balls. The plane is that of a place in the file, where the lower corner of the
/// box lies at an origin; the points are counted from there. Fails if the plane is beyond the box.
fn disks(
    points: &[[f64; 3]],
    region: SolidRegion,
    radius: f64,
    (slice, origin): (Slice, [f64; 3]),
) -> Result<PlaneDisks> {
    let size = region.size();
    let (side, low) = (size[slice.axis], origin[slice.axis]);
    // A plane just beyond the box would meet the balls that reach out of the box, and would look like a plane inside.
    ensure!(
        (low..=low + side).contains(&slice.place),
        "the plane {slice} lies beyond the domain, where {} is from {} to {}",
        AXES[slice.axis],
        Number(low),
        Number(low + side)
    );

    let place = slice.place - low;
    let [across, up] = slice.axes();
    let mut found = PlaneDisks {
        region: Region::new([size[across], size[up]], region.is_periodic()),
        middles: Vec::new(),
        radii: Vec::new(),
        depths: Vec::new(),
        radius,
        samples: points.len(),
        origin: [across, up].map(|axis| origin[axis]),
    };
    for point in points {
        let straight = point[slice.axis] - place;
        // Around the torus the nearest image of a ball counts. If the side is longer than two radii, no other image
        // meets the plane. The verifier refuses shorter sides; here they are drawn without the other images.
        let depth = if region.is_periodic() {
            straight - (straight / side).round() * side
        } else {
            straight
        };
        // By Pythagoras; a ball that only touches the plane is a disk of radius 0.
        if depth.abs() <= radius {
            found.middles.push([point[across], point[up]]);
            found.radii.push((radius * radius - depth * depth).sqrt());
            found.depths.push(depth);
        }
    }
    Ok(found)
}

/// Writes the disks of a plane as a table: the two coordinates in the plane, radius and depth. They are no set of
/// samples, and have no certificate.
pub fn write(
    [input, path]: [&Path; 2],
    to: Option<Format>,
    set: &SetArguments,
    slice: Slice,
) -> Result<u8> {
    let format = Format::to_write(path, to)?;
    ensure!(
        format == Format::Csv,
        "{}: the disks of a plane are written as csv, with columns for x, y, radius and depth, not as {format}",
        named(path)
    );
    let disks = read(input, set, slice)?;

    // The first two columns have the names of the plane's axes, so that planes across different axes cannot be
    // mistaken.
    let [across, up] = slice.axes().map(|axis| AXES[axis]);
    let mut table = format!("{across},{up},radius,depth\n");
    let rows = disks.middles.iter().zip(&disks.radii).zip(&disks.depths);
    let [left, low] = disks.origin;
    for (([a, b], radius), depth) in rows {
        let (a, b) = (a + left, b + low);
        let _ = writeln!(table, "{a},{b},{radius},{depth}");
    }
    write_whole(path, table.as_bytes()).in_file(path)?;

    output::emit(&format!(
        "the plane {slice} meets {} of {} balls; their disks are in {}\n",
        disks.radii.len(),
        disks.samples,
        named(path)
    ))?;
    Ok(EXIT_FINE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tilescope_analysis::Boundary;

    #[test]
    fn planes_are_read_by_axis_and_place() {
        let slice = |axis, place| Ok(Slice { axis, place });
        assert_eq!(Slice::parse("z=5"), slice(2, 5.0));
        assert_eq!(Slice::parse("x=-0.5"), slice(0, -0.5));
        for text in ["z", "5", "w=1", "z=", "z=inf", "zz=1"] {
            assert!(
                Slice::parse(text).expect_err(text).contains("z=5"),
                "{text}"
            );
        }
    }

    #[test]
    fn a_ball_is_a_disk_as_pythagoras_says_and_goes_around() {
        let region = SolidRegion {
            width: 4.0,
            height: 5.0,
            depth: 6.0,
            boundary: Boundary::Periodic,
        };
        let points = [[1.0, 2.0, 0.2], [3.0, 4.0, 5.6], [0.0, 0.0, 3.0]];
        let at_0 = [0.0; 3];
        let slice = Slice {
            axis: 2,
            place: 0.0,
        };
        let found = disks(&points, region, 0.5, (slice, at_0)).expect("disks");
        assert_eq!(found.middles, [[1.0, 2.0], [3.0, 4.0]]);
        for (found, wanted) in found.radii.iter().zip([0.21_f64.sqrt(), 0.3]) {
            assert!((found - wanted).abs() < 1e-12);
        }
        assert!((found.depths[1] + 0.4).abs() < 1e-12);

        // In a bounded box nothing goes around; the other axes have their own coordinates.
        let bounded = SolidRegion {
            boundary: Boundary::Bounded,
            ..region
        };
        assert_eq!(
            disks(&points, bounded, 0.5, (slice, at_0))
                .expect("disks")
                .radii
                .len(),
            1
        );
        let beside = Slice {
            axis: 1,
            place: 2.0,
        };
        assert_eq!(
            disks(&points, region, 0.5, (beside, at_0))
                .expect("disks")
                .middles,
            [[1.0, 0.2]]
        );
        let beyond = Slice {
            axis: 1,
            place: 5.5,
        };
        let said = disks(&points, region, 0.5, (beyond, at_0))
            .err()
            .expect("beyond")
            .to_string();
        assert!(
            said.contains("y = 5.5") && said.contains("from 0 to 5"),
            "{said}"
        );

        // In a file whose box begins elsewhere the plane is at a place of the file, where it was beyond before.
        let elsewhere = [7.0, 3.5, 0.0];
        let found = disks(&points, region, 0.5, (beyond, elsewhere)).expect("disks");
        assert_eq!(found.middles, [[1.0, 0.2]]);
        assert_eq!(
            found.origin.map(f64::to_bits),
            [7.0_f64, 0.0].map(f64::to_bits)
        );
    }
}
