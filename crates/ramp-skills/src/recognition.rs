//! Recognises what stands when the work begins: beams in their places in the frame, and pegs in their holes.
//!
//! An episode may begin with a frame that is built in part. The agent is not told so: it sees it.

use nalgebra::{Point3, Translation3};
use ramp_kit::joint::FEMALE_HEIGHT;
use ramp_planner::State;
use ramp_robot::{EventKind, RobotError};

use crate::Pose;
use crate::cell::Workcell;
use crate::fault::{Fault, SkillError};
use crate::recovery::recover;
use crate::table::SkillTable;

/// A beam of the goal, by its index, and the beam that stands in its place, by name.
pub type Swap = (usize, String);

/// Takes over a frame that stands in part when the work begins, and brings it in order as after a fault:
/// loose beams are realigned, pegs that are not flush pressed. Adds to `lost` the pegs that cannot be
/// fetched.
///
/// # Errors
/// The robot's.
pub fn take_over(skills: &SkillTable, cell: &mut Workcell, lost: &mut Vec<String>) -> Result<(), RobotError> {
    let stand = recognise(cell);
    if stand.is_empty() {
        return Ok(());
    }
    cell.record(EventKind::Note { text: format!("in their places in the frame: {}", stand.join(", ")) });
    recover(skills, cell, None, lost)
}

/// Takes every beam that is seen in its place as standing, and every peg that is seen seated between two such
/// beams as seated. Gives the names of both.
pub fn recognise(cell: &mut Workcell) -> Vec<String> {
    let assembly = cell.assembly;
    let mut found = Vec::new();
    for index in (0..assembly.beams.len()).filter(|index| *index != assembly.base) {
        if is_in_place(cell, index, &assembly.beams[index].beam.name)
            && !cell.belief.standing.contains(&index)
        {
            cell.belief.standing.push(index);
            found.push(assembly.beams[index].beam.name.clone());
        }
    }
    for peg in &cell.kit.pegs {
        let Ok(Some(connection)) = cell.belief.fallen_into(&peg.name) else { continue };
        // Any other peg in a hole is pressed.
        let flush = |gap: f64| gap <= 2.0 * cell.parameters.press.seated;
        if cell.belief.gap(connection, &peg.name).is_ok_and(flush) {
            cell.belief.pinned.push((connection, peg.name.clone()));
            found.push(peg.name.clone());
        }
    }
    if !found.is_empty() {
        let standing = cell.belief.standing.clone();
        cell.remember_standing(&standing);
    }
    found
}

/// Whether both ends of a beam of this name are seen where those of a beam of the goal are in the frame, and
/// the right side is up.
pub fn is_in_place(cell: &Workcell, index: usize, beam: &str) -> bool {
    let placed = &cell.assembly.beams[index];
    let Ok(x_wb) = cell.belief.parts.pose(beam) else { return false };
    let goal = cell.belief.x_wa() * placed.x_ab;
    let near = |p: Point3<f64>| (x_wb * p - goal * p).norm() < cell.parameters.alignment.stands;
    // The third point is beside the axis: it tells the turn about the axis.
    let span = placed.beam.span();
    near(Point3::origin()) && near(Point3::new(span, 0.0, 0.0)) && near(Point3::new(0.0, span, 0.0))
}

/// Records the given assembly without a detection.
///
/// # Errors
/// [`Fault::Unseen`] for a name that the goal lacks.
pub fn expect_state(cell: &mut Workcell, state: &State) -> Result<(), SkillError> {
    let unknown = |name: &str| Fault::Unseen { part: name.to_string() };
    let assembly = cell.assembly;
    for name in &state.in_assembly {
        cell.belief.standing.push(assembly.beam_index(name).ok_or_else(|| unknown(name))?);
    }
    for name in &state.deep {
        cell.belief.deep.push(assembly.beam_index(name).ok_or_else(|| unknown(name))?);
    }
    for (name, peg) in &state.fastened {
        let connection = assembly.connection_index(name).ok_or_else(|| unknown(name))?;
        cell.belief.pinned.push((connection, peg.clone()));
        let hole = cell.belief.x_wa() * assembly.p_a_hole(assembly.connections[connection].female);
        let x_wp = Pose::translation(hole.x, hole.y, hole.z + FEMALE_HEIGHT / 2.0);
        cell.belief.parts.expect(
            peg,
            x_wp,
            (cell.parameters.piece.peg_position, cell.parameters.piece.peg_rotation),
        );
    }
    let beams: Vec<usize> =
        cell.belief.standing.iter().copied().filter(|beam| *beam != assembly.base).collect();
    for &beam in &beams {
        let mut x_wb = cell.belief.x_wa() * assembly.beams[beam].x_ab;
        if cell.belief.deep.contains(&beam) {
            let path = cell.belief.path(beam)?;
            x_wb = Translation3::from(cell.belief.x_wa().rotation * path.direction * path.depth) * x_wb;
        }
        let x_wb = cell.belief.drooped(beam, &x_wb).unwrap_or(x_wb);
        cell.belief.parts.expect(
            &assembly.beams[beam].beam.name,
            x_wb,
            (cell.parameters.piece.beam_position, cell.parameters.piece.beam_rotation),
        );
    }
    for beam in beams {
        cell.belief.reckon_heights(beam);
    }
    Ok(())
}
