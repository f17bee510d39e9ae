//! Input and output of the planner: plain data, with names as in the kit and the goal.

pub use crate::fine_action::{ActionKind, FineAction};
use crate::motion::MotionFact;
pub use crate::place::{Area, Grasp, Item, Place, Target};
use serde::{Deserialize, Serialize};
use std::fmt::{self, Display};

/// Known state at the start of planning. Default: nothing is built, the hand is empty and over the
/// sheet.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct State {
    /// Beams in their goal poses, without the base.
    pub in_assembly: Vec<String>,
    /// Connections (by name) that are already pinned, each with its peg.
    pub fastened: Vec<(String, String)>,
    /// Beams in the assembly that are known to be misaligned.
    pub misaligned: Vec<String>,
    /// Pegs that must not be used: lost, or out of reach.
    pub lost_pegs: Vec<String>,
    /// Beams in the assembly that are pushed back, to let another one on.
    pub deep: Vec<String>,
    /// The held item.
    pub in_hand: Option<Item>,
    /// Whether the held item has slipped in the grasp.
    pub slipped: bool,
    /// Position of the hand.
    pub hand_over: Area,
    /// Known limits of the arm and the hand.
    pub motion: Vec<MotionFact>,
}

/// An action of the coarse resolution.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "action")]
pub enum CoarseAction {
    /// Move the hand, and the held item, to a neighbouring area.
    Move {
        /// The area.
        to: Area,
    },
    /// Pick up a beam or a peg.
    PickUp {
        /// The item.
        item: Item,
    },
    /// Release the held item.
    PutDown {
        /// The item.
        item: Item,
    },
    /// Insert the held beam into the assembly.
    Assemble {
        /// The beam.
        beam: String,
    },
    /// Lay the held beam down at its goal pose, without support by other beams.
    LayDown {
        /// The beam.
        beam: String,
    },
    /// Insert the held beam beyond its goal pose, through a joint that is open at the back.
    AssembleDeep {
        /// The beam.
        beam: String,
    },
    /// Slide a beam that was inserted too deep forward to its goal pose, with the hand empty before
    /// and after.
    Slide {
        /// The beam.
        beam: String,
    },
    /// Change the grasp to another link of the beam.
    Regrasp {
        /// The beam.
        beam: String,
    },
    /// Pin a connection with the held peg.
    Fasten {
        /// The connection's name in the goal.
        connection: String,
        /// The peg.
        peg: String,
    },
    /// Align a beam of the assembly with its goal pose, with the hand empty before and after.
    Push {
        /// The beam.
        beam: String,
    },
    /// Grasp a beam in the assembly and draw it out.
    TakeOut {
        /// The beam.
        beam: String,
    },
    /// Grasp a peg and pull it out of its connection.
    PullOut {
        /// The connection's name in the goal.
        connection: String,
        /// The peg.
        peg: String,
    },
    /// Slide a beam back through its open joint, so that another can be drawn off, with the hand empty
    /// before and after.
    SlideBack {
        /// The beam.
        beam: String,
    },
}

/// A coarse action and the fine actions that carry it out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CoarseStep {
    /// The coarse action.
    pub coarse: CoarseAction,
    /// The fine actions, in order.
    pub fine: Vec<FineAction>,
}

/// A plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plan {
    /// The steps, in order.
    pub steps: Vec<CoarseStep>,
    /// Insertion motions of the beams, in the order of the steps.
    pub entries: Vec<Entry>,
    /// Figures of the search.
    pub statistics: Statistics,
}

/// The straight insertion motion of a beam.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// The beam.
    pub beam: String,
    /// The name of the insertion path.
    pub path: String,
    /// Direction of the motion in the assembly frame.
    pub direction: [f64; 3],
    /// Its length, m; it is collision-free.
    pub distance: f64,
    /// Overshoot beyond the goal pose, m, to be slid forward later; 0 for most beams.
    pub depth: f64,
}

/// The planner's own figures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Statistics {
    /// Number of calls to the solver.
    pub solves: usize,
    /// Whether the number of coarse actions is proven minimal.
    pub optimal: bool,
    /// Lower bound on the number of coarse actions.
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
            CoarseAction::TakeOut { beam } => write!(f, "take out {beam}"),
            CoarseAction::PullOut { connection, peg } => write!(f, "pull {peg} out of {connection}"),
            CoarseAction::SlideBack { beam } => write!(f, "slide {beam} back"),
        }
    }
}
