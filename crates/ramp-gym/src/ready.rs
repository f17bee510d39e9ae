//! The moment at which a skill begins: the baseline does what comes before it, and stops there.
//!
//! A task of `ramp trials` begins with the arm at home. Most of its time is fetching and carrying. Here the baseline does
//! that part: the peg is in the hand over its hole, the beam is where its insertion begins. What the baseline then
//! believes is kept beside the state of the twin, since that is what an agent on its track can know.

use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_abilities::manipulation::Aim;
use ramp_kit::Pose;
use ramp_robot::{Agent, DOF, GripperCommand};
use ramp_skills::cell::Workcell;
use ramp_skills::skill::{ActionKind, Call, Effect, Need, Skill};
use ramp_skills::{Baseline, Fault, Piece, SkillError, SkillTable};
use ramp_twin::{Setup, Twin};

use crate::benchmark::Benchmark;
use crate::tasks::Step;

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

/// What an agent on its track knows at the start.
#[derive(Clone, Debug, PartialEq)]
pub struct Known {
    /// What is in the hand.
    pub held: Option<Held>,
    /// The part that the task works on.
    pub part: String,
    /// Where it is believed to be, in the world.
    pub x_wp: Pose,
    /// Where it is to be, in the world.
    pub x_goal: Pose,
    /// What the gripper was told last.
    pub gripper: GripperCommand,
    /// Joint positions, rad.
    pub posture: [f64; DOF],
}

/// The skill that notes what is known, and ends the work.
struct Pause {
    kind: [ActionKind; 1],
    needs: Vec<Need>,
    aim: Aim,
    known: Arc<Mutex<Option<Known>>>,
}

impl Skill for Pause {
    fn name(&self) -> &str {
        "pause"
    }

    fn serves(&self) -> &[ActionKind] {
        &self.kind
    }

    fn needs(&self) -> &[Need] {
        &self.needs
    }

    fn expects(&self) -> &[Effect] {
        &[]
    }

    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let known = known(cell, call, &self.aim)?;
        *self.known.lock().unwrap_or_else(PoisonError::into_inner) = Some(known);
        Err(Fault::NoSkill { action: call.action.to_string() }.into())
    }
}

/// What the baseline believes as the skill begins.
fn known(cell: &Workcell, call: &Call, aim: &Aim) -> Result<Known, SkillError> {
    let part = call.part().ok_or_else(|| call.no_skill())?.to_string();
    let x_wp = cell.hand.x_wp_held().map_or_else(|| cell.belief.pose(&part), Ok)?;
    let x_goal = match aim {
        // Its head on the plate, turned as it is.
        Aim::Pinned { connection } => {
            let x = x_wp.rotation * Vector3::x();
            let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), x.y.atan2(x.x));
            Pose::from_parts(Translation3::from(cell.mouth(*connection)?), yaw)
        }
        Aim::Deep { beam, shift } => {
            Translation3::from(cell.kit.x_wa().rotation * shift) * cell.target(*beam)?
        }
        Aim::Held { .. } => x_wp,
        Aim::Placed { .. } | Aim::Laid { .. } | Aim::Straight { .. } => cell.target(call.beam(cell)?)?,
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

/// Lets the baseline do what comes before the contact action of `step`; what it knows then, or why it did not get there.
pub(crate) fn bring(
    benchmark: &Benchmark,
    setup: &Setup,
    step: &Step,
    twin: &mut Twin,
) -> Result<Known, String> {
    let known = Arc::new(Mutex::new(None));
    let table = SkillTable::default();
    let needs = table.get(step.kind).map(|skill| skill.needs().to_vec()).unwrap_or_default();
    let pause = Pause { kind: [step.kind], needs, aim: step.task.aim.clone(), known: Arc::clone(&known) };
    let baseline =
        Baseline::new(&benchmark.kit, setup.assembly, &benchmark.arm, &benchmark.domains, setup.seed)
            .with_skills(table.with(pause));
    let mut agent = Piece::new(baseline, step.state.clone(), step.plan.clone(), Vec::new());
    let outcome = agent.run(twin);
    let known = known.lock().unwrap_or_else(PoisonError::into_inner).take();
    match (known, outcome) {
        (Some(known), Ok(())) => Ok(known),
        (_, Err(error)) => Err(error.to_string()),
        (None, Ok(())) => Err(agent.failure().unwrap_or_else(|| "the skill did not begin".to_string())),
    }
}
