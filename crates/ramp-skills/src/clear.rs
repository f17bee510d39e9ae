//! Lays beams aside that lie in the way: before a build from a start whose parts lie anywhere, for which it
//! finds the parts and clears the place of the frame; and before a beam is taken on which others lie.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Point3, Translation3, Vector3};
use ramp_kit::dimensions::{BODY_WIDTH, EXTRUSION};
use ramp_kit::{Beam, Footprint, Holder};
use ramp_planner::{Entry, FineAction, Grasp, Item, Plan, PlanError};
use ramp_robot::{EventKind, RobotError};
use ramp_world::start::{Scatter, Start};

use crate::Pose;
use crate::cell::Workcell;
use crate::cell::footprints::footprints;
use crate::fault::{Fault, SkillError};
use crate::recovery::note_fault;
use crate::skill::Call;
use crate::skill::regrasp::Regrasp;
use crate::table::SkillTable;

/// Finds the parts, and clears the place of the frame of this plan: gives the pegs that cannot be used, by
/// name, or the reason for which the goal cannot be built.
///
/// # Errors
/// The robot's.
pub fn prepare(
    skills: &SkillTable,
    cell: &mut Workcell,
    scatter: &Scatter,
    plan: impl FnOnce() -> Result<Plan, PlanError>,
) -> Result<Result<Vec<String>, String>, RobotError> {
    let found = find_parts(cell, scatter);
    note_fault(cell, found)?;
    let unusable = match usable(cell) {
        Ok(unusable) => unusable,
        Err(why) => return Ok(Err(why)),
    };
    match plan() {
        Ok(plan) => clear(skills, cell, scatter, &plan.entries)?,
        Err(error) => return Ok(Err(format!("no plan: {error}"))),
    }
    Ok(Ok(unusable))
}

/// Looks until every part of the kit was seen, from over each place where parts may lie once.
///
/// # Errors
/// The robot's, or the fault that stopped a motion.
fn find_parts(cell: &mut Workcell, scatter: &Scatter) -> Result<(), SkillError> {
    cell.belief.parts.update(&mut cell.hand)?;
    if !cell.belief.parts.eyes.images() {
        return Ok(());
    }
    let looks = cell.parameters.clear.looks;
    cell.look_again(looks)?;
    let mut visited = Vec::new();
    if !cell.belief.parts.eyes.tags() {
        cell.calibrate()?;
        tell_apart(cell, &mut visited)?;
    }
    let far = (scatter.ring.from + scatter.ring.to) / 2.0;
    let steps = (FRAC_PI_2 / cell.parameters.clear.turn).floor() as i32;
    for step in -steps..=steps {
        if unseen(cell).is_empty() {
            return Ok(());
        }
        let (sine, cosine) = (f64::from(step) * cell.parameters.clear.turn).sin_cos();
        cell.visit(&Point3::new(far * cosine, far * sine, 0.0))?;
        cell.look_again(looks)?;
        tell_apart(cell, &mut visited)?;
    }
    let unseen = unseen(cell);
    if !unseen.is_empty() {
        cell.record(EventKind::Note { text: format!("not found on the table: {}", unseen.join(", ")) });
    }
    Ok(())
}

/// Looks from near at each beam whose shape cannot be told from far, the nearest first, and at no point that
/// was `visited`.
fn tell_apart(cell: &mut Workcell, visited: &mut Vec<Point3<f64>>) -> Result<(), SkillError> {
    let looks = cell.parameters.clear.looks;
    loop {
        let hand = Point3::from(cell.hand.seen.x_wt.translation.vector);
        let off = |place: &Point3<f64>| (place - hand).xy().norm();
        let untold = cell.belief.parts.eyes.untold();
        let near = cell.parameters.clear.visited;
        let is_new = |point: &&Point3<f64>| visited.iter().all(|other| (other - *point).norm() > near);
        let next = untold.iter().filter_map(|points| points.iter().find(is_new));
        let Some(next) = next.copied().min_by(|a, b| off(a).total_cmp(&off(b))) else { return Ok(()) };
        cell.visit(&next)?;
        cell.look_again(looks)?;
        visited.push(next);
    }
}

/// The parts of the kit that were never seen, by name.
fn unseen(cell: &Workcell) -> Vec<String> {
    let kit = cell.kit;
    let names = kit.beams.iter().map(|beam| &beam.name).chain(kit.pegs.iter().map(|peg| &peg.name));
    names.filter(|name| cell.belief.parts.pose(name).is_err()).cloned().collect()
}

/// The pegs that cannot be used, because they do not stand upright or were not found, by name.
///
/// # Errors
/// The reason for which the goal cannot be built, for a person: a beam of the goal that cannot be used, or
/// too few pegs.
fn usable(cell: &Workcell) -> Result<Vec<String>, String> {
    let (assembly, kit) = (cell.assembly, cell.kit);
    let up = |x: &Pose| (x.rotation * Vector3::z()).z;
    for placed in assembly.beams.iter().filter(|placed| placed.beam.start.is_some()) {
        let beam = &placed.beam;
        let Ok(x_wb) = cell.belief.parts.pose(&beam.name) else {
            return Err(format!("{} was not found on the table", beam.name));
        };
        let raised = x_wb.translation.z - beam.axis_height_on_table();
        let usual = if beam.start.is_some_and(|start| start.flipped) { -1.0 } else { 1.0 };
        if up(&x_wb) * usual < 0.0 {
            return Err(format!("{} lies face down, and this agent turns no beam over", beam.name));
        }
        if raised.abs() > cell.parameters.clear.raised || up(&x_wb).abs() < cell.parameters.belief.level {
            return Err(format!("{} does not lie flat on the table", beam.name));
        }
    }
    let stands = |x: Pose| {
        let raised = x.translation.z - Holder::HEIGHT;
        up(&x) > cell.parameters.belief.level && raised.abs() < cell.parameters.clear.raised
    };
    let pegs = kit.pegs.iter().map(|peg| &peg.name);
    let unusable: Vec<String> =
        pegs.filter(|peg| !cell.belief.parts.pose(peg).is_ok_and(stands)).cloned().collect();
    let (left, needed) = (kit.pegs.len() - unusable.len(), assembly.connections.len());
    if left < needed {
        return Err(format!("{left} pegs stand in holders, and the goal needs {needed}"));
    }
    Ok(unusable)
}

/// Lays each beam that lies where the frame is to stand, or on the path of a beam to it, down on a free place
/// of the table. One that the hand cannot take stays, and the build begins without.
///
/// # Errors
/// The robot's.
fn clear(
    skills: &SkillTable,
    cell: &mut Workcell,
    scatter: &Scatter,
    entries: &[Entry],
) -> Result<(), RobotError> {
    let frame = frame(cell, entries);
    for _ in 0..cell.parameters.clear.rounds {
        let beams = in_the_way(cell, &frame);
        if beams.is_empty() {
            break;
        }
        for beam in beams {
            let why = format!("{} lies where the frame is to stand", beam.name);
            let cleared = clear_beam(skills, cell, (scatter, &frame), beam, &why);
            if !note_fault(cell, cleared)? {
                let done = put_back(skills, cell, &beam.name);
                note_fault(cell, done)?;
            }
        }
    }
    for beam in in_the_way(cell, &frame) {
        let text = format!("{} lies where the frame is to stand, and cannot be taken away", beam.name);
        cell.record(EventKind::Note { text });
    }
    Ok(())
}

/// Lays one beam down on a free place of the table, where it is not in the way of the beams of a plan. `why`
/// tells, in an event, why it had to go. It lies where a scattered part may lie. One that cannot be laid down
/// is put back.
///
/// # Errors
/// The fault that kept it where it is, or the robot's.
pub fn lay_aside(
    skills: &SkillTable,
    cell: &mut Workcell,
    entries: &[Entry],
    beam: &Beam,
    why: &str,
) -> Result<(), SkillError> {
    let frame = frame(cell, entries);
    let Some(scatter) = &Start::scattered().scatter else {
        return Err(Fault::NoGrasp { part: beam.name.clone() }.into());
    };
    let done = clear_beam(skills, cell, (scatter, &frame), beam, why);
    if done.is_err() {
        put_back(skills, cell, &beam.name)?;
    }
    done
}

/// Lays each loose beam that lies on this one aside, the uppermost first: it would fall as this one is
/// lifted. One that the hand cannot take stays.
///
/// # Errors
/// The robot's.
pub fn uncover(
    skills: &SkillTable,
    cell: &mut Workcell,
    entries: &[Entry],
    beam: &str,
) -> Result<(), RobotError> {
    for _ in 0..cell.kit.beams.len() {
        let Some((upper, lower)) = uppermost(cell, beam) else { break };
        let laid = lay_aside(skills, cell, entries, upper, &format!("{} lies on {lower}", upper.name));
        if !note_fault(cell, laid)? {
            break;
        }
    }
    Ok(())
}

/// Of the loose beams that lie on this one, or on one that does, one on which none lies, with the name of the
/// beam under it.
fn uppermost<'k>(cell: &Workcell<'k, '_>, beam: &str) -> Option<(&'k Beam, &'k str)> {
    let kit: &'k ramp_kit::Kit = cell.kit;
    let (mut lower, mut upper) = (kit.beam(beam)?, None);
    for _ in 0..kit.beams.len() {
        let Some(next) = kit.beams.iter().find(|next| is_loose(cell, next) && lies_on(cell, next, lower))
        else {
            break;
        };
        (lower, upper) = (next, Some((next, lower.name.as_str())));
    }
    upper
}

/// Whether a beam is neither clamped nor stands in the frame, and was not lost.
fn is_loose(cell: &Workcell, beam: &Beam) -> bool {
    let stands = |index| index == cell.assembly.base || cell.belief.standing.contains(&index);
    let in_frame = cell.assembly.beam_index(&beam.name).is_some_and(stands);
    !in_frame && !cell.belief.parts.is_lost(&beam.name)
}

/// Whether a beam lies over another one: a point of its axis is over the other's width, and higher than the
/// other's axis by at least half of its thickness.
fn lies_on(cell: &Workcell, upper: &Beam, lower: &Beam) -> bool {
    let pose = |beam: &Beam| cell.belief.parts.pose(&beam.name);
    let (Ok(x_wu), Ok(x_wl)) = (pose(upper), pose(lower)) else { return false };
    let x_lu = x_wl.inverse() * x_wu;
    let up = x_wl.rotation.inverse() * Vector3::z();
    let points = (upper.span() / cell.parameters.clear.step).ceil() as i32;
    (0..=points).any(|point| {
        let p_l = x_lu * Point3::new(upper.span() * f64::from(point) / f64::from(points), 0.0, 0.0);
        let on_axis = Point3::new(p_l.x.clamp(0.0, lower.span()), 0.0, 0.0);
        let off = p_l - on_axis;
        let height = off.dot(&up);
        (off - up * height).norm() < BODY_WIDTH && height > EXTRUSION / 2.0
    })
}

/// Takes a beam by the link nearest to its middle that can be gripped, and lays it down elsewhere, where the
/// frame is not.
fn clear_beam(
    skills: &SkillTable,
    cell: &mut Workcell,
    (scatter, frame): (&Scatter, &[Footprint]),
    beam: &Beam,
    why: &str,
) -> Result<(), SkillError> {
    let mut links: Vec<_> = beam.links.iter().collect();
    let off = |link: &ramp_kit::Link| ((link.grasp[0] + link.grasp[1] - beam.span()) / 2.0).abs();
    links.sort_by(|a, b| off(a).total_cmp(&off(b)));
    let mut taken = Err(Fault::NoGrasp { part: beam.name.clone() }.into());
    for link in links {
        let (item, grasp) = (Item::Beam(beam.name.clone()), Grasp::Link(link.name.clone()));
        taken = skills.perform(cell, &Call::alone(&FineAction::PickUp { item, grasp }));
        match taken {
            Ok(()) => return lay_down(cell, (scatter, frame), beam, &link.name, why),
            Err(SkillError::Robot(_)) => return taken,
            Err(_) => cell.retreat()?,
        }
    }
    taken
}

/// Lays the held beam down where it is in nobody's way.
fn lay_down(
    cell: &mut Workcell,
    (scatter, frame): (&Scatter, &[Footprint]),
    beam: &Beam,
    link: &str,
    why: &str,
) -> Result<(), SkillError> {
    let around = cell.around(beam);
    let mut parameters = (*cell.parameters).clone();
    let [x, y] = [scatter.area_x, scatter.area_y].map(|range| [range.from, range.to]);
    (parameters.regrasp.table_x, parameters.regrasp.table_y) = (x, y);
    parameters.regrasp.step = parameters.clear.place_step;
    let regrasp = Regrasp::new(&parameters);
    let free = |x_wb: &Pose, beside: f64| {
        let own = footprints(beam, x_wb);
        let clear = |others: &[Footprint], distance: f64| {
            own.iter().all(|own| others.iter().all(|other| own.is_clear(other, distance)))
        };
        let inside = |own: &Footprint| {
            own.corners().iter().all(|it| scatter.area_x.holds(it.x) && scatter.area_y.holds(it.y))
        };
        own.iter().all(inside) && clear(frame, parameters.clear.frame) && clear(&around, beside)
    };
    let mut laid = Err(Fault::NoGrasp { part: beam.name.clone() }.into());
    for beside in parameters.clear.beside {
        laid = regrasp.lay_aside(cell, beam, link, |x_wb| free(x_wb, beside));
        if !matches!(laid, Err(SkillError::Fault(Fault::NoGrasp { .. }))) {
            break;
        }
    }
    laid?;
    cell.laid_at.pop();
    let x_wb = cell.belief.parts.pose(&beam.name)?;
    let middle = x_wb * Point3::new(beam.span() / 2.0, 0.0, 0.0);
    let text = format!("{why}: laid down at x {:.2} m, y {:.2} m", middle.x, middle.y);
    cell.record(EventKind::Note { text });
    Ok(())
}

/// Puts a beam that is still in the hand back where it lay, and raises the hand.
fn put_back(skills: &SkillTable, cell: &mut Workcell, beam: &str) -> Result<(), SkillError> {
    if cell.hand.held.is_some() {
        let item = Item::Beam(beam.to_string());
        skills.perform(cell, &Call::alone(&FineAction::PutDown { item }))?;
    }
    cell.release()?;
    cell.retreat()
}

/// The footprints of all beams of the frame that are to be put in, at their places and along their paths.
fn frame(cell: &Workcell, entries: &[Entry]) -> Vec<Footprint> {
    let x_wa = cell.belief.x_wa();
    let step = cell.parameters.clear.step;
    let mut frame = Vec::new();
    for entry in entries {
        let Some(index) = cell.assembly.beam_index(&entry.beam) else { continue };
        let placed = &cell.assembly.beams[index];
        let back = -Vector3::from(entry.direction);
        let steps = ((entry.distance + entry.depth) / step).ceil() as i32;
        for index in 0..=steps {
            let far = (f64::from(index) * step - entry.depth).min(entry.distance);
            let x_wb = x_wa * Translation3::from(back * far) * placed.x_ab;
            frame.extend(footprints(&placed.beam, &x_wb));
        }
    }
    frame
}

/// The beams that lie in the way of the frame, the longest first: for it a free place is hardest to find.
fn in_the_way<'k>(cell: &Workcell<'k, '_>, frame: &[Footprint]) -> Vec<&'k Beam> {
    let margin = cell.parameters.clear.frame;
    let blocks = |beam: &&Beam| {
        cell.belief.parts.pose(&beam.name).is_ok_and(|x_wb| {
            let own = footprints(beam, &x_wb);
            own.iter().any(|own| frame.iter().any(|other| !own.is_clear(other, margin)))
        })
    };
    let others = cell.kit.beams.iter().filter(|beam| beam.name != base(cell));
    let mut beams: Vec<&Beam> = others.filter(blocks).collect();
    beams.sort_by(|a, b| b.span().total_cmp(&a.span()));
    beams
}

/// The name of the clamped beam.
fn base<'k>(cell: &Workcell<'k, '_>) -> &'k str {
    &cell.assembly.beams[cell.assembly.base].beam.name
}
