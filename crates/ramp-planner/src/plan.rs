//! What goes into the planner and what comes out: plain data, names as in the kit and the goal.

pub use crate::fine_action::{ActionKind, FineAction};
use crate::motion::MotionFact;
pub use crate::place::{Area, Grasp, Item, Place, Target};
use serde::{Deserialize, Serialize};
use std::fmt::{self, Display};

/// What is known when planning starts. The default: nothing is built, the hand is empty and over the sheet.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct State {
    /// Beams that are already at their place, the base not counted.
    pub in_assembly: Vec<String>,
    /// Connections (their names in the goal) that a peg already pins, with the peg.
    pub fastened: Vec<(String, String)>,
    /// Beams in the assembly that are known to stand off their place.
    pub misaligned: Vec<String>,
    /// Pegs that must not be used: lost, or out of reach.
    pub lost_pegs: Vec<String>,
    /// Beams in the assembly that are pushed back, to let another one on.
    pub deep: Vec<String>,
    /// What the hand holds.
    pub in_hand: Option<Item>,
    /// What the hand holds has slipped: it is not held as it should be.
    pub slipped: bool,
    /// Where the hand is.
    pub hand_over: Area,
    /// What the arm and the hand were found not to be able to do.
    pub motion: Vec<MotionFact>,
}

/// An action of the coarse resolution.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "action")]
pub enum CoarseAction {
    /// Move the hand, and what it holds, to a neighbouring area.
    Move {
        /// Where to.
        to: Area,
    },
    /// Pick up a beam or a peg.
    PickUp {
        /// What.
        item: Item,
    },
    /// Let go of what the hand holds.
    PutDown {
        /// What.
        item: Item,
    },
    /// Insert the held beam into the assembly.
    Assemble {
        /// Which beam.
        beam: String,
    },
    /// Lay the held beam down at its place, with nothing to hold it.
    LayDown {
        /// Which beam.
        beam: String,
    },
    /// Insert the held beam deeper than its place, through a joint that is open behind.
    AssembleDeep {
        /// Which beam.
        beam: String,
    },
    /// Slide a beam that stands too deep forward to its place, with the hand empty before and after.
    Slide {
        /// Which beam.
        beam: String,
    },
    /// Hold the beam by another link.
    Regrasp {
        /// Which beam.
        beam: String,
    },
    /// Pin a connection with the held peg.
    Fasten {
        /// The connection's name in the goal.
        connection: String,
        /// Which peg.
        peg: String,
    },
    /// Bring a beam that stands in the assembly to its nominal place, with the hand empty before and after.
    Push {
        /// Which beam.
        beam: String,
    },
}

/// A coarse action and the fine actions that carry it out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CoarseStep {
    /// The coarse action.
    pub coarse: CoarseAction,
    /// What carries it out, in order.
    pub fine: Vec<FineAction>,
}

/// A plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plan {
    /// The steps, in order.
    pub steps: Vec<CoarseStep>,
    /// How the beams get to their places, in the order of the steps.
    pub entries: Vec<Entry>,
    /// How hard it was to find.
    pub statistics: Statistics,
}

/// The straight motion with which a beam gets to its place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Which beam.
    pub beam: String,
    /// The name of the insertion path.
    pub path: String,
    /// Direction of the motion in the assembly frame.
    pub direction: [f64; 3],
    /// Its length, m: it is free from its start to the place.
    pub distance: f64,
    /// How much further than its place the beam goes at first, to be slid forward later, m; 0 for most.
    pub depth: f64,
}

/// The planner's own figures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Statistics {
    /// Number of calls to the solver.
    pub solves: usize,
    /// Is the number of coarse actions proven to be the smallest?
    pub optimal: bool,
    /// No plan has fewer coarse actions than this.
    pub lower_bound: usize,
}

impl Plan {
    /// All fine actions, in order.
    pub fn fine(&self) -> impl Iterator<Item = &FineAction> {
        self.steps.iter().flat_map(|step| &step.fine)
    }
}

// In words, for people and for the golden files of the tests.

impl Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, step) in self.steps.iter().enumerate() {
            writeln!(f, "{:3} {}", index + 1, step.coarse)?;
            for action in &step.fine {
                writeln!(f, "      {action}")?;
            }
        }
        Ok(())
    }
}

impl Display for CoarseAction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CoarseAction::Move { to } => write!(f, "move to {to}"),
            CoarseAction::PickUp { item } => write!(f, "pick up {item}"),
            CoarseAction::PutDown { item } => write!(f, "put down {item}"),
            CoarseAction::Assemble { beam } => write!(f, "assemble {beam}"),
            CoarseAction::LayDown { beam } => write!(f, "lay down {beam} at its place"),
            CoarseAction::AssembleDeep { beam } => write!(f, "assemble {beam} too deep"),
            CoarseAction::Slide { beam } => write!(f, "slide {beam} forward"),
            CoarseAction::Regrasp { beam } => write!(f, "regrasp {beam}"),
            CoarseAction::Fasten { connection, peg } => write!(f, "fasten {connection} with {peg}"),
            CoarseAction::Push { beam } => write!(f, "push {beam}"),
        }
    }
}
