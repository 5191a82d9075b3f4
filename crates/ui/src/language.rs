//! The language of the window's texts, for widgets: [`speak`] sets it, [`Worded::words`] gives a text in it.

use std::hash::{Hash, Hasher};

use egui::cache::{ComputerMut, FrameCache};
use egui::{Context, Id, Ui};
use tilescope_session::language::Language;

fn id() -> Id {
    Id::unique("language of the window")
}

/// Sets the language of the texts that are shown from now on; `None` is English.
pub fn speak(ctx: &Context, language: Option<&'static Language>) {
    ctx.data_mut(|data| data.insert_temp(id(), language));
}

/// Where texts are shown in the language of the window.
pub trait Worded {
    /// Returns the text to show for an English one. It takes the lock of the context: a closure that egui calls under that
    /// lock, such as the one of `widget_info`, gets the text from outside.
    fn words(&self, english: impl AsRef<str>) -> String;
}

impl Worded for Context {
    fn words(&self, english: impl AsRef<str>) -> String {
        let language: Option<&'static Language> = self.data(|data| data.get_temp(id())).flatten();
        let english = english.as_ref();
        let Some(language) = language else {
            return english.to_owned();
        };

        let wanted = Wanted { language, english };
        self.memory_mut(|memory| memory.caches.cache::<Texts>().get(wanted).clone())
    }
}

impl Worded for Ui {
    fn words(&self, english: impl AsRef<str>) -> String {
        self.ctx().words(english)
    }
}

/// The texts of the last frame: a frame shows nearly the same ones, and to look for one takes up to a twentieth of a
/// millisecond.
type Texts = FrameCache<String, Search>;

/// An English text that is wanted in a language.
#[derive(Clone, Copy)]
struct Wanted<'a> {
    language: &'static Language,
    english: &'a str,
}

impl Hash for Wanted<'_> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        // Each language is in memory once, so that its address identifies it.
        std::ptr::hash(self.language, state);
        self.english.hash(state);
    }
}

#[derive(Default)]
struct Search;

impl ComputerMut<Wanted<'_>, String> for Search {
    fn compute(&mut self, wanted: Wanted<'_>) -> String {
        wanted.language.text(wanted.english)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_follow_the_language_of_the_window() {
        let ctx = Context::default();
        assert_eq!(ctx.words("Next"), "Next");
        let german = Language::of("de").unwrap();
        for _ in 0..2 {
            speak(&ctx, Some(german));
            assert_eq!(ctx.words("Next"), german.text("Next"));
            assert_ne!(ctx.words("Next"), "Next");
            speak(&ctx, None);
            assert_eq!(ctx.words("Next"), "Next");
        }
    }
}
