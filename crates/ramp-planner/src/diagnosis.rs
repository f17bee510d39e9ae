//! What must have gone wrong: the fewest events that explain why the world is not as the actions should have left it.
//!
//! A [`History`] of actions and observations goes in. Between the actions the coarse domain's exogenous actions may
//! happen, and an action that was possible may have had no effect; clingo finds the smallest sets of such events under
//! which everything that was seen holds. Each comes back as a [`Diagnosis`] with the state to be believed then, from
//! which the planner can go on.

use crate::domains::Domains;
use crate::error::PlanError;
use crate::plan::{CoarseAction, CoarseStep, Item, State};
use crate::replay::Replayer;
use crate::solver::{Happening, Solver};
use ramp_action_language::{Prospect, Term, Unrolled};
use ramp_assembly::Assembly;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// The most events that are thought of at once.
const MOST_EVENTS: usize = 3;

/// What was done and seen since a state that was known.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct History {
    /// The state at the beginning.
    #[serde(default)]
    pub start: State,
    /// In order of time.
    pub records: Vec<Record>,
    /// What was still planned: it tells for which connection a peg was fetched.
    #[serde(default)]
    pub planned: Vec<CoarseAction>,
}

/// One thing that was done or seen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Record {
    /// The hand did this, or tried to.
    Did(CoarseAction),
    /// A fluent of the coarse domain, such as `in_assembly(b4)`, was seen to be true, or, with `-` before it, false.
    Saw(String),
}

/// Events that explain a history, and what to believe then.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnosis {
    /// In order of time; empty where all went as it should.
    pub events: Vec<Unexpected>,
    /// The state in the end.
    pub state: State,
}

/// Something that happened, or an action that did nothing.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Unexpected {
    /// An exogenous action of the coarse domain, such as `drop_peg("C1")`, or `no_effect(…)` of an action.
    pub event: String,
    /// Before which action of the history it happened at the latest, counted from 0; for an action without effect,
    /// that action.
    pub before: usize,
}

/// The smallest sets of events that explain a history: all of one size, in a fixed order. None at all when not even
/// three events together explain it.
///
/// # Errors
/// When the history names what the goal does not have, or when the solver fails.
///
/// ```
/// use ramp_planner::{CoarseAction, Domains, History, Item, Record, diagnose};
///
/// let kit = ramp_kit::read_kit("../../data/kit.xml".as_ref())?;
/// let assembly = ramp_assembly::read_goal("../../data/goals/easy-1.xml".as_ref(), &kit)?;
/// let domains = Domains::read("../../data/domains".as_ref())?;
/// let records = vec![
///     Record::Did(CoarseAction::PickUp { item: Item::Beam("b4".to_string()) }),
///     Record::Saw("-in_hand(beam(b4))".to_string()),
/// ];
/// let found = diagnose(&assembly, &domains, &History { records, ..History::default() })?;
/// assert_eq!(found[0].events[0].event, "no_effect(pick_up(beam(\"b4\")))");
/// assert!(found[0].state.in_hand.is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn diagnose(
    assembly: &Assembly,
    domains: &Domains,
    history: &History,
) -> Result<Vec<Diagnosis>, PlanError> {
    let table = Replayer::new(assembly, domains, &history.start)?;
    let actions = terms(&table, history)?;
    let model = &table.planner.model;
    let mut unrolled = Unrolled::new(model, table.fluents().clone());
    let mut happenings: Vec<Happening> = Vec::new();
    let mut done = 0;
    // Something may have happened since the last thing that was done.
    let mut fresh = true;
    for record in &history.records {
        if fresh {
            happenings.extend(may_happen(&mut unrolled, done));
            fresh = false;
        }
        match record {
            Record::Did(_) => {
                let action = &actions[done];
                if let Some(failed) = unrolled.attempt(action) {
                    let event = Term::new("no_effect", [action.clone()]);
                    happenings.push(Happening { event, before: done, literal: failed });
                }
                done += 1;
                fresh = true;
            }
            Record::Saw(text) => {
                let (fluent, truth) = observation(&table, text)?;
                match unrolled.prospect(&fluent, truth) {
                    Prospect::Certain => {}
                    Prospect::Never => return Ok(Vec::new()),
                    Prospect::If(literal) => unrolled.require(literal),
                }
            }
        }
    }
    let mut solver = Solver::default();
    let file = domains.coarse().file();
    let sets = solver
        .explanations(&mut unrolled, &happenings, MOST_EVENTS)
        .map_err(|error| PlanError::solver(file, &error))?;
    let mut found = Vec::new();
    for set in sets {
        let mut events: Vec<&Happening> = set.iter().map(|&index| &happenings[index]).collect();
        events.sort_by_key(|happening| happening.before);
        let state = believed(assembly, domains, history, &actions, &events)?;
        let events = events
            .iter()
            .map(|happening| Unexpected { event: happening.event.to_string(), before: happening.before });
        found.push(Diagnosis { events: events.collect(), state });
    }
    found.sort_by(|a, b| {
        let key = |d: &Diagnosis| d.events.iter().map(|e| (e.event.clone(), e.before)).collect::<Vec<_>>();
        key(a).cmp(&key(b))
    });
    Ok(found)
}

fn may_happen(unrolled: &mut Unrolled, before: usize) -> Vec<Happening> {
    let events = unrolled.may_happen();
    events.into_iter().map(|(event, literal)| Happening { event, before, literal }).collect()
}

/// The actions of a history in the words of the rules.
fn terms(table: &Replayer, history: &History) -> Result<Vec<Term>, PlanError> {
    let actions: Vec<&CoarseAction> = history
        .records
        .iter()
        .filter_map(|record| match record {
            Record::Did(action) => Some(action),
            Record::Saw(_) => None,
        })
        .collect();
    let mut picked: HashMap<&Item, Term> = HashMap::new();
    let mut terms = Vec::new();
    for (index, action) in actions.iter().enumerate() {
        let rest = actions[index + 1..].iter().copied().chain(&history.planned);
        let term = match action {
            CoarseAction::PutDown { item } if picked.contains_key(item) => {
                Term::new("put_down", [picked[item].clone()])
            }
            action => table.coarse_term(action, rest).map_err(|why| PlanError::ImpossibleState { why })?,
        };
        if let (CoarseAction::PickUp { item }, Some((_, [what]))) = (action, term.parts()) {
            picked.insert(item, what.clone());
        }
        terms.push(term);
    }
    Ok(terms)
}

/// What was seen: `-in_hand(beam(b4))`, with or without quotes.
fn observation(table: &Replayer, text: &str) -> Result<(Term, bool), PlanError> {
    let bad = |why: String| PlanError::ImpossibleState { why };
    let trimmed = text.trim();
    let (truth, name) = match trimmed.strip_prefix('-') {
        Some(rest) => (false, rest),
        None => (true, trimmed),
    };
    let fluent = Term::read(name)
        .ok_or_else(|| bad(format!("`{text}` is not a fluent; expected one such as `-in_assembly(b4)`")))?;
    let fluent = table.planner.model.fluent(&fluent).ok_or_else(|| {
        bad(format!("`{text}` was seen, but the coarse domain has no such fluent for this goal"))
    })?;
    Ok((fluent, truth))
}

/// The state after a history in which some events happened.
fn believed(
    assembly: &Assembly,
    domains: &Domains,
    history: &History,
    actions: &[Term],
    events: &[&Happening],
) -> Result<State, PlanError> {
    let mut table = Replayer::new(assembly, domains, &history.start)?;
    let mut done = Vec::new();
    for record in &history.records {
        if let Record::Did(action) = record {
            done.push(CoarseStep { coarse: action.clone(), fine: Vec::new() });
        }
    }
    let planned = history.planned.iter();
    done.extend(planned.map(|coarse| CoarseStep { coarse: coarse.clone(), fine: Vec::new() }));
    for index in 0..=actions.len() {
        let (failures, happened): (Vec<&Happening>, Vec<&Happening>) = events
            .iter()
            .copied()
            .filter(|happening| happening.before == index)
            .partition(|happening| matches!(happening.event.parts(), Some(("no_effect", _))));
        for happening in happened {
            table.happens(&happening.event);
        }
        if index < actions.len() && failures.is_empty() {
            // An action that was impossible, after what happened, did nothing either.
            let _ = table.step(&done[index..], false);
        }
    }
    Ok(table.state())
}
