//! Shortens the robot time of a plan with the same actions: pegs are interchangeable, and the order
//! of fastenings is often free.
//!
//! This module is independent of the robot. The caller gives the cost of the hand's travel, and
//! [`quicker`] swaps pegs with each other, and fastenings with each other, as long as that reduces
//! the plan's total travel cost.

use crate::domains::Domains;
use crate::error::PlanError;
use crate::plan::{CoarseAction, CoarseStep, FineAction, Item, Place, Plan, State};
use crate::replay::Replayer;
use crate::state;
use ramp_assembly::Assembly;
use std::collections::{BTreeSet, HashMap};

/// Steps of a peg from its holder to its hole: pick up, two moves, fasten.
const FASTENING: usize = 4;

/// The plan with its pegs and fastenings swapped to reduce its travel cost, and the reduction.
/// `cost` is the travel time of the hand between two places, ms: from a part's start to a place in
/// the assembly or back.
///
/// The plan has the same number of actions, and the rules accept it.
///
/// # Errors
/// When the state contradicts itself.
pub fn quicker(
    assembly: &Assembly,
    state: &State,
    domains: &Domains,
    plan: &Plan,
    cost: &mut dyn FnMut(&Place, &Place) -> u64,
) -> Result<(Plan, u64), PlanError> {
    let mut costs: HashMap<(Place, Place), u64> = HashMap::new();
    let mut sum = |steps: &[CoarseStep]| -> u64 {
        let places = places(steps);
        let ways = places.windows(2).map(|way| (way[0].clone(), way[1].clone()));
        ways.map(|way| *costs.entry(way).or_insert_with_key(|(from, to)| cost(from, to))).sum()
    };
    let accepted = |steps: &[CoarseStep]| {
        Replayer::new(assembly, domains, state).is_ok_and(|mut table| table.run(steps).is_ok())
    };
    let fetched: Vec<String> =
        plan.steps.iter().filter_map(|step| peg_of(step).map(str::to_string)).collect();
    let known = state::look_up(assembly, state)?;
    let names = state::peg_names(assembly);
    let held = state.in_hand.as_ref().map(Item::name);
    let free = known.pegs.iter().map(|&peg| names[peg].clone()).filter(|peg| Some(peg.as_str()) != held);
    // Pegs used by the plan come first.
    let spare = free.filter(|peg| !fetched.contains(peg)).collect::<BTreeSet<_>>();
    let pegs: Vec<String> = fetched.iter().cloned().chain(spare).collect();

    let mut steps = plan.steps.clone();
    let before = sum(&steps);
    let mut least = before;
    loop {
        let last = least;
        for first in 0..fetched.len() {
            for second in first + 1..pegs.len() {
                let tried = with_pegs_exchanged(&steps, &pegs[first], &pegs[second]);
                let cost = sum(&tried);
                if cost < least {
                    (steps, least) = (tried, cost);
                }
            }
        }
        let fastenings: Vec<usize> = (0..steps.len()).filter(|&at| is_fastening(&steps[at..])).collect();
        for (number, &first) in fastenings.iter().enumerate() {
            for &second in &fastenings[number + 1..] {
                let mut tried = steps.clone();
                for step in 0..FASTENING {
                    tried.swap(first + step, second + step);
                }
                let cost = sum(&tried);
                if cost < least && accepted(&tried) {
                    (steps, least) = (tried, cost);
                }
            }
        }
        if least == last {
            return Ok((Plan { steps, ..plan.clone() }, before - least));
        }
    }
}

/// The places where the hand acts, in order.
fn places(steps: &[CoarseStep]) -> Vec<Place> {
    let mut places: Vec<Place> = Vec::new();
    for action in steps.iter().flat_map(|step| &step.fine) {
        let place = match action {
            FineAction::Move { to: Place::Approach(target) } => Place::Target(target.clone()),
            FineAction::Move { to: place @ (Place::Input(_) | Place::Target(_)) } => place.clone(),
            _ => continue,
        };
        if places.last() != Some(&place) {
            places.push(place);
        }
    }
    places
}

/// The peg picked up by a step.
fn peg_of(step: &CoarseStep) -> Option<&str> {
    match &step.coarse {
        CoarseAction::PickUp { item: Item::Peg(peg) } => Some(peg),
        _ => None,
    }
}

/// Whether these steps begin with the fetching and inserting of a peg.
fn is_fastening(steps: &[CoarseStep]) -> bool {
    let ends = steps.get(FASTENING - 1).map(|step| &step.coarse);
    let fetched = steps.first().and_then(peg_of);
    matches!((fetched, ends), (Some(peg), Some(CoarseAction::Fasten { peg: other, .. })) if peg == other)
}

/// The steps with two pegs swapped.
fn with_pegs_exchanged(steps: &[CoarseStep], first: &str, second: &str) -> Vec<CoarseStep> {
    let exchanged = |peg: &str| match peg {
        peg if peg == first => second.to_string(),
        peg if peg == second => first.to_string(),
        peg => peg.to_string(),
    };
    let mut steps = steps.to_vec();
    for step in &mut steps {
        match &mut step.coarse {
            CoarseAction::PickUp { item: Item::Peg(peg) }
            | CoarseAction::PutDown { item: Item::Peg(peg) }
            | CoarseAction::Fasten { peg, .. } => *peg = exchanged(peg),
            _ => {}
        }
        for action in &mut step.fine {
            *action = action.with_pegs(exchanged);
        }
    }
    steps
}
