//! Actions outside the plan: aligns beams, and restores the work cell after a fault.

use nalgebra::{Point3, Vector3};
use ramp_kit::joint::{FEMALE_HEIGHT, STEM_LENGTH};
use ramp_planner::{FineAction, Grasp, Item};
use ramp_robot::{EventKind, Retry, RobotError};

use crate::cell::Workcell;
use crate::fault::{Fault, SkillError};
use crate::skill::Call;
use crate::skill::insertion::Insertion;
use crate::table::SkillTable;

/// Pushes a standing beam to its place, by the reachable link that is nearest to its free end.
pub(crate) fn align(skills: &SkillTable, cell: &mut Workcell, beam: usize) -> Result<(), SkillError> {
    cell.retreat()?;
    let link = cell.nearest_link(beam)?;
    let push = FineAction::Push { beam: cell.assembly.beams[beam].beam.name.clone(), link: link.clone() };
    let pushed = skills.perform(cell, &Call::alone(&push));
    if matches!(pushed, Err(SkillError::Fault(Fault::OffPlace { .. }))) {
        cell.pushed_by.entry(beam).or_default().push(link);
    }
    pushed?;
    cell.retreat()
}

/// Before a peg is fetched: looks at the holes of a connection, and pushes its beams until a peg would go in.
/// A peg pulls two holes together that are up to 1.7 mm apart, and jams on the male beyond that.
///
/// # Errors
/// [`Fault::Misaligned`] when the holes stay too far apart, or the fault that stopped a push.
pub fn check_holes(skills: &SkillTable, cell: &mut Workcell, connection: usize) -> Result<(), SkillError> {
    let index = connection;
    let connection = &cell.assembly.connections[index];
    let holes = [cell.belief.hole(connection.female), cell.belief.hole(connection.male)];
    cell.see(&holes, cell.parameters.agent.holes_known)?;
    cell.diagnose_standing();
    let offset = cell.belief.parts.offset(cell.assembly, connection)?;
    // A failed peg has shown that the holes are further apart than they seem: they are pushed as close as
    // possible.
    let told = cell
        .belief
        .apart
        .iter()
        .position(|apart| *apart == index)
        .map(|at| cell.belief.apart.swap_remove(at));
    let peggable = cell.parameters.alignment.peggable;
    let enough = told.map_or(peggable, |_| cell.parameters.alignment.told_apart);
    if offset <= enough {
        return Ok(());
    }
    let misaligned = |offset: f64| Fault::Misaligned { connection: connection.name.clone(), offset };
    cell.record(misaligned(offset));
    // Beams that have swung about their only peg drag the parts joined to them: they are aligned first, then
    // the two beams themselves.
    let mut beams = cell.belief.swung()?;
    let sides = [connection.female.beam, connection.male.beam];
    beams.extend(sides.into_iter().filter(|beam| *beam != cell.assembly.base));
    for _ in 0..cell.parameters.alignment.rounds {
        // One that does not follow may hang on another: it is pushed again once that one stands where it
        // should.
        let mut stuck = false;
        for beam in &beams {
            match align(skills, cell, *beam) {
                Err(SkillError::Fault(fault @ (Fault::Misaligned { .. } | Fault::OffPlace { .. }))) => {
                    cell.record(fault);
                    stuck = true;
                }
                done => done?,
            }
            cell.see(&holes, cell.parameters.agent.holes_known)?;
            cell.remember_standing(&[*beam]);
            if cell.belief.parts.offset(cell.assembly, connection)? <= enough {
                return Ok(());
            }
        }
        if !stuck {
            break;
        }
    }
    let offset = cell.belief.parts.offset(cell.assembly, connection)?;
    if offset <= peggable { Ok(()) } else { Err(misaligned(offset).into()) }
}

/// The connections whose pegs hold one beam alone, by index. Those that seem so are looked at again after a
/// pause, in which a disturbance of the sight may have passed.
fn missed(cell: &mut Workcell) -> Result<Vec<usize>, SkillError> {
    let seems = cell.belief.missed()?;
    if seems.is_empty() {
        return Ok(seems);
    }
    cell.hand.wait(cell.parameters.agent.pause)?;
    cell.belief.parts.update(&mut cell.hand)?;
    for connection in seems {
        let connection = &cell.assembly.connections[connection];
        let holes = [cell.belief.hole(connection.female), cell.belief.hole(connection.male)];
        cell.see(&holes, cell.parameters.agent.holes_known)?;
    }
    cell.belief.missed()
}

/// Checks, at the end of a plan, that each seated peg holds both of its beams.
///
/// # Errors
/// [`Fault::Misaligned`] for the first connection whose peg holds one beam alone.
pub(crate) fn check_pegs(cell: &mut Workcell) -> Result<(), SkillError> {
    let Some(missed) = missed(cell)?.first().copied() else { return Ok(()) };
    let connection = &cell.assembly.connections[missed];
    let offset = cell.belief.parts.offset(cell.assembly, connection)?;
    Err(Fault::Misaligned { connection: connection.name.clone(), offset }.into())
}

/// Takes out pegs that hold one beam alone, and puts each back in its holder.
fn take_out_missed(skills: &SkillTable, cell: &mut Workcell) -> Result<(), SkillError> {
    for connection in missed(cell)? {
        let at = cell.belief.pinned.iter().position(|(pinned, _)| *pinned == connection);
        let Some((_, peg)) = at.map(|at| cell.belief.pinned.remove(at)) else { continue };
        let name = &cell.assembly.connections[connection].name;
        let because = format!("{peg} holds one beam of {name} alone");
        cell.record(Retry::new("pin", name).because(because));
        let fetched = fetch(skills, cell, &Item::Peg(peg), Grasp::Head);
        if !note_fault(cell, fetched)? {
            clear_hand(skills, cell)?;
        }
        cell.retreat()?;
    }
    Ok(())
}

/// Pushes beams that stand loose in the assembly, and were displaced or are short of their places, to their
/// places. The planner knows beams by what they meet, and such a beam meets nothing yet. One that does not
/// follow is left for the next; one that stays far short of its place is drawn out again, and put on the
/// sheet.
fn realign(skills: &SkillTable, cell: &mut Workcell) -> Result<(), SkillError> {
    for beam in cell.belief.displaced()? {
        match align(skills, cell, beam) {
            Err(SkillError::Fault(
                fault @ (Fault::Misaligned { .. } | Fault::OffPlace { .. } | Fault::Jammed { .. }),
            )) => cell.record(fault),
            done => done?,
        }
        if !cell.belief.lies(beam) && cell.belief.short(beam)? > cell.parameters.insertion.back_caught {
            clear_hand(skills, cell)?;
            draw_out(skills, cell, beam)?;
        }
        cell.remember_standing(&[beam]);
    }
    Ok(())
}

/// Draws a beam out of the assembly, and puts it in its place on the sheet.
fn draw_out(skills: &SkillTable, cell: &mut Workcell, beam: usize) -> Result<(), SkillError> {
    let name = cell.assembly.beams[beam].beam.name.clone();
    cell.record(Retry::new("insert", &name).because("it stays short of its place, and is drawn out"));
    let link = cell.nearest_link(beam)?;
    skills.execute(cell, &Call::alone(&FineAction::TakeOut { beam: name.clone(), link }))?;
    skills.execute(cell, &Call::alone(&FineAction::PutDown { item: Item::Beam(name) }))?;
    cell.retreat()
}

/// Puts back the held part, if any.
fn put_down(skills: &SkillTable, cell: &mut Workcell) -> Result<(), SkillError> {
    let Some(part) = cell.hand.held.as_ref().map(|held| held.part.clone()) else { return Ok(()) };
    let item = if cell.kit.beam(&part).is_some() { Item::Beam(part) } else { Item::Peg(part) };
    skills.perform(cell, &Call::alone(&FineAction::PutDown { item }))
}

/// Picks a part up from where it lies, and puts it in its place on the sheet.
pub(crate) fn fetch(
    skills: &SkillTable,
    cell: &mut Workcell,
    item: &Item,
    grasp: Grasp,
) -> Result<(), SkillError> {
    let pick_up = FineAction::PickUp { item: item.clone(), grasp };
    skills.execute(cell, &Call::alone(&pick_up))?;
    cell.return_to_sheet(item.name());
    skills.execute(cell, &Call::alone(&FineAction::PutDown { item: item.clone() }))
}

/// Pegs that stand upright in holes of the frame, and pin nothing that the goal pins, nor will when pressed.
fn misplaced_pegs(cell: &Workcell) -> Vec<String> {
    let assembly = cell.assembly;
    let mut holes: Vec<Point3<f64>> = Vec::new();
    for index in &cell.belief.standing {
        let beam = &assembly.beams[*index].beam;
        let Ok(x_wb) = cell.belief.parts.pose(&beam.name) else { continue };
        holes.extend((0..beam.joints.len()).map(|joint| x_wb * beam.p_b_hole(joint)));
    }
    let in_a_hole = |peg: &String| {
        let Ok(x_wp) = cell.belief.parts.pose(peg) else { return false };
        let upright = (x_wp.rotation * Vector3::z()).z > 0.99;
        let near = |hole: &Point3<f64>| {
            let off = x_wp.translation.vector - hole.coords;
            off.xy().norm() < 2.0 * cell.parameters.alignment.fallen
                && off.z < FEMALE_HEIGHT / 2.0 + STEM_LENGTH
        };
        upright && holes.iter().any(near)
    };
    let pegs = cell.kit.pegs.iter().map(|peg| peg.name.clone());
    // One that no camera has found since it was lost is believed to be where the hand was.
    let seen = pegs.filter(|peg| !cell.belief.parts.is_lost(peg));
    let free = seen.filter(|peg| !cell.belief.pinned.iter().any(|(_, pinned)| pinned == peg));
    free.filter(|peg| !matches!(cell.belief.fallen_into(peg), Ok(Some(_)))).filter(in_a_hole).collect()
}

/// Takes pegs out of holes in which they pin nothing, and puts each back in its holder: they are in the way
/// of the pegs that are to go there. Returns true if there were any.
///
/// # Errors
/// The robot's.
pub(crate) fn take_out_misplaced(skills: &SkillTable, cell: &mut Workcell) -> Result<bool, RobotError> {
    let misplaced = misplaced_pegs(cell);
    for peg in &misplaced {
        let text = format!("{peg} stands in a hole and pins nothing: it is taken out");
        cell.record(EventKind::Note { text });
        let fetched = fetch(skills, cell, &Item::Peg(peg.clone()), Grasp::Head);
        if !note_fault(cell, fetched)? {
            clear_hand(skills, cell)?;
        }
        let retreated = cell.retreat();
        note_fault(cell, retreated)?;
    }
    Ok(!misplaced.is_empty())
}

/// Records a fault and continues; only an error from which the robot does not recover ends the work.
pub(crate) fn note_fault(cell: &mut Workcell, result: Result<(), SkillError>) -> Result<bool, RobotError> {
    match result {
        Err(SkillError::Robot(error)) => Err(error),
        Err(error) => {
            cell.record(error.fault());
            Ok(false)
        }
        Ok(()) => Ok(true),
    }
}

/// Releases a beam that is caught in a joint in place, puts back what else the hand holds, raises the hand,
/// and looks.
///
/// # Errors
/// The robot's.
pub(crate) fn clear_hand(skills: &SkillTable, cell: &mut Workcell) -> Result<(), RobotError> {
    let done = Insertion::new(&cell.parameters).let_go_of_caught(cell);
    note_fault(cell, done)?;
    let done = put_down(skills, cell);
    note_fault(cell, done)?;
    let done = cell.release();
    note_fault(cell, done)?;
    let done = cell.retreat();
    note_fault(cell, done)?;
    let done = cell.belief.parts.update(&mut cell.hand);
    note_fault(cell, done.map_err(SkillError::from))?;
    Ok(())
}

/// After a fault: puts back the held part or releases it in place, retreats, takes out pegs that hold one
/// beam alone, realigns loose beams or draws them out, seats pegs that fell into holes, and takes out those
/// that pin nothing. Adds to `lost` the pegs that can no longer be fetched; `refused` is one that could not
/// be gripped.
///
/// # Errors
/// The robot's.
pub fn recover(
    skills: &SkillTable,
    cell: &mut Workcell,
    refused: Option<&str>,
    lost: &mut Vec<String>,
) -> Result<(), RobotError> {
    clear_hand(skills, cell)?;
    let done = take_out_missed(skills, cell);
    note_fault(cell, done)?;
    let done = realign(skills, cell);
    note_fault(cell, done)?;
    let kit = cell.kit;
    for peg in &kit.pegs {
        let pinned = cell.belief.pinned.iter().any(|(_, name)| *name == peg.name);
        // One that no camera has found since it was lost is believed to be where the hand was.
        if pinned || cell.belief.parts.is_lost(&peg.name) {
            continue;
        }
        let Ok(Some(connection)) = cell.belief.fallen_into(&peg.name) else { continue };
        let name = &cell.assembly.connections[connection].name;
        let because = format!("it has fallen into the hole of {name}");
        cell.record(Retry::new("seat", &peg.name).because(because));
        let done = cell.seat_peg(connection, &peg.name);
        if note_fault(cell, done)? {
            cell.belief.pinned.push((connection, peg.name.clone()));
        }
    }
    take_out_misplaced(skills, cell)?;
    for peg in &kit.pegs {
        let pinned = cell.belief.pinned.iter().any(|(_, name)| *name == peg.name);
        let upright = cell.belief.parts.pose(&peg.name).is_ok_and(|x_wp| {
            let in_holder = cell.belief.parts.place(&peg.name).is_some_and(|place| {
                (place.translation.vector - x_wp.translation.vector).norm()
                    < cell.parameters.agent.peg_strayed
            });
            in_holder && (x_wp.rotation * Vector3::z()).z > 0.99
        });
        let usable = upright && refused != Some(peg.name.as_str());
        if !pinned && !usable && !lost.contains(&peg.name) {
            cell.record(Fault::Lost { peg: peg.name.clone() });
            lost.push(peg.name.clone());
        }
    }
    Ok(())
}
