//! Diagnosis: the smallest sets of events that explain why the world differs from the expected
//! effects of the actions.
//!
//! The input is a [`History`] of actions and observations. Between the actions the coarse domain's
//! exogenous actions may happen, and a possible action may have had no effect. clingo finds the
//! smallest sets of such events that are consistent with all observations. Each becomes a
//! [`Diagnosis`] with the resulting belief state, from which the planner can continue.

use crate::domains::Domains;
use crate::error::PlanError;
use crate::plan::{CoarseAction, CoarseStep, Item, State};
use crate::replay::Replayer;
use crate::solver::{Happening, Solver};
use ramp_action_language::{Prospect, Term, Unrolled};
use ramp_assembly::Assembly;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// Largest number of simultaneous events considered.
const MOST_EVENTS: usize = 3;

/// Actions and observations since a known state.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct History {
    /// The initial state.
    #[serde(default)]
    pub start: State,
    /// In order of time.
    pub records: Vec<Record>,
    /// The rest of the plan: it determines for which connection a peg was fetched.
    #[serde(default)]
    pub planned: Vec<CoarseAction>,
}

/// An action or an observation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Record {
    /// The hand executed or attempted this.
    Did(CoarseAction),
    /// A fluent of the coarse domain, such as `in_assembly(b4)`, was observed to be true, or, with
    /// `-` before it, false.
    Saw(String),
}

/// Events that explain a history, and the resulting belief.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnosis {
    /// In order of time; empty when everything went as planned.
    pub events: Vec<Unexpected>,
    /// The final state.
    pub state: State,
}

/// An event, or an action without effect.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Unexpected {
    /// An exogenous action of the coarse domain, such as `drop_peg("C1")`, or `no_effect(…)` of an action.
    pub event: String,
    /// Index of the action in the history before which it happened at the latest, from 0; for an
    /// action without effect, that action.
    pub before: usize,
}

/// The smallest sets of events that explain a history: all of one size, in a fixed order. Empty
/// when not even three events together explain it.
///
/// # Errors
/// When the history names something unknown to the goal, or when the solver fails.
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
    // An event may have happened since the last action.
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

/// The actions of a history in the terms of the rules.
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

/// An observation: `-in_hand(beam(b4))`, with or without quotes.
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

/// The state after a history with some events.
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
            // An action that the event made impossible had no effect either.
            let _ = table.step(&done[index..], false);
        }
    }
    Ok(table.state())
}
