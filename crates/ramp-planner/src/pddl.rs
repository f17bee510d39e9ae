//! The coarse level for other planners: domain and problem in PDDL, and their plans back.
//!
//! Sorts become types, statics and fluents predicates, defined fluents derived predicates; what forbids an action
//! becomes its precondition, and what follows from an effect by a state constraint becomes part of that effect. PDDL
//! has no terms with arguments, so `beam("b4")` and `peg("C1")` are the objects of the beam and of the connection.
//! The language is PDDL 2.2 without numbers (S. Edelkamp, J. Hoffmann, *PDDL2.2: The Language for the Classical Part
//! of the 4th International Planning Competition*, 2004), with conditional effects and derived predicates.

use crate::domains::Domains;
use crate::error::PlanError;
use crate::language::ast::{Atom, Comparison, Condition, Expression, Law, Literal, Operator, Shape};
use crate::language::check::{CheckedLaw, Domain, Leaf, NUMBER};
use crate::language::{FluentKind, Kind};
use crate::plan::{CoarseStep, State};
use crate::planner::{Options, Planner};
use crate::replay::{Refused, Replayer};
use crate::state;
use crate::term::Term;
use ramp_assembly::Assembly;
use ramp_kit::Kit;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// How often one effect may follow from another.
const DEPTH: usize = 4;

/// A coarse domain and a goal in PDDL.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pddl {
    /// The domain file.
    pub domain: String,
    /// The problem file.
    pub problem: String,
    /// PDDL's name of each object, by the name in the goal.
    objects: BTreeMap<String, String>,
}

/// Writes the coarse domain and a goal in PDDL.
///
/// # Errors
/// When the state cannot be, or a law of the domain cannot be said in PDDL.
///
/// ```
/// use ramp_planner::{Domains, State, pddl};
///
/// let kit = ramp_kit::read_kit("../../data/kit.xml".as_ref())?;
/// let assembly = ramp_assembly::read_goal("../../data/goals/easy-1.xml".as_ref(), &kit)?;
/// let domains = Domains::read("../../data/domains".as_ref())?;
/// let written = pddl(&assembly, &kit, &State::default(), &domains)?;
/// assert!(written.domain.contains("(:action fasten"));
/// assert!(written.problem.contains("(joins c1 b4 b7)"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn pddl(assembly: &Assembly, kit: &Kit, state: &State, domains: &Domains) -> Result<Pddl, PlanError> {
    let known = state::look_up(assembly, kit, state)?;
    let planner = Planner::new(assembly, kit, domains, Options::default());
    let start = planner.fluents(&known)?;
    let model = &planner.model;
    let domain = domains.coarse();
    let statics = model.static_facts();
    let mut writer = Writer { domain, objects: BTreeMap::new(), quoted: BTreeSet::new() };
    // Objects by type; the constants of a sort belong to the domain.
    let mut objects: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (sort, leaves) in domain.sorts.iter().map(|(name, sort)| (name.as_str(), &sort.leaves)) {
        if leaves.contains(&Leaf::Open(sort.to_string())) {
            for fact in &planner.facts.all {
                if let Some((name, [Term::Text(object)])) = fact.parts()
                    && name == sort
                {
                    let object = writer.object(object);
                    objects.entry(sort).or_default().push(object);
                }
            }
        }
    }
    let mut text = String::new();
    let _ = writeln!(text, "; Written from {} by ramp plan --pddl.", domain.file().name());
    let _ = writeln!(text, "(define (domain ramp)");
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
    // What the laws name is a constant of the domain.
    objects.values_mut().for_each(|names| names.retain(|name| !writer.quoted.contains(name)));

    let mut problem = String::new();
    let _ = writeln!(problem, "; The goal {}.", assembly.name);
    let _ = writeln!(problem, "(define (problem {})", plain(&assembly.name));
    problem.push_str("(:domain ramp)\n(:objects\n");
    for (sort, names) in objects.iter().filter(|(_, names)| !names.is_empty()) {
        let _ = writeln!(problem, "  {} - {sort}", names.join(" "));
    }
    problem.push_str(")\n(:init\n");
    for fact in statics.iter().chain(&model.inertial(&start)) {
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

/// Takes a plan of another planner for what [`pddl`] wrote: judged, with pegs of the kit, and with the fine actions
/// under every coarse one.
///
/// # Errors
/// When a line is not an action, an action is not possible, the goal is not reached, or the fine domain has no way to
/// carry an action out.
pub fn pddl_plan(
    assembly: &Assembly,
    kit: &Kit,
    state: &State,
    domains: &Domains,
    text: &str,
) -> Result<Vec<CoarseStep>, PlanError> {
    let written = pddl(assembly, kit, state, domains)?;
    let actions = written.read_plan(domains.coarse(), text)?;
    let known = state::look_up(assembly, kit, state)?;
    let mut planner = Planner::new(assembly, kit, domains, Options::default());
    let mut now = planner.fluents(&known)?;
    let mut transitions = Vec::new();
    for (index, action) in actions.iter().enumerate() {
        let walked = planner.walk(&now, std::slice::from_ref(action)).map_err(|error| Refused {
            step: index + 1,
            action: action.to_string(),
            why: error.to_string(),
        })?;
        if let Some(last) = walked.last() {
            now = last.after.clone();
        }
        transitions.extend(walked);
    }
    let steps = planner.steps(&transitions, &known)?;
    Replayer::new(assembly, kit, domains, state)?.run(&steps)?;
    Ok(steps)
}

impl Pddl {
    /// The actions of a plan in the usual form, one `(action object …)` a line, in the terms of the rules.
    pub(crate) fn read_plan(&self, domain: &Domain, text: &str) -> Result<Vec<Term>, PlanError> {
        let names: BTreeMap<&str, &str> =
            self.objects.iter().map(|(name, pddl)| (pddl.as_str(), name.as_str())).collect();
        let mut actions = Vec::new();
        for (number, line) in text.lines().enumerate() {
            let line = line.split(';').next().unwrap_or_default().trim().to_lowercase();
            if line.is_empty() {
                continue;
            }
            let bad = |why: String| PlanError::PlanText { line: number + 1, found: line.clone(), why };
            // Some planners put the time before and the duration after.
            let inside = line.split_once('(').and_then(|(_, rest)| Some(rest.split_once(')')?.0));
            let inside = inside.ok_or_else(|| bad("expected `(action object …)`".to_string()))?;
            let mut words = inside.split_whitespace();
            let name = words.next().unwrap_or_default();
            let sorts = domain
                .predicates
                .get(name)
                .filter(|predicate| matches!(predicate.kind, Kind::Action { .. }))
                .map(|predicate| &predicate.sorts)
                .ok_or_else(|| bad(format!("the coarse domain has no action `{name}`")))?;
            let mut arguments = Vec::new();
            for (sort, word) in sorts.iter().zip(words.by_ref()) {
                let term =
                    term_of(domain, sort, word, &names, &|sort, object| self.is_of(domain, sort, object));
                arguments.push(term.ok_or_else(|| bad(format!("`{word}` is no {sort}")))?);
            }
            if arguments.len() != sorts.len() || words.next().is_some() {
                return Err(bad(format!("`{name}` has {} arguments", sorts.len())));
            }
            actions.push(Term::Function(name.to_string(), arguments));
        }
        Ok(actions)
    }

    /// Is an object declared with a type in the problem?
    fn is_of(&self, _domain: &Domain, sort: &str, object: &str) -> bool {
        let suffix = format!(" - {sort}");
        self.problem
            .lines()
            .filter_map(|line| line.strip_suffix(&suffix))
            .any(|names| names.split_whitespace().any(|name| name == object))
    }
}

/// An object in the terms of the rules, where an action wants something of a sort.
fn term_of(
    domain: &Domain,
    sort: &str,
    word: &str,
    names: &BTreeMap<&str, &str>,
    is_of: &dyn Fn(&str, &str) -> bool,
) -> Option<Term> {
    domain.sorts.get(sort)?.leaves.iter().find_map(|leaf| match leaf {
        Leaf::Number => None,
        Leaf::Constant(constant) => (constant == word).then(|| Term::new(constant, [])),
        Leaf::Open(open) if is_of(open, word) => names.get(word).map(|name| Term::from(*name)),
        Leaf::Open(_) => None,
        Leaf::Function(function) => {
            let [inner] = &domain.functions.get(function)?[..] else { return None };
            Some(Term::new(function, [term_of(domain, inner, word, names, is_of)?]))
        }
    })
}

/// A name that PDDL can bear: it knows no upper case.
fn plain(name: &str) -> String {
    let mut text = String::new();
    for c in name.chars() {
        match c {
            '+' => text.push_str("plus_"),
            '-' if text.is_empty() => text.push_str("minus_"),
            c if c.is_ascii_alphanumeric() => text.push(c.to_ascii_lowercase()),
            _ => text.push('_'),
        }
    }
    if !text.starts_with(|c: char| c.is_ascii_alphabetic()) {
        text.insert(0, 'o');
    }
    text
}

fn variable(name: &str) -> String {
    match name.strip_prefix('_') {
        Some(number) => format!("?any{number}"),
        None => format!("?{}", name.to_lowercase()),
    }
}

fn all_of(mut parts: Vec<String>) -> String {
    match parts.len() {
        1 => parts.remove(0),
        _ => format!("(and {})", parts.join(" ")),
    }
}

/// `(exists (variables) body)`, or the body where there are none.
fn quantified(word: &str, variables: &[String], body: String) -> String {
    if variables.is_empty() { body } else { format!("({word} ({}) {body})", variables.join(" ")) }
}

struct Writer<'d> {
    domain: &'d Domain,
    objects: BTreeMap<String, String>,
    /// Objects that the laws name.
    quoted: BTreeSet<String>,
}

/// An effect with its condition: `(forall (variables) (when (and conditions) literal))`.
struct Effect {
    variables: Vec<String>,
    conditions: Vec<String>,
    literal: String,
}

impl Writer<'_> {
    /// PDDL's name of an object; no two have the same.
    fn object(&mut self, name: &str) -> String {
        if let Some(known) = self.objects.get(name) {
            return known.clone();
        }
        let taken = |text: &String, all: &BTreeMap<String, String>| {
            all.values().any(|other| other == text)
                || self.domain.sorts.values().any(|sort| sort.leaves.contains(&Leaf::Constant(text.clone())))
        };
        let base = plain(name);
        let numbered = (2..).map(|number| format!("{base}_{number}"));
        let text = std::iter::once(base.clone()).chain(numbered).find(|text| !taken(text, &self.objects));
        let text = text.unwrap_or(base);
        self.objects.insert(name.to_string(), text.clone());
        text
    }

    fn cannot(&self, law: &CheckedLaw, why: &str) -> PlanError {
        let file = self.domain.file();
        PlanError::Pddl {
            file: file.name().to_string(),
            line: file.place(law.span.clone()).line_column().0,
            why: why.to_string(),
        }
    }

    /// A sort and those that are parts of it by a function: `beam connection - item`.
    fn types(&self) -> String {
        let mut parents: BTreeMap<&str, &str> = BTreeMap::new();
        for (name, sort) in &self.domain.sorts {
            for leaf in &sort.leaves {
                if let Leaf::Function(function) = leaf
                    && let Some([inner]) = self.domain.functions.get(function).map(Vec::as_slice)
                {
                    parents.insert(inner, name);
                }
            }
        }
        let mut text = "(:types".to_string();
        for name in self.domain.sorts.keys().filter(|name| *name != NUMBER) {
            let parent = parents.get(name.as_str()).copied().unwrap_or("object");
            let _ = write!(text, " {name} - {parent}");
        }
        text + ")\n"
    }

    fn constants(&self, objects: &BTreeMap<&str, Vec<String>>) -> String {
        let mut text = "(:constants".to_string();
        for (name, sort) in &self.domain.sorts {
            for leaf in &sort.leaves {
                if let Leaf::Constant(constant) = leaf {
                    let _ = write!(text, " {constant} - {name}");
                }
            }
        }
        for (sort, names) in objects {
            for name in names.iter().filter(|name| self.quoted.contains(*name)) {
                let _ = write!(text, " {name} - {sort}");
            }
        }
        text + ")\n"
    }

    fn predicates(&self) -> String {
        let mut text = "(:predicates\n".to_string();
        for (name, predicate) in &self.domain.predicates {
            if !matches!(predicate.kind, Kind::Action { .. }) {
                let _ = writeln!(text, "  ({name}{})", parameters(&predicate.sorts));
            }
        }
        text + ")\n"
    }

    fn derived(&mut self) -> Result<String, PlanError> {
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

    fn action(&mut self, name: &str, sorts: &[String]) -> Result<String, PlanError> {
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

    /// An effect and what follows from it by the state constraints.
    fn effects(
        &mut self,
        law: &CheckedLaw,
        head: &Literal,
        variables: Vec<String>,
        conditions: Vec<String>,
        depth: usize,
        effects: &mut Vec<Effect>,
    ) -> Result<(), PlanError> {
        let terms = self.expressions(law, &head.atom.arguments)?;
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
    ) -> Result<(), PlanError> {
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
                return Err(self.cannot(law, "a state constraint with just one fluent in its body is wanted"));
            };
            if trigger.atom.name.text != name || trigger.positive != positive {
                continue;
            }
            // Its variables are its own.
            let mark = format!("_{depth}");
            let (more, mut parts) = self.matched_to(law, &trigger.atom, terms, &mark)?;
            parts.extend(self.conditions_but(law, trigger, &mark)?);
            let inner: Vec<String> =
                self.expressions(law, &head.atom.arguments)?.iter().map(|term| marked(term, &mark)).collect();
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

    /// The variables of a law, typed, and the equations that make its atom that of the parameters `?x1`, …
    fn matched(
        &mut self,
        law: &CheckedLaw,
        atom: &Atom,
        parameter: &str,
    ) -> Result<(Vec<String>, Vec<String>), PlanError> {
        let terms: Vec<String> = (1..=atom.arguments.len()).map(|n| format!("{parameter}{n}")).collect();
        self.matched_to(law, atom, &terms, "")
    }

    fn matched_to(
        &mut self,
        law: &CheckedLaw,
        atom: &Atom,
        terms: &[String],
        mark: &str,
    ) -> Result<(Vec<String>, Vec<String>), PlanError> {
        let mut variables = Vec::new();
        for (name, sort) in &law.variables {
            if sort == NUMBER {
                return Err(self.cannot(law, "PDDL has no numbers for `--pddl`"));
            }
            variables.push(format!("{} - {sort}", marked(&variable(name), mark)));
        }
        let inner = self.expressions(law, &atom.arguments)?;
        let equal = terms.iter().zip(&inner).map(|(term, own)| format!("(= {term} {})", marked(own, mark)));
        Ok((variables, equal.collect()))
    }

    fn conditions(&mut self, law: &CheckedLaw) -> Result<Vec<String>, PlanError> {
        law.body.iter().map(|condition| self.condition(law, condition)).collect()
    }

    fn conditions_but(
        &mut self,
        law: &CheckedLaw,
        left_out: &Literal,
        mark: &str,
    ) -> Result<Vec<String>, PlanError> {
        let is_it = |condition: &&Condition| !matches!(condition, Condition::Literal(literal) if std::ptr::eq(literal, left_out));
        let conditions = law.body.iter().filter(is_it);
        conditions.map(|condition| Ok(marked(&self.condition(law, condition)?, mark))).collect()
    }

    fn condition(&mut self, law: &CheckedLaw, condition: &Condition) -> Result<String, PlanError> {
        match condition {
            Condition::Literal(Literal { positive, atom }) => {
                let terms = self.expressions(law, &atom.arguments)?;
                let text = spaced(&atom.name.text, &terms);
                Ok(if *positive { text } else { format!("(not {text})") })
            }
            Condition::Comparison(Comparison { left, operator, right }) => {
                let sides = format!("(= {} {})", self.expression(law, left)?, self.expression(law, right)?);
                match operator {
                    Operator::Equal => Ok(sides),
                    Operator::NotEqual => Ok(format!("(not {sides})")),
                    _ => Err(self.cannot(law, "PDDL can only say that objects are equal or not")),
                }
            }
        }
    }

    fn expressions(&mut self, law: &CheckedLaw, terms: &[Expression]) -> Result<Vec<String>, PlanError> {
        terms.iter().map(|term| self.expression(law, term)).collect()
    }

    fn expression(&mut self, law: &CheckedLaw, term: &Expression) -> Result<String, PlanError> {
        match &term.what {
            Shape::Variable(name) => Ok(variable(name)),
            Shape::Quoted(name) => {
                let object = self.object(name);
                self.quoted.insert(object.clone());
                Ok(object)
            }
            Shape::Function(name, arguments) => match &arguments[..] {
                [] => Ok(name.clone()),
                [inner] => self.expression(law, inner),
                _ => Err(self.cannot(law, "PDDL has no terms with several arguments")),
            },
            Shape::Number(_) | Shape::Sum(..) => Err(self.cannot(law, "PDDL has no numbers for `--pddl`")),
        }
    }

    /// A ground atom of the rules.
    fn ground(&mut self, term: &Term) -> String {
        let Some((name, arguments)) = term.parts() else { return String::new() };
        let terms: Vec<String> = arguments.iter().map(|argument| self.argument(argument)).collect();
        spaced(name, &terms)
    }

    fn argument(&mut self, term: &Term) -> String {
        match term {
            Term::Text(name) => self.object(name),
            Term::Function(name, arguments) => match &arguments[..] {
                [inner] => self.argument(inner),
                _ => name.clone(),
            },
            other => other.to_string(),
        }
    }
}

/// `(name a b)`.
fn spaced(name: &str, terms: &[String]) -> String {
    let mut text = format!("({name}");
    for term in terms {
        text.push(' ');
        text.push_str(term);
    }
    text + ")"
}

/// The variables in a text with a mark behind their names, so that one law's do not meet another's.
fn marked(text: &str, mark: &str) -> String {
    if mark.is_empty() {
        return text.to_string();
    }
    let mut marked = String::new();
    let mut in_variable = false;
    for c in text.chars() {
        let belongs = c.is_ascii_alphanumeric() || c == '_';
        if in_variable && !belongs {
            marked.push_str(mark);
        }
        in_variable = c == '?' || in_variable && belongs;
        marked.push(c);
    }
    if in_variable {
        marked.push_str(mark);
    }
    marked
}

fn parameters(sorts: &[String]) -> String {
    sorts.iter().enumerate().map(|(index, sort)| format!(" ?x{} - {sort}", index + 1)).collect()
}
