//! Knowledge of an agent on its track as a skill begins.

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_kit::{Beam, Pose};
use ramp_robot::{DOF, GripperCommand};
use ramp_skills::SkillError;
use ramp_skills::cell::Workcell;
use ramp_skills::grasp::{PEG_MASS, beam_centre, peg_centre, yaw_of};
use ramp_skills::rehearsal::Scene;
use ramp_skills::skill::{ActionKind, Call};

/// A part between the fingers, as far as the agent knows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Held {
    /// Its name.
    pub part: String,
    /// Its frame in the tip's frame.
    pub x_tp: Pose,
    /// kg.
    pub mass: f64,
    /// Centre of mass in the part's frame, m.
    pub p_centre: Point3<f64>,
}

/// Knowledge of an agent on its track as a skill begins.
#[derive(Clone, Debug, PartialEq)]
pub struct Known {
    /// The held part.
    pub held: Option<Held>,
    /// The part that the task works on.
    pub part: String,
    /// Its believed pose, in the world.
    pub x_wp: Pose,
    /// Its goal pose, in the world.
    pub x_goal: Pose,
    /// The last command of the gripper.
    pub gripper: GripperCommand,
    /// Joint positions, rad.
    pub posture: [f64; DOF],
}

impl Known {
    /// The baseline's belief as a skill begins.
    ///
    /// # Errors
    /// When a part was never seen, or the action has no part.
    pub fn of(cell: &Workcell, call: &Call) -> Result<Known, SkillError> {
        let part = call.part().ok_or_else(|| call.no_skill())?.to_string();
        let x_wp = cell.hand.x_wp_held().map_or_else(|| cell.belief.parts.pose(&part), Ok)?;
        let x_goal = match call.kind() {
            // Its head on the plate, turned as it is.
            ActionKind::Fasten => {
                let x = x_wp.rotation * Vector3::x();
                let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), x.y.atan2(x.x));
                Pose::from_parts(Translation3::from(cell.belief.mouth(call.connection(cell.assembly)?)?), yaw)
            }
            ActionKind::AssembleDeep => {
                let beam = call.beam(cell.assembly)?;
                let path = cell.belief.path(beam)?;
                let deeper = cell.kit.x_wa().rotation * path.direction * path.depth;
                Translation3::from(deeper) * cell.belief.target(beam)?
            }
            ActionKind::Move | ActionKind::PickUp | ActionKind::PutDown | ActionKind::Regrasp => x_wp,
            _ => cell.belief.target(call.beam(cell.assembly)?)?,
        };
        let held = cell.hand.held.as_ref().map(|held| Held {
            part: held.part.clone(),
            x_tp: held.x_tp,
            mass: held.mass,
            p_centre: held.p_centre,
        });
        let seen = &cell.hand.seen;
        Ok(Known { held, part, x_wp, x_goal, gripper: cell.hand.gripper, posture: seen.positions })
    }

    /// The expectation in a rehearsal, where the plan has come so far; `None` when a part was never seen, or
    /// the action has no part.
    pub fn expected(scene: &Scene, call: &Call) -> Option<Known> {
        let part = call.part()?.to_string();
        let x_wt = scene.x_wt();
        let x_wp = scene.holds(&part).map_or_else(|| scene.x_wp(&part), |held| Some(x_wt * held.x_tp))?;
        let x_goal = match call.kind() {
            ActionKind::Fasten => {
                let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw_of(&x_wp));
                let seated = scene.x_wp_seated(call.connection(scene.assembly).ok()?);
                Pose::from_parts(seated.translation, yaw)
            }
            kind => {
                let beam = call.beam(scene.assembly).ok()?;
                let path = scene.paths.get(&beam).filter(|_| kind == ActionKind::AssembleDeep);
                scene.x_wb_goal(beam, path.map_or(0.0, |path| path.depth))
            }
        };
        let held = scene.now.held.as_ref().map(|held| {
            let beam = scene.kit.beam(&held.part);
            Held {
                part: held.part.clone(),
                x_tp: held.x_tp,
                mass: beam.map_or(PEG_MASS, Beam::mass),
                p_centre: beam.map_or_else(peg_centre, beam_centre),
            }
        });
        let width = held.as_ref().map_or(scene.parameters.grip.beam_open, |held| scene.width(&held.part));
        let gripper = GripperCommand { width, force: scene.parameters.grip.force };
        Some(Known { held, part, x_wp, x_goal, gripper, posture: scene.now.q.into() })
    }
}
