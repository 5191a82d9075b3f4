//! How a stipple is drawn, as the export sheet has it: colours of paper and ink as typed, and how large dots are.

use tilescope_sets::{StippleLook, color_of};

use super::refusal::ExportRefusal;

/// A change of how a stipple is drawn.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum InkCommand {
    /// Draws a picture as dots of ink on paper, instead of as in the window.
    OnPaper,
    /// Types the colour of the paper; nothing for that of the tone.
    Paper(String),
    /// Types the colour of the ink; nothing for that of the tone.
    Color(String),
    /// Chooses whether dots are the larger the darker the image is.
    ByDarkness(bool),
}

/// How a stipple is drawn, as filled in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InkForm {
    /// Whether pictures have dots of ink on paper, instead of the view of the window.
    pub on_paper: bool,
    /// The colour of the paper, as typed: if empty white, or black where the tone is inverted.
    pub paper: String,
    /// The colour of the ink, as typed: if empty the other one.
    pub color: String,
    /// Whether dots are the larger the darker the image is; otherwise all are equal.
    pub by_darkness: bool,
}

impl Default for InkForm {
    fn default() -> Self {
        Self {
            // Of a stipple one wants the dots first.
            on_paper: true,
            paper: String::new(),
            color: String::new(),
            by_darkness: false,
        }
    }
}

impl InkForm {
    /// Changes it.
    pub(crate) fn apply(&mut self, command: InkCommand) {
        match command {
            InkCommand::OnPaper => self.on_paper = true,
            InkCommand::Paper(text) => self.paper = text,
            InkCommand::Color(text) => self.color = text,
            InkCommand::ByDarkness(by_darkness) => self.by_darkness = by_darkness,
        }
    }

    /// Returns how pictures show a stipple that is drawn as ink on paper, or why a typed colour is refused.
    pub fn look(&self) -> Result<StippleLook, ExportRefusal> {
        let color = |text: &str| match text.trim() {
            "" => Ok(None),
            typed => match color_of(typed) {
                Ok(color) => Ok(Some(color)),
                Err(_) => Err(ExportRefusal::Color(text.to_owned())),
            },
        };
        Ok(StippleLook {
            paper: color(&self.paper)?,
            ink: color(&self.color)?,
            by_darkness: self.by_darkness,
            // The form has no field for it: dots have as much ink as the image is dark.
            dot_radius: None,
        })
    }
}
