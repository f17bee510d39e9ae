//! A problem in STRIPS: ground actions whose conditions are positive atoms, for planners that read no more.
//!
//! `ground` finds what actions can reach. `write` gives each literal that a condition needs an atom,
//! and proves those of defined fluents by auxiliary actions: one that needs `-full` comes after an
//! action `derive_N` that concludes it from atoms of inertial fluents. An action of the domain
//! deletes the conclusions that depend on what it changes. So a plan has the actions of the domain
//! in order, with auxiliary ones between them.

mod ground;
mod write;

use std::collections::BTreeMap;

use crate::interpreter::{Model, State};
use crate::pddl::{PddlError, words_of_plan};
use crate::term::Term;

/// A ground problem, as a domain and a problem in PDDL with `:strips` only.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Strips {
    /// The domain file.
    pub domain: String,
    /// The problem file.
    pub problem: String,
    /// The action of the domain for each of its actions; `None` for an auxiliary one.
    actions: BTreeMap<String, Option<Term>>,
}

impl Strips {
    /// Writes the problem to reach the goals of a model's domain from a state.
    ///
    /// # Errors
    /// When a state constraint has several fluents in its body, or an action too many conditional effects.
    ///
    /// ```
    /// use ramp_action_language::{Domain, Model, SourceFile, Strips, Term};
    ///
    /// let text = "sort lamp. inertial fluent on(lamp). action press(lamp).
    ///     press(L) causes on(L) if -on(L). goal on(L).";
    /// let domain = Domain::new(&SourceFile::new("lamp.al", text), None)?;
    /// let model = Model::new(&domain, &[Term::new("lamp", [Term::from("Hall")])]);
    /// let dark = model.initial(&[], &[]).unwrap();
    /// let strips = Strips::new(&model, &dark, "lamps", "evening").unwrap();
    /// assert!(strips.problem.contains("(on__hall)"));
    /// let plan = strips.read_plan("(press__hall)").unwrap().unwrap();
    /// assert_eq!(plan[0].to_string(), "press(\"Hall\")");
    /// # Ok::<(), ramp_action_language::LanguageError>(())
    /// ```
    pub fn new(model: &Model, start: &State, domain: &str, problem: &str) -> Result<Strips, PddlError> {
        let grounded = ground::Grounded::new(model, start)?;
        let write::Files { domain, problem, actions } =
            write::write(model, start, &grounded, domain, problem)?;
        Ok(Strips { domain, problem, actions })
    }

    /// The actions of a plan in the terms of the rules; `None` if it is not a plan for these files.
    ///
    /// # Errors
    /// At the first line that is no action, after one that is.
    pub fn read_plan(&self, text: &str) -> Option<Result<Vec<Term>, PddlError>> {
        let lines = match words_of_plan(text) {
            Ok(lines) => lines,
            Err(error) => return Some(Err(error)),
        };
        let known = |words: &Vec<String>| words.first().and_then(|name| self.actions.get(name));
        if !lines.iter().any(|(_, words)| known(words).is_some()) {
            return None;
        }
        let mut actions = Vec::new();
        for (number, words) in &lines {
            match known(words) {
                Some(action) => actions.extend(action.clone()),
                None => {
                    let found = ramp_source::shorten(&words.join(" "));
                    let why = "these files have no such action".to_string();
                    return Some(Err(PddlError::Plan { line: *number, found, why }));
                }
            }
        }
        Some(Ok(actions))
    }
}
