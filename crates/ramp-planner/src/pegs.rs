//! Assignment of pegs: pegs are interchangeable, so each connection takes the next free one.

use crate::state::Known;
use ramp_assembly::Assembly;

/// Assignment of pegs to connections.
pub(crate) struct Pegs {
    /// The free pegs, by index, the next one last.
    free: Vec<usize>,
    /// The peg of each connection.
    of: Vec<Option<usize>>,
}

impl Pegs {
    /// The pegs of a state.
    pub(crate) fn new(assembly: &Assembly, known: &Known) -> Pegs {
        let of =
            if known.pinned.len() == assembly.connections.len() { known.pinned.clone() } else { Vec::new() };
        Pegs { free: known.pegs.iter().rev().copied().collect(), of }
    }

    /// The name of a connection's peg; on first use, the next free one.
    pub(crate) fn name(&mut self, names: &[String], connection: usize) -> String {
        let chosen = self.of[connection].or_else(|| self.free.pop());
        self.of[connection] = chosen;
        // Their number was checked before.
        chosen.map_or_else(String::new, |index| names[index].clone())
    }
}
