//! Lessons and talks in a window, without the window: the lesson that is open, the answer that is being put together, results,
//! presenter mode with votes and pen, handouts, and all of it as JSON for pages.
//!
//! Begin with [`Classroom`]: it applies the commands of lessons ([`lessons::LessonCommand`]) and talks
//! ([`talk::TalkCommand`]) to itself, and asks the window for everything else by [`Effect`]s. The crate `tilescope-lessons`
//! reads lessons, asks questions and grades answers.

pub mod graded;
pub mod handout;
pub mod lesson_labels;
pub mod lesson_picture;
pub mod lesson_set;
pub mod lessons;
pub mod pen;
pub mod room;
pub mod talk;

pub use room::{Classroom, Context, Effect};
