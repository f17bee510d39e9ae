//! The table while a plan is simulated: true fluents, positions of the pegs, and the held item.

use crate::domains::Domains;
use crate::error::PlanError;
use crate::facts::beam_name;
use crate::plan::{Area, Item, State};
use crate::planner::{Options, Planner};
use crate::state::{Known, area_name, look_up};
use ramp_action_language::{State as Fluents, Term};
use ramp_assembly::Assembly;

/// The table while a plan is simulated, at both resolutions.
///
/// ```
/// use ramp_planner::{Domains, Replayer, State, plan};
///
/// let kit = ramp_kit::read_kit("../../data/kit.xml".as_ref())?;
/// let assembly = ramp_assembly::read_goal("../../data/goals/easy-1.xml".as_ref(), &kit)?;
/// let domains = Domains::read("../../data/domains".as_ref())?;
/// let mut steps = plan(&assembly, &State::default(), &domains)?.steps;
/// assert!(Replayer::new(&assembly, &domains, &State::default())?.run(&steps).is_ok());
/// steps.remove(3);
/// assert!(Replayer::new(&assembly, &domains, &State::default())?.run(&steps).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Replayer<'a> {
    pub(crate) planner: Planner<'a>,
    pub(super) start: Known,
    pub(super) state: Fluents,
    /// The fluents of the fine domain alone.
    pub(super) own: Vec<Term>,
    /// The peg in each connection.
    pub(super) pegs: Vec<Option<String>>,
    pub(super) lost: Vec<String>,
    pub(super) hand: Option<Item>,
}

impl<'a> Replayer<'a> {
    /// The table at the beginning.
    ///
    /// # Errors
    /// When the state contradicts itself.
    pub fn new(
        assembly: &'a Assembly,
        domains: &'a Domains,
        state: &State,
    ) -> Result<Replayer<'a>, PlanError> {
        let known = look_up(assembly, state)?;
        let planner = Planner::new(assembly, domains, Options::default(), known.motion.clone());
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

    /// The coarse state.
    pub(crate) fn fluents(&self) -> &Fluents {
        &self.state
    }

    /// An event happens, if it is possible.
    pub(crate) fn happens(&mut self, event: &Term) {
        let Ok(after) = self.planner.model.after(&self.state, event) else { return };
        self.state = after;
        let dropped = matches!(event.parts(), Some(("drop_peg", _)));
        if let (true, Some(Item::Peg(peg))) = (dropped, self.hand.take_if(|_| dropped)) {
            self.lost.push(peg);
        }
    }

    /// The current state as input of the planner.
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
            motion: self.start.motion.facts.clone(),
        }
    }
}
