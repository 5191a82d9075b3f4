//! The frames of an animation: which events of a range become frames, by the ticks of a clock.

use std::ops::Range;

use tilescope_debugger::Event;
use tilescope_session::session::Session;

use super::refusal::ExportRefusal;
use crate::clock::Clock;

/// The most frames of an animation. Chosen, not measured.
pub const MAX_FRAMES: usize = 600;
/// The approximate number of frames proposed for an animation. Chosen, not measured.
const AT_FIRST: usize = 120;

/// Everything that the number of frames depends on: the session's generation, the range, the clock and the ticks from frame
/// to frame.
pub type Key = (u64, Range<usize>, Clock, usize);

/// The number of frames for a key, or why there are none.
#[derive(Clone, Debug, PartialEq)]
pub struct Count {
    /// The inputs of the number.
    pub key: Key,
    /// The number of frames, or why there are none.
    pub frames: Result<usize, ExportRefusal>,
}

/// Returns the cursors of the frames: the start of `range`, every `every`-th tick in it, and its end. `every` is 1 or
/// more.
///
/// # Errors
///
/// [`ExportRefusal::NoEvents`], [`ExportRefusal::EmptyRange`] and, above [`MAX_FRAMES`], [`ExportRefusal::TooManyFrames`].
pub fn frames(
    session: &Session,
    range: &Range<usize>,
    clock: Clock,
    every: usize,
) -> Result<Vec<usize>, ExportRefusal> {
    let number_of_frames = count(session, range, clock, every)?;
    let range = &within(session, range)?;
    let mut cursors = Vec::with_capacity(number_of_frames);
    cursors.push(range.start);
    // The first frame after the start is that of tick number `every`, and the others follow at the same distance.
    let from_first = ticks(session, range, clock).skip(every - 1);
    cursors.extend(from_first.step_by(every));
    cursors.push(range.end);
    Ok(cursors)
}

/// Returns the number of frames that [`frames`] would return, or the same error.
pub fn count(
    session: &Session,
    range: &Range<usize>,
    clock: Clock,
    every: usize,
) -> Result<usize, ExportRefusal> {
    let range = within(session, range)?;
    let ticks = number_of_ticks(session, &range, clock);
    // The start and the end of the range are frames, too.
    let frames = ticks / every + 2;
    if frames > MAX_FRAMES {
        // The least number of ticks between frames that keeps the limit: ticks < enough * (MAX_FRAMES - 1), so that at
        // most MAX_FRAMES - 2 of them are frames.
        let enough = ticks / (MAX_FRAMES - 1) + 1;
        return Err(ExportRefusal::TooManyFrames { frames, enough });
    }

    Ok(frames)
}

/// Returns the part of a range within the run, or why there is none.
fn within(session: &Session, range: &Range<usize>) -> Result<Range<usize>, ExportRefusal> {
    let recording = session.recording().ok_or(ExportRefusal::NoEvents)?;
    // A range that begins at the end of the run or behind it is empty, too.
    let (start, end) = (range.start, range.end.min(recording.len()));

    if start >= end {
        return Err(ExportRefusal::EmptyRange { start, end });
    }
    Ok(start..end)
}

/// Returns the number of ticks between frames to propose.
pub(crate) fn every_at_first(session: &Session, range: &Range<usize>, clock: Clock) -> usize {
    number_of_ticks(session, range, clock) / AT_FIRST + 1
}

/// Returns the number of ticks inside a range.
fn number_of_ticks(session: &Session, range: &Range<usize>, clock: Clock) -> usize {
    match clock {
        Clock::Event => range.len().saturating_sub(1),
        _ => ticks(session, range, clock).count(),
    }
}

/// Returns the cursors strictly inside a range at which a tick of the clock ends.
fn ticks<'a>(
    session: &'a Session,
    range: &Range<usize>,
    clock: Clock,
) -> Box<dyn Iterator<Item = usize> + 'a> {
    // The start and the end of the range are no ticks: `frames` adds them itself.
    let inside = range.start + 1..range.end;
    let Some(recording) = session.recording() else {
        return Box::new(std::iter::empty());
    };

    match clock {
        Clock::Event => Box::new(inside),
        Clock::Line => {
            // The event at a cursor is the next one to happen. Where its line is not the line of the event before it, a tick ends.
            let mut line = recording.event(range.start).map(Event::line);
            let events = recording.tape().from(inside.start).take(inside.len());
            Box::new(events.filter_map(move |(cursor, event)| {
                let changes = line != Some(event.line());
                line = Some(event.line());
                changes.then_some(cursor)
            }))
        }
        // Passes of the GPU are at no cursors, so that their clock counts stages instead.
        Clock::Stage | Clock::Pass => {
            let ends = (0..session.stages.len()).filter_map(|index| session.stage_end(index));
            Box::new(ends.filter(move |end| inside.contains(end)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use tilescope_core::Parameters;
    use tilescope_session::jobs::Job;

    fn session() -> Session {
        let parameters = Parameters {
            radius: 0.03,
            leaf: 8.0,
            ..Parameters::default()
        };
        let wake: tilescope_session::jobs::Wake = Arc::new(|| {});
        let job = Job::start(&wake, move |monitor| {
            Session::sample(&parameters.into(), 1, monitor)
        });
        job.wait().unwrap().unwrap()
    }

    #[test]
    fn frames_begin_and_end_with_the_range_and_are_counted_right() {
        let session = session();
        let events = session.recording().unwrap().len();
        for clock in Clock::ALL {
            for every in [1, 2, 7, 100] {
                for range in [10..11, 10..12, 0..300, 100..events.min(700)] {
                    let Ok(frames) = frames(&session, &range, clock, every) else {
                        assert_eq!((clock, every), (Clock::Event, 1));
                        continue;
                    };
                    assert_eq!(frames.len(), count(&session, &range, clock, every).unwrap());
                    assert_eq!(
                        (frames[0], frames[frames.len() - 1]),
                        (range.start, range.end)
                    );
                    assert!(frames.windows(2).all(|pair| pair[0] < pair[1]));
                }
            }
        }
        assert_eq!(
            frames(&session, &(5..12), Clock::Event, 3),
            Ok(vec![5, 8, 11, 12])
        );
    }

    #[test]
    fn a_tick_of_a_line_ends_where_another_line_begins() {
        let session = session();
        let recording = session.recording().unwrap();
        let frames = frames(&session, &(0..900), Clock::Line, 1).unwrap();
        let line = |event: usize| recording.event(event).unwrap().line();
        for pair in frames.windows(2) {
            assert!((pair[0]..pair[1]).all(|event| line(event) == line(pair[0])));
            assert!(pair[1] == 900 || line(pair[1]) != line(pair[1] - 1));
        }
        let stages = super::frames(&session, &(0..recording.len()), Clock::Stage, 1).unwrap();
        assert!((session.stages.len()..session.stages.len() + 2).contains(&stages.len()));
    }

    #[test]
    fn empty_and_long_ranges_are_refused_and_the_proposal_is_accepted() {
        let session = session();
        let events = session.recording().unwrap().len();
        let refused = frames(&session, &(7..7), Clock::Event, 1).unwrap_err();
        assert_eq!(refused, ExportRefusal::EmptyRange { start: 7, end: 7 });
        // A range that goes on beyond the run ends with it.
        for clock in Clock::ALL {
            let beyond = frames(&session, &(events - 9..events + 9), clock, 1);
            assert_eq!(beyond, frames(&session, &(events - 9..events), clock, 1));
        }
        let all = 0..events;
        let Err(ExportRefusal::TooManyFrames { frames, enough }) =
            count(&session, &all, Clock::Event, 1)
        else {
            panic!("{events} events are more than {MAX_FRAMES}");
        };
        assert_eq!(frames, events + 1);
        assert!(count(&session, &all, Clock::Event, enough).unwrap() <= MAX_FRAMES);
        assert!(count(&session, &all, Clock::Event, enough - 1).is_err());
        for clock in Clock::ALL {
            let every = every_at_first(&session, &all, clock);
            assert!(count(&session, &all, clock, every).unwrap() <= AT_FIRST + 2);
        }
    }
}
