//! The look of every sample at a moment: symbol, colour, disk. The canvas, whether it draws instances on the GPU or meshes,
//! and exported pictures draw these looks. Begin with [`Looks::of`].

use std::ops::Range;

use crate::palette::Palette;
use ecolor::Color32;
use tilescope_core::{Origin, Stage, Standing};
use tilescope_session::layers::{Colouring, Layer, Layers};
use tilescope_session::nested::NestedLevels;
use tilescope_session::solid::Cut;

use crate::age::Ages;
use crate::brushed;
use crate::look::{SampleLook, Symbol};
use crate::subject::{GroundView, Subject};

/// Everything that looks depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LooksKey {
    generation: u64,
    cursor: usize,
    stage: Stage,
    layers: Layers,
    colouring: Colouring,
    view: GroundView,
    palette: Palette,
    /// The plane through a set in space.
    plane: Option<i32>,
    /// The serial number of the causes shown.
    causes: Option<u64>,
}

impl LooksKey {
    /// Returns the key of a subject drawn in this palette.
    #[must_use]
    pub fn of(subject: &Subject<'_>, palette: &Palette) -> Self {
        Self {
            generation: subject.shown.session.generation,
            cursor: subject.shown.cursor(),
            stage: subject.shown.stage,
            layers: subject.layers,
            colouring: subject.colouring,
            view: subject.view,
            palette: *palette,
            plane: subject.shown.plane,
            causes: subject.causes.map(|found| found.serial),
        }
    }

    /// Returns the range between the two keys' cursors, if nothing else differs.
    #[must_use]
    pub fn span(self, other: Self) -> Option<Range<usize>> {
        let cursor = self.cursor;
        let (low, high) = (cursor.min(other.cursor), cursor.max(other.cursor));
        (Self { cursor, ..other } == self).then_some(low..high)
    }
}

/// The colours of blocks and ages, which take too long to compute for each sample.
#[derive(Default)]
pub struct Swatches {
    palette: Option<Palette>,
    blocks: Vec<Color32>,
    /// The colours of ages, from early to late.
    ages: Vec<Color32>,
}

/// The number of colours of ages.
const SHADES: u32 = 256;

impl Swatches {
    /// Makes the colours of `palette` for the blocks of the subject and for ages, and keeps those that are there
    /// already.
    pub fn follow(&mut self, subject: &Subject<'_>, palette: &Palette) {
        let count = subject.shown.session.run().blocks.leaves.len();
        if self.palette != Some(*palette) {
            let shade = |k: u32| palette.age(k as f32 / (SHADES - 1) as f32);
            *self = Self {
                palette: Some(*palette),
                blocks: Vec::new(),
                ages: (0..SHADES).map(shade).collect(),
            };
        }
        let known = self.blocks.len().min(count);
        self.blocks
            .extend((known..count).map(|k| palette.block(k as u32)));
    }

    fn block(&self, index: u32) -> Color32 {
        self.blocks[index as usize]
    }

    fn age(&self, age: f32) -> Color32 {
        self.ages[(age * (SHADES - 1) as f32).round() as usize]
    }
}

/// Returns the age whose colour a level has: 0 for the first level, 1 for the last.
#[must_use]
pub fn level_age(level: usize, levels: &NestedLevels) -> f32 {
    level as f32 / (levels.claims.len() - 1).max(1) as f32
}

/// Returns the look of a sample in a plane that cuts its ball: the farther from the plane, the paler and the smaller. These
/// shares were chosen, not measured.
fn cut_look(symbol: Symbol, color: Color32, cut: Cut) -> SampleLook {
    let far = cut.above.abs() as f32;
    SampleLook::new(symbol, color.gamma_multiply(1.0 - 0.75 * far))
        .with_disk(true)
        .with_size(1.0 - 0.5 * far)
}

/// How samples look at a moment.
#[derive(Clone, Copy)]
pub struct Looks<'a> {
    subject: Subject<'a>,
    palette: &'a Palette,
    swatches: &'a Swatches,
    ages: Ages,
    /// The colour of eliminated samples.
    ghost: Color32,
    /// The colour of samples outside the domain.
    dropped: Color32,
}

impl<'a> Looks<'a> {
    /// Returns the looks of a subject's samples; `swatches` must have been updated for the same subject and palette.
    #[must_use]
    pub fn new(subject: &Subject<'a>, palette: &'a Palette, swatches: &'a Swatches) -> Self {
        // Eliminated samples are dimmed once gaps are filled, and more where the result is shown. These shares and that
        // of dropped samples were chosen, not measured.
        let presence = match subject.shown.stage {
            Stage::Finish => 0.3,
            Stage::Iterate(_) => 0.6,
            _ => 1.0,
        };

        Self {
            subject: *subject,
            palette,
            swatches,
            ages: Ages::of(subject.shown.session),
            ghost: palette.eliminated.gamma_multiply(presence),
            dropped: palette.eliminated.gamma_multiply(0.35),
        }
    }

    /// Returns the looks of the same samples with all samples of nested levels or of a stipple present.
    #[must_use]
    pub fn of_all_levels(&self) -> Self {
        let mut all = *self;
        let shown = &mut all.subject.shown;
        shown.prefix = shown.prefix.map(|_| shown.session.summary.count);
        all
    }

    /// Returns the subject whose samples these are.
    #[must_use]
    pub const fn subject(&self) -> &Subject<'a> {
        &self.subject
    }

    /// Returns how a sample looks.
    #[must_use]
    pub fn of(&self, id: u32) -> SampleLook {
        let has = |layer| self.subject.layers.has(layer);

        match self.subject.shown.standing(id) {
            Standing::Eliminated { .. } if has(Layer::Eliminated) => {
                SampleLook::new(Symbol::Cross, self.ghost)
            }
            // Samples outside a bounded domain take no part in later stages.
            Standing::Dropped
                if has(Layer::Eliminated) && self.subject.shown.stage == Stage::Tile =>
            {
                SampleLook::new(Symbol::Dot, self.dropped)
            }
            Standing::Valid | Standing::Tiled if self.subject.view == GroundView::Dots => {
                SampleLook::new(Symbol::Dot, self.palette.text)
            }
            // Without its symbol a sample still has its disk, which is a layer of its own.
            Standing::Valid | Standing::Tiled => {
                let (layer, symbol) = match self.origin(id) {
                    Origin::Inserted { .. } => (Layer::Inserted, Symbol::Diamond),
                    Origin::Tiled { .. } => (Layer::Samples, Symbol::Dot),
                };
                // Of a set in space only samples that the plane cuts are valid here.
                if let Some(cut) = self.subject.shown.cut(id) {
                    // All samples of a set in space were darts, so that their symbol need not say so.
                    let drawn = if has(Layer::Samples) {
                        Symbol::Dot
                    } else {
                        Symbol::None
                    };
                    return cut_look(drawn, self.color(id), cut);
                }

                let drawn = if has(layer) { symbol } else { Symbol::None };
                SampleLook::new(drawn, self.color(id))
                    .with_disk(true)
                    // The outline keeps a diamond apart from the dots around it.
                    .with_outline(drawn == Symbol::Diamond)
                    // Without a brush over the curves all samples have the usual size.
                    .with_size(self.tint(id).map_or(1.0, |(_, size)| size))
            }
            // Other samples are not there yet, or belong to a layer that is off.
            _ => SampleLook::HIDDEN,
        }
    }

    /// Returns the colour and size of a sample by its share of the brushed power.
    fn tint(&self, id: u32) -> Option<(Color32, f32)> {
        brushed::tint(self.subject.causes, id, self.palette)
    }

    fn origin(&self, id: u32) -> &'a Origin {
        &self.subject.shown.session.run().samples.origins[id as usize]
    }

    /// Returns the colour of a sample that is tiled or valid.
    #[must_use]
    pub fn color(&self, id: u32) -> Color32 {
        // A brush over the curves replaces any colouring while it lasts.
        if let Some((color, _)) = self.tint(id) {
            return color;
        }

        let origin = self.origin(id);
        let session = self.subject.shown.session;

        match (origin, self.subject.colouring.of(session.kind())) {
            (_, Colouring::Level) => {
                // Only nested levels have this colouring, so that 0 never stands in.
                let nested = session.nested.as_ref();
                let share = |levels: &NestedLevels| level_age(levels.level_of(id as usize), levels);
                self.swatches.age(nested.map_or(0.0, share))
            }
            (_, Colouring::Age) => self.swatches.age(self.ages.of_sample(id, origin)),
            // Only a plane has samples above it and below.
            (_, Colouring::Depth) => {
                let cut = self.subject.shown.cut(id);
                self.palette.depth(cut.map_or(0.0, |cut| cut.above))
            }
            // An inserted sample belongs to no block and to no margin.
            (Origin::Inserted { .. }, _) => self.palette.inserted,
            (Origin::Tiled { block, .. }, Colouring::Block) => self.swatches.block(*block),
            (Origin::Tiled { own: true, .. }, Colouring::Provenance) => self.palette.sample,
            (Origin::Tiled { .. }, Colouring::Provenance) => self.palette.margin,
        }
    }
}
