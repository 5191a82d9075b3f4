//! A run for display: made and verified in the background, with its moments and their description in words.
//!
//! It does not depend on a window. Begin with [`Session`], a finished run with its stages and events; [`sampling`] makes one.
//! [`task`]s are the work in the background that makes, verifies and measures one, carried out by [`jobs`] natively and by
//! workers on a page; [`moment`] is the state at a cursor; [`sentence`] and [`words`] put it into English, and [`glossary`]
//! defines the terms.
//! Positions in r are [`glam::DVec2`]; sets in user units are plain `[f64; 2]`.
//!
//! ```
//! use tilescope_core::{Parameters, Stage};
//! use tilescope_session::{Session, jobs::Monitor, moment::Moment, recipe::Recipe, sentence::stage_sentence};
//!
//! let parameters = Parameters { radius: 0.03, leaf: 10.0, ..Parameters::default() };
//! let session = Session::sample(&Recipe::from(parameters), 1, &Monitor::reporting(|_, _| {}))?;
//! let tiled = Moment::after(&session, session.stage_index(Stage::Tile));
//! assert!(tiled.samples(&session).len() > session.summary.count);
//! assert!(stage_sentence(&session, Stage::Tile).starts_with("Tile: "));
//! # Ok::<(), tilescope_core::SampleError>(())
//! ```

pub mod combination;
pub mod combining;
pub mod draft;
pub mod encoding;
pub mod geometry;
pub mod glossary;
pub mod ground;
pub mod incoming;
pub mod index;
pub mod jobs;
pub mod language;
pub mod layers;
pub mod limits;
pub mod look;
pub mod moment;
pub mod nested;
pub mod nesting;
pub mod octaves;
pub mod packing;
pub mod page_folder;
pub mod recipe;
pub mod sampling;
pub mod selection;
pub mod sentence;
pub mod session;
pub mod solid;
pub mod stipple;
pub mod stippling;
pub mod task;
pub mod typed;
pub mod units;
pub mod varying;
pub mod verification;
pub mod words;

pub use session::Session;
