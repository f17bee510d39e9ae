//! The tasks of a plan, in order: place a beam, pin its connections, slide beams forward.

use super::core::Planner;
use super::order::Order;
use crate::error::PlanError;
use crate::facts::{self, beam_name, connection_name, peg_item};
use crate::state::Known;
use ramp_action_language::{State as Fluents, Term};

/// A task: fluents with their required truth values.
pub(crate) type Task = Vec<(Term, bool)>;

impl Planner<'_> {
    /// The known coarse state.
    pub(crate) fn fluents(&self, known: &Known) -> Result<Fluents, PlanError> {
        let mut told = known.told(self.assembly);
        if known.held_peg.is_some() {
            // Pegs are interchangeable: this one belongs to the connection that is pinned next.
            let first = self.tasks(&Order::default(), known).into_iter().flatten().find_map(|(term, _)| {
                let (name, arguments) = term.parts()?;
                (name == "pinned").then(|| Term::new("in_hand", [Term::new("peg", [arguments[0].clone()])]))
            });
            let open = known.pinned.iter().position(Option::is_none);
            let any = open.map(|index| Term::new("in_hand", [peg_item(self.assembly, index)]));
            told.extend(first.or(any));
        }
        self.model.initial(&told, &[]).map_err(|refusal| self.refused(refusal, "the state"))
    }

    /// The tasks, in order: place a beam, pin its connections, slide beams forward.
    pub(crate) fn tasks(&self, order: &Order, known: &Known) -> Vec<Task> {
        let mut stands = known.stands.clone();
        let mut deep = known.deep.clone();
        let mut pinned: Vec<bool> = known.pinned.iter().map(Option::is_some).collect();
        let mut tasks = Vec::new();
        self.finish(&stands, &mut deep, &mut pinned, &mut tasks);
        for &beam in &order.sequence {
            stands[beam] = true;
            deep[beam] = order.deep.contains(&beam);
            let name = beam_name(self.assembly, beam);
            let fluents = [("in_assembly", true), ("deep", deep[beam])];
            tasks.push(fluents.map(|(fluent, truth)| (Term::new(fluent, [name.clone()]), truth)).to_vec());
            self.finish(&stands, &mut deep, &mut pinned, &mut tasks);
        }
        tasks
    }

    /// Pegs for closed connections, then beams slid forward where all their targets are placed, and
    /// pegs again.
    fn finish(&self, stands: &[bool], deep: &mut [bool], pinned: &mut [bool], tasks: &mut Vec<Task>) {
        loop {
            // Joints that guide the male come first: in any other one the male could rotate about
            // the first peg.
            let mut indices: Vec<usize> = (0..self.assembly.connections.len()).collect();
            indices.sort_by_key(|&index| !facts::is_tight(self.assembly, index));
            for index in indices {
                let connection = &self.assembly.connections[index];
                let sides = [connection.female.beam, connection.male.beam];
                if !pinned[index] && sides.iter().all(|&beam| stands[beam] && !deep[beam]) {
                    pinned[index] = true;
                    tasks.push(vec![(Term::new("pinned", [connection_name(self.assembly, index)]), true)]);
                }
            }
            let ready = |beam: &usize| {
                deep[*beam] && facts::partners(self.assembly, *beam).all(|(_, other)| stands[other])
            };
            let Some(next) = (0..stands.len()).find(ready) else { return };
            deep[next] = false;
            tasks.push(vec![(Term::new("aligned", [beam_name(self.assembly, next)]), true)]);
        }
    }
}
