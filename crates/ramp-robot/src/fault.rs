//! The faults that an agent notices.

use serde::{Deserialize, Serialize};

/// Something that is not as it should be; the agent tries again, plans again or gives up.
///
/// In JSON the field `fault` names the kind. Lengths are in m, forces in N.
#[derive(Clone, Debug, PartialEq, thiserror::Error, Serialize, Deserialize)]
#[serde(tag = "fault", rename_all = "snake_case", deny_unknown_fields)]
pub enum Fault {
    /// The part is not between the fingers.
    #[error("{part} is not in the hand")]
    NotHeld {
        /// Its name.
        part: String,
    },
    /// An insertion met more force than its limit before the beam was seated.
    #[error("{part} jams {:.1} mm before its place at {force:.1} N", .remaining * 1e3)]
    Jammed {
        /// Its name.
        part: String,
        /// Distance to its place, m.
        remaining: f64,
        /// N.
        force: f64,
    },
    /// A motion met more force than any motion should, and was stopped.
    #[error("the hand meets {force:.0} N, and yields")]
    Overload {
        /// N.
        force: f64,
    },
    /// Two holes that should coincide do not.
    #[error("the holes of {connection} are {:.2} mm apart", .offset * 1e3)]
    Misaligned {
        /// The connection.
        connection: String,
        /// m.
        offset: f64,
    },
    /// A beam of the assembly does not reach its place.
    #[error("{part} stands {:.2} mm off its place", .offset * 1e3)]
    OffPlace {
        /// The beam.
        part: String,
        /// m.
        offset: f64,
    },
    /// The search for a hole ended without finding it.
    #[error("{peg} finds no hole at {connection}")]
    HoleNotFound {
        /// The peg.
        peg: String,
        /// The connection.
        connection: String,
    },
    /// A peg is not flush with the plate.
    #[error("{peg} is not flush at {connection}: {:.2} mm", .gap * 1e3)]
    NotSeated {
        /// The peg.
        peg: String,
        /// The connection.
        connection: String,
        /// m.
        gap: f64,
    },
    /// The pose of a part is unknown.
    #[error("{part} was not detected")]
    Unseen {
        /// Its name.
        part: String,
    },
    /// A peg lies where it cannot be fetched.
    #[error("{peg} is lost")]
    Lost {
        /// The peg.
        peg: String,
    },
    /// The plan names something that the goal does not have, or an action that has no skill.
    #[error("there is no skill for `{action}` here")]
    NoSkill {
        /// The action.
        action: String,
    },
    /// A condition that a skill needs does not hold.
    #[error("`{action}` cannot begin: {need} does not hold")]
    NotReady {
        /// The action.
        action: String,
        /// The condition.
        need: String,
    },
    /// A skill ended without the effect that it promises.
    #[error("`{action}` has ended, but {effect} does not hold")]
    Unmet {
        /// The action.
        action: String,
        /// The effect.
        effect: String,
    },
    /// A skill that replaces one of the baseline's has given up.
    #[error("{skill}: {why}")]
    #[serde(rename = "skill_gave_up")]
    Own {
        /// The skill's name.
        skill: String,
        /// Its own words.
        why: String,
    },
    /// The plan has no insertion path for the part.
    #[error("the plan has no insertion path for {part}")]
    NoPath {
        /// Its name.
        part: String,
    },
    /// No grasp of the part can be reached both at its start and at its goal.
    #[error("no reachable grasp for {part}")]
    NoGrasp {
        /// Its name.
        part: String,
    },
    /// The motion planner found no motion.
    #[error("{why}")]
    NoMotion {
        /// The reason.
        why: String,
    },
    /// The robot refused a call or stopped.
    #[error("{why}")]
    Robot {
        /// The robot's reason.
        why: String,
    },
    /// The images cannot be relied on.
    #[error("{why}")]
    Sight {
        /// The oddity in them.
        why: String,
    },
    /// The agent ends its work.
    #[error("{why}")]
    GaveUp {
        /// The reason.
        why: String,
    },
    /// Anything else.
    #[error("{why}")]
    Other {
        /// In words.
        why: String,
    },
}
