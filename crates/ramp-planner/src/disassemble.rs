//! Disassembly: a plan for the same rules run backwards.
//!
//! The domain's actions are deterministic. So a legal plan read from its end, with every action
//! undone, leads back through the same states, and needs no rule that the plan has not satisfied.
//! Pushes are left out: a beam does not have to be aligned to be removed.

use crate::domains::Domains;
use crate::error::PlanError;
use crate::plan::{Area, CoarseAction, Entry, FineAction, Grasp, Item, Place, State, Target};
use crate::planner::plan;
use ramp_assembly::Assembly;
use serde::Serialize;
use std::collections::HashMap;
use std::fmt::{self, Display};

/// A disassembly plan. It begins and ends with an empty hand over the sheet.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Disassembly {
    /// The steps, in order.
    pub steps: Vec<RemovalStep>,
    /// Removal motions of the beams: each straight back along its insertion path, in order of
    /// removal.
    pub exits: Vec<Entry>,
}

/// A coarse action and the fine actions that carry it out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RemovalStep {
    /// The coarse action.
    pub coarse: Removal,
    /// The fine actions, in order.
    pub fine: Vec<FineRemoval>,
}

/// A coarse action of disassembly.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "action")]
pub enum Removal {
    /// Move the hand, and what it holds, to a neighbouring area.
    Move {
        /// The area.
        to: Area,
    },
    /// Grasp a beam in the assembly and withdraw it.
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
    /// Put the held item at its start pose on the sheet.
    PutDown {
        /// The item.
        item: Item,
    },
    /// Change the grasp to another link of the beam.
    Regrasp {
        /// The beam.
        beam: String,
    },
    /// Slide a beam back through its open joint, so that another can be lifted off.
    SlideBack {
        /// The beam.
        beam: String,
    },
}

/// A fine action of disassembly.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "action")]
pub enum FineRemoval {
    /// Move the hand, and the held item, along the graph of places.
    Move {
        /// The place.
        to: Place,
    },
    /// Grasp a beam and withdraw it to its approach.
    TakeOut {
        /// The beam.
        beam: String,
        /// The link to grasp.
        link: String,
    },
    /// Grasp a peg by its head and pull it out.
    PullOut {
        /// The connection's name in the goal.
        connection: String,
        /// The peg.
        peg: String,
    },
    /// Release the held item and retreat.
    PutDown {
        /// The item.
        item: Item,
    },
    /// Set the held beam down between sheet and assembly and grasp it at another link.
    Regrasp {
        /// The held beam.
        beam: String,
        /// The new link to grasp.
        link: String,
    },
    /// Grasp a beam and slide it back.
    SlideBack {
        /// The beam.
        beam: String,
        /// The link to grasp.
        link: String,
    },
}

/// Plans the disassembly of a built goal.
///
/// # Errors
/// As [`plan`]: a goal that cannot be built cannot be taken apart.
///
/// ```
/// use ramp_planner::{Domains, Removal, disassemble};
///
/// let kit = ramp_kit::read_kit("../../data/kit.xml".as_ref())?;
/// let assembly = ramp_assembly::read_goal("../../data/goals/easy-3.xml".as_ref(), &kit)?;
/// let domains = Domains::read("../../data/domains".as_ref())?;
/// let plan = disassemble(&assembly, &domains)?;
/// assert!(matches!(&plan.steps[2].coarse, Removal::PullOut { connection, .. } if connection == "C4"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn disassemble(assembly: &Assembly, domains: &Domains) -> Result<Disassembly, PlanError> {
    let plan = plan(assembly, &State::default(), domains)?;
    let mut area = Area::Input;
    let mut place = Place::Above(area);
    // The grasped link of each beam at its insertion, and the one before a regrasp.
    let mut links: HashMap<String, Vec<String>> = HashMap::new();
    let mut backwards: Vec<RemovalStep> = Vec::new();
    for step in &plan.steps {
        let coarse = match &step.coarse {
            CoarseAction::Push { .. } => continue,
            CoarseAction::Move { to } => Removal::Move { to: std::mem::replace(&mut area, *to) },
            CoarseAction::PickUp { item } => Removal::PutDown { item: item.clone() },
            CoarseAction::Regrasp { beam } => Removal::Regrasp { beam: beam.clone() },
            CoarseAction::Slide { beam } => Removal::SlideBack { beam: beam.clone() },
            CoarseAction::Fasten { connection, peg } => {
                Removal::PullOut { connection: connection.clone(), peg: peg.clone() }
            }
            CoarseAction::Assemble { beam }
            | CoarseAction::AssembleDeep { beam }
            | CoarseAction::LayDown { beam } => Removal::TakeOut { beam: beam.clone() },
            // A plan from the start puts no item back.
            CoarseAction::PutDown { .. } => continue,
        };
        let mut fine = Vec::new();
        for action in &step.fine {
            fine.extend(undone(action, &mut place, &mut links));
        }
        fine.reverse();
        backwards.push(RemovalStep { coarse, fine });
    }
    backwards.reverse();
    let mut exits = plan.entries;
    exits.reverse();
    for exit in &mut exits {
        exit.direction = exit.direction.map(|component| -component);
    }
    let mut steps = vec![];
    if area != Area::Input {
        let fine = vec![FineRemoval::Move { to: Place::Above(area) }];
        steps.push(RemovalStep { coarse: Removal::Move { to: area }, fine });
    }
    steps.extend(backwards);
    Ok(Disassembly { steps, exits })
}

/// A fine action undone.
fn undone(
    action: &FineAction,
    place: &mut Place,
    links: &mut HashMap<String, Vec<String>>,
) -> Option<FineRemoval> {
    let held = |beam: &String, links: &mut HashMap<String, Vec<String>>| {
        links.get(beam).and_then(|links| links.last()).cloned().unwrap_or_default()
    };
    Some(match action {
        FineAction::Move { to } => FineRemoval::Move { to: std::mem::replace(place, to.clone()) },
        FineAction::PickUp { item, grasp } => {
            if let (Item::Beam(beam), Grasp::Link(link)) = (item, grasp) {
                links.insert(beam.clone(), vec![link.clone()]);
            }
            FineRemoval::PutDown { item: item.clone() }
        }
        FineAction::Regrasp { beam, link } => {
            let before = held(beam, links);
            links.entry(beam.clone()).or_default().push(link.clone());
            FineRemoval::Regrasp { beam: beam.clone(), link: before }
        }
        FineAction::Fasten { connection, peg, .. } => {
            *place = Place::Target(Target::Connection(connection.clone()));
            FineRemoval::PullOut { connection: connection.clone(), peg: peg.clone() }
        }
        FineAction::Slide { beam, link } => FineRemoval::SlideBack { beam: beam.clone(), link: link.clone() },
        FineAction::Push { .. } | FineAction::PutDown { .. } => return None,
        // All others bring the held beam to its place.
        _ => {
            let beam = action.part()?.to_string();
            *place = Place::Target(Target::Beam(beam.clone()));
            let link = held(&beam, links);
            FineRemoval::TakeOut { beam, link }
        }
    })
}

impl Display for Removal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Removal::Move { to } => write!(f, "move to {to}"),
            Removal::TakeOut { beam } => write!(f, "take out {beam}"),
            Removal::PullOut { connection, peg } => write!(f, "pull {peg} out of {connection}"),
            Removal::PutDown { item } => write!(f, "put down {item}"),
            Removal::Regrasp { beam } => write!(f, "regrasp {beam}"),
            Removal::SlideBack { beam } => write!(f, "slide {beam} back"),
        }
    }
}

impl Display for FineRemoval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FineRemoval::Move { to } => write!(f, "move to {to}"),
            FineRemoval::TakeOut { beam, link } => write!(f, "draw {beam} out by {link}"),
            FineRemoval::PullOut { connection, peg } => write!(f, "pull {peg} out of {connection}"),
            FineRemoval::PutDown { item } => write!(f, "put down {item}"),
            FineRemoval::Regrasp { beam, link } => write!(f, "regrasp {beam} by {link}"),
            FineRemoval::SlideBack { beam, link } => write!(f, "slide {beam} back by {link}"),
        }
    }
}
