//! A run to look at: made and verified in the background, moment by moment, in words.
//!
//! Architecture invariant: nothing here knows a window. A [`Session`] is a finished run with its stages and events;
//! [`task`]s are the work in the background that makes, verifies and measures one, carried out by [`jobs`] natively and
//! by workers on a page; [`moment`] is the state at a cursor; [`sentence`] and [`words`] put it into English.

pub mod combination;
pub mod combining;
pub mod encoding;
pub mod geometry;
pub mod incoming;
pub mod index;
pub mod jobs;
pub mod layers;
pub mod limits;
pub mod look;
pub mod moment;
pub mod recipe;
pub mod sampling;
pub mod selection;
pub mod sentence;
pub mod session;
pub mod task;
pub mod units;
pub mod verification;
pub mod words;

pub use session::Session;
