//! Checks that an agent kept to its track: its requests, and that it saw before it built.

use ramp_robot::{RobotError, Track};

/// A violation of the track: an action that it does not allow or does not make possible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Breach {
    /// It asked for what its track does not give. The robot refused it.
    #[error("at {time:.3} s the agent requested {what}, not available on track `{}`", track.name())]
    Forbidden {
        /// The track.
        track: Track,
        /// The request.
        what: &'static str,
        /// Robot time, s.
        time: f64,
    },
    /// A peg, or a part that was put back, counts, and the agent had seen nothing before.
    #[error(
        "a peg or a part counts from {time:.3} s on, and the agent never got {what} before, which is all that track `{}` shows of \
         the parts",
        track.name()
    )]
    NeverLooked {
        /// The track.
        track: Track,
        /// The missing request.
        what: &'static str,
        /// Robot time since which the first one counts, s.
        time: f64,
    },
}

/// The requests of an agent up to now.
#[derive(Clone, Debug, Default)]
pub(crate) struct Conduct {
    /// The first thing that was refused because of the track, and when.
    forbidden: Option<(f64, &'static str)>,
    /// When the first image was given.
    image: Option<f64>,
    /// When the parts were first read.
    reading: Option<f64>,
}

impl Conduct {
    /// An image was asked for; `time` is robot time after it, s.
    pub(crate) fn looked<T>(&mut self, time: f64, answer: &Result<T, RobotError>) {
        Conduct::note(&mut self.image, &mut self.forbidden, time, answer);
    }

    /// The shutters were opened; `time` is robot time, s. That shows nothing yet.
    pub(crate) fn exposed(&mut self, time: f64, answer: &Result<(), RobotError>) {
        Conduct::note(&mut None, &mut self.forbidden, time, answer);
    }

    /// The parts were read; `time` is robot time after it, s.
    pub(crate) fn read<T>(&mut self, time: f64, answer: &Result<T, RobotError>) {
        Conduct::note(&mut self.reading, &mut self.forbidden, time, answer);
    }

    fn note<T>(
        given: &mut Option<f64>,
        forbidden: &mut Option<(f64, &'static str)>,
        time: f64,
        answer: &Result<T, RobotError>,
    ) {
        match answer {
            Ok(_) => {
                given.get_or_insert(time);
            }
            Err(RobotError::NotOnTrack { what, .. }) => {
                forbidden.get_or_insert((time, what));
            }
            Err(_) => {}
        }
    }

    /// The violations, given the track and the robot time (s) since which the first peg or part counts that
    /// the agent has brought there.
    pub(crate) fn breach(&self, track: Track, first: Option<f64>) -> Option<Breach> {
        if let Some((time, what)) = self.forbidden {
            return Some(Breach::Forbidden { track, what, time });
        }
        let (seen, what) = match track {
            Track::State => return None,
            Track::Noisy => (self.reading, "a reading of the parts"),
            Track::Tags | Track::Colour | Track::Depth => (self.image, "an image"),
        };
        let first = first?;
        let blind = seen.is_none_or(|seen| seen > first);
        blind.then_some(Breach::NeverLooked { track, what, time: first })
    }
}
