//! Reference values for robot times: a lower bound for any arm, and an attainable reference.
//!
//! Both come from the plan and the arm's model alone, the same for every agent, track and seed. The
//! [`Rehearsal`] simulates the plan with every part at its nominal pose. The motions of arm and hand are
//! summed in two ways.

use ramp_assembly::Assembly;
use ramp_motion::{Joints, Pace, PathPlanner, TimeLaw, least_time_over};
use ramp_planner::{Domains, Plan, PlanError, State};
use ramp_robot::arm::ArmModel;

use crate::rehearsal::{Done, Rehearsal, Rehearsed, plan_for_arm};

/// Speed of the reference in contact, m/s. Chosen: twice that of the baseline's insertions.
const IN_CONTACT: f64 = 0.1;
/// Speed of the reference's fingers, against each other, m/s: the fastest of Franka's hand.
const FINGERS: f64 = 0.1;

/// Times to compare a robot time with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceTimes {
    /// No arm with these limits rests at all grasps and places of the plan in less time, s. Each joint is a
    /// double integrator between two rests; nothing is in the way; neither contact nor gripper takes time.
    pub bound: f64,
    /// Duration of the plan with motions at the arm's limits on paths that keep clear of everything, contact
    /// at 0.1 m/s and fingers at 0.1 m/s, s. Excludes looks, searches, waits and retries. It is not a bound.
    pub reference: f64,
}

/// The times of the baseline's plan for a goal from an empty assembly, within the limits of the arm.
///
/// # Errors
/// If there is no plan that the arm can execute, or as [`reference_times`].
pub fn reference_times_of_goal(
    assembly: &Assembly,
    arm: &ArmModel,
    domains: &Domains,
) -> Result<ReferenceTimes, PlanError> {
    let state = State::default();
    let Rehearsed { plan, facts, .. } = plan_for_arm(assembly, arm, &state, domains)?;
    reference_times(assembly, arm, &State { motion: facts, ..state }, &plan)
}

/// The times of a plan, with every part where it nominally is in `state`.
///
/// # Errors
/// When the arm cannot carry out the plan, or the bound has no end: a grasp or place is out of reach.
pub fn reference_times(
    assembly: &Assembly,
    arm: &ArmModel,
    state: &State,
    plan: &Plan,
) -> Result<ReferenceTimes, PlanError> {
    let planner = PathPlanner::new(arm);
    let pace = Pace { velocity: 1.0, acceleration: 1.0, jerk: 1.0, ramp: 0.0 };
    let refused = |why: String| PlanError::Motion {
        goal: assembly.name.clone(),
        why: "the arm cannot carry out the plan".to_string(),
        reasons: why,
    };
    let done = Rehearsal::of_baseline(assembly, arm, &planner, state)
        .done(plan, TimeLaw::new(arm, &pace))
        .map_err(|fact| refused(fact.to_string()))?;
    let mut rests = Vec::new();
    let mut reference = 0.0;
    for done in done {
        reference += match done {
            Done::Free(seconds) => seconds,
            Done::Contact(way) => way / IN_CONTACT,
            Done::Fingers(x_wt, stroke) => {
                rests.push(x_wt);
                stroke / FINGERS
            }
        };
    }
    let bound =
        least_time_over(arm, &Joints::from(arm.home), &rests).map_err(|error| refused(error.to_string()))?;
    if !bound.is_finite() {
        return Err(refused("a grasp or place is out of reach".to_string()));
    }
    Ok(ReferenceTimes { bound, reference })
}
