//! The domain carried out: states, what an action changes, what forbids it. Written from the definition of the
//! language alone; clingo has no part in it.
//!
//! A [`Model`] is a domain with the objects and statics of a goal; everything in it is a number that stands for a
//! ground term, so that states are small and comparing them is cheap.

mod unroll;

pub(crate) use unroll::{Literal, Prospect, Unrolled};

use super::ast::{Atom, Condition, Expression, Law, Operator, Shape, Sign, Span};
use super::check::{Domain, FluentKind, Kind, Leaf, NUMBER};
use crate::term::Term;
use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};
use smallvec::SmallVec;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

type Value = u32;
type Row = SmallVec<[Value; 4]>;

/// A ground atom: a predicate by number, and its arguments.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Ground {
    predicate: usize,
    row: Row,
}

/// A state: which fluents are true.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct State {
    /// By predicate; shared with the states before and after as far as they are equal.
    rows: Vec<Rc<BTreeSet<Row>>>,
}

/// What a law is matched against: fluents that may be true and fluents that must be. For a state that is known, the
/// two are the same.
#[derive(Clone, Copy)]
pub(crate) struct View<'s> {
    pub may: &'s State,
    pub must: &'s State,
}

impl<'s> From<&'s State> for View<'s> {
    fn from(state: &'s State) -> View<'s> {
        View { may: state, must: state }
    }
}

/// Why there is no next state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Refusal {
    /// There is no such action.
    Unknown(String),
    /// A law forbids it.
    Impossible(Reason),
    /// The laws contradict each other about this fluent.
    Contradiction(String),
}

/// A law that forbids an action, and the conditions of it that were true.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Reason {
    /// As the domain has it.
    pub law: String,
    /// Its line in the file.
    pub line: usize,
    /// Its conditions, with what stood for the variables.
    pub conditions: Vec<String>,
    /// The objects in them.
    pub objects: Vec<String>,
}

pub(crate) struct Model<'d> {
    domain: &'d Domain,
    names: HashMap<&'d str, usize>,
    predicates: Vec<Predicate<'d>>,
    values: RefCell<Values>,
    /// The sorts by number, and for each, by value, whether that belongs to it.
    sort_numbers: HashMap<&'d str, usize>,
    sorts: Vec<Vec<bool>>,
    /// In a fixed order.
    elements: Vec<Vec<Value>>,
    statics: Vec<Relation>,
    causal: Vec<Rule<'d>>,
    impossible: Vec<Rule<'d>>,
    constraints: Vec<Rule<'d>>,
    /// Laws of defined fluents, by fluent, those that others need first.
    defined: Vec<(usize, Vec<Rule<'d>>)>,
    /// For each defined fluent: the inertial fluents that it depends on.
    depends: HashMap<usize, BTreeSet<usize>>,
    initially: Vec<Rule<'d>>,
    goals: Vec<Rule<'d>>,
    bridges: Vec<Rule<'d>>,
}

struct Predicate<'d> {
    name: &'d str,
    kind: Kind,
}

#[derive(Default)]
struct Values {
    numbers: HashMap<Term, Value>,
    terms: Vec<Term>,
    /// The arguments, where it is a function.
    parts: Vec<Option<(Rc<str>, Row)>>,
    /// Functions by their arguments.
    functions: HashMap<Rc<str>, HashMap<Row, Value>>,
}

impl Values {
    fn of(&mut self, term: &Term) -> Value {
        if let Some(&value) = self.numbers.get(term) {
            return value;
        }
        let parts = match term {
            Term::Function(name, arguments) if !arguments.is_empty() => {
                let row: Row = arguments.iter().map(|argument| self.of(argument)).collect();
                Some((Rc::<str>::from(name.as_str()), row))
            }
            _ => None,
        };
        let value = Value::try_from(self.terms.len()).unwrap_or(Value::MAX);
        self.numbers.insert(term.clone(), value);
        self.terms.push(term.clone());
        if let Some((name, row)) = &parts {
            self.functions.entry(name.clone()).or_default().insert(row.clone(), value);
        }
        self.parts.push(parts);
        value
    }
}

#[derive(Default)]
struct Relation {
    rows: HashSet<Row>,
    list: Vec<Row>,
    /// Rows by a position and what stands there.
    index: HashMap<(usize, Value), Vec<usize>>,
}

impl Relation {
    fn insert(&mut self, row: Row) -> bool {
        let new = self.rows.insert(row.clone());
        if new {
            for (position, &value) in row.iter().enumerate() {
                self.index.entry((position, value)).or_default().push(self.list.len());
            }
            self.list.push(row);
        }
        new
    }
}

/// A law, its variables numbered.
struct Rule<'d> {
    heads: Vec<Head<'d>>,
    /// The action of a causal law.
    action: Option<Head<'d>>,
    conditions: Vec<Test>,
    /// The sort of each variable; `None` for numbers.
    variables: Vec<Option<usize>>,
    /// Predicates in the conditions.
    reads: BTreeSet<usize>,
    span: Span,
}

struct Head<'d> {
    positive: bool,
    predicate: usize,
    /// The name, which for a bridge law is one of the coarse domain.
    name: &'d str,
    arguments: Vec<Pattern>,
}

enum Pattern {
    Variable(usize),
    Constant(Value),
    Function(String, Vec<Pattern>),
    Sum(Box<Pattern>, Sign, Box<Pattern>),
}

enum Test {
    Literal { positive: bool, predicate: usize, arguments: Vec<Pattern> },
    Comparison(Pattern, Operator, Pattern),
}

type Binding = SmallVec<[Option<Value>; 8]>;

impl<'d> Model<'d> {
    /// A domain with the objects and statics of a goal; facts about what the domain does not declare are left out.
    pub(crate) fn new(domain: &'d Domain, facts: &[Term]) -> Model<'d> {
        let predicates: Vec<Predicate> =
            domain.predicates.iter().map(|(name, p)| Predicate { name, kind: p.kind }).collect();
        let names = predicates.iter().enumerate().map(|(index, p)| (p.name, index)).collect();
        let mut model = Model {
            domain,
            names,
            statics: predicates.iter().map(|_| Relation::default()).collect(),
            predicates,
            values: RefCell::default(),
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

    fn value(&self, term: &Term) -> Value {
        self.values.borrow_mut().of(term)
    }

    /// Does a value belong to a sort?
    fn is_of(&self, value: Value, sort: usize) -> bool {
        self.sorts[sort].get(value as usize).copied().unwrap_or(false)
    }

    /// The ground term that a value stands for.
    fn term(&self, value: Value) -> Term {
        self.values.borrow().terms[value as usize].clone()
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

    // ---- Laws -------------------------------------------------------------------------------------------------

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

    fn empty(&self) -> State {
        State { rows: self.predicates.iter().map(|_| Rc::default()).collect() }
    }

    // ---- Solving a body ----------------------------------------------------------------------------------------

    /// Calls `with` for everything that the variables of a rule can stand for in a state, until it says `true`.
    fn solve<'s>(
        &self,
        rule: &Rule,
        state: impl Into<View<'s>>,
        with: &mut dyn FnMut(&Binding) -> bool,
    ) -> bool {
        let mut binding = SmallVec::from_elem(None, rule.variables.len());
        let open: SmallVec<[usize; 8]> = (0..rule.conditions.len()).collect();
        self.extend(rule, state.into(), &open, &mut binding, with)
    }

    /// The same where the action of the rule is given.
    fn solve_action<'s>(
        &self,
        rule: &Rule,
        state: impl Into<View<'s>>,
        action: &Ground,
        with: &mut dyn FnMut(&Binding) -> bool,
    ) -> bool {
        let open: SmallVec<[usize; 8]> = (0..rule.conditions.len()).collect();
        self.solve_some(rule, state.into(), action, &open, with)
    }

    fn solve_some(
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

    fn extend(
        &self,
        rule: &Rule,
        state: View,
        open: &[usize],
        binding: &mut Binding,
        with: &mut dyn FnMut(&Binding) -> bool,
    ) -> bool {
        // First what only has to be looked up, then the condition that leaves the fewest ways to go on.
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
            // Only variables are left that nothing narrows down.
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

    /// The rows that agree with one of the arguments that have a value; `None` when none has.
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

    fn has(&self, predicate: usize, row: &Row, state: &State) -> bool {
        match self.predicates[predicate].kind {
            Kind::Static => self.statics[predicate].rows.contains(row),
            _ => state.rows[predicate].contains(row),
        }
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

    /// What a term stands for; `None` where a variable has no value, or a sum is too large.
    fn evaluate(&self, pattern: &Pattern, binding: &Binding) -> Option<Value> {
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

    fn row(&self, patterns: &[Pattern], binding: &Binding) -> Option<Row> {
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

    // ---- States -----------------------------------------------------------------------------------------------

    /// The state in which some fluents are told to be true and others false; the rest is as the domain says.
    pub(crate) fn initial(&self, told: &[Term], told_not: &[Term]) -> Result<State, Refusal> {
        let mut state = self.empty();
        let mut fixed: HashMap<Ground, bool> = HashMap::default();
        for (terms, truth) in [(told, true), (told_not, false)] {
            for term in terms {
                if let Some(fluent) = self.ground(term) {
                    self.put(&mut state, &fluent, truth);
                    fixed.insert(fluent, truth);
                }
            }
        }
        self.settle(&mut state, &mut fixed, None)?;
        // The rule holds where nothing that is known says otherwise.
        let mut usual = Vec::new();
        for rule in &self.initially {
            self.solve(rule, &state, &mut |binding| {
                for head in &rule.heads {
                    usual.extend(self.head(head, binding).map(|fluent| (fluent, head.positive)));
                }
                false
            });
        }
        for (fluent, truth) in usual {
            let known = fixed.get(&fluent).copied();
            if known.is_none() {
                self.put(&mut state, &fluent, truth);
                fixed.insert(fluent, truth);
            }
        }
        self.settle(&mut state, &mut fixed, None)?;
        Ok(state)
    }

    /// The state in which exactly these inertial fluents are true.
    pub(crate) fn resumed(&self, told: &[Term]) -> Result<State, Refusal> {
        let mut state = self.empty();
        let mut fixed: HashMap<Ground, bool> = HashMap::default();
        for fluent in told.iter().filter_map(|term| self.ground(term)) {
            self.put(&mut state, &fluent, true);
            fixed.insert(fluent, true);
        }
        self.settle(&mut state, &mut fixed, None)?;
        Ok(state)
    }

    /// The state after an action.
    pub(crate) fn after(&self, state: &State, action: &Term) -> Result<State, Refusal> {
        let ground = self.action(action)?;
        if let Some(reason) = self.prevented(state, &ground) {
            return Err(Refusal::Impossible(reason));
        }
        self.effects(state, &ground)
    }

    /// The state after an action whose conditions are known to hold.
    fn effects(&self, state: &State, action: &Ground) -> Result<State, Refusal> {
        let mut fixed: HashMap<Ground, bool> = HashMap::default();
        let mut clash = None;
        for rule in &self.causal {
            self.solve_action(rule, state, action, &mut |binding| {
                for head in &rule.heads {
                    if let Some(fluent) = self.head(head, binding)
                        && fixed
                            .insert(fluent.clone(), head.positive)
                            .is_some_and(|other| other != head.positive)
                    {
                        clash = Some(fluent);
                    }
                }
                false
            });
        }
        if let Some(fluent) = clash {
            return Err(Refusal::Contradiction(self.text(&fluent)));
        }
        let mut next = state.clone();
        let mut changed = BTreeSet::new();
        for (fluent, truth) in &fixed {
            if self.put(&mut next, fluent, *truth) {
                changed.insert(fluent.predicate);
            }
        }
        self.settle(&mut next, &mut fixed, Some(changed))?;
        Ok(next)
    }

    /// Makes the defined fluents and the state constraints true. `changed`: inertial fluents that changed since
    /// they were; `None` when nothing is known of that.
    fn settle(
        &self,
        state: &mut State,
        fixed: &mut HashMap<Ground, bool>,
        mut changed: Option<BTreeSet<usize>>,
    ) -> Result<(), Refusal> {
        let mut disputed: Vec<&Rule> = Vec::new();
        loop {
            let mut dirty = changed.clone();
            for (predicate, rules) in &self.defined {
                let needs = &self.depends[predicate];
                if changed.as_ref().is_some_and(|changed| changed.is_disjoint(needs)) {
                    continue;
                }
                let before = state.rows[*predicate].clone();
                let recursive = rules.iter().any(|rule| rule.reads.contains(predicate));
                if recursive {
                    // What was true before is no reason for itself.
                    state.rows[*predicate] = Rc::default();
                }
                let mut rows = BTreeSet::new();
                loop {
                    let known = rows.len();
                    for rule in rules {
                        let mut found = Vec::new();
                        self.solve(rule, &*state, &mut |binding| {
                            found.extend(self.row(&rule.heads[0].arguments, binding));
                            false
                        });
                        rows.extend(found);
                    }
                    if !recursive || rows.len() == known {
                        break;
                    }
                    state.rows[*predicate] = Rc::new(rows.clone());
                }
                if *before == rows {
                    state.rows[*predicate] = before;
                } else {
                    state.rows[*predicate] = Rc::new(rows);
                    if let Some(dirty) = &mut dirty {
                        dirty.insert(*predicate);
                    }
                }
            }
            let mut again = BTreeSet::new();
            for rule in &self.constraints {
                if dirty.as_ref().is_some_and(|dirty| dirty.is_disjoint(&rule.reads)) {
                    continue;
                }
                let mut concluded = Vec::new();
                self.solve(rule, &*state, &mut |binding| {
                    // What held before on the same grounds is no news; it may be just what has to give way.
                    if self.is_news(rule, binding, fixed) {
                        concluded.extend(self.head(&rule.heads[0], binding));
                    }
                    false
                });
                let truth = rule.heads[0].positive;
                for fluent in concluded {
                    if fixed.get(&fluent).is_some_and(|known| *known != truth) {
                        disputed.push(rule);
                        continue;
                    }
                    if self.put(state, &fluent, truth) {
                        again.insert(fluent.predicate);
                    }
                    fixed.insert(fluent, truth);
                }
            }
            if again.is_empty() {
                // A law that had no say while things changed has one in the end.
                for rule in disputed {
                    let mut violated = None;
                    self.solve(rule, &*state, &mut |binding| {
                        let head = &rule.heads[0];
                        let fluent = self.head(head, binding);
                        violated = fluent.filter(|f| self.has(f.predicate, &f.row, state) != head.positive);
                        violated.is_some()
                    });
                    if let Some(fluent) = violated {
                        return Err(Refusal::Contradiction(self.text(&fluent)));
                    }
                }
                return Ok(());
            }
            changed = Some(again);
        }
    }

    /// Rests a conclusion on something that this transition changed, or on defined fluents?
    fn is_news(&self, rule: &Rule, binding: &Binding, fixed: &HashMap<Ground, bool>) -> bool {
        let mut inertial = false;
        for test in &rule.conditions {
            let Test::Literal { predicate, arguments, .. } = test else { continue };
            match self.predicates[*predicate].kind {
                Kind::Fluent(FluentKind::Inertial) => inertial = true,
                Kind::Fluent(FluentKind::Defined) => return true,
                _ => continue,
            }
            let fluent = self.row(arguments, binding).map(|row| Ground { predicate: *predicate, row });
            if fluent.is_some_and(|fluent| fixed.contains_key(&fluent)) {
                return true;
            }
        }
        !inertial
    }

    fn put(&self, state: &mut State, fluent: &Ground, truth: bool) -> bool {
        let rows = &mut state.rows[fluent.predicate];
        if rows.contains(&fluent.row) == truth {
            return false;
        }
        let rows = Rc::make_mut(rows);
        if truth { rows.insert(fluent.row.clone()) } else { rows.remove(&fluent.row) }
    }

    fn head(&self, head: &Head, binding: &Binding) -> Option<Ground> {
        Some(Ground { predicate: head.predicate, row: self.row(&head.arguments, binding)? })
    }

    /// A term as a ground atom of the domain; `None` when it names nothing of it.
    fn ground(&self, term: &Term) -> Option<Ground> {
        let (name, arguments) = term.parts()?;
        let predicate = *self.names.get(name)?;
        let sorts = &self.domain.predicates.get(name)?.sorts;
        if sorts.len() != arguments.len() {
            return None;
        }
        let row: Row = arguments.iter().map(|argument| self.value(argument)).collect();
        let belongs = |(value, sort): (&Value, &String)| {
            sort == NUMBER
                || self.sort_numbers.get(sort.as_str()).is_some_and(|&sort| self.is_of(*value, sort))
        };
        row.iter().zip(sorts).all(belongs).then_some(Ground { predicate, row })
    }

    fn action(&self, term: &Term) -> Result<Ground, Refusal> {
        let ground = self
            .ground(term)
            .filter(|action| matches!(self.predicates[action.predicate].kind, Kind::Action { .. }));
        ground.ok_or_else(|| Refusal::Unknown(term.to_string()))
    }

    fn atom_term(&self, fluent: &Ground) -> Term {
        let arguments = fluent.row.iter().map(|&value| self.term(value)).collect();
        Term::Function(self.predicates[fluent.predicate].name.to_string(), arguments)
    }

    fn text(&self, fluent: &Ground) -> String {
        self.atom_term(fluent).to_string()
    }

    /// The fluent that a term names, with names in it quoted or not; `None` when there is none.
    pub(crate) fn fluent(&self, term: &Term) -> Option<Term> {
        let known = |term: &Term| {
            let ground = self.ground(term)?;
            matches!(self.predicates[ground.predicate].kind, Kind::Fluent(_)).then(|| term.clone())
        };
        known(term).or_else(|| known(&term.quoted()))
    }

    /// Is a fluent true, or a static?
    pub(crate) fn holds(&self, state: &State, fluent: &Term) -> bool {
        self.ground(fluent).is_some_and(|fluent| self.has(fluent.predicate, &fluent.row, state))
    }

    /// The inertial fluents that are true and name nothing but these; without names, all.
    pub(crate) fn inertial_about(&self, state: &State, names: Option<&BTreeSet<String>>) -> Vec<Term> {
        let Some(names) = names else { return self.inertial(state) };
        let mut inside: HashMap<Value, bool> = HashMap::default();
        let mut about = |value: Value| {
            *inside.entry(value).or_insert_with(|| {
                let values = self.values.borrow();
                values.terms[value as usize].texts().into_iter().all(|text| names.contains(text))
            })
        };
        let mut terms = Vec::new();
        for (predicate, rows) in state.rows.iter().enumerate() {
            if self.predicates[predicate].kind == Kind::Fluent(FluentKind::Inertial) {
                let rows = rows.iter().filter(|row| row.iter().all(|&value| about(value)));
                terms.extend(rows.map(|row| self.atom_term(&Ground { predicate, row: row.clone() })));
            }
        }
        terms
    }

    /// The fluents of one name that are true.
    pub(crate) fn true_of(&self, state: &State, name: &str) -> Vec<Term> {
        let Some(&predicate) = self.names.get(name) else { return Vec::new() };
        let rows = state.rows[predicate].iter();
        rows.map(|row| self.atom_term(&Ground { predicate, row: row.clone() })).collect()
    }

    /// The inertial fluents that are true after a step and were not before.
    pub(crate) fn gained(&self, before: &State, after: &State) -> Vec<Term> {
        let mut terms = Vec::new();
        for (predicate, (old, new)) in before.rows.iter().zip(&after.rows).enumerate() {
            let inertial = self.predicates[predicate].kind == Kind::Fluent(FluentKind::Inertial);
            if inertial && !Rc::ptr_eq(old, new) {
                let rows = new.difference(old);
                terms.extend(rows.map(|row| self.atom_term(&Ground { predicate, row: row.clone() })));
            }
        }
        terms
    }

    /// The inertial fluents that are true.
    pub(crate) fn inertial(&self, state: &State) -> Vec<Term> {
        self.of_kind(state, FluentKind::Inertial)
    }

    fn of_kind(&self, state: &State, kind: FluentKind) -> Vec<Term> {
        let mut terms = Vec::new();
        for (predicate, rows) in state.rows.iter().enumerate() {
            if self.predicates[predicate].kind == Kind::Fluent(kind) {
                terms.extend(rows.iter().map(|row| self.atom_term(&Ground { predicate, row: row.clone() })));
            }
        }
        terms
    }

    /// The goals of the domain that a state does not fulfil: fluents that should be true or false.
    pub(crate) fn missing(&self, state: &State) -> Vec<(Term, bool)> {
        let mut missing = Vec::new();
        for rule in &self.goals {
            self.solve(rule, state, &mut |binding| {
                for head in &rule.heads {
                    if let Some(fluent) = self.head(head, binding)
                        && self.has(fluent.predicate, &fluent.row, state) != head.positive
                    {
                        missing.push((self.atom_term(&fluent), head.positive));
                    }
                }
                false
            });
        }
        missing
    }

    /// The statics, those that laws conclude included.
    pub(crate) fn static_facts(&self) -> Vec<Term> {
        let of = |(predicate, relation): (usize, &Relation)| {
            let mut terms: Vec<Term> = relation
                .list
                .iter()
                .map(|row| self.atom_term(&Ground { predicate, row: row.clone() }))
                .collect();
            terms.sort();
            terms
        };
        self.statics.iter().enumerate().flat_map(of).collect()
    }

    /// All goals of the domain that do not depend on the state: fluents that should be true or false.
    pub(crate) fn goals(&self) -> Vec<(Term, bool)> {
        let mut goals = Vec::new();
        let nothing = self.empty();
        for rule in &self.goals {
            self.solve(rule, &nothing, &mut |binding| {
                let heads = rule.heads.iter();
                goals
                    .extend(heads.filter_map(|head| {
                        Some((self.atom_term(&self.head(head, binding)?), head.positive))
                    }));
                false
            });
        }
        goals
    }

    /// The coarse fluents that are true in a fine state: those of the same name, and those of the bridge laws.
    pub(crate) fn bridged(&self, state: &State) -> BTreeSet<Term> {
        let mut terms: BTreeSet<Term> = self.inertial(state).into_iter().collect();
        for rule in &self.bridges {
            self.solve(rule, state, &mut |binding| {
                for head in &rule.heads {
                    if let Some(row) = self.row(&head.arguments, binding) {
                        let arguments = row.iter().map(|&value| self.term(value)).collect();
                        terms.insert(Term::Function(head.name.to_string(), arguments));
                    }
                }
                false
            });
        }
        terms
    }

    /// All that forbids an action in a state: every law, with everything its variables can stand for.
    pub(crate) fn why_not(&self, state: &State, action: &Term) -> Result<Vec<Reason>, Refusal> {
        let action = self.action(action)?;
        let mut reasons: Vec<Reason> = Vec::new();
        for rule in &self.impossible {
            self.solve_action(rule, state, &action, &mut |binding| {
                let reason = self.reason(rule, binding);
                if !reasons.contains(&reason) {
                    reasons.push(reason);
                }
                false
            });
        }
        Ok(reasons)
    }

    fn prevented(&self, state: &State, action: &Ground) -> Option<Reason> {
        self.impossible.iter().find_map(|rule| {
            let mut reason = None;
            self.solve_action(rule, state, action, &mut |binding| {
                reason = Some(self.reason(rule, binding));
                true
            });
            reason
        })
    }

    fn reason(&self, rule: &Rule, binding: &Binding) -> Reason {
        let mut objects = BTreeSet::new();
        let mut conditions = Vec::new();
        for test in &rule.conditions {
            let text = match test {
                Test::Literal { positive, predicate, arguments } => {
                    let Some(row) = self.row(arguments, binding) else { continue };
                    let term = self.atom_term(&Ground { predicate: *predicate, row });
                    objects.extend(term.texts().into_iter().map(str::to_string));
                    format!("{}{term}", if *positive { "" } else { "-" })
                }
                Test::Comparison(left, operator, right) => {
                    let side = |term| self.evaluate(term, binding).map(|value| self.term(value).to_string());
                    let (Some(left), Some(right)) = (side(left), side(right)) else { continue };
                    format!("{left} {} {right}", operator.text())
                }
            };
            conditions.push(text);
        }
        let file = self.domain.file();
        let law = file.text().get(rule.span.clone()).unwrap_or_default();
        Reason {
            law: law.split_whitespace().collect::<Vec<_>>().join(" "),
            line: file.place(rule.span.clone()).line_column().0,
            conditions,
            objects: objects.into_iter().collect(),
        }
    }

    /// The objects that matter for a transition: those that the action names, those of fluents that changed, and
    /// those of the conditions of the action that are literally true before it.
    pub(crate) fn relevant(&self, before: &State, action: &Term, after: &State) -> BTreeSet<String> {
        let mut terms = vec![action.clone()];
        for (predicate, (old, new)) in before.rows.iter().zip(&after.rows).enumerate() {
            let inertial = self.predicates[predicate].kind == Kind::Fluent(FluentKind::Inertial);
            if !inertial || Rc::ptr_eq(old, new) {
                continue;
            }
            let changed = old.symmetric_difference(new);
            terms.extend(changed.map(|row| self.atom_term(&Ground { predicate, row: row.clone() })));
        }
        if let Ok(ground) = self.action(action) {
            for rule in &self.impossible {
                let is_static = |index: &usize| match &rule.conditions[*index] {
                    Test::Literal { positive, predicate, .. } => {
                        *positive && self.predicates[*predicate].kind == Kind::Static
                    }
                    Test::Comparison(..) => false,
                };
                let statics: Vec<usize> = (0..rule.conditions.len()).filter(is_static).collect();
                for index in 0..rule.conditions.len() {
                    let Test::Literal { predicate, .. } = &rule.conditions[index] else { continue };
                    if self.predicates[*predicate].kind == Kind::Static {
                        continue;
                    }
                    let open = [&statics[..], &[index]].concat();
                    self.solve_some(rule, before.into(), &ground, &open, &mut |binding| {
                        for condition in &open {
                            if let Test::Literal { predicate, arguments, .. } = &rule.conditions[*condition]
                                && let Some(row) = self.row(arguments, binding)
                            {
                                terms.push(self.atom_term(&Ground { predicate: *predicate, row }));
                            }
                        }
                        false
                    });
                }
            }
        }
        terms.iter().flat_map(Term::texts).map(str::to_string).collect()
    }
}

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

/// Rules by what they define, those that others read first.
fn in_order(mut rules: BTreeMap<usize, Vec<Rule<'_>>>) -> Vec<(usize, Vec<Rule<'_>>)> {
    let mut order = Vec::new();
    while !rules.is_empty() {
        let ready = rules.iter().find(|(own, rules_of)| {
            let mut reads = rules_of.iter().flat_map(|rule| &rule.reads);
            reads.all(|read| read == *own || !rules.contains_key(read))
        });
        // In a circle without negation, any first one will do.
        let next = ready.or_else(|| rules.iter().next()).map(|(&own, _)| own);
        let Some(next) = next else { break };
        if let Some(of) = rules.remove(&next) {
            order.push((next, of));
        }
    }
    order
}

fn is_bound(pattern: &Pattern, binding: &Binding) -> bool {
    match pattern {
        Pattern::Variable(variable) => binding[*variable].is_some(),
        Pattern::Constant(_) => true,
        Pattern::Function(_, arguments) => arguments.iter().all(|argument| is_bound(argument, binding)),
        Pattern::Sum(left, _, right) => is_bound(left, binding) && is_bound(right, binding),
    }
}

/// The first variable without a value.
fn unbound(patterns: &[Pattern], binding: &Binding) -> Option<usize> {
    patterns.iter().find_map(|pattern| match pattern {
        Pattern::Variable(variable) => binding[*variable].is_none().then_some(*variable),
        Pattern::Constant(_) => None,
        Pattern::Function(_, arguments) => unbound(arguments, binding),
        Pattern::Sum(left, _, right) => unbound(std::slice::from_ref(left), binding)
            .or_else(|| unbound(std::slice::from_ref(right), binding)),
    })
}
