//! Brings a frame that stands wrong to where the build can go on: pegs in wrong holes come out, beams that
//! stand off their places are brought there, and beams that stand in each other's places are taken out.
//!
//! The agent is not told what is wrong: it compares what it sees with the goal before its first plan.

use nalgebra::{Point3, Vector3};
use ramp_assembly::Assembly;
use ramp_kit::Beam;
use ramp_kit::source::{MAX_SENTENCE, plain};
use ramp_motion::PathPlanner;
use ramp_planner::{CoarseAction, Plan, State, backwards, left_of, plan};
use ramp_robot::{EventKind, RobotError};

use super::Baseline;
use super::take_apart::{is_deep, stands};
use crate::belief::{beside, is_clearly_better};
use crate::cell::Workcell;
use crate::fault::SkillError;
use crate::hand::Hand;
use crate::recognition::{Swap, is_in_place, take_over};
use crate::recovery::{align, clear_hand, note_fault, recover, take_out_misplaced};
use crate::table::SkillTable;

/// The beams that stand in the places of others with the same joints in the same places.
pub fn swapped_beams(cell: &Workcell) -> Vec<Swap> {
    let assembly = cell.assembly;
    let mut found = Vec::new();
    for (index, placed) in assembly.beams.iter().enumerate().filter(|(index, _)| *index != assembly.base) {
        let others = cell.kit.beams.iter().filter(|other| other.has_joints_of(&placed.beam));
        let other = others.filter(|other| other.name != placed.beam.name).find(|other| {
            other.name != assembly.beams[assembly.base].beam.name && is_in_place(cell, index, &other.name)
        });
        found.extend(other.map(|other| (index, other.name.clone())));
    }
    found
}

/// Whether anything lies elsewhere than on the sheet: a beam of the kit away from all outlines of its shape,
/// or a peg away from the holders.
pub fn begins_with_a_frame(cell: &Workcell) -> bool {
    let clamped = &cell.assembly.beams[cell.assembly.base].beam.name;
    let beams = cell.kit.beams.iter().map(|beam| &beam.name).filter(|name| *name != clamped);
    let mut parts = beams.chain(cell.kit.pegs.iter().map(|peg| &peg.name));
    parts.any(|part| cell.belief.parts.pose(part).is_ok() && !cell.is_on_sheet(part))
}

/// Looks at all parts that do not lie on the sheet until the hand could grip them: pegs and beams are told
/// apart from their places by a few millimetres.
///
/// # Errors
/// The robot's.
pub fn look_at_frame(cell: &mut Workcell) -> Result<(), RobotError> {
    let clamped = &cell.assembly.beams[cell.assembly.base].beam.name;
    let beams = cell.kit.beams.iter().map(|beam| &beam.name).filter(|name| *name != clamped);
    let parts: Vec<&String> = beams.chain(cell.kit.pegs.iter().map(|peg| &peg.name)).collect();
    for part in parts {
        if cell.belief.parts.pose(part).is_ok() && !cell.is_on_sheet(part) {
            let seen = cell.see_to_grip(part);
            note_fault(cell, seen)?;
        }
    }
    Ok(())
}

/// Without tags, beams with the same joints in the same places look nearly alike: each that stands in the
/// frame is compared from near with those that may stand there in its stead, and called by the name of the
/// one that the images show.
///
/// # Errors
/// The robot's.
fn tell_apart(cell: &mut Workcell) -> Result<(), RobotError> {
    let eyes = &cell.belief.parts.eyes;
    if eyes.tags() || !eyes.images() {
        return Ok(());
    }
    let clamped = &cell.assembly.beams[cell.assembly.base].beam.name;
    let (kit, mut compared) = (cell.kit, Vec::new());
    for beam in kit.beams.iter().filter(|beam| beam.name != *clamped) {
        for other in kit.beams.iter().filter(|other| other.name != *clamped && other.name != beam.name) {
            let nearly = other.has_joints_of(beam) && !other.has_shape_of(beam);
            let stands =
                |cell: &Workcell, name: &str| cell.belief.parts.pose(name).is_ok() && !cell.is_on_sheet(name);
            let missing = cell.belief.parts.pose(&other.name).is_err();
            let pair = [&beam.name, &other.name];
            if !nearly || !stands(cell, &beam.name) || compared.contains(&[pair[1], pair[0]]) {
                continue;
            }
            if !missing && !stands(cell, &other.name) {
                continue;
            }
            compared.push(pair);
            let mut off = [0.0; 2];
            let told = compare_in_place(cell, [&beam.name, &other.name], &mut off);
            note_fault(cell, told)?;
            if !missing {
                let mut there = [0.0; 2];
                let told = compare_in_place(cell, [&other.name, &beam.name], &mut there);
                note_fault(cell, told)?;
                off = [off[0] + there[0], off[1] + there[1]];
            }
            if is_clearly_better(off[1], off[0]) {
                let text = format!("{} is seen where {} was believed to stand", other.name, beam.name);
                cell.record(EventKind::Note { text });
                cell.belief.parts.exchange([&beam.name, &other.name]);
            }
        }
    }
    Ok(())
}

/// Looks at a beam from its sides, and adds to `off` how far off the images are from it and from another one
/// in its place, until they tell.
fn compare_in_place(cell: &mut Workcell, names: [&str; 2], off: &mut [f64; 2]) -> Result<(), SkillError> {
    let Some(span) = cell.kit.beam(names[0]).map(Beam::span) else { return Ok(()) };
    let x_wb = cell.belief.parts.pose(names[0])?;
    let points = [0.5, 0.0, 1.0].map(|share| x_wb * Point3::new(share * span, 0.0, 0.0));
    for point in beside(x_wb.rotation * Vector3::x(), points) {
        cell.visit(&point)?;
        cell.look_again(cell.parameters.clear.looks)?;
        if let Some(more) = cell.belief.parts.compare(&mut cell.hand, names)? {
            *off = [off[0] + more[0], off[1] + more[1]];
        }
        if is_clearly_better(off[0], off[1]) || is_clearly_better(off[1], off[0]) {
            break;
        }
    }
    Ok(())
}

/// The goal as it stands: with the beams swapped.
fn as_it_stands(goal: &Assembly, swaps: &[Swap]) -> Assembly {
    let mut assembly = goal.clone();
    for (index, other) in swaps {
        let Some(beam) = goal.kit.beam(other) else { continue };
        let own = std::mem::replace(&mut assembly.beams[*index].beam, beam.clone());
        // One name for each beam: the other place, if the goal has one, gets the beam that is missing here.
        let twice = |it: &(usize, &ramp_assembly::PlacedBeam)| it.0 != *index && it.1.beam.name == *other;
        if let Some(other) = assembly.beams.iter().enumerate().find(twice).map(|(other, _)| other) {
            assembly.beams[other].beam = own;
        }
    }
    assembly
}

/// Takes pegs out of holes that nothing is to be pinned through yet, and brings beams to
/// their places that stand off them along their insertion paths. After [`take_over`]. Returns true if there
/// was anything to do.
///
/// # Errors
/// The robot's.
pub fn set_right(skills: &SkillTable, cell: &mut Workcell) -> Result<bool, RobotError> {
    let off = off_along_path(cell);
    let mut worked = !off.is_empty();
    for beam in off {
        let name = cell.assembly.beams[beam].beam.name.clone();
        cell.record(EventKind::Note { text: format!("{name} stands off its place: it is brought there") });
        cell.belief.standing.push(beam);
        let done = align(skills, cell, beam);
        if !note_fault(cell, done)? {
            clear_hand(skills, cell)?;
        }
        cell.remember_standing(&[beam]);
    }
    worked |= take_out_misplaced(skills, cell)?;
    Ok(worked)
}

/// Beams that lie in line with their places, but farther in or out along their insertion paths, by index.
fn off_along_path(cell: &Workcell) -> Vec<usize> {
    let assembly = cell.assembly;
    let is_off = |index: &usize| {
        let placed = &assembly.beams[*index];
        let (Ok(x_wb), Some(path)) =
            (cell.belief.parts.pose(&placed.beam.name), cell.belief.paths.get(index))
        else {
            return false;
        };
        let goal = cell.belief.x_wa() * placed.x_ab;
        let direction = cell.belief.x_wa().rotation * path.direction;
        let own = &cell.parameters.repair;
        let beside = |p: Point3<f64>| {
            let off = x_wb * p - goal * p;
            (off - direction * off.dot(&direction)).norm() < cell.parameters.alignment.stands
                && off.dot(&direction).abs() < own.along
        };
        let span = placed.beam.span();
        [[0.0; 3], [span, 0.0, 0.0], [0.0, span, 0.0]].iter().all(|p| beside(Point3::from(*p)))
    };
    let others = (0..assembly.beams.len()).filter(|index| !cell.belief.standing.contains(index));
    others.filter(is_off).collect()
}

impl Baseline<'_> {
    /// Takes over what stands when the work begins, and sets right what stands wrong.
    pub(crate) fn begin(
        &mut self,
        cell: &mut Workcell,
        lost: &mut Vec<String>,
    ) -> Result<Vec<Swap>, RobotError> {
        if self.start.scatter.is_none() && begins_with_a_frame(cell) {
            look_at_frame(cell)?;
            tell_apart(cell)?;
            let swaps = if self.swapped { Vec::new() } else { swapped_beams(cell) };
            if !swaps.is_empty() {
                self.swapped = true;
                return Ok(swaps);
            }
            let (assembly, domains) = (self.assembly, self.domains);
            let built = self.timed(|| ramp_planner::plan(assembly, &State::default(), domains));
            built.iter().for_each(|plan| self.learn_paths(cell, plan));
            take_over(&self.skills, cell, lost)?;
            if set_right(&self.skills, cell)? {
                lost.clear();
                recover(&self.skills, cell, None, lost)?;
            }
        } else {
            take_over(&self.skills, cell, lost)?;
        }
        Ok(Vec::new())
    }

    /// Takes beams out that stand in the places of others, with everything that has to go before them, and
    /// puts all that on the sheet.
    ///
    /// # Errors
    /// The robot's.
    pub(crate) fn take_out_swapped<'r>(
        &mut self,
        swaps: &[Swap],
        planner: &PathPlanner,
        hand: Hand<'r>,
    ) -> Result<Hand<'r>, RobotError> {
        let assembly = as_it_stands(self.assembly, swaps);
        let mut cell = self.cell_of(&assembly, planner, hand);
        let domains = self.domains;
        let built = match self.timed(|| plan(&assembly, &State::default(), domains)) {
            Ok(built) => built,
            Err(error) => {
                let text = plain(&format!("no plan for the frame as it stands: {error}"), MAX_SENTENCE - 1);
                cell.record(EventKind::Note { text });
                self.report(&mut cell);
                return Ok(cell.hand);
            }
        };
        self.learn_paths(&mut cell, &built);
        cell.belief.parts.are_told_apart();
        let seen = cell.look_first();
        note_fault(&mut cell, seen)?;
        look_at_frame(&mut cell)?;
        take_over(&self.skills, &mut cell, &mut Vec::new())?;
        let others: Vec<&str> = swaps.iter().map(|(_, name)| name.as_str()).collect();
        if let Some(why) = self.carry_out_backwards(&mut cell, &built, &|left| until_out(left, &others))? {
            let text = plain(&format!("beams stay in each other's places: {why}"), MAX_SENTENCE - 1);
            cell.record(EventKind::Note { text });
        }
        self.report(&mut cell);
        Ok(cell.hand)
    }

    /// Takes a frame that stands in part apart, piece by piece as the plan of the build backwards, until a
    /// plan leads on from there.
    ///
    /// # Errors
    /// The robot's.
    pub(crate) fn take_apart_until_planned(
        &mut self,
        cell: &mut Workcell,
        lost: &[String],
    ) -> Result<(), RobotError> {
        let (assembly, domains) = (self.assembly, self.domains);
        let Ok(built) = self.timed(|| plan(assembly, &State::default(), domains)) else { return Ok(()) };
        let whole = backwards(&built, &cell.belief.fastened());
        loop {
            let left = left_of(&whole, |item| stands(cell, item), |beam| is_deep(cell, beam));
            let next = first_piece(left);
            if next.steps.is_empty() {
                return Ok(());
            }
            match self.run_plan(cell, &next) {
                Ok(()) => {}
                Err(SkillError::Robot(error)) => return Err(error),
                Err(error) => {
                    cell.record(error.fault());
                    clear_hand(&self.skills, cell)?;
                    return Ok(());
                }
            }
            let state = self.state(cell, lost);
            if state.is_ok_and(|state| self.timed(|| plan(assembly, &state, domains)).is_ok()) {
                return Ok(());
            }
        }
    }
}

/// The steps of a plan up to where a first part is put down, or a first beam slid back.
fn first_piece(mut plan: Plan) -> Plan {
    let ends = |coarse: &CoarseAction| {
        matches!(coarse, CoarseAction::PutDown { .. } | CoarseAction::SlideBack { .. })
    };
    let first = plan.steps.iter().position(|step| ends(&step.coarse));
    plan.steps.truncate(first.map_or(0, |first| first + 1));
    plan
}

/// The steps of a plan up to where the last of these beams is put down.
fn until_out(mut plan: Plan, beams: &[&str]) -> Plan {
    let last = plan.steps.iter().rposition(
        |step| matches!(&step.coarse, CoarseAction::PutDown { item } if beams.contains(&item.name())),
    );
    plan.steps.truncate(last.map_or(0, |last| last + 1));
    plan
}
