//! Actions of a plan in the terms of the rules.

use super::table::Replayer;
use crate::answer::{receives, sleeved};
use crate::facts::{beam_item, beam_name, connection_name, peg_item};
use crate::fine_action::{FineAction, Parameter, Value};
use crate::place::{Grasp, Item, Place, Target};
use crate::plan::CoarseAction;
use crate::state::area_name;
use ramp_action_language::Term;
use ramp_assembly::{Connection, JointRef};

/// A value, or the defect of an action.
pub(crate) type Check<T> = Result<T, String>;

impl Replayer<'_> {
    /// A coarse action as a term of the rules; `rest` determines for which connection a peg is
    /// fetched.
    pub(crate) fn coarse_term<'s>(
        &self,
        action: &CoarseAction,
        rest: impl Iterator<Item = &'s CoarseAction>,
    ) -> Check<Term> {
        let beam = |name: &str| self.beam(name);
        Ok(match action {
            CoarseAction::Move { to } => Term::new("move", [area_name(*to)]),
            CoarseAction::PickUp { item } => Term::new("pick_up", [self.item(item, rest)?]),
            CoarseAction::PutDown { item } => Term::new("put_down", [self.held(item)?]),
            CoarseAction::Assemble { beam: name } => Term::new("assemble", [beam(name)?]),
            CoarseAction::AssembleDeep { beam: name } => Term::new("assemble_deep", [beam(name)?]),
            CoarseAction::LayDown { beam: name } => Term::new("lay_down", [beam(name)?]),
            CoarseAction::Slide { beam: name } => Term::new("slide", [beam(name)?]),
            CoarseAction::Regrasp { beam: name } => Term::new("regrasp", [beam(name)?]),
            CoarseAction::Push { beam: name } => Term::new("push", [beam(name)?]),
            CoarseAction::Fasten { connection, .. } => Term::new("fasten", [self.connection(connection)?]),
            CoarseAction::TakeOut { .. } | CoarseAction::PullOut { .. } | CoarseAction::SlideBack { .. } => {
                return Err("this takes the frame apart".to_string());
            }
        })
    }

    pub(crate) fn fine_term<'s>(
        &self,
        action: &FineAction,
        stands: &[bool],
        deep: &[bool],
        coarse: &CoarseAction,
        rest: impl Iterator<Item = &'s CoarseAction> + Clone,
    ) -> Check<Term> {
        let assembly = self.planner.assembly;
        let kind = action.kind();
        let mut terms = Vec::new();
        // The beam and the connection of the action, by index: other fields follow from them.
        let (mut beam, mut connection) = (None, None);
        for (parameter, value) in kind.parameters().iter().zip(action.values()) {
            let of_beam = || beam.ok_or("there is no such beam");
            let of_connection = || connection.ok_or("there is no such connection");
            let joint = |side: fn(&Connection) -> JointRef, name: &str| {
                let joint = side(&assembly.connections[of_connection()?]);
                if assembly.joint_name(joint) == name { Ok(()) } else { Err("these are not its joints") }
            };
            match (parameter, value) {
                (Parameter::Place, Value::Place(place)) => {
                    terms.push(self.place(&place, coarse, rest.clone())?);
                }
                (Parameter::Item, Value::Item(item)) => terms.push(self.item(&item, rest.clone())?),
                (Parameter::Held, Value::Item(item)) => terms.push(self.held(&item)?),
                (Parameter::Grasp, Value::Grasp(Grasp::Head)) => terms.push(Term::new("head", [])),
                (Parameter::Grasp, Value::Grasp(Grasp::Link(link))) => {
                    terms.push(Term::new("link", [Term::from(link.as_str())]));
                }
                (Parameter::Beam, Value::Name(name)) => {
                    beam = assembly.beam_index(&name);
                    terms.push(self.beam(&name)?);
                }
                (Parameter::Name, Value::Name(name)) => terms.push(Term::from(name.as_str())),
                (Parameter::Sleeved, Value::Names(names)) => {
                    if names != sleeved(assembly, of_beam()?, stands) {
                        return Err("these are not the joints that come to lie in sleeves".to_string());
                    }
                }
                (Parameter::Receiving, Value::Names(names)) => {
                    if names != receives(assembly, of_beam()?, stands, deep) {
                        return Err("these are not the joints that receive".to_string());
                    }
                }
                (Parameter::Connection, Value::Name(name)) => {
                    connection = assembly.connection_index(&name);
                    terms.push(connection_name(assembly, connection.ok_or("there is no such connection")?));
                }
                (Parameter::Female, Value::Name(name)) => joint(|pair| pair.female, &name)?,
                (Parameter::Male, Value::Name(name)) => joint(|pair| pair.male, &name)?,
                (Parameter::Peg, Value::Name(peg)) => {
                    if !matches!(coarse, CoarseAction::Fasten { peg: other, .. } if *other == peg) {
                        return Err("the fine actions use another peg than the coarse one".to_string());
                    }
                }
                _ => return Err(format!("the fields of {} do not fit", kind.name())),
            }
        }
        Ok(Term::Function(kind.name().to_string(), terms))
    }

    fn place<'s>(
        &self,
        place: &Place,
        coarse: &CoarseAction,
        rest: impl Iterator<Item = &'s CoarseAction>,
    ) -> Check<Term> {
        let target = |target: &Target| {
            Ok::<Term, String>(match target {
                Target::Beam(name) => Term::new("beam", [self.beam(name)?]),
                Target::Connection(name) => Term::new("hole", [self.connection(name)?]),
            })
        };
        Ok(match place {
            Place::Above(area) => Term::new("above", [area_name(*area)]),
            Place::Input(item) => {
                let item = match coarse {
                    CoarseAction::PutDown { .. } => self.held(item)?,
                    _ => self.item(item, rest)?,
                };
                Term::new("input", [item])
            }
            Place::Approach(of) => Term::new("approach", [target(of)?]),
            Place::Target(of) => Term::new("target", [target(of)?]),
        })
    }

    fn beam(&self, name: &str) -> Check<Term> {
        let index =
            self.planner.assembly.beam_index(name).ok_or_else(|| format!("there is no beam {name}"))?;
        Ok(beam_name(self.planner.assembly, index))
    }

    fn connection(&self, name: &str) -> Check<Term> {
        let assembly = self.planner.assembly;
        let index =
            assembly.connection_index(name).ok_or_else(|| format!("there is no connection {name}"))?;
        Ok(connection_name(assembly, index))
    }

    /// An item to be fetched. Pegs are interchangeable: the rules name them by their connection.
    fn item<'s>(&self, item: &Item, rest: impl Iterator<Item = &'s CoarseAction>) -> Check<Term> {
        let assembly = self.planner.assembly;
        let peg = match item {
            Item::Beam(name) => return Ok(Term::new("beam", [self.beam(name)?])),
            Item::Peg(peg) => peg,
        };
        for action in rest {
            match action {
                CoarseAction::Fasten { connection, peg: other } if other == peg => {
                    return Ok(Term::new("peg", [self.connection(connection)?]));
                }
                CoarseAction::PutDown { item: other } if other == item => break,
                _ => {}
            }
        }
        let free = self.pegs.iter().position(Option::is_none).ok_or("all connections have their pegs")?;
        Ok(peg_item(assembly, free))
    }

    /// The item in the hand.
    fn held(&self, item: &Item) -> Check<Term> {
        if self.hand.as_ref() != Some(item) {
            return Err(format!("{item} is not in the hand"));
        }
        let assembly = self.planner.assembly;
        let model = &self.planner.model;
        let items = (0..assembly.beams.len())
            .map(|beam| beam_item(assembly, beam))
            .chain((0..assembly.connections.len()).map(|connection| peg_item(assembly, connection)));
        let mut held = items.filter(|item| model.holds(&self.state, &Term::new("in_hand", [item.clone()])));
        held.next().ok_or_else(|| format!("{item} is not in the hand"))
    }
}
