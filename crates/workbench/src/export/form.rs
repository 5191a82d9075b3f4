//! The export sheet as filled in: a path, and numbers as typed, with their checks. `state/export.rs` fills it in.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use tilescope_formats::Precision;

use crate::files::missing_folder;

use super::refusal::ExportRefusal;
use super::{ExportKind, InkForm, extension, scene_path};
use crate::clock::Clock;

/// The smallest scale: pixels for a point of the window.
pub const MIN_SCALE: f64 = 0.5;
/// The largest scale, in pixels for a point of the window. Chosen, not measured.
pub const MAX_SCALE: f64 = 8.0;
/// The most ticks from frame to frame. Chosen, not measured.
pub const MAX_EVERY: usize = 10_000_000;
/// The most pixels that a picture of dots is wide: one of a square image then takes a gigabyte while it is drawn.
pub const MAX_COLUMNS: u32 = 16_384;
/// How many pixels a picture of dots is wide at first, as the command line draws stipples.
const COLUMNS: u32 = 1_600;
/// How many pixels an animation of dots is wide at first: half as many, since it has a hundred such pictures.
const ANIMATED_COLUMNS: u32 = 800;
/// The shortest time for a frame, in ms: viewers slow shorter ones down.
pub const MIN_DELAY_MS: u32 = 20;
/// The longest time for a frame, in ms. Chosen, not measured.
pub const MAX_DELAY_MS: u32 = 60_000;

/// A typed number of the sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NumberField {
    /// Pixels for a point of the window.
    Scale,
    /// Ticks of the clock from frame to frame.
    Every,
    /// Milliseconds for a frame.
    Delay,
    /// The width of a picture of dots, in pixels.
    Columns,
}

/// The export sheet as it is filled in.
#[derive(Clone, Debug, PartialEq)]
#[allow(
    clippy::struct_excessive_bools,
    reason = "independent switches of a form"
)]
pub struct ExportForm {
    /// The kind of export.
    pub kind: ExportKind,
    /// The file to write; its extension chooses the format.
    pub path: String,
    /// Number type of the coordinates, if the format leaves a choice.
    pub precision: Precision,
    /// Pixels for a point of the window, as typed.
    pub scale: String,
    /// Whether pictures are coloured for print instead of as in the window.
    pub print: bool,
    /// Whether a legend is below a picture.
    pub legend: bool,
    /// Whether the analysis of the moment is beside a picture.
    pub analysis: bool,
    /// The number of scenes.
    pub scenes: usize,
    /// Whether an animation shows the whole run instead of the stage shown or the loop.
    pub whole_run: bool,
    /// Whether an animation of a set in space shows the passage of the plane, instead of events.
    pub passage: bool,
    /// The clock that counts frames.
    pub clock: Clock,
    /// Ticks of the clock from frame to frame, as typed; empty until an animation is chosen.
    pub every: String,
    /// Milliseconds for a frame, as typed.
    pub delay: String,
    /// How a stipple is drawn.
    pub ink: InkForm,
    /// The width of a picture of dots in pixels, as typed.
    pub columns: String,
    /// An existing file, or certificate, that would be replaced.
    pub taken: Option<PathBuf>,
    /// Whether the user has been asked about replacing it.
    pub asked: bool,
}

impl Default for ExportForm {
    /// Returns a new sheet. The scenes are counted when it is opened, and the ticks are set when an animation is
    /// chosen.
    fn default() -> Self {
        Self {
            kind: ExportKind::Result,
            path: "tilescope.csv".to_owned(),
            precision: Precision::Double,
            scale: "1".to_owned(),
            print: false,
            legend: false,
            analysis: false,
            scenes: 0,
            whole_run: false,
            passage: false,
            clock: Clock::Event,
            every: String::new(),
            delay: "100".to_owned(),
            ink: InkForm::default(),
            columns: COLUMNS.to_string(),
            taken: None,
            asked: false,
        }
    }
}

impl ExportForm {
    /// Returns the file's path. A name without an extension gets the first one of its kind, as that of a session does.
    #[must_use]
    pub fn file(&self) -> PathBuf {
        let path = Path::new(self.path.trim());
        let ends_with_separator = self.path.trim().ends_with(std::path::is_separator);
        if path.extension().is_some() || path.file_name().is_none() || ends_with_separator {
            return path.to_owned();
        }
        path.with_extension(self.kind.extensions()[0])
    }

    /// Chooses the kind. The file's extension changes if the kind does, or if it is unknown.
    pub fn choose(&mut self, kind: ExportKind) {
        // Both kinds of samples have the same formats.
        let same = kind == self.kind || (kind.is_set() && self.kind.is_set());
        let fits = same && kind.format(&self.file()).is_some();
        if !fits && self.file().file_name().is_some() {
            let path = self.file().with_extension(kind.extensions()[0]);
            self.path = path.to_string_lossy().into_owned();
        }
        self.kind = kind;
        // A width that was typed stays.
        let [from, to] = match kind {
            ExportKind::Animation => [COLUMNS, ANIMATED_COLUMNS],
            _ => [ANIMATED_COLUMNS, COLUMNS],
        };
        if self.columns == from.to_string() {
            self.columns = to.to_string();
        }

        self.look();
        self.asked = false;
    }

    /// Notes whether the file exists already.
    pub fn look(&mut self) {
        self.taken = if self.path.trim().is_empty() {
            None
        } else {
            self.files().find(|file| file.symlink_metadata().is_ok())
        };
    }

    /// Returns the files that an export writes; none where a browser stores them.
    fn files(&self) -> impl Iterator<Item = PathBuf> {
        let file = self.file();
        let mut files = match self.kind {
            ExportKind::Scenes => (0..self.scenes)
                .map(|index| scene_path(&file, index, self.scenes))
                .collect(),
            _ => vec![file.clone()],
        };
        if self.kind.is_set() {
            files.push(tilescope_formats::certificate_path(&file));
        }
        // A page cannot see the files in the folder of downloads.
        files.retain(|_| cfg!(not(target_arch = "wasm32")));
        files.into_iter()
    }

    /// Returns why no file of this name can be written.
    #[must_use]
    pub fn name_refusal(&self) -> Option<ExportRefusal> {
        let file = self.file();
        if file.file_name().is_none() {
            Some(ExportRefusal::NoName)
        } else if self.kind.format(&file).is_none() {
            Some(ExportRefusal::Extension(self.kind.extensions()))
        } else {
            missing_folder(&file).map(ExportRefusal::NoFolder)
        }
    }

    /// Returns whether the scale applies; a vector picture has no pixels.
    #[must_use]
    pub fn has_scale(&self) -> bool {
        !self.kind.is_set() && !self.is_svg()
    }

    /// Returns whether a file of samples draws the dots of a stipple, in colours: of the formats only SVG does.
    #[must_use]
    pub fn draws_samples(&self) -> bool {
        self.kind.is_set() && self.is_svg()
    }

    fn is_svg(&self) -> bool {
        extension(&self.file()).as_deref() == Some("svg")
    }

    /// Returns the scale, or why the typed one is refused.
    pub fn scale(&self) -> Result<f64, ExportRefusal> {
        within(&self.scale, MIN_SCALE..=MAX_SCALE, ExportRefusal::Scale)
    }

    /// Returns the ticks from frame to frame.
    pub fn every(&self) -> Result<usize, ExportRefusal> {
        within(&self.every, 1..=MAX_EVERY, ExportRefusal::Every)
    }

    /// Returns whether a picture of dots has a width in pixels; a vector picture has none.
    #[must_use]
    pub fn has_columns(&self) -> bool {
        !self.is_svg()
    }

    /// Returns the width of a picture of dots. Where it has none, that of a new sheet, whatever is typed.
    pub fn columns(&self) -> Result<u32, ExportRefusal> {
        if !self.has_columns() {
            return Ok(COLUMNS);
        }
        within(&self.columns, 1..=MAX_COLUMNS, ExportRefusal::Columns)
    }

    /// Returns the hundredths of a second for a frame.
    pub fn delay(&self) -> Result<u16, ExportRefusal> {
        let delay = within(
            &self.delay,
            MIN_DELAY_MS..=MAX_DELAY_MS,
            ExportRefusal::Delay,
        )?;
        // Both kinds of animation count in hundredths of a second.
        Ok(((delay + 5) / 10) as u16)
    }
}

/// Returns the number in a text, if it is within limits.
fn within<T: FromStr + PartialOrd>(
    text: &str,
    limits: RangeInclusive<T>,
    refusal: fn(String) -> ExportRefusal,
) -> Result<T, ExportRefusal> {
    let number = text.trim().parse().ok();
    let allowed = number.filter(|number| limits.contains(number));
    allowed.ok_or_else(|| refusal(text.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extension_follows_the_kind() {
        let mut form = ExportForm {
            path: "first.set.ply".to_owned(),
            ..ExportForm::default()
        };
        for (kind, path) in [
            (ExportKind::Samples, "first.set.ply"),
            (ExportKind::Picture, "first.set.png"),
            (ExportKind::Scenes, "first.set.png"),
            (ExportKind::Animation, "first.set.gif"),
            (ExportKind::Result, "first.set.csv"),
            (ExportKind::Samples, "first.set.csv"),
        ] {
            form.choose(kind);
            assert_eq!(form.path, path);
            assert_eq!(form.name_refusal(), None);
        }
        form.kind = ExportKind::Animation;
        form.path = "film.SVG".to_owned();
        assert!(matches!(
            form.name_refusal(),
            Some(ExportRefusal::Extension(_))
        ));
        form.kind = ExportKind::Picture;
        form.choose(ExportKind::Picture);
        assert!(form.path == "film.SVG" && !form.has_scale());
        // Without an ending the name gets that of its kind, and in the list of formats it is not refused.
        form.path = "film".to_owned();
        assert_eq!(
            (form.file(), form.name_refusal()),
            ("film.png".into(), None)
        );
        form.path = "film.tar".to_owned();
        let refusal = form.name_refusal();
        assert!(matches!(refusal, Some(ExportRefusal::Extension(_))));
        form.path = "no such folder/film.png".to_owned();
        let refusal = form.name_refusal().map(|refusal| refusal.to_string());
        assert_eq!(
            refusal.as_deref(),
            Some("There is no folder \"no such folder\".")
        );
        form.path = "  ".to_owned();
        assert_eq!(form.name_refusal(), Some(ExportRefusal::NoName));
    }

    #[test]
    fn scenes_have_numbered_files() {
        let names = |count| {
            let path = |index| scene_path(Path::new("talks/intro.v2.png"), index, count);
            [0, count - 1].map(|index| path(index).to_string_lossy().into_owned())
        };
        assert_eq!(names(3), ["talks/intro.v2-1.png", "talks/intro.v2-3.png"]);
        assert_eq!(
            names(12),
            ["talks/intro.v2-01.png", "talks/intro.v2-12.png"]
        );
    }

    #[test]
    fn numbers_are_refused_by_value_and_limit() {
        let mut form = ExportForm::default();
        for text in ["0", "NaN", "1e9", "inf", "-1", "0.4999", "", "two"] {
            text.clone_into(&mut form.scale);
            let refusal = form.scale().unwrap_err().to_string();
            assert!(refusal.contains(&format!("\"{text}\"")), "{refusal}");
            assert!(refusal.contains("0.5 to 8"), "{refusal}");
        }
        for (text, scale) in [("0.5", 0.5), (" 8 ", 8.0), ("1.25", 1.25)] {
            text.clone_into(&mut form.scale);
            assert_eq!(form.scale(), Ok(scale));
        }
        for text in ["0", "-3", "1.5", "10000001", ""] {
            text.clone_into(&mut form.every);
            let refusal = form.every().unwrap_err().to_string();
            assert!(refusal.contains("1 to 10,000,000"), "{refusal}");
        }
        for text in ["0", "19", "60001", "NaN"] {
            text.clone_into(&mut form.delay);
            let refusal = form.delay().unwrap_err().to_string();
            assert!(refusal.contains("20 to 60,000"), "{refusal}");
        }
        for (text, hundredths) in [("20", 2), ("25", 3), ("60000", 6_000)] {
            text.clone_into(&mut form.delay);
            assert_eq!(form.delay(), Ok(hundredths));
        }
    }
}
