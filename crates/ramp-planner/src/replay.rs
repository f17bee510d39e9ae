//! Judges plans without clingo: states, conditions and effects by the definition of the language, ways to the beams'
//! places by the shapes of the assembly.

use crate::domains::Domains;
use crate::error::PlanError;
use crate::facts::{self, beam_item, beam_name, connection_name, peg_item};
use crate::language::ground::{Model, Refusal, State as Fluents};
use crate::plan::{Area, CoarseAction, CoarseStep, FineAction, Grasp, Item, Place, State, Target};
use crate::planner::{Options, Planner};
use crate::state::{Known, area_name, look_up};
use crate::term::Term;
use ramp_assembly::Assembly;
use ramp_kit::Kit;
use std::collections::BTreeSet;

/// Why a plan is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("step {step} ({action}): {why}")]
pub struct Refused {
    /// The coarse step, counted from 1; one more than there are when the end is wrong.
    pub step: usize,
    /// The action.
    pub action: String,
    /// What is wrong with it.
    pub why: String,
}

/// The table while a plan is carried out, as both resolutions see it.
///
/// ```
/// use ramp_planner::{Domains, Replayer, State, plan};
///
/// let kit = ramp_kit::read_kit("../../data/kit.xml".as_ref())?;
/// let assembly = ramp_assembly::read_goal("../../data/goals/easy-1.xml".as_ref(), &kit)?;
/// let domains = Domains::read("../../data/domains".as_ref())?;
/// let mut steps = plan(&assembly, &kit, &State::default(), &domains)?.steps;
/// assert!(Replayer::new(&assembly, &kit, &domains, &State::default())?.run(&steps).is_ok());
/// steps.remove(3);
/// assert!(Replayer::new(&assembly, &kit, &domains, &State::default())?.run(&steps).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Replayer<'a> {
    pub(crate) planner: Planner<'a>,
    start: Known,
    state: Fluents,
    /// What the fine domain has besides.
    own: Vec<Term>,
    /// The peg in each connection.
    pegs: Vec<Option<String>>,
    lost: Vec<String>,
    hand: Option<Item>,
}

type Check<T> = Result<T, String>;

impl<'a> Replayer<'a> {
    /// The table at the beginning.
    ///
    /// # Errors
    /// When the state cannot be.
    pub fn new(
        assembly: &'a Assembly,
        kit: &'a Kit,
        domains: &'a Domains,
        state: &State,
    ) -> Result<Replayer<'a>, PlanError> {
        let known = look_up(assembly, kit, state)?;
        let planner = Planner::new(assembly, kit, domains, Options::default());
        let fluents = planner.fluents(&known)?;
        let pinned = known.pinned.iter().map(|peg| peg.map(|peg| planner.pegs[peg].clone())).collect();
        Ok(Replayer {
            planner,
            state: fluents,
            own: vec![Term::new("hand_at", [Term::new("above", [area_name(known.area)])])],
            start: known,
            pegs: pinned,
            lost: state.lost_pegs.clone(),
            hand: state.in_hand.clone(),
        })
    }

    /// Carries out a whole plan and checks that it reaches the goal.
    ///
    /// # Errors
    /// At the first step that is not possible, or does something else than it says.
    pub fn run(&mut self, steps: &[CoarseStep]) -> Result<(), Refused> {
        self.expect_regrasps(steps.iter().map(|step| &step.coarse))?;
        for index in 0..steps.len() {
            self.step(&steps[index..], true).map_err(|why| Refused {
                step: index + 1,
                action: steps[index].coarse.to_string(),
                why,
            })?;
        }
        self.end(steps.len())
    }

    /// The same for coarse actions alone.
    ///
    /// # Errors
    /// As [`Replayer::run`].
    pub fn run_coarse(&mut self, actions: &[CoarseAction]) -> Result<(), Refused> {
        self.carry_out(actions)?;
        self.end(actions.len())
    }

    /// Carries out coarse actions that need not reach the goal: a plan's beginning, up to where nothing is in the hand.
    ///
    /// # Errors
    /// At the first one that is not possible.
    pub fn carry_out(&mut self, actions: &[CoarseAction]) -> Result<(), Refused> {
        let steps: Vec<CoarseStep> =
            actions.iter().map(|coarse| CoarseStep { coarse: coarse.clone(), fine: Vec::new() }).collect();
        self.expect_regrasps(actions.iter())?;
        for index in 0..steps.len() {
            self.step(&steps[index..], false).map_err(|why| Refused {
                step: index + 1,
                action: steps[index].coarse.to_string(),
                why,
            })?;
        }
        Ok(())
    }

    /// A plan may regrasp any beam; the rules then hold it to what that means.
    fn expect_regrasps<'s>(
        &mut self,
        actions: impl Iterator<Item = &'s CoarseAction>,
    ) -> Result<(), Refused> {
        let beams: Vec<usize> = actions
            .filter_map(|action| match action {
                CoarseAction::Regrasp { beam } => self.planner.assembly.beam_index(beam),
                _ => None,
            })
            .collect();
        if self.planner.regrasp(&beams) {
            self.state = self.planner.fluents(&self.start).map_err(|error| Refused {
                step: 1,
                action: "the start".to_string(),
                why: error.to_string(),
            })?;
        }
        Ok(())
    }

    fn end(&self, steps: usize) -> Result<(), Refused> {
        let missing = self.planner.model.missing(&self.state);
        match missing.first() {
            None => Ok(()),
            Some((fluent, wanted)) => Err(Refused {
                step: steps + 1,
                action: "the end".to_string(),
                why: format!("{}{fluent} should hold", if *wanted { "" } else { "-" }),
            }),
        }
    }

    /// Carries out the first of some steps; the others say for which connection a peg is fetched.
    pub(crate) fn step(&mut self, steps: &[CoarseStep], fine: bool) -> Check<()> {
        let Some(step) = steps.first() else { return Ok(()) };
        let rest = || steps[1..].iter().map(|step| &step.coarse);
        let action = self.coarse_term(&step.coarse, rest())?;
        self.geometry(&step.coarse)?;
        let before = self.state.clone();
        let after = self.planner.model.after(&before, &action).map_err(|refusal| words(&refusal))?;
        if fine {
            self.fine(step, &before, &after, rest())?;
        }
        match &step.coarse {
            CoarseAction::PickUp { item } => {
                if let Item::Peg(peg) = item {
                    let in_use =
                        self.pegs.iter().flatten().any(|used| used == peg) || self.lost.contains(peg);
                    if in_use || !self.planner.pegs.contains(peg) {
                        return Err(format!("{peg} cannot be had"));
                    }
                }
                self.hand = Some(item.clone());
            }
            CoarseAction::Fasten { connection, peg } => {
                if self.hand != Some(Item::Peg(peg.clone())) {
                    return Err(format!("{peg} is not in the hand"));
                }
                if let Some(index) = self.planner.assembly.connection_index(connection) {
                    self.pegs[index] = Some(peg.clone());
                }
                self.hand = None;
            }
            _ => {}
        }
        let full = self.planner.model.holds(&after, &Term::new("full", []));
        if !full {
            self.hand = None;
        }
        self.state = after;
        Ok(())
    }

    pub(crate) fn fluents(&self) -> &Fluents {
        &self.state
    }

    /// Something happens, if it can.
    pub(crate) fn happens(&mut self, event: &Term) {
        let Ok(after) = self.planner.model.after(&self.state, event) else { return };
        self.state = after;
        let dropped = matches!(event.parts(), Some(("drop_peg", _)));
        if let (true, Some(Item::Peg(peg))) = (dropped, self.hand.take_if(|_| dropped)) {
            self.lost.push(peg);
        }
    }

    /// Is there a way for what is placed?
    fn geometry(&self, action: &CoarseAction) -> Check<()> {
        let (beam, laid) = match action {
            CoarseAction::Assemble { beam } | CoarseAction::AssembleDeep { beam } => (beam, false),
            CoarseAction::LayDown { beam } => (beam, true),
            _ => return Ok(()),
        };
        let index =
            self.planner.assembly.beam_index(beam).ok_or_else(|| format!("there is no beam {beam}"))?;
        let (stands, _) = self.planner.standing(&self.state);
        match self.planner.geometry.way(index, &stands, laid) {
            Some(_) => Ok(()),
            None => Err(format!("no straight way leads {beam} to its place")),
        }
    }

    // ---- The fine resolution ----------------------------------------------------------------------------------

    fn fine<'s>(
        &mut self,
        step: &CoarseStep,
        before: &Fluents,
        after: &Fluents,
        rest: impl Iterator<Item = &'s CoarseAction> + Clone,
    ) -> Check<()> {
        let (planner, assembly) = (&self.planner, self.planner.assembly);
        let (stands, deep) = planner.standing(before);
        let pinned: Vec<bool> = self.pegs.iter().map(Option::is_some).collect();
        // All that the step can be about: the beams that it names, and those that they meet.
        let mut beams: BTreeSet<usize> = BTreeSet::new();
        let names = self.coarse_term(&step.coarse, rest.clone())?;
        beams.extend(names.texts().iter().filter_map(|text| assembly.beam_index(text)));
        let near: Vec<usize> =
            beams.iter().flat_map(|&beam| facts::partners(assembly, beam)).map(|(_, other)| other).collect();
        beams.extend(near);
        let beams: Vec<usize> = beams.into_iter().collect();
        let mut all = planner.facts.all.clone();
        all.extend(facts::fine(assembly, &planner.geometry, &beams, &|_| true, &stands, &pinned));
        let model = Model::new(planner.domains.fine(), &all);
        let mut told = planner.model.inertial(before);
        told.extend(self.own.iter().cloned());
        let not: Vec<Term> = Vec::new();
        let mut fluents = model.initial(&told, &not).map_err(|refusal| words(&refusal))?;
        for action in &step.fine {
            let term = self.fine_term(action, &stands, &deep, &step.coarse, rest.clone())?;
            fluents =
                model.after(&fluents, &term).map_err(|refusal| format!("{action}: {}", words(&refusal)))?;
        }
        // What the fine actions did is what the coarse action says.
        let reached = model.bridged(&fluents);
        let old: BTreeSet<Term> = planner.model.inertial(before).into_iter().collect();
        let new: BTreeSet<Term> = planner.model.inertial(after).into_iter().collect();
        for fluent in new.difference(&old) {
            let known = fluent.parts().is_some_and(|(name, _)| {
                planner.domains.fine().kind(name).is_some() || planner.domains.fine().bridges(name)
            });
            if known && !reached.contains(fluent) {
                return Err(format!("the fine actions do not make {fluent} true"));
            }
        }
        for fluent in &reached {
            let coarse =
                fluent.parts().is_some_and(|(name, _)| planner.domains.coarse().kind(name).is_some());
            // An alignment that is lost by the way is seen by the coarse domain alone.
            let aligned = matches!(fluent.parts(), Some(("aligned", _)));
            if coarse && !aligned && !new.contains(fluent) {
                return Err(format!("the fine actions make {fluent} true, the coarse one does not"));
            }
        }
        let coarse = planner.domains.coarse();
        let own = model.inertial(&fluents);
        self.own = own
            .into_iter()
            .filter(|f| f.parts().is_some_and(|(name, _)| coarse.kind(name).is_none()))
            .collect();
        Ok(())
    }

    // ---- Plans in the terms of the rules ------------------------------------------------------------------------

    /// A coarse action as the rules name it; `rest` says for which connection a peg is fetched.
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
        })
    }

    fn fine_term<'s>(
        &self,
        action: &FineAction,
        stands: &[bool],
        deep: &[bool],
        coarse: &CoarseAction,
        rest: impl Iterator<Item = &'s CoarseAction> + Clone,
    ) -> Check<Term> {
        let assembly = self.planner.assembly;
        let beam = |name: &str| self.beam(name);
        let text = |name: &str| Term::from(name);
        Ok(match action {
            FineAction::Move { to } => {
                let target = |target: &Target| {
                    Ok::<Term, String>(match target {
                        Target::Beam(name) => Term::new("beam", [beam(name)?]),
                        Target::Connection(name) => Term::new("hole", [self.connection(name)?]),
                    })
                };
                let place = match to {
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
                };
                Term::new("move", [place])
            }
            FineAction::PickUp { item, grasp } => {
                let grasp = match grasp {
                    Grasp::Link(link) => Term::new("link", [text(link)]),
                    Grasp::Head => Term::new("head", []),
                };
                Term::new("pick_up", [self.item(item, rest)?, grasp])
            }
            FineAction::PutDown { item } => Term::new("put_down", [self.held(item)?]),
            FineAction::AssembleSquare { beam: name, joint } => {
                Term::new("assemble_square", [beam(name)?, text(joint)])
            }
            FineAction::AssembleAngled { beam: name, joint } => {
                Term::new("assemble_angled", [beam(name)?, text(joint)])
            }
            FineAction::AssembleThrough { beam: name, joint, through } => {
                let index = assembly.beam_index(name).ok_or("there is no such beam")?;
                if *through != crate::answer::sleeved(assembly, index, stands) {
                    return Err("these are not the joints that come to lie in sleeves".to_string());
                }
                Term::new("assemble_through", [beam(name)?, text(joint)])
            }
            FineAction::AssembleDeep { beam: name, joint } => {
                Term::new("assemble_deep", [beam(name)?, text(joint)])
            }
            FineAction::AssembleCap { beam: name, joints } => {
                let index = assembly.beam_index(name).ok_or("there is no such beam")?;
                if *joints != crate::answer::receives(assembly, index, stands, deep) {
                    return Err("these are not the joints that receive".to_string());
                }
                Term::new("assemble_cap", [beam(name)?])
            }
            FineAction::LayDown { beam: name } => Term::new("lay_down", [beam(name)?]),
            FineAction::Slide { beam: name, link } => Term::new("slide", [beam(name)?, text(link)]),
            FineAction::Regrasp { beam: name, link } => Term::new("regrasp", [beam(name)?, text(link)]),
            FineAction::Push { beam: name, link } => Term::new("push", [beam(name)?, text(link)]),
            FineAction::Fasten { connection, female, male, peg } => {
                let index = assembly.connection_index(connection).ok_or("there is no such connection")?;
                let pair = &assembly.connections[index];
                if [assembly.joint_name(pair.female), assembly.joint_name(pair.male)] != [female, male] {
                    return Err("these are not its joints".to_string());
                }
                if !matches!(coarse, CoarseAction::Fasten { peg: other, .. } if other == peg) {
                    return Err("the fine actions use another peg than the coarse one".to_string());
                }
                Term::new("fasten", [connection_name(assembly, index)])
            }
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

    /// An item that is to be fetched. Pegs are alike: the rules name them by the connection that they are for.
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

    /// What a planner would be told now.
    pub fn state(&self) -> State {
        let assembly = self.planner.assembly;
        let (stands, deep) = self.planner.standing(&self.state);
        let name = |beam: usize| assembly.beams[beam].beam.name.clone();
        let holds = |fluent: &str, beam: usize| {
            self.planner.model.holds(&self.state, &Term::new(fluent, [beam_name(assembly, beam)]))
        };
        let beams = || (0..stands.len()).filter(|&beam| stands[beam] && beam != assembly.base);
        let over = |area: &Area| self.planner.model.holds(&self.state, &Term::new("at", [area_name(*area)]));
        let areas = [Area::Input, Area::Intermediate, Area::Assembly];
        State {
            in_assembly: beams().map(name).collect(),
            fastened: assembly
                .connections
                .iter()
                .zip(&self.pegs)
                .filter_map(|(connection, peg)| Some((connection.name.clone(), peg.clone()?)))
                .collect(),
            misaligned: beams().filter(|&beam| !holds("aligned", beam) && !deep[beam]).map(name).collect(),
            lost_pegs: self.lost.clone(),
            deep: beams().filter(|&beam| deep[beam]).map(name).collect(),
            in_hand: self.hand.clone(),
            slipped: (0..stands.len()).any(|beam| holds("slipped", beam)),
            hand_over: areas.into_iter().find(over).unwrap_or_default(),
        }
    }
}

fn words(refusal: &Refusal) -> String {
    match refusal {
        Refusal::Unknown(name) => format!("there is no action {name}"),
        Refusal::Impossible(reason) => format!("impossible by line {}: {}", reason.line, reason.law),
        Refusal::Contradiction(fluent) => format!("{fluent} would be both true and false"),
    }
}
