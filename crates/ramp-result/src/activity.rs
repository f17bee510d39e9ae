//! Robot time by activity, from the actions that a result's events report.

use ramp_robot::{Action, EventKind};

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
    /// Actions of other kinds.
    Other,
    /// Not reported: looking, waiting, or an agent that reports no events.
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

    /// The activity of an action, by its kind; of no action, [`Activity::Untold`].
    fn of(action: Option<&Action>) -> Activity {
        let Some(action) = action else { return Activity::Untold };
        match action.kind.as_str() {
            "move" => Activity::Moving,
            "pick_up" | "put_down" | "lay_down" | "regrasp" => Activity::Gripping,
            "slide" | "push" => Activity::Inserting,
            kind if kind.starts_with("assemble_") => Activity::Inserting,
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
    /// The activity.
    pub activity: Activity,
    /// The action; `None` between actions.
    pub action: Option<&'r Action>,
}

/// The whole robot time of an episode, cut into spans without gaps. An action begins with the event
/// `action_begun` and ends with `action_ended` of the same action, or else where the next one begins, a new
/// plan is made, or the episode ends.
pub fn spans(result: &EpisodeResult) -> Vec<Span<'_>> {
    let end = result.time.robot;
    let mut spans: Vec<Span> = Vec::new();
    let mut push = |from: f64, to: f64, action| {
        if to > from {
            spans.push(Span { from, to, activity: Activity::of(action), action });
        }
    };
    // The end of the last span, and the action that is under way.
    let mut told = 0.0;
    let mut open: Option<&Action> = None;
    for event in &result.events {
        // An agent's clock may run past the end, or back.
        let t = event.time.clamp(told, end);
        let next = match (&event.kind, open) {
            (EventKind::ActionBegun(action), _) => Some(action),
            (EventKind::Replan { .. }, Some(_)) => None,
            (EventKind::ActionEnded(ended), Some(action)) if ended == action => None,
            _ => continue,
        };
        push(told, t, open);
        told = t;
        open = next;
    }
    push(told, end, open);
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
    use crate::testing::episode;
    use ramp_robot::{Event, Fault, Retry};

    fn told(events: Vec<(f64, EventKind)>, robot: f64) -> EpisodeResult {
        let mut result = episode("easy-1", 1, &[], 3);
        result.time.robot = robot;
        result.events = events.into_iter().map(|(t, kind)| Event::new(t, kind)).collect();
        result
    }

    #[test]
    fn every_second_is_told_once() {
        let (insert, carry) = (Action::new("assemble_square").with("beam", "b4"), Action::new("move"));
        let fault = Fault::Jammed { part: "b4".into(), remaining: 3e-3, force: 25.0 };
        let result = told(
            vec![
                (1.0, EventKind::ActionBegun(carry.clone())),
                (3.0, EventKind::ActionEnded(carry)),
                (4.0, EventKind::ActionBegun(insert)),
                (4.5, Retry::new("insert", "b4").attempt(2).into()),
                (6.0, fault.into()),
                (6.5, EventKind::Replan { coarse: 12 }),
                (7.0, EventKind::ActionBegun(Action::new("fasten"))),
            ],
            10.0,
        );
        assert_eq!(times(&result), [2.0, 0.0, 2.5, 3.0, 0.0, 2.5]);
        let spans = spans(&result);
        assert!(spans.windows(2).all(|pair| pair[0].to == pair[1].from));
    }

    #[test]
    fn nonsense_of_an_agent_does_no_harm() {
        let dance = Action::new("dance");
        let result = told(
            vec![
                (50.0, EventKind::ActionBegun(dance.clone())),
                (2.0, EventKind::ActionEnded(dance)),
                (3.0, EventKind::ActionEnded(Action::default())),
                (1e7, EventKind::ActionBegun(Action::default())),
            ],
            10.0,
        );
        assert_eq!(times(&result).iter().sum::<f64>(), 10.0);
        assert_eq!(times(&told(Vec::new(), 10.0)), [0.0, 0.0, 0.0, 0.0, 0.0, 10.0]);
    }
}
