//! From a domain and the facts of a problem to a [`Model`]: objects, statics and laws, all as
//! numbers.

use super::model::{Model, Predicate};
use super::rule::{Head, Pattern, Rule, Test};
use super::values::{Relation, Value};
use crate::ast::{Atom, Condition, Expression, Law, Shape};
use crate::domain::{Domain, FluentKind, Kind, Leaf, NUMBER};
use crate::term::Term;
use rustc_hash::FxHashMap as HashMap;
use std::collections::{BTreeMap, BTreeSet};

impl<'d> Model<'d> {
    /// A domain with the objects and statics of a problem; facts about undeclared names are
    /// ignored.
    pub fn new(domain: &'d Domain, facts: &[Term]) -> Model<'d> {
        let predicates: Vec<Predicate> =
            domain.predicates.iter().map(|(name, p)| Predicate { name, kind: p.kind }).collect();
        let names = predicates.iter().enumerate().map(|(index, p)| (p.name, index)).collect();
        let mut model = Model {
            domain,
            names,
            statics: predicates.iter().map(|_| Relation::default()).collect(),
            predicates,
            values: std::cell::RefCell::default(),
            sort_numbers: HashMap::default(),
            sorts: Vec::new(),
            elements: Vec::new(),
            causal: Vec::new(),
            impossible: Vec::new(),
            constraints: Vec::new(),
            defined: Vec::new(),
            depends: HashMap::default(),
            initially: Vec::new(),
            goals: Vec::new(),
            bridges: Vec::new(),
        };
        model.find_elements(facts);
        for fact in facts {
            let Some((name, arguments)) = fact.parts() else { continue };
            let arity = domain.predicates.get(name).filter(|p| p.kind == Kind::Static).map(|p| p.sorts.len());
            if let (Some(&predicate), Some(true)) =
                (model.names.get(name), arity.map(|n| n == arguments.len()))
            {
                let row = arguments.iter().map(|term| model.value(term)).collect();
                model.statics[predicate].insert(row);
            }
        }
        model.compile();
        model
    }

    fn find_elements(&mut self, facts: &[Term]) {
        let mut objects: HashMap<&str, Vec<Value>> = HashMap::default();
        for fact in facts {
            if let Some((name, [object])) = fact.parts()
                && self.domain.sorts.contains_key(name)
            {
                let value = self.value(object);
                objects.entry(name).or_default().push(value);
            }
        }
        for name in self.domain.sorts.keys() {
            let elements = self.elements_of(name, &objects, 0);
            let most = elements.iter().max().map_or(0, |&value| value as usize + 1);
            let mut belongs = vec![false; most];
            for &value in &elements {
                belongs[value as usize] = true;
            }
            self.sort_numbers.insert(name, self.sorts.len());
            self.sorts.push(belongs);
            self.elements.push(elements);
        }
    }

    fn elements_of(&self, name: &str, objects: &HashMap<&str, Vec<Value>>, depth: usize) -> Vec<Value> {
        let mut elements = Vec::new();
        let Some(sort) = self.domain.sorts.get(name).filter(|_| depth < 8) else { return elements };
        for leaf in &sort.leaves {
            match leaf {
                Leaf::Number => {}
                Leaf::Open(open) => elements.extend(objects.get(open.as_str()).into_iter().flatten()),
                Leaf::Constant(constant) => elements.push(self.value(&Term::new(constant, []))),
                Leaf::Function(function) => {
                    let sorts = self.domain.functions.get(function).map(Vec::as_slice).unwrap_or_default();
                    let mut rows: Vec<Vec<Term>> = vec![Vec::new()];
                    for sort in sorts {
                        let inner = self.elements_of(sort, objects, depth + 1);
                        rows = rows
                            .iter()
                            .flat_map(|row| {
                                inner.iter().map(|&value| [row.clone(), vec![self.term(value)]].concat())
                            })
                            .collect();
                    }
                    elements.extend(
                        rows.into_iter().map(|row| self.value(&Term::Function(function.clone(), row))),
                    );
                }
            }
        }
        elements
    }

    fn compile(&mut self) {
        let domain = self.domain;
        let mut by_fluent: BTreeMap<usize, Vec<Rule<'d>>> = BTreeMap::new();
        let mut by_static: BTreeMap<usize, Vec<Rule<'d>>> = BTreeMap::new();
        for law in &domain.laws {
            let variables: Vec<&str> = law.variables.keys().map(String::as_str).collect();
            let number =
                |sort: &String| self.sort_numbers.get(sort.as_str()).filter(|_| sort != NUMBER).copied();
            let sorts = law.variables.values().map(number).collect();
            let compiler = Compiler { model: self, variables: &variables };
            let (action, heads) = match &law.law {
                Law::Causal { action, heads } => {
                    let heads = heads.iter().map(|head| compiler.head(&head.atom, head.positive)).collect();
                    (Some(compiler.head(action, true)), heads)
                }
                Law::Impossible { action } => (Some(compiler.head(action, true)), Vec::new()),
                Law::Holds { head } | Law::Initially { head } | Law::Goal { head } => {
                    (None, vec![compiler.head(&head.atom, head.positive)])
                }
                Law::Bridge { head } => (None, vec![compiler.head(head, true)]),
            };
            let conditions: Vec<Test> = law.body.iter().map(|condition| compiler.test(condition)).collect();
            let reads = conditions.iter().filter_map(|test| match test {
                Test::Literal { predicate, .. } => Some(*predicate),
                Test::Comparison(..) => None,
            });
            let reads = reads.collect();
            let rule = Rule { heads, action, conditions, variables: sorts, reads, span: law.span.clone() };
            match &law.law {
                Law::Causal { .. } => self.causal.push(rule),
                Law::Impossible { .. } => self.impossible.push(rule),
                Law::Initially { .. } => self.initially.push(rule),
                Law::Goal { .. } => self.goals.push(rule),
                Law::Bridge { .. } => self.bridges.push(rule),
                Law::Holds { .. } => {
                    let predicate = rule.heads[0].predicate;
                    match self.predicates[predicate].kind {
                        Kind::Static => by_static.entry(predicate).or_default().push(rule),
                        Kind::Fluent(FluentKind::Defined) => {
                            by_fluent.entry(predicate).or_default().push(rule)
                        }
                        _ => self.constraints.push(rule),
                    }
                }
            }
        }
        let nothing = self.empty();
        for (_, rules) in in_order(by_static) {
            loop {
                let mut new = false;
                for rule in &rules {
                    let mut rows = Vec::new();
                    self.solve(rule, &nothing, &mut |binding| {
                        rows.extend(self.row(&rule.heads[0].arguments, binding));
                        false
                    });
                    for row in rows {
                        new |= self.statics[rule.heads[0].predicate].insert(row);
                    }
                }
                if !new {
                    break;
                }
            }
        }
        self.defined = in_order(by_fluent);
        for (predicate, rules) in &self.defined {
            let mut needs = BTreeSet::new();
            for read in rules.iter().flat_map(|rule| &rule.reads) {
                match self.predicates[*read].kind {
                    Kind::Fluent(FluentKind::Inertial) => {
                        needs.insert(*read);
                    }
                    Kind::Fluent(FluentKind::Defined) => {
                        needs.extend(self.depends.get(read).into_iter().flatten());
                    }
                    _ => {}
                }
            }
            self.depends.insert(*predicate, needs);
        }
    }
}

/// Numbers the names and variables of one law.
struct Compiler<'m, 'd> {
    model: &'m Model<'d>,
    variables: &'m [&'d str],
}

impl<'d> Compiler<'_, 'd> {
    fn pattern(&self, term: &Expression) -> Pattern {
        match &term.what {
            Shape::Variable(name) => Pattern::Variable(
                self.variables.iter().position(|variable| variable == name).unwrap_or_default(),
            ),
            Shape::Number(number) => Pattern::Constant(self.model.value(&Term::Number(*number))),
            Shape::Quoted(name) => Pattern::Constant(self.model.value(&Term::Text(name.clone()))),
            Shape::Function(name, arguments) if arguments.is_empty() => {
                Pattern::Constant(self.model.value(&Term::new(name, [])))
            }
            Shape::Function(name, arguments) => Pattern::Function(name.clone(), self.patterns(arguments)),
            Shape::Sum(left, sign, right) => {
                Pattern::Sum(Box::new(self.pattern(left)), *sign, Box::new(self.pattern(right)))
            }
        }
    }

    fn patterns(&self, terms: &[Expression]) -> Vec<Pattern> {
        terms.iter().map(|term| self.pattern(term)).collect()
    }

    fn head(&self, atom: &'d Atom, positive: bool) -> Head<'d> {
        let name = atom.name.text.as_str();
        let predicate = self.model.names.get(name).copied().unwrap_or(usize::MAX);
        Head { positive, predicate, name, arguments: self.patterns(&atom.arguments) }
    }

    fn test(&self, condition: &Condition) -> Test {
        match condition {
            Condition::Literal(literal) => Test::Literal {
                positive: literal.positive,
                predicate: self
                    .model
                    .names
                    .get(literal.atom.name.text.as_str())
                    .copied()
                    .unwrap_or(usize::MAX),
                arguments: self.patterns(&literal.atom.arguments),
            },
            Condition::Comparison(comparison) => Test::Comparison(
                self.pattern(&comparison.left),
                comparison.operator,
                self.pattern(&comparison.right),
            ),
        }
    }
}

/// Rules by their defined predicate, in order of dependency.
fn in_order(mut rules: BTreeMap<usize, Vec<Rule<'_>>>) -> Vec<(usize, Vec<Rule<'_>>)> {
    let mut order = Vec::new();
    while !rules.is_empty() {
        let ready = rules.iter().find(|(own, rules_of)| {
            let mut reads = rules_of.iter().flat_map(|rule| &rule.reads);
            reads.all(|read| read == *own || !rules.contains_key(read))
        });
        // In a cycle without negation any order is correct.
        let next = ready.or_else(|| rules.iter().next()).map(|(&own, _)| own);
        let Some(next) = next else { break };
        if let Some(of) = rules.remove(&next) {
            order.push((next, of));
        }
    }
    order
}
