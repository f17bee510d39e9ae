//! What can go wrong while a skill runs.

use ramp_motion::MotionError;
use ramp_robot::RobotError;

/// Something a skill noticed that is not as it should be; the agent tries again or plans again.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// The part is not between the fingers.
    #[error("{part} is not in the hand")]
    NotHeld {
        /// Its name.
        part: String,
    },
    /// An insertion met more force than it may before the beam was seated.
    #[error("{part} jams {remaining_mm:.1} mm before its place at {force:.1} N")]
    Jammed {
        /// Its name.
        part: String,
        /// mm.
        remaining_mm: f64,
        /// N.
        force: f64,
    },
    /// A motion met more force than it ever should, and was broken off.
    #[error("the hand meets {force:.0} N, and yields")]
    Overload {
        /// N.
        force: f64,
    },
    /// Two holes that should coincide do not.
    #[error("the holes of {connection} are {offset_mm:.2} mm apart")]
    Misaligned {
        /// The connection.
        connection: String,
        /// mm.
        offset_mm: f64,
    },
    /// A beam of the assembly that does not reach its place.
    #[error("{part} stands {offset_mm:.2} mm off its place")]
    OffPlace {
        /// The beam.
        part: String,
        /// mm.
        offset_mm: f64,
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
    #[error("{peg} is not flush at {connection}: {gap_mm:.2} mm")]
    NotSeated {
        /// The peg.
        peg: String,
        /// The connection.
        connection: String,
        /// mm.
        gap_mm: f64,
    },
    /// Nothing is known about where a part is.
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
    /// What a skill needs does not hold.
    #[error("`{action}` cannot begin: {need} does not hold")]
    NotReady {
        /// The action.
        action: String,
        /// What must hold.
        need: String,
    },
    /// A skill ended without what it promises.
    #[error("`{action}` has ended, but {effect} does not hold")]
    Unmet {
        /// The action.
        action: String,
        /// What should hold.
        effect: String,
    },
    /// A skill of somebody's own has given up.
    #[error("{skill}: {why}")]
    Own {
        /// The skill's name.
        skill: String,
        /// What it says.
        why: String,
    },
    /// The plan does not say how the part gets to its place.
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
}

/// Why a skill ended early.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SkillError {
    /// The robot stopped; nothing more can be done.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// No motion was found.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// Something went wrong that a retry or a new plan may repair.
    #[error(transparent)]
    Fault(#[from] Fault),
}
