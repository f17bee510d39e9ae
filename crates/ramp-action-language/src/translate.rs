//! Translation of a domain into a readable answer set program.
//!
//! The translation is the usual one for AL_d: `holds(F,T)` and `-holds(F,T)` state the true and
//! false fluents at a time, a causal law looks one step back, inertia is a default, and a defined
//! fluent is false unless it is derived.

use crate::ast::{Atom, Condition, Expression, Law, Literal, Shape, is_anonymous};
use crate::domain::{CheckedLaw, Domain, FluentKind, Kind, Leaf, NUMBER};
use std::collections::BTreeSet;
use std::fmt::Write;

/// The common head of all translations.
const BASE: &str = "
% ---- At time 0: what was told, what is the rule, and nothing else ----
holds(F,0)  :- told(F).
-holds(F,0) :- told_not(F).
holds(F,0)  :- initially(F), not -holds(F,0), not resumed.
-holds(F,0) :- inertial(F), not initially(F), not holds(F,0).
-holds(F,0) :- inertial(F), not holds(F,0), resumed.
#show occurs/2.
";

/// The common part of every step.
const STEP: &str = "
% ---- One action at a time, and what nothing changes stays as it is ----
{ occurs(A,t) : action(A), not impossible(A,t) } = 1.
:- occurs(A,t), impossible(A,t).
holds(F,t)  :- inertial(F), holds(F,t-1), not -holds(F,t).
-holds(F,t) :- inertial(F), -holds(F,t-1), not holds(F,t).
";

/// The common part of every time: the goal, checked at one time after another.
const CHECK: &str = "
#external query(t).
:- query(t), goal(F), not holds(F,t).
:- query(t), avoid(F), holds(F,t).
";

impl Domain {
    /// The domain as a program for clingo without the objects and statics of a problem, in the
    /// parts `base`, `step(t)` and `check(t)` of clingo's incremental mode.
    ///
    /// ```
    /// use ramp_action_language::{Domain, SourceFile};
    ///
    /// let text = "sort lamp. inertial fluent on(lamp). action press(lamp).
    ///     press(L) causes on(L) if -on(L).";
    /// let domain = Domain::new(&SourceFile::new("lamp.al", text), None)?;
    /// assert!(domain.to_asp().contains("holds(on(L),t) :- occurs(press(L),t), -holds(on(L),t-1)."));
    /// # Ok::<(), ramp_action_language::LanguageError>(())
    /// ```
    pub fn to_asp(&self) -> String {
        let mut parts = Parts::default();
        let _ = writeln!(parts.base, "% Written from {}.\n#program base.\n", self.file.name());
        self.sorts_to_asp(&mut parts.base);
        for (name, predicate) in &self.predicates {
            let variables: Vec<String> =
                (1..=predicate.sorts.len()).map(|index| format!("X{index}")).collect();
            let atom = match variables.is_empty() {
                true => name.clone(),
                false => format!("{name}({})", variables.join(",")),
            };
            let kind = match predicate.kind {
                Kind::Fluent(FluentKind::Inertial) => "inertial",
                Kind::Action { exogenous: false } => "action",
                Kind::Action { exogenous: true } => "event",
                Kind::Static | Kind::Fluent(FluentKind::Defined) => continue,
            };
            let sorts =
                predicate.sorts.iter().zip(&variables).map(|(sort, variable)| format!("{sort}({variable})"));
            let _ = writeln!(parts.base, "{}", rule(&format!("{kind}({atom})"), &sorts.collect::<Vec<_>>()));
        }
        parts.base.push('\n');
        for law in &self.laws {
            self.law_to_asp(law, &mut parts);
        }
        parts.base.push_str(BASE);
        format!(
            "{}\n#program check(t).\n{}{CHECK}\n#program step(t).\n{}{STEP}",
            parts.base, parts.check, parts.step
        )
    }

    fn sorts_to_asp(&self, text: &mut String) {
        for (name, sort) in &self.sorts {
            for leaf in &sort.leaves {
                let _ = match leaf {
                    Leaf::Number => continue,
                    Leaf::Open(open) if open == name => continue,
                    Leaf::Open(open) => writeln!(text, "{name}(X) :- {open}(X)."),
                    Leaf::Constant(constant) => writeln!(text, "{name}({constant})."),
                    Leaf::Function(function) => {
                        let sorts = self.functions.get(function).map(Vec::as_slice).unwrap_or_default();
                        let variables: Vec<String> = (1..=sorts.len()).map(|i| format!("X{i}")).collect();
                        let body: Vec<String> = sorts
                            .iter()
                            .zip(&variables)
                            .map(|(sort, variable)| format!("{sort}({variable})"))
                            .collect();
                        writeln!(
                            text,
                            "{}",
                            rule(&format!("{name}({function}({}))", variables.join(",")), &body)
                        )
                    }
                };
            }
        }
        text.push('\n');
    }

    fn law_to_asp(&self, law: &CheckedLaw, parts: &mut Parts) {
        match &law.law {
            Law::Causal { action, heads } => {
                for head in heads {
                    let first = vec![format!("occurs({action},t)")];
                    let body = self.body(law, first, Some(&action.arguments), "t-1", &[&head.atom]);
                    let _ = writeln!(parts.step, "{}", rule(&self.literal(head, "t"), &body));
                }
            }
            Law::Impossible { action } => {
                let body = self.body(law, Vec::new(), None, "t-1", &[action]);
                let body = if body.is_empty() { vec!["action(_)".to_string()] } else { body };
                let _ = writeln!(
                    parts.step,
                    "{}",
                    rule(&format!("impossible({},t)", self.spelled(action)), &body)
                );
            }
            Law::Holds { head } => {
                let body = self.body(law, Vec::new(), None, "t", &[&head.atom]);
                let to = if self.kind(&head.atom.name.text) == Some(Kind::Static) {
                    &mut parts.base
                } else {
                    &mut parts.check
                };
                let _ = writeln!(to, "{}", rule(&self.literal(head, "t"), &body));
            }
            Law::Initially { head } => {
                let body = self.body(law, Vec::new(), None, "0", &[&head.atom]);
                let name = if head.positive { "initially" } else { "told_not" };
                let _ = writeln!(parts.base, "{}", rule(&format!("{name}({})", head.atom), &body));
            }
            Law::Goal { head } => {
                let body = self.body(law, Vec::new(), None, "0", &[&head.atom]);
                let name = if head.positive { "final" } else { "final_not" };
                let _ = writeln!(parts.base, "{}", rule(&format!("{name}({})", head.atom), &body));
            }
            Law::Bridge { head } => {
                let body = self.body(law, Vec::new(), None, "t", &[head]);
                let _ = writeln!(parts.check, "{}", rule(&format!("holds(coarse({head}),t)"), &body));
            }
        }
    }

    /// A literal at a time.
    fn literal(&self, literal: &Literal, time: &str) -> String {
        let atom = &literal.atom;
        match (self.kind(&atom.name.text), literal.positive) {
            (Some(Kind::Fluent(_)), true) => format!("holds({atom},{time})"),
            (Some(Kind::Fluent(FluentKind::Inertial)), false) => format!("-holds({atom},{time})"),
            (Some(Kind::Fluent(FluentKind::Defined)), false) => format!("not holds({atom},{time})"),
            (_, true) => atom.to_string(),
            (_, false) => format!("not {atom}"),
        }
    }

    /// An action with a name for each `_`, which the head of a rule needs.
    fn spelled(&self, atom: &Atom) -> String {
        let mut atom = atom.clone();
        atom.arguments.iter_mut().for_each(spell);
        atom.to_string()
    }

    /// The conditions of a law, after `first`, with a sort for every unbound variable.
    fn body(
        &self,
        law: &CheckedLaw,
        first: Vec<String>,
        given: Option<&[Expression]>,
        time: &str,
        heads: &[&Atom],
    ) -> Vec<String> {
        let mut body = first;
        let mut known: BTreeSet<String> = BTreeSet::new();
        let mut wanted: BTreeSet<String> = BTreeSet::new();
        let variables = |terms: &[Expression], into: &mut BTreeSet<String>| {
            terms.iter().for_each(|term| {
                term.variables(&mut |variable, _| {
                    into.insert(variable.to_string());
                });
            });
        };
        for head in heads {
            variables(&head.arguments, &mut wanted);
        }
        let action = match &law.law {
            Law::Causal { action, .. } => given.map(|_| action),
            _ => None,
        };
        if let Some(action) = action {
            self.bound(law, action, &mut known);
        }
        for condition in &law.body {
            match condition {
                Condition::Literal(literal) => {
                    variables(&literal.atom.arguments, &mut wanted);
                    if literal.positive {
                        self.bound(law, &literal.atom, &mut known);
                    }
                    body.push(self.literal(literal, time));
                }
                Condition::Comparison(comparison) => {
                    variables(&[comparison.left.clone(), comparison.right.clone()], &mut wanted);
                    body.push(comparison.to_string());
                }
            }
        }
        for variable in wanted.difference(&known) {
            if let Some(sort) = law.variables.get(variable).filter(|sort| *sort != NUMBER) {
                let in_head =
                    heads.iter().any(|head| head.arguments.iter().any(|term| mentions(term, variable)));
                // A `_` of the body stays one; a `_` of an action in a head gets a name.
                if !is_anonymous(variable) || in_head {
                    body.push(format!("{sort}({})", spelled_name(variable)));
                }
            }
        }
        body
    }

    /// The variables that a positive atom binds to a value of their sort.
    fn bound(&self, law: &CheckedLaw, atom: &Atom, known: &mut BTreeSet<String>) {
        let Some(predicate) = self.predicates.get(&atom.name.text) else { return };
        for (term, sort) in atom.arguments.iter().zip(&predicate.sorts) {
            self.bound_in(law, term, sort, known);
        }
    }

    fn bound_in(&self, law: &CheckedLaw, term: &Expression, sort: &str, known: &mut BTreeSet<String>) {
        match &term.what {
            Shape::Variable(name) => {
                let narrowed = law.variables.get(name).is_some_and(|own| self.within(sort, own));
                if narrowed || sort == NUMBER {
                    known.insert(name.clone());
                }
            }
            Shape::Function(name, arguments) => {
                for (term, sort) in arguments.iter().zip(self.functions.get(name).into_iter().flatten()) {
                    self.bound_in(law, term, sort, known);
                }
            }
            Shape::Number(_) | Shape::Quoted(_) | Shape::Sum(..) => {}
        }
    }
}

#[derive(Default)]
struct Parts {
    base: String,
    check: String,
    step: String,
}

fn rule(head: &str, body: &[String]) -> String {
    if body.is_empty() { format!("{head}.") } else { format!("{head} :- {}.", body.join(", ")) }
}

fn mentions(term: &Expression, variable: &str) -> bool {
    let mut found = false;
    term.variables(&mut |name, _| found |= name == variable);
    found
}

/// A name for a `_`, such as `Any3`.
fn spelled_name(variable: &str) -> String {
    variable.strip_prefix('_').map_or_else(|| variable.to_string(), |number| format!("Any{number}"))
}

fn spell(term: &mut Expression) {
    match &mut term.what {
        Shape::Variable(name) => *name = spelled_name(name),
        Shape::Function(_, arguments) => arguments.iter_mut().for_each(spell),
        Shape::Sum(left, _, right) => {
            spell(left);
            spell(right);
        }
        Shape::Number(_) | Shape::Quoted(_) => {}
    }
}
