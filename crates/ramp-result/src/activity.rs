//! Where a robot's time went, as far as the events of a result tell: what was done from when to when.

use crate::episode::EpisodeResult;

/// A kind of work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Activity {
    /// From place to place, in the open.
    Moving,
    /// Picking parts up and putting them down.
    Gripping,
    /// Beams going to their places: inserting, capping, sliding, pushing.
    Inserting,
    /// Pegs going into their holes.
    Fastening,
    /// Actions that are called something else.
    Other,
    /// Not told: looking, waiting, or an agent that gives no events.
    Untold,
}

impl Activity {
    /// All, in the order of tables.
    pub const ALL: [Activity; 6] = [
        Activity::Moving,
        Activity::Gripping,
        Activity::Inserting,
        Activity::Fastening,
        Activity::Other,
        Activity::Untold,
    ];

    /// In one or two words.
    pub fn name(self) -> &'static str {
        match self {
            Activity::Moving => "moving",
            Activity::Gripping => "gripping",
            Activity::Inserting => "inserting beams",
            Activity::Fastening => "fastening pegs",
            Activity::Other => "other actions",
            Activity::Untold => "between actions",
        }
    }

    /// By the first word of an action.
    fn of(action: &str) -> Activity {
        match action.split_whitespace().next().unwrap_or_default() {
            "move" => Activity::Moving,
            "pick" | "put" | "lay" | "regrasp" => Activity::Gripping,
            "insert" | "slide" | "cap" | "push" => Activity::Inserting,
            "fasten" => Activity::Fastening,
            _ => Activity::Other,
        }
    }
}

/// A stretch of an episode.
#[derive(Clone, Debug, PartialEq)]
pub struct Span<'r> {
    /// Robot time of its begin, s.
    pub from: f64,
    /// Robot time of its end, s.
    pub to: f64,
    /// What it was.
    pub activity: Activity,
    /// The action, in the agent's words; empty between actions.
    pub what: &'r str,
}

/// The whole robot time of an episode, cut into stretches without gaps. An action begins with the
/// event `start` and ends with `done` of the same words, or else where the next one starts, a new
/// plan is made, or the episode ends.
pub fn spans(result: &EpisodeResult) -> Vec<Span<'_>> {
    let end = result.time.robot;
    let mut spans: Vec<Span> = Vec::new();
    let mut push = |from: f64, to: f64, activity, what| {
        if to > from {
            spans.push(Span { from, to, activity, what });
        }
    };
    // From where on nothing is told yet, and the action that is being done.
    let mut told = 0.0;
    let mut open: Option<&str> = None;
    for event in &result.events {
        // An agent's clock may run past the end, or back.
        let t = event.t.clamp(told, end);
        let ends = match (event.kind.as_str(), open) {
            ("start", _) | ("replan", Some(_)) => true,
            ("done", Some(action)) => action == event.what,
            _ => false,
        };
        if !ends {
            continue;
        }
        push(told, t, open.map_or(Activity::Untold, Activity::of), open.unwrap_or_default());
        told = t;
        open = (event.kind == "start").then_some(event.what.as_str());
    }
    push(told, end, open.map_or(Activity::Untold, Activity::of), open.unwrap_or_default());
    spans
}

/// Robot time of each activity, in the order of [`Activity::ALL`], s.
pub fn times(result: &EpisodeResult) -> [f64; Activity::ALL.len()] {
    let mut times = [0.0; Activity::ALL.len()];
    for span in spans(result) {
        times[span.activity as usize] += span.to - span.from;
    }
    times
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::episode::EventInfo;
    use crate::testing::episode;

    fn told(events: &[(f64, &str, &str)], robot: f64) -> EpisodeResult {
        let mut result = episode("easy-1", 1, &[], 3);
        result.time.robot = robot;
        result.events = events
            .iter()
            .map(|(t, kind, what)| EventInfo { t: *t, kind: (*kind).into(), what: (*what).into() })
            .collect();
        result
    }

    #[test]
    fn every_second_is_told_once() {
        let result = told(
            &[
                (1.0, "start", "move to the start of b4"),
                (3.0, "done", "move to the start of b4"),
                (4.0, "start", "insert b4 by b4j1"),
                (4.5, "retry", "insert b4, try 2"),
                (6.0, "fault", "b4 jams"),
                (6.5, "replan", "12 coarse actions"),
                (7.0, "start", "fasten C1 with p1"),
            ],
            10.0,
        );
        assert_eq!(times(&result), [2.0, 0.0, 2.5, 3.0, 0.0, 2.5]);
        let spans = spans(&result);
        assert!(spans.windows(2).all(|pair| pair[0].to == pair[1].from));
    }

    #[test]
    fn nonsense_of_an_agent_does_no_harm() {
        let result = told(
            &[(50.0, "start", "dance"), (2.0, "done", "dance"), (3.0, "done", ""), (1e7, "start", "")],
            10.0,
        );
        assert_eq!(times(&result).iter().sum::<f64>(), 10.0);
        assert_eq!(times(&told(&[], 10.0)), [0.0, 0.0, 0.0, 0.0, 0.0, 10.0]);
    }
}
