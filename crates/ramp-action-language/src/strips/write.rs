//! The ground problem as text: atoms for literals, auxiliary actions that conclude them, and the actions.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use super::ground::{Action, All, Grounded, Literal};
use crate::interpreter::{Ground, Model, State};
use crate::pddl::{PddlError, plain};
use crate::term::Term;

/// Most conditional effects of an action: it is written once for each set of those that happen.
const MOST_CONDITIONS: usize = 8;

/// The two files.
pub(super) struct Files {
    pub domain: String,
    pub problem: String,
    /// The action of the domain for each action; `None` for an auxiliary one.
    pub actions: BTreeMap<String, Option<Term>>,
}

/// The meaning of an atom of the files.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
enum Meaning {
    /// A literal.
    Literal(Literal),
    /// All of several hold.
    All(All),
    /// One of several does not hold.
    NotAll(All),
}

/// An action of the files.
struct Written {
    name: String,
    conditions: BTreeSet<String>,
    /// Changes of inertial fluents.
    changes: BTreeSet<Literal>,
}

struct Writer<'p> {
    model: &'p Model<'p>,
    grounded: &'p Grounded,
    atoms: BTreeMap<Meaning, String>,
    taken: BTreeSet<String>,
    /// Auxiliary actions: conditions and conclusion.
    proofs: Vec<(BTreeSet<String>, String)>,
    /// The fluents on which each conclusion depends.
    depends: BTreeMap<String, BTreeSet<Ground>>,
}

/// Writes the files.
///
/// # Errors
/// When an action has too many conditional effects.
pub(super) fn write(
    model: &Model,
    start: &State,
    grounded: &Grounded,
    domain: &str,
    problem: &str,
) -> Result<Files, PddlError> {
    let mut writer = Writer {
        model,
        grounded,
        atoms: BTreeMap::new(),
        taken: BTreeSet::new(),
        proofs: Vec::new(),
        depends: BTreeMap::new(),
    };
    let mut names: BTreeMap<String, Option<Term>> = BTreeMap::new();
    let mut actions = Vec::new();
    for action in &grounded.actions {
        for written in writer.variants(action)? {
            names.insert(written.name.clone(), Some(model.atom_term(&action.action)));
            actions.push(written);
        }
    }
    let goals: Option<Vec<String>> =
        grounded.goals.as_ref().map(|goals| goals.iter().map(|goal| writer.literal(goal)).collect());
    writer.follow_dependencies();
    let mut text =
        format!("(define (domain {})\n(:requirements :strips)\n(:predicates\n  (never)\n", plain(domain));
    for atom in writer.atoms.values() {
        let _ = writeln!(text, "  ({atom})");
    }
    text.push_str(")\n");
    for Written { name, conditions, changes } in &actions {
        let effects = writer.effects(changes);
        text.push_str(&action_text(name, conditions, &effects));
    }
    for (number, (conditions, conclusion)) in writer.proofs.iter().enumerate() {
        let name = format!("derive_{}", number + 1);
        text.push_str(&action_text(&name, conditions, &[format!("({conclusion})")]));
        names.insert(name, None);
    }
    text.push_str(")\n");
    let mut facts = format!("(define (problem {})\n(:domain {})\n(:init\n", plain(problem), plain(domain));
    for (saying, atom) in &writer.atoms {
        if let Meaning::Literal((fluent, truth)) = saying
            && grounded.inertial.contains(fluent)
            && model.has(fluent.predicate, &fluent.row, start) == *truth
        {
            let _ = writeln!(facts, "  ({atom})");
        }
    }
    let goals = goals.unwrap_or_else(|| vec!["never".to_string()]);
    let goals: Vec<String> = goals.iter().map(|goal| format!("({goal})")).collect();
    let _ = writeln!(facts, ")\n(:goal (and\n  {})))", goals.join("\n  "));
    Ok(Files { domain: text, problem: facts, actions: names })
}

fn action_text(name: &str, conditions: &BTreeSet<String>, effects: &[String]) -> String {
    let conditions: Vec<String> = conditions.iter().map(|atom| format!("({atom})")).collect();
    format!(
        "(:action {name}\n  :parameters ()\n  :precondition (and {})\n  :effect (and {}))\n",
        conditions.join(" "),
        effects.join(" ")
    )
}

impl Writer<'_> {
    /// A new name.
    fn name(&mut self, base: String) -> String {
        let numbered = (2..).map(|number| format!("{base}__{number}"));
        let free = std::iter::once(base.clone()).chain(numbered).find(|name| !self.taken.contains(name));
        let name = free.unwrap_or(base);
        self.taken.insert(name.clone());
        name
    }

    /// The atom of a saying, and whether it is new.
    fn atom(&mut self, saying: Meaning, base: impl FnOnce() -> String) -> (String, bool) {
        if let Some(known) = self.atoms.get(&saying) {
            return (known.clone(), false);
        }
        let name = self.name(base());
        self.atoms.insert(saying, name.clone());
        (name, true)
    }

    /// The atom of a literal. That of a defined fluent gets its proofs.
    fn literal(&mut self, literal: &Literal) -> String {
        let (fluent, truth) = literal;
        let term = self.model.atom_term(fluent);
        let base = || if *truth { flat(&term) } else { format!("not_{}", flat(&term)) };
        let (atom, new) = self.atom(Meaning::Literal(literal.clone()), base);
        let Some(bodies) = self.grounded.defined.get(fluent).filter(|_| new) else { return atom };
        if *truth {
            for body in bodies {
                let conditions = body.iter().map(|literal| self.literal(literal)).collect();
                self.proofs.push((conditions, atom.clone()));
            }
        } else {
            let conditions = bodies.iter().map(|body| self.not_all(body)).collect();
            self.proofs.push((conditions, atom.clone()));
        }
        atom
    }

    fn all(&mut self, body: &All) -> String {
        if let (Some(only), 1) = (body.first(), body.len()) {
            return self.literal(only);
        }
        let (atom, new) = self.atom(Meaning::All(body.clone()), || "all".to_string());
        if new {
            let conditions = body.iter().map(|literal| self.literal(literal)).collect();
            self.proofs.push((conditions, atom.clone()));
        }
        atom
    }

    fn not_all(&mut self, body: &All) -> String {
        if let (Some((fluent, truth)), 1) = (body.first(), body.len()) {
            return self.literal(&(fluent.clone(), !truth));
        }
        let (atom, new) = self.atom(Meaning::NotAll(body.clone()), || "not_all".to_string());
        if new {
            for (fluent, truth) in body {
                let condition = self.literal(&(fluent.clone(), !truth));
                self.proofs.push((BTreeSet::from([condition]), atom.clone()));
            }
        }
        atom
    }

    /// An action, once for each set of its conditional effects.
    fn variants(&mut self, action: &Action) -> Result<Vec<Written>, PddlError> {
        let certain: All = action
            .forbidden
            .iter()
            .filter(|body| body.len() == 1)
            .flatten()
            .map(|(fluent, truth)| (fluent.clone(), !truth))
            .collect();
        let always: BTreeSet<String> = action.forbidden.iter().map(|body| self.not_all(body)).collect();
        let mut by_condition: BTreeMap<All, BTreeSet<Literal>> = BTreeMap::new();
        for (body, literal) in &action.effects {
            let body: All = body.difference(&certain).cloned().collect();
            let never = body.iter().any(|(fluent, truth)| certain.contains(&(fluent.clone(), !truth)));
            if !never {
                by_condition.entry(body).or_default().insert(literal.clone());
            }
        }
        let plain_changes = by_condition.remove(&All::new()).unwrap_or_default();
        by_condition.values_mut().for_each(|literals| literals.retain(|it| !plain_changes.contains(it)));
        by_condition.retain(|_, literals| !literals.is_empty());
        let term = self.model.atom_term(&action.action);
        if by_condition.len() > MOST_CONDITIONS {
            return Err(PddlError::Law {
                file: self.model.domain.file().name().to_string(),
                line: 1,
                why: format!("`{term}` has more than {MOST_CONDITIONS} conditional effects"),
            });
        }
        let mut variants = Vec::new();
        for chosen in 0..1_usize << by_condition.len() {
            let mut conditions = always.clone();
            let mut changes = plain_changes.clone();
            for (index, (body, literals)) in by_condition.iter().enumerate() {
                let happens = chosen >> index & 1 == 1;
                conditions.insert(if happens { self.all(body) } else { self.not_all(body) });
                if happens {
                    changes.extend(literals.iter().cloned());
                }
            }
            // Laws that contradict each other make the action impossible.
            if !changes.iter().any(|(fluent, truth)| *truth && changes.contains(&(fluent.clone(), false))) {
                let name = self.name(flat(&term));
                variants.push(Written { name, conditions, changes });
            }
        }
        Ok(variants)
    }

    /// Finds the inertial fluents on which each conclusion depends.
    fn follow_dependencies(&mut self) {
        for (saying, atom) in &self.atoms {
            if let Meaning::Literal((fluent, _)) = saying
                && self.grounded.inertial.contains(fluent)
            {
                self.depends.insert(atom.clone(), BTreeSet::from([fluent.clone()]));
            }
        }
        loop {
            let mut any = false;
            for (conditions, conclusion) in &self.proofs {
                let found: BTreeSet<Ground> =
                    conditions.iter().filter_map(|atom| self.depends.get(atom)).flatten().cloned().collect();
                let known = self.depends.entry(conclusion.clone()).or_default();
                let before = known.len();
                known.extend(found);
                any |= known.len() > before;
            }
            if !any {
                return;
            }
        }
    }

    /// The effects of changes: their atoms, and the conclusions that may no longer hold.
    fn effects(&self, changes: &BTreeSet<Literal>) -> Vec<String> {
        let mut effects = Vec::new();
        for (fluent, truth) in changes {
            for side in [true, false] {
                if let Some(atom) = self.atoms.get(&Meaning::Literal((fluent.clone(), side))) {
                    effects.push(if side == *truth {
                        format!("({atom})")
                    } else {
                        format!("(not ({atom}))")
                    });
                }
            }
        }
        let conclusions: BTreeSet<&String> = self.proofs.iter().map(|(_, conclusion)| conclusion).collect();
        for conclusion in conclusions {
            let depends = self.depends.get(conclusion);
            let touched =
                |depends: &BTreeSet<Ground>| changes.iter().any(|(fluent, _)| depends.contains(fluent));
            if depends.is_some_and(touched) {
                effects.push(format!("(not ({conclusion}))"));
            }
        }
        effects
    }
}

/// A ground term as one name.
fn flat(term: &Term) -> String {
    match term {
        Term::Function(name, arguments) => {
            let parts = std::iter::once(plain(name)).chain(arguments.iter().map(inner));
            parts.collect::<Vec<String>>().join("__")
        }
        other => inner(other),
    }
}

/// An argument: objects without the function around them.
fn inner(term: &Term) -> String {
    match term {
        Term::Text(name) => plain(name),
        Term::Function(name, arguments) => match &arguments[..] {
            [inner_term] => inner(inner_term),
            _ => plain(name),
        },
        other => plain(&other.to_string()),
    }
}
