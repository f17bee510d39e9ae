//! Matches laws against states: enumerates the bindings of a law's variables.
//!
//! The search takes next the condition with the fewest choices, and looks statics up by an argument
//! that is already bound.

use super::model::Model;
use super::rule::{Binding, Head, Pattern, Rule, Test, is_bound, unbound};
use super::state::{Ground, State, View};
use super::values::{Relation, Row, Value};
use crate::ast::{Operator, Sign};
use crate::domain::Kind;
use crate::term::Term;
use smallvec::SmallVec;

impl Model<'_> {
    /// Calls `with` for every binding of a rule's variables in a state, until it returns `true`.
    pub(crate) fn solve<'s>(
        &self,
        rule: &Rule,
        state: impl Into<View<'s>>,
        with: &mut dyn FnMut(&Binding) -> bool,
    ) -> bool {
        let mut binding = SmallVec::from_elem(None, rule.variables.len());
        let open: SmallVec<[usize; 8]> = (0..rule.conditions.len()).collect();
        self.extend(rule, state.into(), &open, &mut binding, with)
    }

    /// The same for a given action.
    pub(crate) fn solve_action<'s>(
        &self,
        rule: &Rule,
        state: impl Into<View<'s>>,
        action: &Ground,
        with: &mut dyn FnMut(&Binding) -> bool,
    ) -> bool {
        let open: SmallVec<[usize; 8]> = (0..rule.conditions.len()).collect();
        self.solve_some(rule, state.into(), action, &open, with)
    }

    /// The same for some of the conditions, by index.
    pub(crate) fn solve_some(
        &self,
        rule: &Rule,
        state: View,
        action: &Ground,
        open: &[usize],
        with: &mut dyn FnMut(&Binding) -> bool,
    ) -> bool {
        let mut binding = SmallVec::from_elem(None, rule.variables.len());
        match &rule.action {
            Some(head) if head.predicate == action.predicate => {
                let mut trail = Vec::new();
                self.match_row(rule, &head.arguments, &action.row, &mut binding, &mut trail)
                    && self.extend(rule, state, open, &mut binding, with)
            }
            _ => false,
        }
    }

    /// The same with one condition bound to a given row of a predicate.
    pub(crate) fn solve_with(
        &self,
        rule: &Rule,
        state: &State,
        predicate: usize,
        row: &Row,
        with: &mut dyn FnMut(&Binding) -> bool,
    ) -> bool {
        rule.conditions.iter().any(|test| match test {
            Test::Literal { predicate: own, arguments, .. } if *own == predicate => {
                self.solve_matched(rule, state, arguments, row, with)
            }
            _ => false,
        })
    }

    /// The same for a given conclusion.
    pub(crate) fn solve_head(
        &self,
        rule: &Rule,
        state: &State,
        row: &Row,
        with: &mut dyn FnMut(&Binding) -> bool,
    ) -> bool {
        self.solve_matched(rule, state, &rule.heads[0].arguments, row, with)
    }

    fn solve_matched(
        &self,
        rule: &Rule,
        state: &State,
        arguments: &[Pattern],
        row: &Row,
        with: &mut dyn FnMut(&Binding) -> bool,
    ) -> bool {
        let mut binding = SmallVec::from_elem(None, rule.variables.len());
        let open: SmallVec<[usize; 8]> = (0..rule.conditions.len()).collect();
        self.match_row(rule, arguments, row, &mut binding, &mut Vec::new())
            && self.extend(rule, state.into(), &open, &mut binding, with)
    }

    fn extend(
        &self,
        rule: &Rule,
        state: View,
        open: &[usize],
        binding: &mut Binding,
        with: &mut dyn FnMut(&Binding) -> bool,
    ) -> bool {
        // First pure look-ups, then the condition with the fewest choices.
        let mut best: Option<(usize, usize)> = None;
        for (place, &condition) in open.iter().enumerate() {
            let cost =
                match &rule.conditions[condition] {
                    Test::Comparison(left, _, right) => {
                        if is_bound(left, binding) && is_bound(right, binding) { 0 } else { usize::MAX }
                    }
                    Test::Literal { positive, predicate, arguments } => {
                        if arguments.iter().all(|term| is_bound(term, binding)) {
                            0
                        } else if !positive {
                            usize::MAX
                        } else {
                            1 + self.candidates(*predicate, arguments, state.may, binding)
                        }
                    }
                };
            if cost < best.map_or(usize::MAX, |(_, least)| least) {
                best = Some((place, cost));
            }
        }
        let Some((place, _)) = best else {
            // Only unconstrained variables are left.
            let free = match open.is_empty() {
                true => {
                    rule.heads.iter().chain(&rule.action).find_map(|head| unbound(&head.arguments, binding))
                }
                false => open.iter().find_map(|&condition| match &rule.conditions[condition] {
                    Test::Literal { arguments, .. } => unbound(arguments, binding),
                    Test::Comparison(left, _, right) => unbound(std::slice::from_ref(left), binding)
                        .or_else(|| unbound(std::slice::from_ref(right), binding)),
                }),
            };
            let Some(variable) = free else { return with(binding) };
            let elements = rule.variables[variable].map(|sort| self.elements[sort].as_slice());
            for &value in elements.unwrap_or_default() {
                binding[variable] = Some(value);
                if self.extend(rule, state, open, binding, with) {
                    return true;
                }
            }
            binding[variable] = None;
            return false;
        };
        let condition = open[place];
        let rest: SmallVec<[usize; 8]> = open.iter().copied().filter(|&other| other != condition).collect();
        match &rule.conditions[condition] {
            Test::Comparison(left, operator, right) => {
                self.compares(left, *operator, right, binding)
                    && self.extend(rule, state, &rest, binding, with)
            }
            Test::Literal { positive, predicate, arguments } => {
                if arguments.iter().all(|term| is_bound(term, binding)) {
                    let side = if *positive { state.may } else { state.must };
                    let there =
                        self.row(arguments, binding).is_some_and(|row| self.has(*predicate, &row, side));
                    return there == *positive && self.extend(rule, state, &rest, binding, with);
                }
                let mut each = |row: &Row, binding: &mut Binding| {
                    let mut trail = Vec::new();
                    let stop = self.match_row(rule, arguments, row, binding, &mut trail)
                        && self.extend(rule, state, &rest, binding, with);
                    for variable in trail {
                        binding[variable] = None;
                    }
                    stop
                };
                if self.predicates[*predicate].kind == Kind::Static {
                    let relation = &self.statics[*predicate];
                    match self.narrowest(relation, arguments, binding) {
                        Some(rows) => rows.iter().any(|&row| each(&relation.list[row], binding)),
                        None => relation.list.iter().any(|row| each(row, binding)),
                    }
                } else {
                    state.may.rows[*predicate].iter().any(|row| each(row, binding))
                }
            }
        }
    }

    fn candidates(&self, predicate: usize, arguments: &[Pattern], state: &State, binding: &Binding) -> usize {
        if self.predicates[predicate].kind != Kind::Static {
            return state.rows[predicate].len();
        }
        let relation = &self.statics[predicate];
        self.narrowest(relation, arguments, binding).map_or(relation.list.len(), <[usize]>::len)
    }

    /// The shortest list of rows that agree with one of the bound arguments; `None` when none is
    /// bound.
    fn narrowest<'r>(
        &self,
        relation: &'r Relation,
        arguments: &[Pattern],
        binding: &Binding,
    ) -> Option<&'r [usize]> {
        let mut best: Option<&[usize]> = None;
        for (position, term) in arguments.iter().enumerate() {
            let value = match term {
                Pattern::Constant(value) => Some(*value),
                Pattern::Variable(variable) => binding[*variable],
                _ => None,
            };
            if let Some(value) = value {
                let rows = relation.index.get(&(position, value)).map_or(&[][..], Vec::as_slice);
                if best.is_none_or(|best| rows.len() < best.len()) {
                    best = Some(rows);
                }
            }
        }
        best
    }

    fn match_row(
        &self,
        rule: &Rule,
        patterns: &[Pattern],
        row: &[Value],
        binding: &mut Binding,
        trail: &mut Vec<usize>,
    ) -> bool {
        patterns.len() == row.len()
            && patterns
                .iter()
                .zip(row)
                .all(|(pattern, &value)| self.matches(rule, pattern, value, binding, trail))
    }

    fn matches(
        &self,
        rule: &Rule,
        pattern: &Pattern,
        value: Value,
        binding: &mut Binding,
        trail: &mut Vec<usize>,
    ) -> bool {
        match pattern {
            Pattern::Constant(constant) => *constant == value,
            Pattern::Variable(variable) => match binding[*variable] {
                Some(known) => known == value,
                None => {
                    let belongs = rule.variables[*variable].is_none_or(|sort| self.is_of(value, sort));
                    if belongs {
                        binding[*variable] = Some(value);
                        trail.push(*variable);
                    }
                    belongs
                }
            },
            Pattern::Function(name, arguments) => {
                let parts = self.values.borrow().parts[value as usize].clone();
                parts.is_some_and(|(function, row)| {
                    *function == **name && self.match_row(rule, arguments, &row, binding, trail)
                })
            }
            Pattern::Sum(..) => self.evaluate(pattern, binding) == Some(value),
        }
    }

    /// The value of a term; `None` for an unbound variable or an overflowing sum.
    pub(crate) fn evaluate(&self, pattern: &Pattern, binding: &Binding) -> Option<Value> {
        match pattern {
            Pattern::Constant(value) => Some(*value),
            Pattern::Variable(variable) => binding[*variable],
            Pattern::Function(name, arguments) => {
                let row = self.row(arguments, binding)?;
                let known =
                    self.values.borrow().functions.get(name.as_str()).and_then(|all| all.get(&row).copied());
                if known.is_some() {
                    return known;
                }
                let arguments = row.iter().map(|&value| self.term(value)).collect();
                Some(self.value(&Term::Function(name.clone(), arguments)))
            }
            Pattern::Sum(left, sign, right) => {
                let sides = [self.evaluate(left, binding)?, self.evaluate(right, binding)?];
                let [Term::Number(left), Term::Number(right)] = sides.map(|value| self.term(value)) else {
                    return None;
                };
                let sum = if *sign == Sign::Plus { left.checked_add(right) } else { left.checked_sub(right) };
                Some(self.value(&Term::Number(sum?)))
            }
        }
    }

    /// The values of some terms; `None` when a variable is unbound.
    pub(crate) fn row(&self, patterns: &[Pattern], binding: &Binding) -> Option<Row> {
        patterns.iter().map(|pattern| self.evaluate(pattern, binding)).collect()
    }

    fn compares(&self, left: &Pattern, operator: Operator, right: &Pattern, binding: &Binding) -> bool {
        match (self.evaluate(left, binding), self.evaluate(right, binding)) {
            (Some(left), Some(right)) => {
                let values = self.values.borrow();
                operator.holds(values.terms[left as usize].cmp(&values.terms[right as usize]))
            }
            _ => false,
        }
    }

    /// The conclusion of a law under a binding.
    pub(crate) fn head(&self, head: &Head, binding: &Binding) -> Option<Ground> {
        Some(Ground { predicate: head.predicate, row: self.row(&head.arguments, binding)? })
    }
}
