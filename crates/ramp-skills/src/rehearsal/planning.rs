//! Plans, and goes through each plan with the arm's model, until one passes.

use std::collections::BTreeMap;

use ramp_assembly::Assembly;
use ramp_motion::PathPlanner;
use ramp_planner::{Domains, Item, MotionFact, Place, Plan, PlanError, State, Target};
use ramp_robot::arm::ArmModel;

use super::scene::Scene;
use super::search::{Findings, Rehearsal, Stuck, UnusualGrasp};
use crate::Pose;
use crate::grasp::{beam_grasp, peg_grasp};

/// The most facts that plan and rehearsal exchange before they give up: each takes away one grasp, path or
/// order.
const MOST_FACTS: usize = 60;

/// A plan that the arm can execute, and the facts learned while finding it.
#[derive(Clone, Debug)]
pub struct Rehearsed {
    /// The plan.
    pub plan: Plan,
    /// Motions that the arm cannot do, in the order in which they were found; those of the given state come
    /// first.
    pub facts: Vec<MotionFact>,
    /// Grasps of beams for which the usual one would not do, by name.
    pub grasps: BTreeMap<String, UnusualGrasp>,
    /// Names of the skills that cannot rehearse: their actions count as possible.
    pub not_rehearsed: Vec<String>,
}

/// Plans for parts that are where they nominally are, and goes through the plan with the arm's model.
///
/// # Errors
/// As [`plan_with_motion`].
pub fn plan_for_arm(
    assembly: &Assembly,
    arm: &ArmModel,
    state: &State,
    domains: &Domains,
) -> Result<Rehearsed, PlanError> {
    let planner = PathPlanner::new(arm);
    plan_with_motion(assembly, state, domains, || Rehearsal::of_baseline(assembly, arm, &planner, state))
}

/// Goes through a plan of another planner, with parts that are where they nominally are in `state`.
///
/// # Errors
/// The first step that the arm or the hand cannot carry out.
pub fn check_for_arm(
    assembly: &Assembly,
    arm: &ArmModel,
    state: &State,
    plan: &Plan,
) -> Result<(), Box<Stuck>> {
    let planner = PathPlanner::new(arm);
    Rehearsal::of_baseline(assembly, arm, &planner, state).check_steps(plan).map(|_| ())
}

/// A plan that was made quicker.
#[derive(Clone, Debug)]
pub struct Quicker {
    /// The plan.
    pub plan: Plan,
    /// Duration of its motions by [`Rehearsal::seconds`], s.
    pub seconds: f64,
    /// Duration of the motions of the plan from which it was made, s.
    pub before: f64,
}

/// Makes a plan quicker that the arm can carry out: parts are where they nominally are in `state`, the ways
/// of the hand between them are timed by the motion planner, and [`ramp_planner::quicker`] exchanges pegs and
/// fastenings. The plan stays as it is where the rehearsal finds the other one slower or impossible.
///
/// # Errors
/// When the state cannot be, or the arm cannot carry out the plan.
pub fn quicker_for_arm(
    assembly: &Assembly,
    arm: &ArmModel,
    state: &State,
    domains: &Domains,
    plan: &Plan,
) -> Result<Quicker, PlanError> {
    let planner = PathPlanner::new(arm);
    let rehearsal = || Rehearsal::of_baseline(assembly, arm, &planner, state);
    let before = rehearsal().seconds(plan).map_err(|fact| PlanError::Motion {
        goal: assembly.name.clone(),
        why: "the arm cannot carry out the plan".to_string(),
        reasons: fact.to_string(),
    })?;
    let mut ways = rehearsal();
    let mut cost = |from: &Place, to: &Place| {
        let seconds = time_between(&mut ways, from, to);
        seconds.map_or(u64::from(u32::MAX), |seconds| (seconds * 1e3).round() as u64)
    };
    let (tried, _) = ramp_planner::quicker(assembly, state, domains, plan, &mut cost)?;
    Ok(match rehearsal().seconds(&tried) {
        Ok(seconds) if seconds < before => Quicker { plan: tried, seconds, before },
        _ => Quicker { plan: plan.clone(), seconds: before, before },
    })
}

/// Plans, and goes through the plan with the arm's model; what the arm cannot do becomes a fact, and the
/// planner plans again, until a plan passes. `rehearsal` gives the world at the beginning.
///
/// # Errors
/// The planner's, when no plan is left; it then says what the arm cannot do.
pub fn plan_with_motion<'a>(
    assembly: &Assembly,
    state: &State,
    domains: &Domains,
    mut rehearsal: impl FnMut() -> Rehearsal<'a>,
) -> Result<Rehearsed, PlanError> {
    let mut state = state.clone();
    loop {
        let plan = ramp_planner::plan(assembly, &state, domains)?;
        match rehearsal().check(&plan) {
            Ok(Findings { grasps, not_rehearsed }) => {
                return Ok(Rehearsed { plan, facts: state.motion, grasps, not_rehearsed });
            }
            Err(fact) => {
                let new = fact.of(assembly).filter(|fact| !state.motion.contains(fact));
                match new.filter(|_| state.motion.len() < MOST_FACTS) {
                    Some(fact) => state.motion.push(fact),
                    // The same answer again, or too many: the plan is carried out as far as it goes.
                    None => {
                        let reasons = state.motion.iter().map(MotionFact::to_string);
                        return Err(PlanError::Motion {
                            goal: assembly.name.clone(),
                            why: "the arm finds no plan that it can carry out".to_string(),
                            reasons: reasons.collect::<Vec<_>>().join("; "),
                        });
                    }
                }
            }
        }
    }
}

/// Time of the hand's motion from one place to another if nothing is in the way, s; `None` where the arm does
/// not reach one of them.
fn time_between(rehearsal: &mut Rehearsal, from: &Place, to: &Place) -> Option<f64> {
    let Rehearsal { scene, walk, .. } = rehearsal;
    walk.time_between(scene, &x_wt_at(scene, from)?, &x_wt_at(scene, to)?)
}

/// The pose of the tip at a place, in the world.
fn x_wt_at(scene: &Scene, place: &Place) -> Option<Pose> {
    match place {
        Place::Input(Item::Peg(peg)) => Some(peg_grasp(&scene.x_wp(peg)?, 0)),
        Place::Input(Item::Beam(beam)) => {
            let middle = scene.kit.beam(beam)?.span() / 2.0;
            Some(beam_grasp(&scene.x_wp(beam)?, middle, false))
        }
        Place::Approach(Target::Beam(beam)) | Place::Target(Target::Beam(beam)) => {
            let index = scene.assembly.beam_index(beam)?;
            let middle = scene.assembly.beams[index].beam.span() / 2.0;
            Some(beam_grasp(&scene.x_wb_goal(index, 0.0), middle, false))
        }
        Place::Approach(Target::Connection(name)) | Place::Target(Target::Connection(name)) => {
            let x_wp = scene.x_wp_seated(scene.assembly.connection_index(name)?);
            Some(peg_grasp(&x_wp, 0))
        }
        Place::Above(_) => None,
    }
}
