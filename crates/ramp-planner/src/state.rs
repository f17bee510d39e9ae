//! A state with its names resolved, refused when it contradicts itself.

use crate::error::PlanError;
use crate::facts::{beam_item, beam_name, connection_name};
use crate::motion::Motion;
use crate::plan::{Area, Item, State};
use ramp_action_language::Term;
use ramp_assembly::Assembly;
use ramp_source::nearest;

/// A state with every name resolved.
pub(crate) struct Known {
    /// Placed beams, by index, the base included.
    pub(crate) stands: Vec<bool>,
    /// Pinned connections, by index, each with its peg of the kit.
    pub(crate) pinned: Vec<Option<usize>>,
    /// Misaligned beams, by index.
    pub(crate) misaligned: Vec<bool>,
    /// Pushed-back beams, by index.
    pub(crate) deep: Vec<bool>,
    /// Usable pegs, by index, in the order of the kit; a held one comes first.
    pub(crate) pegs: Vec<usize>,
    /// The held beam.
    pub(crate) held_beam: Option<usize>,
    /// The held peg.
    pub(crate) held_peg: Option<usize>,
    pub(crate) slipped: bool,
    pub(crate) area: Area,
    /// Known limits of the arm and the hand.
    pub(crate) motion: Motion,
}

impl Known {
    /// A connection without a peg, by index, that the hand can reach in no state.
    pub(crate) fn unreachable(&self) -> Option<usize> {
        let fastenings = self.motion.fastenings.iter();
        let mut never = fastenings
            .filter(|(index, past)| past.is_none_or(|past| !past.stands) && self.pinned[*index].is_none());
        never.next().map(|(index, _)| *index)
    }

    /// The known coarse fluents; the domain derives all others.
    pub(crate) fn told(&self, assembly: &Assembly) -> Vec<Term> {
        let mut told = vec![Term::new("at", [area_name(self.area)])];
        for beam in (0..assembly.beams.len()).filter(|&beam| self.stands[beam]) {
            let name = beam_name(assembly, beam);
            told.push(Term::new("in_assembly", [name.clone()]));
            if self.deep[beam] {
                told.push(Term::new("deep", [name]));
            } else if !self.misaligned[beam] {
                told.push(Term::new("aligned", [name]));
            }
        }
        for connection in (0..assembly.connections.len()).filter(|&index| self.pinned[index].is_some()) {
            told.push(Term::new("pinned", [connection_name(assembly, connection)]));
        }
        if let Some(beam) = self.held_beam {
            told.push(Term::new("in_hand", [beam_item(assembly, beam)]));
            if self.slipped {
                told.push(Term::new("slipped", [beam_name(assembly, beam)]));
            }
        }
        told
    }
}

/// The name of an area in the rules.
pub(crate) fn area_name(area: Area) -> Term {
    let name = match area {
        Area::Input => "input",
        Area::Intermediate => "intermediate",
        Area::Assembly => "assembly",
    };
    Term::new(name, [])
}

/// The names of the pegs: the kit's, or, for a kit that says nothing of pegs, as many as the goal needs.
pub(crate) fn peg_names(assembly: &Assembly) -> Vec<String> {
    match assembly.kit.pegs.is_empty() {
        false => assembly.kit.pegs.iter().map(|peg| peg.name.clone()).collect(),
        true => (1..=assembly.connections.len()).map(|number| format!("p{number}")).collect(),
    }
}

/// Looks up every name of a state and checks that it does not contradict itself.
pub(crate) fn look_up(assembly: &Assembly, state: &State) -> Result<Known, PlanError> {
    let all_pegs = peg_names(assembly);
    let impossible = |why: String| Err(PlanError::ImpossibleState { why });
    let beam = |name: &str| {
        let names = assembly.beams.iter().map(|placed| placed.beam.name.as_str());
        assembly.beam_index(name).ok_or_else(|| unknown("beam", name, &assembly.name, nearest(name, names)))
    };
    let peg = |name: &str| {
        let names = all_pegs.iter().map(String::as_str);
        let index = all_pegs.iter().position(|peg| peg == name);
        index.ok_or_else(|| unknown("peg", name, "the kit", nearest(name, names)))
    };

    let mut stands = vec![false; assembly.beams.len()];
    stands[assembly.base] = true;
    for name in &state.in_assembly {
        stands[beam(name)?] = true;
    }

    let mut misaligned = vec![false; assembly.beams.len()];
    let mut deep = vec![false; assembly.beams.len()];
    for (names, flags, what) in
        [(&state.misaligned, &mut misaligned, "misaligned"), (&state.deep, &mut deep, "pushed back")]
    {
        for name in names {
            let index = beam(name)?;
            if index == assembly.base {
                return impossible(format!("`{name}` is {what}, but it is clamped to the table"));
            }
            if !stands[index] {
                return impossible(format!("`{name}` is {what}, but it is not in the assembly"));
            }
            flags[index] = true;
        }
    }

    let mut pinned = vec![None; assembly.connections.len()];
    let mut used = vec![false; all_pegs.len()];
    for (name, peg_name) in &state.fastened {
        let names = assembly.connections.iter().map(|connection| connection.name.as_str());
        let index = assembly
            .connection_index(name)
            .ok_or_else(|| unknown("connection", name, &assembly.name, nearest(name, names)))?;
        let connection = &assembly.connections[index];
        for side in [connection.female, connection.male] {
            let missing = &assembly.beams[side.beam].beam.name;
            if !stands[side.beam] {
                return impossible(format!("`{name}` is fastened, but `{missing}` is not in the assembly"));
            }
            if deep[side.beam] {
                return impossible(format!("`{name}` is fastened, but `{missing}` is pushed back"));
            }
        }
        let peg = peg(peg_name)?;
        if pinned[index].replace(peg).is_some() {
            return impossible(format!("`{name}` is fastened twice"));
        }
        if std::mem::replace(&mut used[peg], true) {
            return impossible(format!("the peg `{peg_name}` is used twice"));
        }
    }
    for name in &state.lost_pegs {
        used[peg(name)?] = true;
    }
    let (mut held_beam, mut held_peg) = (None, None);
    match &state.in_hand {
        Some(Item::Beam(name)) => {
            let index = beam(name)?;
            if stands[index] {
                return impossible(format!("`{name}` is in the hand, but also in the assembly"));
            }
            held_beam = Some(index);
        }
        Some(Item::Peg(name)) => {
            let index = peg(name)?;
            if used[index] {
                return impossible(format!("`{name}` is in the hand, but also used or lost"));
            }
            held_peg = Some(index);
        }
        None => {}
    }
    if state.slipped && held_beam.is_none() {
        return impossible("a beam has slipped, but the hand holds none".to_string());
    }
    let mut pegs: Vec<usize> = (0..all_pegs.len()).filter(|&index| !used[index]).collect();
    pegs.sort_by_key(|&index| (Some(index) != held_peg, index));
    let (slipped, area) = (state.slipped, state.hand_over);
    let motion = Motion::look_up(assembly, &state.motion)?;
    Ok(Known { stands, pinned, misaligned, deep, pegs, held_beam, held_peg, slipped, area, motion })
}

fn unknown(kind: &'static str, name: &str, place: &str, nearest: Option<&str>) -> PlanError {
    PlanError::UnknownName {
        kind,
        name: name.to_string(),
        place: place.to_string(),
        nearest: nearest.map(str::to_string),
    }
}
