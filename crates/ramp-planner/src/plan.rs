//! Input and output of the planner: plain data, with names as in the kit and the goal.

use crate::motion::MotionFact;
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

/// Coarse places: three areas in a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Area {
    /// Over the sheet.
    #[default]
    Input,
    /// Between the sheet and the assembly.
    Intermediate,
    /// Over the assembly.
    Assembly,
}

/// An item that the hand can hold.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Item {
    /// A beam, by name.
    Beam(String),
    /// A peg, by name.
    Peg(String),
}

impl Item {
    /// Its name in the kit.
    pub fn name(&self) -> &str {
        match self {
            Item::Beam(name) | Item::Peg(name) => name,
        }
    }
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
}

/// A grasp of an item.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Grasp {
    /// A beam, at one of its links.
    Link(String),
    /// A peg, at its head.
    Head,
}

/// Fine places of the hand.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// Over an area, clear of everything.
    Above(Area),
    /// Over the start place of an item.
    Input(Item),
    /// The start of the insertion of a beam, or the position over the hole of a connection.
    Approach(Target),
    /// The goal pose.
    Target(Target),
}

/// The subject of a fine place.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// A beam's place in the assembly.
    Beam(String),
    /// A connection's hole.
    Connection(String),
}

/// An action of the fine resolution, executed by a skill.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "action")]
pub enum FineAction {
    /// Move the hand, and the held item, along the graph of places.
    Move {
        /// The place.
        to: Place,
    },
    /// Grasp an item and lift it.
    PickUp {
        /// The item.
        item: Item,
        /// The grasp.
        grasp: Grasp,
    },
    /// Release the held item and retreat.
    PutDown {
        /// The item.
        item: Item,
    },
    /// Insert a joint of the held beam into a joint of the assembly.
    AssembleSquare {
        /// The held beam.
        beam: String,
        /// Its joint that enters or receives, for example `b4j1`.
        joint: String,
    },
    /// Insert a joint of the held beam obliquely, along the beam's own axis.
    AssembleAngled {
        /// The held beam.
        beam: String,
        /// Its joint that enters.
        joint: String,
    },
    /// Slide the held beam through sleeves and insert its end.
    AssembleThrough {
        /// The held beam.
        beam: String,
        /// Its joint that enters last.
        joint: String,
        /// Its joints that end up in sleeves, from j1 on.
        through: Vec<String>,
    },
    /// Lay the held beam down at its goal pose.
    LayDown {
        /// The held beam.
        beam: String,
    },
    /// Insert the held beam beyond its goal pose; [`Plan::entries`] holds the depth.
    AssembleDeep {
        /// The held beam.
        beam: String,
        /// Its joint that enters.
        joint: String,
    },
    /// Grasp a beam that was inserted too deep, lift it level, slide it forward to its goal pose,
    /// release it.
    Slide {
        /// The beam.
        beam: String,
        /// The link to grasp.
        link: String,
    },
    /// Set the held beam down between sheet and assembly and grasp it at another link.
    Regrasp {
        /// The held beam.
        beam: String,
        /// The new link to grasp.
        link: String,
    },
    /// Cap: one or more joints of the assembly enter the held beam.
    AssembleCap {
        /// The held beam.
        beam: String,
        /// Its joints that receive.
        joints: Vec<String>,
    },
    /// Pin two joints with the held peg, and release it.
    Fasten {
        /// The connection's name in the goal.
        connection: String,
        /// Its female joint.
        female: String,
        /// Its male joint.
        male: String,
        /// The peg.
        peg: String,
    },
    /// Grasp a beam in the assembly, align it with its goal pose, release it.
    Push {
        /// The beam.
        beam: String,
        /// The link to grasp.
        link: String,
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

impl Display for Area {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Area::Input => "the sheet",
            Area::Intermediate => "the intermediate area",
            Area::Assembly => "the assembly",
        })
    }
}

impl Display for Item {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
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

impl Display for Grasp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Grasp::Link(link) => f.write_str(link),
            Grasp::Head => f.write_str("its head"),
        }
    }
}

impl Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Above(area) => write!(f, "above {area}"),
            Place::Input(item) => write!(f, "the start of {item}"),
            Place::Approach(target) => write!(f, "the approach of {target}"),
            Place::Target(target) => write!(f, "the place of {target}"),
        }
    }
}

impl Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Target::Beam(name) | Target::Connection(name) => f.write_str(name),
        }
    }
}

impl Display for FineAction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FineAction::Move { to } => write!(f, "move to {to}"),
            FineAction::PickUp { item, grasp } => write!(f, "pick up {item} by {grasp}"),
            FineAction::PutDown { item } => write!(f, "put down {item}"),
            FineAction::AssembleSquare { beam, joint } => write!(f, "insert {beam} by {joint}"),
            FineAction::AssembleAngled { beam, joint } => write!(f, "insert {beam} at an angle by {joint}"),
            FineAction::AssembleThrough { beam, joint, through } => {
                write!(f, "slide {beam} in by {joint} until {} is in its sleeve", through.join(", "))
            }
            FineAction::LayDown { beam } => write!(f, "lay down {beam} at its place"),
            FineAction::AssembleDeep { beam, joint } => write!(f, "insert {beam} too deep by {joint}"),
            FineAction::Slide { beam, link } => write!(f, "slide {beam} forward by {link}"),
            FineAction::Regrasp { beam, link } => write!(f, "regrasp {beam} by {link}"),
            FineAction::AssembleCap { beam, joints } => write!(f, "cap with {beam} at {}", joints.join(", ")),
            FineAction::Fasten { connection, female, male, peg } => {
                write!(f, "fasten {connection} ({male}-{female}) with {peg}")
            }
            FineAction::Push { beam, link } => write!(f, "push {beam} by {link}"),
        }
    }
}
