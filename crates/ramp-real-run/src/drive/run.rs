//! The subject of a run over the wire.

use ramp_assembly::Assembly;
use ramp_result::episode::{RobotKind, Software};
use ramp_robot::Track;
use ramp_robot::arm::ArmModel;

use super::guard::Workspace;

/// The subject of a run: goal, arm, robot and people.
pub struct Run<'a> {
    /// The goal.
    pub assembly: &'a Assembly,
    /// The arm.
    pub arm: &'a ArmModel,
    /// The arm as its agent is told of it: with the largest velocities that are allowed here.
    pub told: &'a ArmModel,
    /// The track.
    pub track: Track,
    /// The number of the run in a row of repeats, from 1. It feeds random numbers of motions, too.
    pub repeat: u32,
    /// The kind of robot, and with it the clock.
    pub kind: RobotKind,
    /// The robot, in words.
    pub robot: &'a str,
    /// Who answers for the run.
    pub scorer: &'a str,
    /// Where it is done.
    pub source: &'a str,
    /// With what it is run.
    pub software: &'a Software,
    /// Whether the images that are taken go into the log.
    pub images: bool,
    /// The workspace.
    pub workspace: &'a Workspace,
}
