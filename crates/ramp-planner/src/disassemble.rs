//! Disassembly: a plan for the same rules run backwards.
//!
//! The domain's actions are deterministic. So a legal plan read from its end, with every action
//! undone, leads back through the same states, and needs no rule that the plan has not satisfied.
//! Pushes are left out: a beam does not have to be aligned to be removed.

use crate::domains::Domains;
use crate::error::PlanError;
use crate::plan::{Area, CoarseAction, CoarseStep, FineAction, Grasp, Item, Place, Plan, State, Target};
use crate::planner::plan;
use ramp_assembly::Assembly;
use std::collections::HashMap;

/// Plans the disassembly of a built goal.
///
/// # Errors
/// As [`plan`]: a goal that cannot be built cannot be taken apart.
///
/// ```
/// use ramp_planner::{CoarseAction, Domains, disassemble};
///
/// let kit = ramp_kit::read_kit("../../data/kit.xml".as_ref())?;
/// let assembly = ramp_assembly::read_goal("../../data/goals/easy-3.xml".as_ref(), &kit)?;
/// let domains = Domains::read("../../data/domains".as_ref())?;
/// let plan = disassemble(&assembly, &domains)?;
/// assert!(
///     matches!(&plan.steps[2].coarse, CoarseAction::PullOut { connection, .. } if connection == "C4")
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn disassemble(assembly: &Assembly, domains: &Domains) -> Result<Plan, PlanError> {
    Ok(backwards(&plan(assembly, &State::default(), domains)?, &[]))
}

/// A plan that begins with nothing built, backwards: it takes apart what that plan builds. It begins and
/// ends with an empty hand over the sheet. Its entries are still the insertion paths, in the order in which
/// the beams are drawn out along them. `pinned` are the pegs that pin connections, by the connection's name,
/// where they are others than those of the plan.
pub fn backwards(plan: &Plan, pinned: &[(String, String)]) -> Plan {
    let fastened: HashMap<&str, &str> = plan
        .steps
        .iter()
        .filter_map(|step| match &step.coarse {
            CoarseAction::Fasten { connection, peg } => Some((peg.as_str(), connection.as_str())),
            _ => None,
        })
        .collect();
    let peg = |planned: &str| {
        let connection = fastened.get(planned).copied();
        let other = pinned.iter().find(|(pinned, _)| Some(pinned.as_str()) == connection);
        other.map_or_else(|| planned.to_string(), |(_, peg)| peg.clone())
    };
    let mut area = Area::Input;
    let mut place = Place::Above(area);
    // The grasped link of each beam at its insertion, and the one before a regrasp.
    let mut links: HashMap<String, Vec<String>> = HashMap::new();
    let mut steps: Vec<CoarseStep> = Vec::new();
    for step in &plan.steps {
        let coarse = match &step.coarse {
            CoarseAction::Move { to } => CoarseAction::Move { to: std::mem::replace(&mut area, *to) },
            CoarseAction::PickUp { item: Item::Peg(planned) } => {
                CoarseAction::PutDown { item: Item::Peg(peg(planned)) }
            }
            CoarseAction::PickUp { item } => CoarseAction::PutDown { item: item.clone() },
            CoarseAction::Regrasp { beam } => CoarseAction::Regrasp { beam: beam.clone() },
            CoarseAction::Slide { beam } => CoarseAction::SlideBack { beam: beam.clone() },
            CoarseAction::Fasten { connection, peg: planned } => {
                CoarseAction::PullOut { connection: connection.clone(), peg: peg(planned) }
            }
            CoarseAction::Assemble { beam }
            | CoarseAction::AssembleDeep { beam }
            | CoarseAction::LayDown { beam } => CoarseAction::TakeOut { beam: beam.clone() },
            // A plan that begins with nothing built puts no item back, and takes nothing apart.
            CoarseAction::Push { .. }
            | CoarseAction::PutDown { .. }
            | CoarseAction::TakeOut { .. }
            | CoarseAction::PullOut { .. }
            | CoarseAction::SlideBack { .. } => continue,
        };
        let mut fine = Vec::new();
        for action in &step.fine {
            fine.extend(undone(&action.with_pegs(peg), &mut place, &mut links));
        }
        fine.reverse();
        steps.push(CoarseStep { coarse, fine });
    }
    if area != Area::Input {
        let fine = vec![FineAction::Move { to: Place::Above(area) }];
        steps.push(CoarseStep { coarse: CoarseAction::Move { to: area }, fine });
    }
    steps.reverse();
    let entries = plan.entries.iter().rev().cloned().collect();
    Plan { steps, entries, statistics: plan.statistics }
}

/// What is left of a plan that takes a frame apart, where it was carried out in part: `stands` tells whether
/// a part is still in its place, and `deep` whether a beam was slid back.
pub fn left_of(plan: &Plan, stands: impl Fn(&Item) -> bool, deep: impl Fn(&str) -> bool) -> Plan {
    let beam = |name: &String| Item::Beam(name.clone());
    let mut steps: Vec<CoarseStep> = Vec::new();
    let mut unit: Vec<CoarseStep> = Vec::new();
    for step in &plan.steps {
        let is_left = match &step.coarse {
            CoarseAction::SlideBack { beam: name } => stands(&beam(name)) && !deep(name),
            CoarseAction::TakeOut { beam: name } | CoarseAction::Regrasp { beam: name } => {
                stands(&beam(name))
            }
            CoarseAction::PullOut { peg, .. } => stands(&Item::Peg(peg.clone())),
            CoarseAction::PutDown { item } => stands(item),
            _ => true,
        };
        unit.extend(is_left.then(|| step.clone()));
        if matches!(step.coarse, CoarseAction::PutDown { .. }) {
            let works = unit.iter().any(|step| !matches!(step.coarse, CoarseAction::Move { .. }));
            steps.extend(std::mem::take(&mut unit).into_iter().filter(|_| works));
        }
    }
    Plan { steps, ..plan.clone() }
}

/// A fine action undone.
fn undone(
    action: &FineAction,
    place: &mut Place,
    links: &mut HashMap<String, Vec<String>>,
) -> Option<FineAction> {
    let held = |beam: &String, links: &mut HashMap<String, Vec<String>>| {
        links.get(beam).and_then(|links| links.last()).cloned().unwrap_or_default()
    };
    Some(match action {
        FineAction::Move { to } => FineAction::Move { to: std::mem::replace(place, to.clone()) },
        FineAction::PickUp { item, grasp } => {
            if let (Item::Beam(beam), Grasp::Link(link)) = (item, grasp) {
                links.insert(beam.clone(), vec![link.clone()]);
            }
            FineAction::PutDown { item: item.clone() }
        }
        FineAction::Regrasp { beam, link } => {
            let before = held(beam, links);
            links.entry(beam.clone()).or_default().push(link.clone());
            FineAction::Regrasp { beam: beam.clone(), link: before }
        }
        FineAction::Fasten { connection, peg, .. } => {
            *place = Place::Target(Target::Connection(connection.clone()));
            FineAction::PullOut { connection: connection.clone(), peg: peg.clone() }
        }
        FineAction::Slide { beam, link } => FineAction::SlideBack { beam: beam.clone(), link: link.clone() },
        FineAction::AssembleSquare { beam, .. }
        | FineAction::AssembleAngled { beam, .. }
        | FineAction::AssembleThrough { beam, .. }
        | FineAction::AssembleDeep { beam, .. }
        | FineAction::AssembleCap { beam, .. }
        | FineAction::LayDown { beam } => {
            *place = Place::Target(Target::Beam(beam.clone()));
            FineAction::TakeOut { beam: beam.clone(), link: held(beam, links) }
        }
        FineAction::Push { .. }
        | FineAction::PutDown { .. }
        | FineAction::TakeOut { .. }
        | FineAction::PullOut { .. }
        | FineAction::SlideBack { .. } => return None,
    })
}
