//! Laws in PDDL: derived predicates, preconditions and effects.

use super::error::PddlError;
use super::text::{all_of, marked, parameters, quantified, spaced, variable};
use super::writer::Writer;
use crate::ast::{Atom, Comparison, Condition, Expression, Law, Literal, Operator, Shape};
use crate::domain::{CheckedLaw, FluentKind, Kind, NUMBER};
use std::fmt::Write;

/// Largest chain of effects that follow from one effect.
const DEPTH: usize = 4;

/// An effect with its condition: `(forall (variables) (when (and conditions) literal))`.
struct Effect {
    variables: Vec<String>,
    conditions: Vec<String>,
    literal: String,
}

impl Writer<'_> {
    /// Derived predicates: the laws of defined fluents.
    pub(crate) fn derived(&mut self) -> Result<String, PddlError> {
        let mut text = String::new();
        let laws: Vec<&CheckedLaw> = self.domain.laws.iter().collect();
        for law in laws {
            let Law::Holds { head } = &law.law else { continue };
            let name = &head.atom.name.text;
            if self.domain.kind(name) != Some(Kind::Fluent(FluentKind::Defined)) {
                continue;
            }
            let sorts = self.domain.predicates[name].sorts.clone();
            let (variables, mut parts) = self.matched(law, &head.atom, "?x")?;
            parts.extend(self.conditions(law)?);
            let body = quantified("exists", &variables, all_of(parts));
            let _ = writeln!(text, "(:derived ({name}{})\n  {body})", parameters(&sorts));
        }
        Ok(text)
    }

    /// An action: its preconditions and effects.
    pub(crate) fn action(&mut self, name: &str, sorts: &[String]) -> Result<String, PddlError> {
        let mut preconditions = Vec::new();
        let mut effects = Vec::new();
        let laws: Vec<&CheckedLaw> = self.domain.laws.iter().collect();
        for law in laws {
            match &law.law {
                Law::Impossible { action } if action.name.text == name => {
                    let (variables, mut parts) = self.matched(law, action, "?x")?;
                    parts.extend(self.conditions(law)?);
                    let body = quantified("exists", &variables, all_of(parts));
                    preconditions.push(format!("(not {body})"));
                }
                Law::Causal { action, heads } if action.name.text == name => {
                    let (variables, mut parts) = self.matched(law, action, "?x")?;
                    parts.extend(self.conditions(law)?);
                    for head in heads {
                        self.effects(law, head, variables.clone(), parts.clone(), DEPTH, &mut effects)?;
                    }
                }
                _ => {}
            }
        }
        let mut text = format!("(:action {name}\n  :parameters ({})\n", parameters(sorts).trim_start());
        let _ = writeln!(text, "  :precondition (and\n    {})", preconditions.join("\n    "));
        let _ = writeln!(text, "  :effect (and");
        for Effect { variables, conditions, literal } in effects {
            let effect = match conditions.is_empty() {
                true => literal,
                false => format!("(when {} {literal})", all_of(conditions)),
            };
            let _ = writeln!(text, "    {}", quantified("forall", &variables, effect));
        }
        text.push_str("  ))\n");
        Ok(text)
    }

    /// An effect with its consequences by the state constraints.
    fn effects(
        &mut self,
        law: &CheckedLaw,
        head: &Literal,
        variables: Vec<String>,
        conditions: Vec<String>,
        depth: usize,
        effects: &mut Vec<Effect>,
    ) -> Result<(), PddlError> {
        let terms = self.expressions(law, &head.atom)?;
        self.follow(&head.atom.name.text, &terms, head.positive, variables, conditions, depth, effects)
    }

    #[allow(clippy::too_many_arguments)] // what an effect is, and where it comes from
    fn follow(
        &mut self,
        name: &str,
        terms: &[String],
        positive: bool,
        variables: Vec<String>,
        conditions: Vec<String>,
        depth: usize,
        effects: &mut Vec<Effect>,
    ) -> Result<(), PddlError> {
        let atom = spaced(name, terms);
        let literal = if positive { atom } else { format!("(not {atom})") };
        effects.push(Effect { variables: variables.clone(), conditions: conditions.clone(), literal });
        if depth == 0 {
            return Ok(());
        }
        let laws: Vec<&CheckedLaw> = self.domain.laws.iter().collect();
        for law in laws {
            let Law::Holds { head } = &law.law else { continue };
            let kind = self.domain.kind(&head.atom.name.text);
            if kind != Some(Kind::Fluent(FluentKind::Inertial)) {
                continue;
            }
            let fluents: Vec<&Literal> = law
                .body
                .iter()
                .filter_map(|condition| match condition {
                    Condition::Literal(literal) => Some(literal),
                    Condition::Comparison(_) => None,
                })
                .filter(|literal| matches!(self.domain.kind(&literal.atom.name.text), Some(Kind::Fluent(_))))
                .collect();
            let [trigger] = fluents[..] else {
                return Err(self.cannot(law, "expected a state constraint with one fluent in its body"));
            };
            if trigger.atom.name.text != name || trigger.positive != positive {
                continue;
            }
            // Its variables get names of their own.
            let mark = format!("_{depth}");
            let (more, mut parts) = self.matched_to(law, &trigger.atom, terms, &mark)?;
            parts.extend(self.conditions_but(law, trigger, &mark)?);
            let inner: Vec<String> =
                self.expressions(law, &head.atom)?.iter().map(|term| marked(term, &mark)).collect();
            let variables = [&variables[..], &more[..]].concat();
            let conditions = [&conditions[..], &parts[..]].concat();
            self.follow(
                &head.atom.name.text,
                &inner,
                head.positive,
                variables,
                conditions,
                depth - 1,
                effects,
            )?;
        }
        Ok(())
    }

    /// The typed variables of a law, and the equations between its atom and the parameters `?x1`, …
    fn matched(
        &mut self,
        law: &CheckedLaw,
        atom: &Atom,
        parameter: &str,
    ) -> Result<(Vec<String>, Vec<String>), PddlError> {
        let terms: Vec<String> = (1..=atom.arguments.len()).map(|n| format!("{parameter}{n}")).collect();
        self.matched_to(law, atom, &terms, "")
    }

    fn matched_to(
        &mut self,
        law: &CheckedLaw,
        atom: &Atom,
        terms: &[String],
        mark: &str,
    ) -> Result<(Vec<String>, Vec<String>), PddlError> {
        let mut variables = Vec::new();
        for (name, sort) in &law.variables {
            if sort == NUMBER {
                return Err(self.cannot(law, "it needs numbers, which this PDDL has not"));
            }
            variables.push(format!("{} - {sort}", marked(&variable(name), mark)));
        }
        let inner = self.expressions(law, atom)?;
        let equal = terms.iter().zip(&inner).map(|(term, own)| format!("(= {term} {})", marked(own, mark)));
        Ok((variables, equal.collect()))
    }

    fn conditions(&mut self, law: &CheckedLaw) -> Result<Vec<String>, PddlError> {
        law.body.iter().map(|condition| self.condition(law, condition)).collect()
    }

    fn conditions_but(
        &mut self,
        law: &CheckedLaw,
        left_out: &Literal,
        mark: &str,
    ) -> Result<Vec<String>, PddlError> {
        let is_it = |condition: &&Condition| !matches!(condition, Condition::Literal(literal) if std::ptr::eq(literal, left_out));
        let conditions = law.body.iter().filter(is_it);
        conditions.map(|condition| Ok(marked(&self.condition(law, condition)?, mark))).collect()
    }

    fn condition(&mut self, law: &CheckedLaw, condition: &Condition) -> Result<String, PddlError> {
        match condition {
            Condition::Literal(Literal { positive, atom }) => {
                let terms = self.expressions(law, atom)?;
                let text = spaced(&atom.name.text, &terms);
                Ok(if *positive { text } else { format!("(not {text})") })
            }
            Condition::Comparison(Comparison { left, operator, right }) => {
                let sort = sort_of(law, left).or_else(|| sort_of(law, right)).unwrap_or_default();
                let [left, right] = [self.expression(law, left, sort)?, self.expression(law, right, sort)?];
                let sides = format!("(= {left} {right})");
                match operator {
                    Operator::Equal => Ok(sides),
                    Operator::NotEqual => Ok(format!("(not {sides})")),
                    _ => {
                        Err(self.cannot(law, "PDDL compares objects for being equal or not, and no further"))
                    }
                }
            }
        }
    }
}

/// The sort of a variable.
fn sort_of<'l>(law: &'l CheckedLaw, term: &Expression) -> Option<&'l str> {
    match &term.what {
        Shape::Variable(name) => law.variables.get(name).map(String::as_str),
        _ => None,
    }
}
