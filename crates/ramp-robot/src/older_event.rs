//! Events of older results and agents: a kind in one word, and the rest as text.

use ramp_source::to_name;

use crate::action::Action;
use crate::cause::Cause;
use crate::event::{EventKind, Retry};
use crate::fault::Fault;

/// The kinds of older events.
pub const OLDER_KINDS: [&str; 10] =
    ["start", "done", "fault", "retry", "search", "replan", "seen", "diagnosis", "motion", "clipped"];

impl EventKind {
    /// From the word and the text of an older event: those of results up to `ramp-episode-3` and
    /// `ramp-manipulation-2`. Text that fits no kind becomes a note.
    ///
    /// ```
    /// use ramp_robot::{Cause, EventKind};
    /// let begun = EventKind::of_words("start", "pick up b4 by b4l1");
    /// assert!(matches!(&begun, EventKind::ActionBegun(action) if action.kind == "pick_up"));
    /// assert_eq!(begun.to_string(), "pick up b4 by b4l1");
    /// let jam = EventKind::of_words("diagnosis", "jam: b4 stands still at 25 N");
    /// assert!(matches!(jam, EventKind::Diagnosis { cause: Cause::Jam, .. }));
    /// ```
    pub fn of_words(kind: &str, text: &str) -> EventKind {
        let note = || EventKind::Note { text: text.to_string() };
        match kind {
            "start" => EventKind::ActionBegun(action(text)),
            "done" => EventKind::ActionEnded(action(text)),
            "fault" => EventKind::Fault(Fault::Other { why: text.to_string() }),
            "retry" => EventKind::Retry(Retry { step: text.to_string(), ..Retry::default() }),
            "replan" => {
                let coarse = text.split(' ').next().and_then(|number| number.parse().ok());
                coarse.map_or_else(note, |coarse| EventKind::Replan { coarse })
            }
            "diagnosis" => {
                let told = text.split_once(':');
                let cause = told.and_then(|(word, rest)| Some((Cause::named(word.trim())?, rest.trim())));
                cause.map_or_else(note, |(cause, evidence)| EventKind::Diagnosis {
                    cause,
                    part: None,
                    evidence: evidence.to_string(),
                })
            }
            "clipped" => EventKind::Clipped {},
            _ => note(),
        }
    }
}

/// An action in words; one that no plan has is named after its words.
fn action(words: &str) -> Action {
    Action::from_words(words).unwrap_or_else(|| Action::new(&to_name(&words.replace(' ', "_"))))
}
