//! What goes into the planner and what comes out: plain data, names as in the kit and the goal.

use crate::motion::MotionFact;
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

/// A thing the hand can hold.
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

/// How the hand holds a thing.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Grasp {
    /// A beam, by one of its links.
    Link(String),
    /// A peg, by its head.
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
    /// Where the insertion of a beam begins, or over the hole of a connection (`Beam` or the connection's name).
    Approach(Target),
    /// The place itself.
    Target(Target),
}

/// What a fine place belongs to.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// A beam's place in the assembly.
    Beam(String),
    /// A connection's hole.
    Connection(String),
}

/// An action of the fine resolution: what a skill executes.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "action")]
pub enum FineAction {
    /// Move the hand, and what it holds, along the graph of places.
    Move {
        /// Where to.
        to: Place,
    },
    /// Grasp an item and lift it.
    PickUp {
        /// What.
        item: Item,
        /// Where.
        grasp: Grasp,
    },
    /// Let go of what the hand holds and retreat.
    PutDown {
        /// What.
        item: Item,
    },
    /// Insert a joint of the held beam into a joint of the assembly.
    AssembleSquare {
        /// The held beam.
        beam: String,
        /// Its joint that enters or receives, for example `b4j1`.
        joint: String,
    },
    /// Insert a joint of the held beam at an angle, along the beam's own axis.
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
        /// Its joint that enters in the end.
        joint: String,
        /// Its joints that come to lie in sleeves, from j1 on.
        through: Vec<String>,
    },
    /// Lay the held beam down at its place.
    LayDown {
        /// The held beam.
        beam: String,
    },
    /// Insert the held beam deeper than its place; [`Plan::entries`] says how deep.
    AssembleDeep {
        /// The held beam.
        beam: String,
        /// Its joint that enters.
        joint: String,
    },
    /// Grasp a beam that stands too deep, lift it level, slide it forward to its place, let go.
    Slide {
        /// Which beam.
        beam: String,
        /// The link to hold it by.
        link: String,
    },
    /// Set the held beam down on the way and hold it by another link.
    Regrasp {
        /// The held beam.
        beam: String,
        /// The link to hold it by from now on.
        link: String,
    },
    /// Cap: one or more joints of the assembly enter the held beam.
    AssembleCap {
        /// The held beam.
        beam: String,
        /// Its joints that receive.
        joints: Vec<String>,
    },
    /// Pin two joints with the held peg, and let go of it.
    Fasten {
        /// The connection's name in the goal.
        connection: String,
        /// Its female joint.
        female: String,
        /// Its male joint.
        male: String,
        /// Which peg.
        peg: String,
    },
    /// Grasp a beam in the assembly, bring it to its nominal place, let go.
    Push {
        /// Which beam.
        beam: String,
        /// The link to hold it by.
        link: String,
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
