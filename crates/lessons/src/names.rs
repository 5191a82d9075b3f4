//! The names of the functions that expressions may call, and of an event's properties. `functions.rs` has the functions.

/// The functions, one on a line: how it is called, a colon, its meaning.
const FUNCTIONS: &str = r#"
next(query): the next event that matches a query, as a map, or () if there is none
previous(query): the last event before this moment that matches a query
count(query): how many events of the whole run match a query
exists(value): whether a value is not ()
valid(s): whether a sample is valid at this moment
lost(s): whether a sample is eliminated, now or later
lost_to(s): the sample that eliminates it
kept(s): whether a sample is in the result
inserted(s): whether a sample is an inserted one
own(s): whether a tiled sample lies in its own block, not in the margin around it
marked(s): whether elimination makes a sample a gap detector
turn(s): the number of the event at which elimination takes a sample, or at which it arrives in exact tiling; -1 if there is none
unsure(s): whether a sample's fate is open when every sample has only looked at its own conflicts
first_unsure(): the valid sample with the smallest number whose fate is open then, or ()
samples(): how many samples are valid
conflicts(): how many pairs of valid samples are closer than r
conflicts_of(s): how many valid samples are closer than r to a sample
conflict(s, k): the k-th valid sample closer than r to a sample, from 0 and by number, or ()
covered(x, y): whether a place lies in the disk of a valid sample
nearest(x, y): the valid sample nearest to a place
far(s, x, y): how far a sample is from a place
apart(place, other): the distance of two places, each [x, y]
odd_run(): whether the run's seed is odd: in a condition, it varies which answer is right
gaps(): how many gaps the valid samples leave
deepest(): the deepest place [x, y] of the largest gap, or ()
clear_deepest(): by how much the largest gap is deeper than every other one; 1 if it is the only one
deepest_inside(d): the deepest place of the largest gap at least d from the border of the domain, or ()
deepest_near(x, y): the deepest place of the gap nearest to a place
seam(x, y): how far a place is from the nearest edge of a block
on_seam(x, y): the place on the nearest edge of a block, [x, y]
border(x, y): how far a place is from the border of the domain, negative outside
density_near(d): how many samples of the result per r² lie nearer than d to an edge of a block
density_far(d): how many samples of the result per r² lie farther than d from the edges of their blocks
rank(s): the rank of a sample of nested levels, from 0 to below 1
below(t): how many samples of nested levels have ranks below t
ranked(x, y, low, high): the valid sample nearest to a place, of those with ranks from low to below high, or ()
radius_at(x, y): the radius at a place of a field of radii; 1 where every radius is r
radius_of(s): the radius at the place of a sample
refuses(s, x, y): whether a sample refuses a dart at a place: whether the two are near each other
refusers(x, y): how many valid samples refuse a dart at a place
cell_side(x, y): the side of the cell in which darts around a place begin to fall
packed(low, high): the valid samples times their radius squared, divided by the area, of places whose radius is from low to below high
open_places(): how many of 128 x 128 places all over the domain are near no valid sample
plane(): where the plane through a set in space lies along the third axis
above(s): how far a sample lies above the plane; below it, less than 0
disk(s): the radius of the disk in which the plane cuts the ball of a sample; 0 where it does not cut it
far_in_space(s, x, y): how far a sample is in space from a place of the plane
dot(x, y, k): the k-th nearest to a place, from 0, of the dots in the picture: the valid samples whose balls the plane cuts; or ()
dots_apart(s, t): how far two samples are apart in the picture, without their heights
clear_above(x, y): how far the plane can rise until a ball covers a place of it; 0 where one covers it already
first_above(x, y): the valid sample of that ball, or ()
open_within(t): how many of 128 x 128 places of the plane are farther than r from all valid samples at most t above or below it
close_pairs(t): how many pairs of valid samples at most t above or below the plane are closer than r seen along the third axis
active_cubes(): how many cubes are active in the current throw
cubes_in_plane(): how many of them the plane cuts
cube_side(): their side
planes_cut(): in how many of a hundred planes, all heights alike, one of them lies
position(s): the place of a sample, [x, y]
within(x, y, d): how many valid samples are closer than d to a place
seam_of(s): how far a sample is from the nearest edge of a block
reach_of_conflicts(): how far from the edges of their blocks valid samples with conflicts are at most
reach_of_losses(): the same of samples that are eliminated, now or later
reach_of_insertions(): the same of samples that are inserted, now or later
reach_of_detectors(): how far a gap detector of elimination is at most from the lost sample nearest to it
block_size(b): the sides of a block, [width, height]
parameter(name): a parameter of the run
measure(name): a number of the valid samples by its name in the JSON of `tilescope analyze`, such as density, packing, min_distance_r, peak
measure_with(name, changes): the same of the result with other parameters, such as "leaf=10"; not of nested levels
same_points(engine): whether an engine ("parallel") makes the same points; not of nested levels
parts_at(changes): the number of the event in which the run with other parameters first differs; not of nested levels
"#;

/// Returns the functions that expressions may call: how each is called, and its meaning.
pub fn functions() -> impl Iterator<Item = (&'static str, &'static str)> {
    FUNCTIONS.lines().filter_map(|line| line.split_once(": "))
}

/// The properties that an event's map may have.
pub const PROPERTIES: [&str; 21] = [
    "event", "kind", "a", "b", "sites", "x", "y", "z", "distance", "verdict", "block", "found",
    "turned", "axis", "plane", "x0", "y0", "x1", "y1", "count", "len",
];
