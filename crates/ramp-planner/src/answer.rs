//! Answers of the rules, translated into the terms of plans.

use crate::error::PlanError;
use crate::fine_action::{ActionKind, FineAction, Parameter, Value};
use crate::pegs::Pegs;
use crate::place::{Area, Grasp, Item, Place, Target};
use crate::plan::CoarseAction;
use ramp_action_language::Term;
use ramp_assembly::Assembly;
use ramp_source::SourceFile;

/// Looks up the names in an answer.
pub(crate) struct Answers<'a> {
    pub assembly: &'a Assembly,
    /// The names of the pegs.
    pub pegs: &'a [String],
    pub rules: &'a SourceFile,
}

impl Answers<'_> {
    fn wrong(&self, term: &Term) -> PlanError {
        meaningless(self.rules, term)
    }

    pub(crate) fn coarse_action(&self, term: &Term, pegs: &mut Pegs) -> Result<CoarseAction, PlanError> {
        Ok(match term.parts() {
            Some(("move", [to])) => CoarseAction::Move { to: self.area(to)? },
            Some(("pick_up", [item])) => CoarseAction::PickUp { item: self.item(item, pegs)? },
            Some(("put_down", [item])) => CoarseAction::PutDown { item: self.item(item, pegs)? },
            Some(("assemble", [beam])) => CoarseAction::Assemble { beam: self.beam_name(beam)? },
            Some(("assemble_deep", [beam])) => CoarseAction::AssembleDeep { beam: self.beam_name(beam)? },
            Some(("lay_down", [beam])) => CoarseAction::LayDown { beam: self.beam_name(beam)? },
            Some(("slide", [beam])) => CoarseAction::Slide { beam: self.beam_name(beam)? },
            Some(("regrasp", [beam])) => CoarseAction::Regrasp { beam: self.beam_name(beam)? },
            Some(("push", [beam])) => CoarseAction::Push { beam: self.beam_name(beam)? },
            Some(("fasten", [connection])) => {
                let index = self.connection(connection)?;
                let connection = self.assembly.connections[index].name.clone();
                CoarseAction::Fasten { connection, peg: pegs.name(self.pegs, index) }
            }
            _ => return Err(self.wrong(term)),
        })
    }

    /// `stands` and `deep` are the beams placed before the action, and those of them that are
    /// pushed back.
    pub(crate) fn fine_action(
        &self,
        term: &Term,
        stands: &[bool],
        deep: &[bool],
        pegs: &mut Pegs,
    ) -> Result<FineAction, PlanError> {
        let wrong = || self.wrong(term);
        let (name, terms) = term.parts().ok_or_else(wrong)?;
        let kind = ActionKind::ALL.iter().copied().find(|kind| kind.name() == name).ok_or_else(wrong)?;
        let mut terms = terms.iter();
        let mut values: Vec<Value> = Vec::new();
        // The beam and the connection of the action, by index: other fields follow from them.
        let (mut beam, mut connection) = (None, None);
        for parameter in kind.parameters() {
            let mut next = || terms.next().ok_or_else(wrong);
            let joints = |connection: Option<usize>| {
                connection.map(|index| &self.assembly.connections[index]).ok_or_else(wrong)
            };
            values.push(match parameter {
                Parameter::Place => self.place(next()?, pegs)?.into(),
                Parameter::Item | Parameter::Held => self.item(next()?, pegs)?.into(),
                Parameter::Grasp => self.grasp(next()?)?.into(),
                Parameter::Beam => {
                    let term = next()?;
                    beam = Some(self.beam(term)?);
                    self.beam_name(term)?.into()
                }
                Parameter::Name => self.text(next()?)?.into(),
                Parameter::Sleeved => sleeved(self.assembly, beam.ok_or_else(wrong)?, stands).into(),
                Parameter::Receiving => receives(self.assembly, beam.ok_or_else(wrong)?, stands, deep).into(),
                Parameter::Connection => {
                    let index = self.connection(next()?)?;
                    connection = Some(index);
                    self.assembly.connections[index].name.clone().into()
                }
                Parameter::Female => self.assembly.joint_name(joints(connection)?.female).to_string().into(),
                Parameter::Male => self.assembly.joint_name(joints(connection)?.male).to_string().into(),
                Parameter::Peg => pegs.name(self.pegs, connection.ok_or_else(wrong)?).into(),
            });
        }
        match terms.next() {
            None => FineAction::new(kind, values).ok_or_else(wrong),
            Some(_) => Err(wrong()),
        }
    }

    fn grasp(&self, term: &Term) -> Result<Grasp, PlanError> {
        match term.parts() {
            Some(("link", [link])) => Ok(Grasp::Link(self.text(link)?)),
            Some(("head", [])) => Ok(Grasp::Head),
            _ => Err(self.wrong(term)),
        }
    }

    fn place(&self, term: &Term, pegs: &mut Pegs) -> Result<Place, PlanError> {
        match term.parts() {
            Some(("above", [of])) => Ok(Place::Above(self.area(of)?)),
            Some(("input", [item])) => Ok(Place::Input(self.item(item, pegs)?)),
            Some(("approach", [of])) => Ok(Place::Approach(self.target(of)?)),
            Some(("target", [of])) => Ok(Place::Target(self.target(of)?)),
            _ => Err(self.wrong(term)),
        }
    }

    fn target(&self, term: &Term) -> Result<Target, PlanError> {
        match term.parts() {
            Some(("beam", [beam])) => Ok(Target::Beam(self.beam_name(beam)?)),
            Some(("hole", [connection])) => {
                let index = self.connection(connection)?;
                Ok(Target::Connection(self.assembly.connections[index].name.clone()))
            }
            _ => Err(self.wrong(term)),
        }
    }

    fn item(&self, term: &Term, pegs: &mut Pegs) -> Result<Item, PlanError> {
        match term.parts() {
            Some(("beam", [beam])) => Ok(Item::Beam(self.beam_name(beam)?)),
            Some(("peg", [connection])) => {
                let index = self.connection(connection)?;
                Ok(Item::Peg(pegs.name(self.pegs, index)))
            }
            _ => Err(self.wrong(term)),
        }
    }

    fn area(&self, term: &Term) -> Result<Area, PlanError> {
        match term.parts() {
            Some(("input", [])) => Ok(Area::Input),
            Some(("intermediate", [])) => Ok(Area::Intermediate),
            Some(("assembly", [])) => Ok(Area::Assembly),
            _ => Err(self.wrong(term)),
        }
    }

    fn text(&self, term: &Term) -> Result<String, PlanError> {
        match term {
            Term::Text(text) => Ok(text.clone()),
            _ => Err(self.wrong(term)),
        }
    }

    pub(crate) fn beam(&self, term: &Term) -> Result<usize, PlanError> {
        self.assembly.beam_index(&self.text(term)?).ok_or_else(|| self.wrong(term))
    }

    fn beam_name(&self, term: &Term) -> Result<String, PlanError> {
        Ok(self.assembly.beams[self.beam(term)?].beam.name.clone())
    }

    fn connection(&self, term: &Term) -> Result<usize, PlanError> {
        self.assembly.connection_index(&self.text(term)?).ok_or_else(|| self.wrong(term))
    }
}

/// The joints that a cap puts over placed males, from j1 to jn.
pub(crate) fn receives(assembly: &Assembly, beam: usize, stands: &[bool], deep: &[bool]) -> Vec<String> {
    let over = |joint: usize| {
        assembly.connections.iter().any(|c| {
            c.female.beam == beam && c.female.joint == joint && stands[c.male.beam] && !deep[c.male.beam]
        })
    };
    let joints = assembly.beams[beam].beam.joints.iter().enumerate();
    joints.filter(|(index, _)| over(*index)).map(|(_, joint)| joint.name.clone()).collect()
}

/// The middle joints of a beam that end up inside placed females, from j1 to jn.
pub(crate) fn sleeved(assembly: &Assembly, beam: usize, stands: &[bool]) -> Vec<String> {
    let within = |joint: usize| {
        assembly
            .connections
            .iter()
            .any(|c| c.male.beam == beam && c.male.joint == joint && stands[c.female.beam])
    };
    let joints = assembly.beams[beam].beam.joints.iter().enumerate();
    joints
        .filter(|(index, joint)| !joint.kind.is_end() && within(*index))
        .map(|(_, joint)| joint.name.clone())
        .collect()
}

pub(crate) fn meaningless(rules: &SourceFile, term: &Term) -> PlanError {
    PlanError::Answer { file: rules.name().to_string(), answer: term.to_string() }
}
