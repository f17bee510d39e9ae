//! Is the state one that can be? Checked before anything is planned from it.

use crate::error::PlanError;
use crate::plan::State;
use ramp_assembly::Assembly;
use ramp_kit::Kit;
use ramp_kit::source::nearest;

/// A state with every name looked up.
pub(crate) struct Known {
    /// Which beams stand, by index; the base does.
    pub(crate) stands: Vec<bool>,
    /// Which connections are pinned, by index.
    pub(crate) pinned: Vec<bool>,
    /// Which beams stand off their place, by index.
    pub(crate) misaligned: Vec<bool>,
    /// Pegs that can still be used, by index, in the order of the kit.
    pub(crate) pegs: Vec<usize>,
}

/// Looks up every name of a state and checks that it does not contradict itself.
pub(crate) fn look_up(assembly: &Assembly, kit: &Kit, state: &State) -> Result<Known, PlanError> {
    let impossible = |why: String| Err(PlanError::ImpossibleState { why });
    let beam = |name: &str| {
        let names = assembly.beams.iter().map(|placed| placed.beam.name.as_str());
        assembly.beam_index(name).ok_or_else(|| unknown("beam", name, &assembly.name, nearest(name, names)))
    };
    let peg = |name: &str| {
        let names = kit.pegs.iter().map(|peg| peg.name.as_str());
        let index = kit.pegs.iter().position(|peg| peg.name == name);
        index.ok_or_else(|| unknown("peg", name, "the kit", nearest(name, names)))
    };

    let mut stands = vec![false; assembly.beams.len()];
    stands[assembly.base] = true;
    for name in &state.in_assembly {
        stands[beam(name)?] = true;
    }

    let mut misaligned = vec![false; assembly.beams.len()];
    for name in &state.misaligned {
        let index = beam(name)?;
        if index == assembly.base {
            return impossible(format!("`{name}` is misaligned, but it is clamped to the table"));
        }
        if !stands[index] {
            return impossible(format!("`{name}` is misaligned, but it is not in the assembly"));
        }
        misaligned[index] = true;
    }

    let mut pinned = vec![false; assembly.connections.len()];
    let mut used = vec![false; kit.pegs.len()];
    for (name, peg_name) in &state.fastened {
        let names = assembly.connections.iter().map(|connection| connection.name.as_str());
        let index = assembly
            .connection_index(name)
            .ok_or_else(|| unknown("connection", name, &assembly.name, nearest(name, names)))?;
        let connection = &assembly.connections[index];
        for side in [connection.female, connection.male] {
            if !stands[side.beam] {
                let missing = &assembly.beams[side.beam].beam.name;
                return impossible(format!("`{name}` is fastened, but `{missing}` is not in the assembly"));
            }
        }
        if std::mem::replace(&mut pinned[index], true) {
            return impossible(format!("`{name}` is fastened twice"));
        }
        if std::mem::replace(&mut used[peg(peg_name)?], true) {
            return impossible(format!("the peg `{peg_name}` is used twice"));
        }
    }
    for name in &state.lost_pegs {
        used[peg(name)?] = true;
    }
    let pegs = (0..kit.pegs.len()).filter(|&index| !used[index]).collect();
    Ok(Known { stands, pinned, misaligned, pegs })
}

fn unknown(kind: &'static str, name: &str, place: &str, nearest: Option<&str>) -> PlanError {
    PlanError::UnknownName {
        kind,
        name: name.to_string(),
        place: place.to_string(),
        nearest: nearest.map(str::to_string),
    }
}
