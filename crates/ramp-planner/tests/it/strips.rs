//! The coarse level in STRIPS: our own plans are plans of its files, and come back from them.

use std::collections::BTreeSet;

use crate::common::{domains, goal};
use crate::pddl::as_pddl;
use ramp_planner::{State, pddl_plan, strips};

/// An action of the files: name, conditions, and what it adds and deletes.
struct Action {
    name: String,
    conditions: Vec<String>,
    adds: Vec<String>,
    deletes: Vec<String>,
}

/// The atoms `(a)` of a conjunction; those in `(not (a))` come second.
fn atoms(text: &str) -> [Vec<String>; 2] {
    let mut sides = [Vec::new(), Vec::new()];
    for part in text
        .split('(')
        .map(|part| part.trim_matches(|c: char| c.is_whitespace() || c == ')'))
        .filter(|part| !part.is_empty())
    {
        match part {
            "and" => {}
            "not" => sides[1].push(String::new()),
            atom => match sides[1].last_mut().filter(|open| open.is_empty()) {
                Some(open) => *open = atom.to_string(),
                None => sides[0].push(atom.to_string()),
            },
        }
    }
    sides
}

fn actions(domain: &str) -> Vec<Action> {
    let blocks = domain.split("(:action ").skip(1);
    blocks
        .map(|block| {
            let lines: Vec<&str> = block.lines().map(str::trim).collect();
            let [conditions, none] = atoms(lines[2].trim_start_matches(":precondition"));
            assert!(none.is_empty(), "a negative condition: {}", lines[2]);
            let [adds, deletes] = atoms(lines[3].trim_start_matches(":effect"));
            Action { name: lines[0].to_string(), conditions, adds, deletes }
        })
        .collect()
}

/// Carries a plan out: each action by the variant that is possible, after all conclusions. Returns the whole
/// plan; `None` if an action is impossible or a goal is not reached.
fn carry_out(domain: &str, problem: &str, plan: &[String]) -> Option<String> {
    let all = actions(domain);
    let (init, goals) = problem.split_once("(:init").unwrap().1.split_once("(:goal").unwrap();
    let mut state: BTreeSet<String> = atoms(init)[0].iter().cloned().collect();
    let mut text = String::new();
    let conclude = |state: &mut BTreeSet<String>, text: &mut String| {
        loop {
            let before = state.len();
            for proof in all.iter().filter(|action| action.name.starts_with("derive_")) {
                if !state.contains(&proof.adds[0]) && proof.conditions.iter().all(|atom| state.contains(atom))
                {
                    state.insert(proof.adds[0].clone());
                    text.push_str(&format!("({})\n", proof.name));
                }
            }
            if state.len() == before {
                return;
            }
        }
    };
    for wanted in plan {
        conclude(&mut state, &mut text);
        let is_it = |name: &str| {
            name == wanted || name.strip_prefix(wanted).is_some_and(|rest| rest.starts_with("__"))
        };
        let action = all.iter().find(|action| {
            is_it(&action.name) && action.conditions.iter().all(|atom| state.contains(atom))
        })?;
        action.deletes.iter().for_each(|atom| {
            state.remove(atom);
        });
        state.extend(action.adds.iter().cloned());
        text.push_str(&format!("({})\n", action.name));
    }
    conclude(&mut state, &mut text);
    atoms(goals)[0].iter().all(|goal| state.contains(goal)).then_some(text)
}

#[test]
fn our_plans_are_plans_of_the_strips_files() {
    for name in ["easy-1", "easy-3"] {
        let assembly = goal(name);
        let files = strips(&assembly, &State::default(), domains()).unwrap();
        for text in [&files.domain, &files.problem] {
            assert_eq!(text.matches('(').count(), text.matches(')').count());
        }
        let plan: Vec<String> = as_pddl(name)
            .lines()
            .filter_map(|line| {
                Some(line.to_lowercase().split_once('(')?.1.split_once(')')?.0.replace(' ', "__"))
            })
            .collect();
        let whole = carry_out(&files.domain, &files.problem, &plan).unwrap();
        assert!(whole.contains("(derive_"));
        // It comes back with the fine actions, without the auxiliary ones.
        let steps = pddl_plan(&assembly, &State::default(), domains(), &whole).unwrap();
        assert_eq!(steps.len(), plan.len());
        // Without one of its actions it is none.
        for left_out in 0..plan.len() {
            let mut fewer = plan.clone();
            let action = fewer.remove(left_out);
            let found = carry_out(&files.domain, &files.problem, &fewer);
            assert!(found.is_none(), "{name} without {action}: {found:?}");
        }
    }
    let files = strips(&goal("easy-1"), &State::default(), domains()).unwrap();
    let names = ["(fasten__c9)", "(pick_up__b4)\n(fasten__c9)"];
    for text in names {
        let error = pddl_plan(&goal("easy-1"), &State::default(), domains(), text).unwrap_err().to_string();
        assert!(error.starts_with("line "), "{error}");
    }
    assert!(files.domain.contains("(:requirements :strips)\n"));
}
