//! The parallel engine: any window of a run, computed from the blocks around it alone.
//! A run is cut into windows that fit the cache; windows share nothing and write nothing that
//! another reads, so threads cannot change the result. It never decides differently from the
//! sequential engine: the two are compared byte for byte.

mod claim;
mod clip;
mod frame;
pub mod gaps;
mod near;
mod region;
mod stamp;
mod uniform;

use std::sync::Arc;

use fearless_simd::{Level, dispatch};

use crate::error::SampleError;
use crate::lattice::{Domain, Point, Rect};
use crate::parameters::Parameters;
use crate::pattern::Pattern;
use crate::random::Key;
use crate::stages::order::Ranking;

use claim::Turns;
use clip::Clipper;
use frame::Frame;
use gaps::Rules;
use region::Region;

/// Cells around a window that are computed with it at first.
const HALO: i32 = 8;

/// The plane of a run.
pub struct Plane {
    domain: Domain,
    clipper: Clipper,
    ranking: Ranking,
    rules: Rules,
    touches_itself: bool,
    order: crate::parameters::Order,
    level: Level,
}

impl Plane {
    /// Returns the plane of `parameters` with a pattern.
    pub fn new(parameters: &Parameters, pattern: &Arc<Pattern>) -> Result<Self, SampleError> {
        let domain = parameters.validate()?;
        let key = Key::from_seed(parameters.seed);
        let leaf = parameters.leaf_units()?;
        let short = domain.width() / 2 < leaf || domain.height() / 2 < leaf;
        Ok(Self {
            domain,
            clipper: Clipper::new(domain, leaf, key, pattern, parameters.dihedral),
            ranking: Ranking::new(parameters.order, &domain, key),
            rules: Rules {
                domain,
                search: parameters.search,
                key,
                lost_reach: 1,
                insertion: parameters.insertion,
            },
            touches_itself: domain.is_periodic() && short,
            order: parameters.order,
            level: Level::new(),
        })
    }

    /// Returns the samples of the full run inside `window`, in canonical order.
    pub fn window(&self, window: &Rect) -> Result<Vec<Point>, SampleError> {
        let mut out = Vec::new();
        let mut region = Region::<false>::default();
        self.compute(&mut region, window, HALO)?;
        dispatch!(self.level, _simd => region.emit(&mut out, &mut Vec::new(), &mut Vec::new()));
        Ok(out)
    }

    /// Returns the whole run.
    pub fn all(&self, side: i32) -> Result<Vec<Point>, SampleError> {
        let mut out = Vec::new();
        let mut region = Region::<false>::default();
        let max = self.domain.rect().max;
        for y in (0..max.y).step_by((side << 15) as usize) {
            let mut parts = Vec::new();
            for x in (0..max.x).step_by((side << 15) as usize) {
                let window = Rect { min: Point::new(x, y), max: Point::new((x + (side << 15)).min(max.x), (y + (side << 15)).min(max.y)) };
                self.compute(&mut region, &window, HALO)?;
                let (mut o, mut rows) = (Vec::new(), Vec::new());
                lap(11);dispatch!(self.level, _simd => region.emit(&mut o, &mut Vec::new(), &mut rows));lap(8);
                parts.push((o, rows));
            }
            let rows = parts[0].1.len();
            for r in 0..rows {
                for (o, rows) in &parts {
                    let from = if r == 0 { 0 } else { rows[r - 1] as usize };
                    out.extend_from_slice(&o[from..rows[r] as usize]);
                }
            }
        }
        Ok(out)
    }

    fn compute<const TAGS: bool>(&self, region: &mut Region<TAGS>, window: &Rect, halo: i32) -> Result<(), SampleError> {
        let frame = Frame::new(&self.domain, window, halo);
        lap(11);
        region.reset(frame, self.rules.reach());
        lap(0);
        let mut blocks = std::mem::take(&mut region.blocks);
        let found = self.clipper.blocks(&region.frame, &mut blocks);
        region.blocks = blocks;
        found?;
        lap(1);
        let turns = Turns::new(self.order, self.touches_itself, &self.ranking);
        dispatch!(self.level, _simd => {
            region.claim(&self.clipper, &turns);
            match self.rules.insertion {
                crate::Insertion::Circumcentre => region.fill(&self.rules),
                crate::Insertion::Uniform => region.fill_uniformly(&self.rules),
            }
        });
        if let Some(unsure) = region.unsure_in_window() {
            let cells = Rect { min: unsure.min, max: unsure.max };
            let _ = cells;
            RETRIES.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            return self.compute(region, window, 2 * halo);
        }
        Ok(())
    }
}
/// x
pub static RETRIES: std::sync::atomic::AtomicU64 = std::sync::atomic::AtomicU64::new(0);

use std::cell::Cell;
thread_local!{ static LAST: Cell<Option<std::time::Instant>> = const { Cell::new(None) }; pub static LAPS: [Cell<u64>;16] = const { [const { Cell::new(0) };16] }; }
pub fn lap(k: usize) { let now=std::time::Instant::now(); LAST.with(|l| { if let Some(t)=l.get() { LAPS.with(|a| a[k].set(a[k].get()+(now-t).as_nanos() as u64)); } l.set(Some(now)); }); }
pub fn laps() { LAPS.with(|a| { for (k,name) in ["reset","blocks+","interior","mark","masks","pixels","insert","again","emit","own","margin","other"].iter().enumerate() { println!("   {name:10} {:.2} ms", a[k].get() as f64/1e6); a[k].set(0);} }); }
