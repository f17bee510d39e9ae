//! The domain unrolled over time: a ground program for clingo, one step after another.
//!
//! What clingo's own grounder would write of a domain's translation, but less of it: the state at the beginning is
//! known, so at every time the fluents fall into those that must be true, those that cannot be, and those that a
//! plan can decide. Only the last become atoms, only actions that nothing certain forbids become choices, and what no
//! step can touch keeps its atom from one time to the next. A goal that cannot be true yet needs no search.
//!
//! The rules are those of the translation (`translate`); a test solves both and compares.

use super::{Binding, Ground, Model, Row, Rule, State, Test, View};
use crate::language::{FluentKind, Kind};
use crate::term::Term;
use rustc_hash::FxHashMap as HashMap;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// An atom of the ground program, counted from 1; negative where it is false.
pub(crate) type Literal = i32;

/// A rule of the ground program: `head :- body`, or `{ head } :- body` for a choice; without a head, a constraint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct GroundRule {
    pub choice: bool,
    pub head: Option<Literal>,
    pub body: Vec<Literal>,
}

/// What can be said of a goal at some time.
pub(crate) enum Prospect {
    Certain,
    Never,
    /// If this literal is true.
    If(Literal),
}

/// The literals of a fluent being true and of it being false. Of an inertial fluent they are two atoms, as in the
/// translation, of which just one is true; the laws may conclude either.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Sides {
    yes: Literal,
    no: Literal,
}

/// A domain up to some time.
pub(crate) struct Unrolled<'m, 'd> {
    model: &'m Model<'d>,
    candidates: Vec<Candidate>,
    may: State,
    must: State,
    /// Of the fluents that may be true and need not.
    sides: HashMap<Ground, Sides>,
    /// Why a defined fluent is true at the time that is reached, and the literal that says so.
    grounds: HashMap<Ground, (BTreeSet<Vec<Literal>>, Literal)>,
    atoms: Literal,
    rules: Vec<GroundRule>,
    /// By time: what may be done to get there.
    choices: Vec<Vec<(Term, Literal)>>,
}

/// An action that a plan may hold.
struct Candidate {
    action: Ground,
    /// The laws that may forbid it; the one that last did comes first.
    laws: Vec<usize>,
}

/// A law between the fluents of one time: what it concludes, and under which conditions.
type Link = (Ground, bool, Vec<(Ground, bool)>);

impl Candidate {
    fn new(model: &Model, action: Ground) -> Candidate {
        Candidate { laws: Candidate::laws(model, action.predicate), action }
    }

    /// The laws that may forbid actions of a name.
    fn laws(model: &Model, predicate: usize) -> Vec<usize> {
        let is_about = |law: &usize| {
            model.impossible[*law].action.as_ref().is_some_and(|head| head.predicate == predicate)
        };
        (0..model.impossible.len()).filter(is_about).collect()
    }

    /// All actions that the hand does, or all that happen.
    fn all(model: &Model, exogenous: bool) -> Vec<Candidate> {
        let mut candidates = Vec::new();
        for (predicate, known) in model.predicates.iter().enumerate() {
            if known.kind != (Kind::Action { exogenous }) {
                continue;
            }
            let sorts = model.domain.predicates.get(known.name).map(|p| p.sorts.as_slice());
            let mut rows: Vec<Row> = vec![Row::new()];
            for sort in sorts.unwrap_or_default() {
                let sort = model.sort_numbers.get(sort.as_str());
                let elements = sort.map(|&sort| model.elements[sort].as_slice()).unwrap_or_default();
                let longer = |row: Row| {
                    elements.iter().map(move |&value| row.iter().copied().chain([value]).collect::<Row>())
                };
                rows = rows.into_iter().flat_map(longer).collect();
            }
            let grounds = rows.into_iter().map(|row| Ground { predicate, row });
            let laws = Candidate::laws(model, predicate);
            candidates.extend(grounds.map(|action| Candidate { action, laws: laws.clone() }));
        }
        candidates
    }
}

impl<'m, 'd> Unrolled<'m, 'd> {
    /// Time 0, where the state is known.
    pub(crate) fn new(model: &'m Model<'d>, start: State) -> Unrolled<'m, 'd> {
        Unrolled {
            model,
            candidates: Candidate::all(model, false),
            must: start.clone(),
            may: start,
            sides: HashMap::default(),
            grounds: HashMap::default(),
            atoms: 0,
            rules: Vec::new(),
            choices: Vec::new(),
        }
    }

    /// Number of atoms so far.
    pub(crate) fn atoms(&self) -> Literal {
        self.atoms
    }

    /// The rules since the last call.
    pub(crate) fn take_rules(&mut self) -> Vec<GroundRule> {
        std::mem::take(&mut self.rules)
    }

    /// By time: the actions that may lead there.
    pub(crate) fn choices(&self) -> &[Vec<(Term, Literal)>] {
        &self.choices
    }

    /// One step further; `false` when nothing can be done any more.
    pub(crate) fn advance(&mut self) -> bool {
        let mut candidates = std::mem::take(&mut self.candidates);
        let choices = self.choose(&mut candidates, &mut Vec::new());
        self.candidates = candidates;
        let atoms: Vec<Literal> = choices.iter().map(|(_, occurs)| *occurs).collect();
        let any = self.at_most_one(&atoms);
        self.rules.push(GroundRule {
            choice: false,
            head: None,
            body: any.map(|any| -any).into_iter().collect(),
        });
        self.choices.push(choices);
        any.is_some()
    }

    /// At most one exogenous action happens; those that can, with their literals.
    pub(crate) fn may_happen(&mut self) -> Vec<(Term, Literal)> {
        let mut candidates = Candidate::all(self.model, true);
        let choices = self.choose(&mut candidates, &mut Vec::new());
        let atoms: Vec<Literal> = choices.iter().map(|(_, occurs)| *occurs).collect();
        self.at_most_one(&atoms);
        choices
    }

    /// An action that was tried: where it is impossible, it does nothing. Returns the literal of its having done
    /// nothing although it was possible; `None` where it cannot have been.
    pub(crate) fn attempt(&mut self, action: &Term) -> Option<Literal> {
        let Ok(ground) = self.model.action(action) else { return None };
        let mut forbidden = Vec::new();
        let mut candidates = vec![Candidate::new(self.model, ground)];
        let choices = self.choose(&mut candidates, &mut forbidden);
        let &[(_, occurs)] = &choices[..] else { return None };
        let impossible = self.either(forbidden);
        Some(self.either(vec![vec![-occurs, -impossible]]))
    }

    /// An atom that is true when one of some bodies is.
    pub(crate) fn either(&mut self, bodies: Vec<Vec<Literal>>) -> Literal {
        let head = self.atom();
        let rules = bodies.into_iter().map(|body| GroundRule { choice: false, head: Some(head), body });
        self.rules.extend(rules);
        head
    }

    /// A literal must be true.
    pub(crate) fn require(&mut self, literal: Literal) {
        self.forbid(vec![-literal]);
    }

    /// Not all of these are true.
    pub(crate) fn forbid(&mut self, body: Vec<Literal>) {
        self.rules.push(GroundRule { choice: false, head: None, body });
    }

    /// The actions that are possible, as choices, and what follows; `forbidding` takes what forbids them.
    fn choose(
        &mut self,
        candidates: &mut [Candidate],
        forbidding: &mut Vec<Vec<Literal>>,
    ) -> Vec<(Term, Literal)> {
        let model = self.model;
        let mut caused: BTreeMap<Ground, Vec<(bool, Vec<Literal>)>> = BTreeMap::new();
        let mut choices = Vec::new();
        let mut rules = Vec::new();
        for candidate in candidates {
            let Some(forbidden) = self.forbidden(candidate) else { continue };
            let occurs = self.atom();
            rules.push(GroundRule { choice: true, head: Some(occurs), body: Vec::new() });
            forbidding.extend(forbidden.iter().cloned());
            let constraints = forbidden.into_iter().map(|mut body| {
                body.push(occurs);
                GroundRule { choice: false, head: None, body }
            });
            rules.extend(constraints);
            for rule in &model.causal {
                model.solve_action(rule, self.view(), &candidate.action, &mut |binding| {
                    let mut body = self.body(&self.conditions(rule, binding, self.view()));
                    body.push(occurs);
                    for head in &rule.heads {
                        if let Some(fluent) = model.head(head, binding) {
                            caused.entry(fluent).or_default().push((head.positive, body.clone()));
                        }
                    }
                    false
                });
            }
            choices.push((model.atom_term(&candidate.action), occurs));
        }
        self.rules.append(&mut rules);
        self.follow(caused);
        choices
    }

    /// Whether a goal is true at the time that is reached. `coarse(F)` is what a bridge law says.
    pub(crate) fn prospect(&mut self, fluent: &Term, truth: bool) -> Prospect {
        if let Some(("coarse", [coarse])) = fluent.parts() {
            return self.bridge(coarse);
        }
        let Some(ground) = self.model.ground(fluent) else {
            return if truth { Prospect::Never } else { Prospect::Certain };
        };
        let (may, must) = (self.in_state(&ground, &self.may), self.in_state(&ground, &self.must));
        match (truth, may, must) {
            (true, _, true) | (false, false, _) => Prospect::Certain,
            (true, false, _) | (false, _, true) => Prospect::Never,
            _ => Prospect::If(self.literal(&ground, truth)),
        }
    }

    fn bridge(&mut self, coarse: &Term) -> Prospect {
        let model = self.model;
        let mut bodies = Vec::new();
        for rule in &model.bridges {
            model.solve(rule, self.view(), &mut |binding| {
                let said = rule.heads.iter().any(|head| {
                    let row = model.row(&head.arguments, binding);
                    let arguments = row.into_iter().flatten().map(|value| model.term(value)).collect();
                    Term::Function(head.name.to_string(), arguments) == *coarse
                });
                if said {
                    bodies.push(self.body(&self.conditions(rule, binding, self.view())));
                }
                false
            });
        }
        if bodies.is_empty() {
            return Prospect::Never;
        }
        if bodies.iter().any(Vec::is_empty) {
            return Prospect::Certain;
        }
        let head = self.atom();
        let rules = bodies.into_iter().map(|body| GroundRule { choice: false, head: Some(head), body });
        self.rules.extend(rules);
        Prospect::If(head)
    }

    fn view(&self) -> View<'_> {
        View { may: &self.may, must: &self.must }
    }

    fn atom(&mut self) -> Literal {
        self.atoms += 1;
        self.atoms
    }

    fn in_state(&self, fluent: &Ground, state: &State) -> bool {
        self.model.has(fluent.predicate, &fluent.row, state)
    }

    /// The literal of a fluent that is not certain.
    fn literal(&self, fluent: &Ground, truth: bool) -> Literal {
        // Every fluent that may be true and need not has its sides.
        self.sides.get(fluent).map_or(0, |sides| if truth { sides.yes } else { sides.no })
    }

    /// What a body asks of the fluents that are not certain.
    fn conditions(&self, rule: &Rule, binding: &Binding, view: View) -> Vec<(Ground, bool)> {
        let mut conditions = Vec::new();
        for test in &rule.conditions {
            let Test::Literal { positive, predicate, arguments } = test else { continue };
            if self.model.predicates[*predicate].kind == Kind::Static {
                continue;
            }
            let Some(row) = self.model.row(arguments, binding) else { continue };
            let fluent = Ground { predicate: *predicate, row };
            let certain = match positive {
                true => self.in_state(&fluent, view.must),
                false => !self.in_state(&fluent, view.may),
            };
            if !certain {
                conditions.push((fluent, *positive));
            }
        }
        conditions
    }

    fn body(&self, conditions: &[(Ground, bool)]) -> Vec<Literal> {
        let mut body: Vec<Literal> =
            conditions.iter().map(|(fluent, truth)| self.literal(fluent, *truth)).collect();
        body.sort_unstable();
        body.dedup();
        body
    }

    /// The bodies that forbid an action; `None` when one of them is certain.
    fn forbidden(&self, candidate: &mut Candidate) -> Option<Vec<Vec<Literal>>> {
        let mut bodies = Vec::new();
        let mut certain = None;
        for (place, &law) in candidate.laws.iter().enumerate() {
            let rule = &self.model.impossible[law];
            let stopped = self.model.solve_action(rule, self.view(), &candidate.action, &mut |binding| {
                let conditions = self.conditions(rule, binding, self.view());
                if !conditions.is_empty() {
                    bodies.push(self.body(&conditions));
                }
                conditions.is_empty()
            });
            if stopped {
                certain = Some(place);
                break;
            }
        }
        match certain {
            Some(place) => {
                candidate.laws.swap(0, place);
                None
            }
            None => Some(bodies),
        }
    }

    /// At most one of some atoms is true: each of a row of further atoms says that one up to there is. The last says
    /// that any is.
    fn at_most_one(&mut self, atoms: &[Literal]) -> Option<Literal> {
        let mut so_far: Option<Literal> = None;
        for &atom in atoms {
            let next = self.atom();
            self.rules.push(GroundRule { choice: false, head: Some(next), body: vec![atom] });
            if let Some(before) = so_far {
                self.rules.push(GroundRule { choice: false, head: Some(next), body: vec![before] });
                self.rules.push(GroundRule { choice: false, head: None, body: vec![before, atom] });
            }
            so_far = Some(next);
        }
        so_far
    }

    /// The next time: what the actions cause, what follows, and what stays.
    fn follow(&mut self, caused: BTreeMap<Ground, Vec<(bool, Vec<Literal>)>>) {
        let model = self.model;
        let (mut may, mut must) = (self.may.clone(), self.must.clone());
        let mut changed = BTreeSet::new();
        for (fluent, causes) in &caused {
            for (truth, _) in causes {
                let new = if *truth {
                    model.put(&mut may, fluent, true)
                } else {
                    model.put(&mut must, fluent, false)
                };
                if new {
                    changed.insert(fluent.predicate);
                }
            }
        }
        self.relax(&mut may, &mut must, changed);
        let view = View { may: &may, must: &must };
        let open = |fluent: &Ground| self.in_state(fluent, &may) && !self.in_state(fluent, &must);

        // Laws between the fluents of one time, as far as something is open.
        let mut links: Vec<Link> = Vec::new();
        for rule in &model.constraints {
            let head = &rule.heads[0];
            model.solve(rule, view, &mut |binding| {
                if let Some(fluent) = model.head(head, binding).filter(open) {
                    links.push((fluent, head.positive, self.conditions(rule, binding, view)));
                }
                false
            });
        }
        // What this step can touch gets new atoms.
        let mut touched: BTreeSet<Ground> = caused.keys().filter(|fluent| open(fluent)).cloned().collect();
        let is_defined =
            |fluent: &Ground| model.predicates[fluent.predicate].kind == Kind::Fluent(FluentKind::Defined);
        loop {
            let known = touched.len();
            for (fluent, _, conditions) in &links {
                let new = |(other, _): &(Ground, bool)| is_defined(other) || touched.contains(other);
                if !touched.contains(fluent) && (conditions.is_empty() || conditions.iter().any(new)) {
                    touched.insert(fluent.clone());
                }
            }
            if touched.len() == known {
                break;
            }
        }
        let mut rules = Vec::new();
        let mut sides: HashMap<Ground, Sides> = HashMap::default();
        for (predicate, rows) in may.rows.iter().enumerate() {
            if model.predicates[predicate].kind != Kind::Fluent(FluentKind::Inertial) {
                continue;
            }
            for row in rows.iter().filter(|row| !must.rows[predicate].contains(*row)) {
                let fluent = Ground { predicate, row: row.clone() };
                let before = self.sides.get(&fluent).copied();
                let now = match before {
                    Some(before) if !touched.contains(&fluent) => before,
                    _ => {
                        let now = Sides { yes: self.atom(), no: self.atom() };
                        let rule = |head, body| GroundRule { choice: false, head, body };
                        // What nothing changes stays as it is.
                        let was = self.in_state(&fluent, &self.must);
                        if was || before.is_some() {
                            let body = before.map(|before| before.yes).into_iter().chain([-now.no]).collect();
                            rules.push(rule(Some(now.yes), body));
                        }
                        if !was {
                            let body = before.map(|before| before.no).into_iter().chain([-now.yes]).collect();
                            rules.push(rule(Some(now.no), body));
                        }
                        rules.push(rule(None, vec![now.yes, now.no]));
                        now
                    }
                };
                sides.insert(fluent, now);
            }
        }
        for (fluent, causes) in caused {
            if let Some(sides) = sides.get(&fluent) {
                for (truth, body) in causes {
                    let head = Some(if truth { sides.yes } else { sides.no });
                    rules.push(GroundRule { choice: false, head, body });
                }
            }
        }
        self.sides = sides;
        self.define(&may, &must, &mut rules);
        for (fluent, truth, conditions) in links {
            if touched.contains(&fluent) {
                let head = Some(self.literal(&fluent, truth));
                rules.push(GroundRule { choice: false, head, body: self.body(&conditions) });
            }
        }
        self.rules.append(&mut rules);
        (self.may, self.must) = (may, must);
    }

    /// The defined fluents that are open, with their laws.
    fn define(&mut self, may: &State, must: &State, rules: &mut Vec<GroundRule>) {
        let model = self.model;
        let view = View { may, must };
        let mut before = std::mem::take(&mut self.grounds);
        for (predicate, laws) in &model.defined {
            let rows = may.rows[*predicate].iter().filter(|row| !must.rows[*predicate].contains(*row));
            let open: Vec<Ground> =
                rows.map(|row| Ground { predicate: *predicate, row: row.clone() }).collect();
            if open.is_empty() {
                continue;
            }
            let recursive = laws.iter().any(|law| law.reads.contains(predicate));
            if recursive {
                for fluent in &open {
                    let yes = self.atom();
                    self.sides.insert(fluent.clone(), Sides { yes, no: -yes });
                }
            }
            let mut bodies: HashMap<Ground, BTreeSet<Vec<Literal>>> = HashMap::default();
            for law in laws {
                model.solve(law, view, &mut |binding| {
                    let fluent = model.head(&law.heads[0], binding);
                    if let Some(fluent) = fluent.filter(|fluent| !self.in_state(fluent, must)) {
                        let body = self.body(&self.conditions(law, binding, view));
                        bodies.entry(fluent).or_default().insert(body);
                    }
                    false
                });
            }
            for fluent in open {
                let own = bodies.remove(&fluent).unwrap_or_default();
                let mut only = own.iter().flatten();
                let yes = match (before.remove(&fluent), only.next(), only.next()) {
                    // On the same grounds as before it is what it was.
                    (Some((old, yes)), ..) if !recursive && old == own => yes,
                    // On one ground it is that.
                    (_, Some(&ground), None) if !recursive && own.len() == 1 => ground,
                    _ => {
                        let yes = if recursive { self.literal(&fluent, true) } else { self.atom() };
                        let rule = |body: &Vec<Literal>| GroundRule {
                            choice: false,
                            head: Some(yes),
                            body: body.clone(),
                        };
                        rules.extend(own.iter().map(rule));
                        yes
                    }
                };
                self.sides.insert(fluent.clone(), Sides { yes, no: -yes });
                self.grounds.insert(fluent, (own, yes));
            }
        }
    }

    /// Widens what may be true and narrows what must be until the laws between fluents add nothing. `changed`: the
    /// inertial fluents that are known to be wider than before.
    fn relax(&self, may: &mut State, must: &mut State, mut changed: BTreeSet<usize>) {
        let model = self.model;
        while !changed.is_empty() {
            let mut dirty = changed.clone();
            for (predicate, laws) in &model.defined {
                if changed.is_disjoint(&model.depends[predicate]) {
                    continue;
                }
                let possible = self.derived(*predicate, laws, may, must, true);
                let new = possible != *may.rows[*predicate];
                may.rows[*predicate] = Rc::new(possible);
                let certain = self.derived(*predicate, laws, may, must, false);
                if new || certain != *must.rows[*predicate] {
                    dirty.insert(*predicate);
                }
                must.rows[*predicate] = Rc::new(certain);
            }
            let mut again = BTreeSet::new();
            for rule in &model.constraints {
                if dirty.is_disjoint(&rule.reads) {
                    continue;
                }
                let head = &rule.heads[0];
                let mut concluded = Vec::new();
                model.solve(rule, View { may, must }, &mut |binding| {
                    concluded.extend(model.head(head, binding));
                    false
                });
                for fluent in concluded {
                    let new = if head.positive {
                        model.put(may, &fluent, true)
                    } else {
                        model.put(must, &fluent, false)
                    };
                    if new {
                        again.insert(fluent.predicate);
                    }
                }
            }
            changed = again;
        }
    }

    /// The rows of a defined fluent that may be true, or those that must be.
    fn derived(
        &self,
        predicate: usize,
        laws: &[Rule],
        may: &mut State,
        must: &mut State,
        possible: bool,
    ) -> BTreeSet<Row> {
        let recursive = laws.iter().any(|law| law.reads.contains(&predicate));
        let mut rows = BTreeSet::new();
        loop {
            if recursive {
                // What was true before is no reason for itself.
                let state = if possible { &mut *may } else { &mut *must };
                state.rows[predicate] = Rc::new(rows.clone());
            }
            let known = rows.len();
            let view = if possible { View { may, must } } else { View { may: must, must: may } };
            for law in laws {
                self.model.solve(law, view, &mut |binding| {
                    rows.extend(self.model.row(&law.heads[0].arguments, binding));
                    false
                });
            }
            if !recursive || rows.len() == known {
                return rows;
            }
        }
    }
}
