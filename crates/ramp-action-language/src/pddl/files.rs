//! The two files: a domain with its types, predicates and actions, and a problem with objects,
//! state and goals.

use super::error::PddlError;
use super::text::plain;
use super::writer::{Objects, Writer};
use crate::domain::{Kind, Leaf};
use crate::interpreter::{Model, State};
use crate::term::Term;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// A domain and a problem in PDDL.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pddl {
    /// The domain file.
    pub domain: String,
    /// The problem file.
    pub problem: String,
    /// PDDL's name of each object.
    pub(crate) objects: Objects,
}

impl Pddl {
    /// Writes a domain, and the problem to reach its goals from a state. `facts` are those of the
    /// model; they define the order of the objects.
    ///
    /// # Errors
    /// When PDDL cannot express a law of the domain.
    ///
    /// ```
    /// use ramp_action_language::{Domain, Model, Pddl, SourceFile, Term};
    ///
    /// let text = "sort lamp. inertial fluent on(lamp). action press(lamp).
    ///     press(L) causes on(L) if -on(L). goal on(L).";
    /// let domain = Domain::new(&SourceFile::new("lamp.al", text), None)?;
    /// let facts = [Term::new("lamp", [Term::from("Hall")])];
    /// let model = Model::new(&domain, &facts);
    /// let dark = model.initial(&[], &[]).unwrap();
    /// let pddl = Pddl::new(&model, &facts, &dark, "lamps", "evening").unwrap();
    /// assert!(pddl.domain.contains("(:action press"));
    /// assert!(pddl.problem.contains("(on hall)"));
    /// let plan = pddl.read_plan(&domain, "(press hall)").unwrap();
    /// assert_eq!(plan[0].to_string(), "press(\"Hall\")");
    /// # Ok::<(), ramp_action_language::LanguageError>(())
    /// ```
    pub fn new(
        model: &Model,
        facts: &[Term],
        start: &State,
        domain_name: &str,
        problem_name: &str,
    ) -> Result<Pddl, PddlError> {
        let domain = model.domain;
        let statics = model.static_facts();
        let mut writer = Writer { domain, objects: Objects::new(), quoted: BTreeSet::new() };
        // Objects by type; the constants of a sort belong to the domain.
        let mut objects: BTreeMap<&str, Vec<String>> = BTreeMap::new();
        for (sort, leaves) in domain.sorts.iter().map(|(name, sort)| (name.as_str(), &sort.leaves)) {
            if leaves.contains(&Leaf::Open(sort.to_string())) {
                for fact in facts {
                    if let Some((name, [Term::Text(object)])) = fact.parts()
                        && name == sort
                    {
                        let object = writer.object(sort, object);
                        objects.entry(sort).or_default().push(object);
                    }
                }
            }
        }
        let mut text = String::new();
        let _ = writeln!(text, "(define (domain {domain_name})");
        text.push_str(
            "(:requirements :typing :equality :negative-preconditions :disjunctive-preconditions\n  \
             :quantified-preconditions :conditional-effects :derived-predicates)\n",
        );
        let mut laws = writer.derived()?;
        for (name, predicate) in &domain.predicates {
            if predicate.kind == (Kind::Action { exogenous: false }) {
                laws.push_str(&writer.action(name, &predicate.sorts)?);
            }
        }
        text.push_str(&writer.types());
        text.push_str(&writer.constants(&objects));
        text.push_str(&writer.predicates());
        text.push_str(&laws);
        text.push_str(")\n");
        // Objects named by the laws are constants of the domain.
        objects.values_mut().for_each(|names| names.retain(|name| !writer.quoted.contains(name)));

        let mut problem = String::new();
        let _ = writeln!(problem, "(define (problem {})", plain(problem_name));
        problem.push_str(&format!("(:domain {domain_name})\n(:objects\n"));
        for (sort, names) in objects.iter().filter(|(_, names)| !names.is_empty()) {
            let _ = writeln!(problem, "  {} - {sort}", names.join(" "));
        }
        problem.push_str(")\n(:init\n");
        for fact in statics.iter().chain(&model.inertial(start)) {
            let _ = writeln!(problem, "  {}", writer.ground(fact));
        }
        problem.push_str(")\n(:goal (and\n");
        for (fluent, truth) in model.goals() {
            let atom = writer.ground(&fluent);
            let _ = match truth {
                true => writeln!(problem, "  {atom}"),
                false => writeln!(problem, "  (not {atom})"),
            };
        }
        problem.push_str(")))\n");
        Ok(Pddl { domain: text, problem, objects: writer.objects })
    }
}
