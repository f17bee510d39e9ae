//! The differences of a plan from one that failed, and the choice of them in a work cell.

use std::collections::BTreeMap;
use std::fmt;

use crate::cell::Workcell;
use crate::cell::footprints::footprints;
use crate::grasp::BeamGrasp;

/// The difference of a plan from the one that failed.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// Everything was looked at again, and lies where it lies now.
    Look,
    /// The beam is held in another place, or with the hand turned by 180°.
    Grasp {
        /// The grasp that failed.
        not: BeamGrasp,
    },
    /// The beam is held by another link.
    Link {
        /// The link that failed.
        not: String,
    },
    /// The beam is brought along another path.
    Path {
        /// The path that failed.
        not: String,
    },
    /// The beam stays as it is, and the next part has to find its way.
    AsItIs,
    /// Some time has passed, in which a disturbance of the sight may have.
    Pause,
    /// A beam beside the one that is to be taken is laid down elsewhere first.
    Aside {
        /// The neighbour.
        beam: String,
    },
    /// Another peg is taken.
    Peg {
        /// The peg that failed.
        not: String,
    },
    /// The rest of the frame comes first.
    Later,
}

impl Change {
    /// The most differences of this kind in a row. Chosen: a third grasp of a link, or a third peg, is hardly
    /// better than two.
    pub(crate) fn most(&self) -> usize {
        match self {
            Change::Look | Change::AsItIs | Change::Pause | Change::Later => 1,
            Change::Grasp { .. } | Change::Peg { .. } | Change::Aside { .. } => 2,
            Change::Link { .. } | Change::Path { .. } => usize::MAX,
        }
    }

    /// Whether it is of the same kind.
    pub(crate) fn is_like(&self, other: &Change) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Change::Look => f.write_str("after another look"),
            Change::Grasp { not: BeamGrasp { s, reverse } } => {
                let turned = if *reverse { " with the hand turned" } else { "" };
                write!(f, "with another grasp than {:.0} mm from its j1 hole{turned}", s * 1e3)
            }
            Change::Link { not } => write!(f, "by another link than {not}"),
            Change::Path { not } => write!(f, "along another path than {not}"),
            Change::AsItIs => f.write_str("left as it is"),
            Change::Aside { beam } => write!(f, "with {beam} laid aside"),
            Change::Pause => f.write_str("after a pause"),
            Change::Peg { not } => write!(f, "with another peg than {not}"),
            Change::Later => f.write_str("after the rest"),
        }
    }
}

/// The grasps, pegs and neighbours among which there is a choice.
#[derive(Clone, Debug, Default)]
pub struct Choice {
    /// The last grasp of each beam, by name.
    pub gripped: BTreeMap<String, BeamGrasp>,
    /// Pegs beyond those that open connections need.
    pub spare: usize,
    /// The beams beside each beam that lies on the table, by name, the nearest first: the hand may need their
    /// room.
    pub beside: BTreeMap<String, Vec<String>>,
}

impl Choice {
    /// In a work cell, in which some pegs are lost.
    pub fn of(cell: &Workcell, lost: &[String]) -> Choice {
        let pinned = &cell.belief.pinned;
        let usable = cell
            .kit
            .pegs
            .iter()
            .filter(|peg| !lost.contains(&peg.name) && !pinned.iter().any(|(_, name)| *name == peg.name));
        let open = cell.assembly.connections.len() - pinned.len();
        let spare = usable.count().saturating_sub(open);
        Choice { gripped: cell.gripped.clone(), spare, beside: beside(cell) }
    }
}

/// The beams beside each beam on the table, those first that leave the least room.
fn beside(cell: &Workcell) -> BTreeMap<String, Vec<String>> {
    let stands = |name: &str| {
        let index = cell.assembly.beam_index(name);
        index.is_some_and(|beam| beam == cell.assembly.base || cell.belief.standing.contains(&beam))
    };
    let places = |beam: &ramp_kit::Beam| {
        let x_wb = cell.belief.parts.pose(&beam.name).ok()?;
        Some((beam.name.clone(), footprints(beam, &x_wb)))
    };
    let lying: Vec<_> = cell.kit.beams.iter().filter(|beam| !stands(&beam.name)).filter_map(places).collect();
    let beside = |(name, own): &(String, Vec<ramp_kit::Footprint>)| {
        let others = lying.iter().filter(|(other, _)| other != name);
        let near = |(other, theirs): &(String, Vec<_>)| {
            let is_near =
                |room: &&f64| own.iter().any(|own| theirs.iter().any(|it| !own.is_clear(it, **room)));
            // The number of distances within which it is.
            let rank = cell.parameters.clear.beside.iter().filter(is_near).count();
            (rank > 0).then(|| (std::cmp::Reverse(rank), other.clone()))
        };
        let mut near: Vec<_> = others.filter_map(near).collect();
        near.sort();
        (name.clone(), near.into_iter().map(|(_, other)| other).collect())
    };
    lying.iter().map(beside).collect()
}
