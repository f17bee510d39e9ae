//! The baseline takes a frame apart: the plan of the build, backwards.
//!
//! It knows that the frame is built, and of which parts. Pegs are pulled out and beams drawn out one after
//! another, and each is put back in its place on the sheet before the next. What fails is tried again
//! [otherwise](super::apart); a part that fell is picked up from where it lies.

use ramp_planner::{Grasp, Item, Plan, PlanError, State, backwards, plan};
use ramp_robot::{EventKind, RobotError};

use super::Baseline;
use crate::cell::Workcell;
use crate::fault::SkillError;
use crate::recognition::expect_state;
use crate::recovery::{clear_hand, fetch, note_fault};
use crate::rehearsal::{Rehearsal, Scene, plan_with_motion};

impl Baseline<'_> {
    /// Takes the frame apart.
    ///
    /// # Errors
    /// The robot's.
    pub(crate) fn take_apart(&mut self, cell: &mut Workcell) -> Result<(), RobotError> {
        let state = built(cell);
        let known = expect_state(cell, &state);
        note_fault(cell, known)?;
        let seen = cell.look_first();
        note_fault(cell, seen)?;
        let built = match self.plan_of_build(cell) {
            Ok(plan) => plan,
            Err(error) => {
                self.give_up(cell, &format!("no plan: {error}"));
                return Ok(());
            }
        };
        self.begins_with(&backwards(&built, &state.fastened));
        self.learn_paths(cell, &built);
        if let Some(why) = self.carry_out_backwards(cell, &built, &|left| left)? {
            self.tidy(cell)?;
            self.give_up(cell, &why);
            return Ok(());
        }
        self.tidy(cell)?;
        let beside: Vec<&str> =
            cell.assembly.movable_parts().into_iter().filter(|part| !cell.is_in_sheet_place(part)).collect();
        if !beside.is_empty() {
            self.give_up(cell, &format!("not in their places on the sheet: {}", beside.join(", ")));
        }
        Ok(())
    }

    /// The plan of the build from the sheet, rehearsed with the arm's model.
    fn plan_of_build(&mut self, cell: &mut Workcell) -> Result<Plan, PlanError> {
        let state = State::default();
        let (assembly, arm, domains) = (self.assembly, self.arm, self.domains);
        let (planner, parameters, skills) = (cell.planner, cell.parameters.clone(), self.skills.clone());
        let rehearsed = self.timed(|| {
            plan_with_motion(assembly, &state, domains, || {
                let scene = Scene::nominal(assembly, arm, planner, parameters.clone(), &state);
                Rehearsal::new(scene, skills.clone())
            })
        });
        match rehearsed {
            Ok(rehearsed) => {
                cell.grasps = rehearsed.grasps.into_iter().map(|(beam, it)| (beam, it.grasp)).collect();
                Ok(rehearsed.plan)
            }
            // The arm may manage what the rehearsal could not.
            Err(PlanError::Motion { .. }) => plan(assembly, &state, domains),
            Err(error) => Err(error),
        }
    }

    /// Fetches parts that lie about, and puts each in its place on the sheet. One that cannot be taken stays.
    fn tidy(&mut self, cell: &mut Workcell) -> Result<(), RobotError> {
        let seen = cell.belief.parts.update(&mut cell.hand);
        note_fault(cell, seen.map_err(SkillError::from))?;
        for part in cell.assembly.movable_parts() {
            let beam = cell.kit.beam(part);
            let item = match beam {
                Some(_) => Item::Beam(part.to_string()),
                None => Item::Peg(part.to_string()),
            };
            if stands(cell, &item) || cell.is_in_sheet_place(part) {
                continue;
            }
            cell.record(EventKind::Note { text: format!("{part} is not in its place on the sheet") });
            let links = beam.map_or(&[][..], |beam| &beam.links);
            let grasps = links.iter().map(|link| Grasp::Link(link.name.clone()));
            let grasps: Vec<Grasp> = if beam.is_some() { grasps.collect() } else { vec![Grasp::Head] };
            for grasp in grasps {
                let fetched = fetch(&self.skills, cell, &item, grasp);
                let done = note_fault(cell, fetched)?;
                clear_hand(&self.skills, cell)?;
                self.report(cell);
                if done {
                    break;
                }
            }
        }
        Ok(())
    }
}

/// The state of the built frame.
fn built(cell: &Workcell) -> State {
    let assembly = cell.assembly;
    let beams = assembly.beams.iter().enumerate().filter(|(index, _)| *index != assembly.base);
    let connections = assembly.connections.iter().map(|connection| connection.name.clone());
    State {
        in_assembly: beams.map(|(_, placed)| placed.beam.name.clone()).collect(),
        fastened: connections.zip(assembly.built_with().into_iter().map(str::to_string)).collect(),
        ..State::default()
    }
}

/// Whether a part is still in its place in the frame, as is believed.
pub fn stands(cell: &Workcell, item: &Item) -> bool {
    match item {
        Item::Beam(beam) => {
            cell.assembly.beam_index(beam).is_some_and(|beam| cell.belief.standing.contains(&beam))
        }
        Item::Peg(peg) => cell.belief.pinned.iter().any(|(_, pinned)| pinned == peg),
    }
}

/// Whether a beam stands deeper than its place, as is believed.
pub fn is_deep(cell: &Workcell, beam: &str) -> bool {
    cell.assembly.beam_index(beam).is_some_and(|beam| cell.belief.deep.contains(&beam))
}
