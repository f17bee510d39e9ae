//! From an assembly and a state to a plan: the order of the beams, then coarse actions, then fine ones.
//!
//! What may be done, and how, stands in the rule files; here their answers are carried from level to level. A level
//! that finds no answer to what the one above decided hands that back, and gets another decision.

use crate::answer::{Answers, meaningless};
use crate::domains::Domains;
use crate::error::PlanError;
use crate::facts::{self, beam_name, connection_name, peg_item};
use crate::geometry::Geometry;
use crate::language::ground::{Model, Refusal, State as Fluents, Unrolled};
use crate::language::{Domain, FluentKind, Kind};
use crate::plan::{CoarseStep, Entry, Plan, State, Statistics};
use crate::shape::Shape;
use crate::solver::Solver;
use crate::state::{self, Known};
use crate::term::Term;
use ramp_assembly::Assembly;
use ramp_kit::Kit;
use std::collections::{BTreeSet, HashMap};

/// The most fine actions in one coarse action; the rules never need more than four.
const MOST_FINE_STEPS: usize = 8;
/// How many orders of the beams are tried before the planner gives up.
const MOST_ORDERS: usize = 24;

/// How a plan is searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Prove that no plan has fewer coarse actions; takes much longer.
    pub optimal: bool,
    /// Look at no more of the goal at a time than what matters there.
    pub zoom: bool,
    /// Find the fine actions, too.
    pub fine: bool,
}

impl Default for Options {
    fn default() -> Options {
        Options { optimal: false, zoom: true, fine: true }
    }
}

/// Plans what is left to do to build an assembly.
///
/// The same input always gives the same plan.
///
/// # Errors
/// When the state cannot be, when the rules say that the goal cannot be built, when the pegs do not suffice, or when
/// a rule file gives an answer that means nothing here.
///
/// ```
/// use ramp_planner::{CoarseAction, Domains, State, plan};
///
/// let kit = ramp_kit::read_kit("../../data/kit.xml".as_ref())?;
/// let assembly = ramp_assembly::read_goal("../../data/goals/easy-3.xml".as_ref(), &kit)?;
/// let domains = Domains::read("../../data/domains".as_ref())?;
/// let plan = plan(&assembly, &kit, &State::default(), &domains)?;
/// assert!(matches!(&plan.steps[3].coarse, CoarseAction::Assemble { beam } if beam == "b4"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn plan(assembly: &Assembly, kit: &Kit, state: &State, domains: &Domains) -> Result<Plan, PlanError> {
    plan_with(assembly, kit, state, domains, Options::default())
}

/// The same, searched in another way.
///
/// # Errors
/// As [`plan`].
pub fn plan_with(
    assembly: &Assembly,
    kit: &Kit,
    state: &State,
    domains: &Domains,
    options: Options,
) -> Result<Plan, PlanError> {
    let known = state::look_up(assembly, kit, state)?;
    let needed = known.pinned.iter().filter(|pinned| pinned.is_none()).count();
    if needed > known.pegs.len() {
        return Err(PlanError::Pegs { goal: assembly.name.clone(), needed, left: known.pegs.len() });
    }
    Planner::new(assembly, kit, domains, options).plan(&known)
}

/// A domain with a goal as a program for clingo's incremental mode: `ramp plan GOAL --emit-asp > goal.lp`, then
/// `clingo goal.lp`. The fine domain is emitted for the state at the beginning and with no goals of its own.
pub fn asp(assembly: &Assembly, kit: &Kit, domains: &Domains, fine: bool) -> String {
    let planner = Planner::new(assembly, kit, domains, Options::default());
    let mut facts = planner.facts.all;
    let domain = match fine {
        false => domains.coarse(),
        true => {
            let beams: Vec<usize> = (0..assembly.beams.len()).collect();
            let stands: Vec<bool> = beams.iter().map(|&beam| beam == assembly.base).collect();
            let pinned = vec![false; assembly.connections.len()];
            facts.extend(facts::fine(assembly, &planner.geometry, &beams, &|_| true, &stands, &pinned));
            domains.fine()
        }
    };
    let facts: String = facts.iter().map(|fact| format!("{fact}.\n")).collect();
    format!(
        "{}\n% ---- {} ----\n#include <incmode>.\n#program base.\ngoal(F) :- final(F).\navoid(F) :- final_not(F).\n{facts}",
        domain.to_asp(),
        assembly.name
    )
}

/// What every step of planning needs.
pub(crate) struct Planner<'a> {
    pub assembly: &'a Assembly,
    /// The names of the pegs.
    pub pegs: Vec<String>,
    pub domains: &'a Domains,
    pub geometry: Geometry<'a>,
    pub facts: Facts,
    pub model: Model<'a>,
    /// The beams by name.
    numbers: HashMap<String, usize>,
    /// Names that the laws themselves mention, and those of ways: these are always in sight, and not like others.
    coarse_names: BTreeSet<String>,
    fine_names: BTreeSet<String>,
    solver: Solver,
    options: Options,
    /// Answers to problems of the same shape.
    coarse_answers: KnownAnswers,
    fine_answers: KnownAnswers,
    /// The first beam for which no link was found that can be held where the beam starts and at its place.
    ungrasped: Option<usize>,
}

/// Answers to problems of one domain, by their shape.
#[derive(Default)]
struct KnownAnswers(HashMap<Vec<Term>, Option<Found>>);

/// The fewest actions for a problem.
#[derive(Clone, Debug, Default)]
struct Found {
    actions: Vec<Term>,
    /// The inertial fluents that are true in the end.
    end: Vec<Term>,
}

impl Found {
    fn name(&self, shape: &Shape) -> Found {
        let [actions, end] =
            [&self.actions, &self.end].map(|terms| terms.iter().map(|term| shape.name(term)).collect());
        Found { actions, end }
    }
}

impl KnownAnswers {
    /// Solves a problem of objects, statics, `told(F)`, `goal(F)` and `avoid(F)`.
    fn shortest(
        &mut self,
        solver: &mut Solver,
        domain: &Domain,
        shape: &Shape,
        most: usize,
    ) -> Result<Option<Found>, PlanError> {
        if let Some(found) = self.0.get(&shape.facts) {
            return Ok(found.as_ref().map(|found| found.name(shape)));
        }
        let found = solve(solver, domain, &shape.facts, [0, most])?;
        let named = found.as_ref().map(|found| found.name(shape));
        self.0.insert(shape.facts.clone(), found);
        Ok(named)
    }
}

/// The fewest actions, from the least number to the most, for a problem of objects, statics, `told(F)`, `goal(F)` and
/// `avoid(F)`.
fn solve(
    solver: &mut Solver,
    domain: &Domain,
    problem: &[Term],
    range: [usize; 2],
) -> Result<Option<Found>, PlanError> {
    let file = domain.file();
    let (mut told, mut goals) = (Vec::new(), Vec::new());
    for term in problem {
        match term.parts() {
            Some(("told", [fluent])) => told.push(fluent.clone()),
            Some((name @ ("goal" | "avoid"), [fluent])) => goals.push((fluent.clone(), name == "goal")),
            _ => {}
        }
    }
    let model = Model::new(domain, problem);
    let refused = |refusal: Refusal| PlanError::Refused {
        file: file.name().to_string(),
        why: refusal_words(refusal, "the state"),
    };
    let start = model.resumed(&told).map_err(refused)?;
    let mut unrolled = Unrolled::new(&model, start.clone());
    let actions =
        solver.shortest(&mut unrolled, &goals, range).map_err(|error| PlanError::solver(file, &error))?;
    let Some(actions) = actions else { return Ok(None) };
    let mut state = start;
    for action in &actions {
        state = model.after(&state, action).map_err(refused)?;
    }
    Ok(Some(Found { actions, end: model.inertial(&state) }))
}

/// An answer of the first level.
#[derive(Clone, Debug, Default)]
struct Order {
    /// The beams that are not in yet, in the order in which they are to be placed.
    sequence: Vec<usize>,
    before: Vec<(usize, usize)>,
    deep: Vec<usize>,
}

/// Facts, to be picked by the names in them.
pub(crate) struct Facts {
    pub all: Vec<Term>,
    /// By name: where it occurs, in order.
    of: HashMap<String, Vec<usize>>,
    /// Facts without any name.
    nameless: Vec<usize>,
}

impl Facts {
    fn new(all: Vec<Term>) -> Facts {
        let mut of: HashMap<String, Vec<usize>> = HashMap::new();
        let mut nameless = Vec::new();
        for (index, fact) in all.iter().enumerate() {
            let texts: BTreeSet<&str> = fact.texts().into_iter().collect();
            if texts.is_empty() {
                nameless.push(index);
            }
            for text in texts {
                of.entry(text.to_string()).or_default().push(index);
            }
        }
        Facts { all, of, nameless }
    }

    /// The facts that name nothing but these, in order; without names, all.
    fn about(&self, names: Option<&BTreeSet<String>>) -> impl Iterator<Item = &Term> {
        let picked = match names {
            None => (0..self.all.len()).collect(),
            Some(names) => {
                let near = names.iter().filter_map(|name| self.of.get(name)).flatten().chain(&self.nameless);
                let near: BTreeSet<usize> = near.copied().collect();
                let inside =
                    |index: &usize| self.all[*index].texts().into_iter().all(|text| names.contains(text));
                near.into_iter().filter(inside).collect::<Vec<_>>()
            }
        };
        picked.into_iter().map(|index| &self.all[index])
    }
}

/// Something to be reached: fluents that are to be true or false.
type Task = Vec<(Term, bool)>;

/// A coarse action with the states around it.
#[derive(Clone)]
pub(crate) struct Transition {
    pub action: Term,
    pub before: Fluents,
    pub after: Fluents,
}

impl<'a> Planner<'a> {
    pub(crate) fn new(
        assembly: &'a Assembly,
        kit: &'a Kit,
        domains: &'a Domains,
        options: Options,
    ) -> Planner<'a> {
        let geometry = Geometry::new(assembly, kit);
        let facts = facts::coarse(assembly, &geometry);
        let model = Model::new(domains.coarse(), &facts);
        let facts = Facts::new(facts);
        let mut coarse_names = domains.coarse().quoted();
        coarse_names.extend(geometry.ways.iter().flatten().map(|way| way.name.to_string()));
        let numbers =
            assembly.beams.iter().enumerate().map(|(index, placed)| (placed.beam.name.clone(), index));
        Planner {
            numbers: numbers.collect(),
            coarse_names,
            fine_names: domains.fine().quoted(),
            assembly,
            pegs: state::peg_names(assembly, kit),
            domains,
            geometry,
            facts,
            model,
            solver: Solver::default(),
            options,
            coarse_answers: KnownAnswers::default(),
            fine_answers: KnownAnswers::default(),
            ungrasped: None,
        }
    }

    /// The coarse state that is known.
    pub(crate) fn fluents(&self, known: &Known) -> Result<Fluents, PlanError> {
        let mut told = known.told(self.assembly);
        if known.held_peg.is_some() {
            // Pegs are alike: it is the one of the connection that is pinned next.
            let first = self.tasks(&Order::default(), known).into_iter().flatten().find_map(|(term, _)| {
                let (name, arguments) = term.parts()?;
                (name == "pinned").then(|| Term::new("in_hand", [Term::new("peg", [arguments[0].clone()])]))
            });
            let open = known.pinned.iter().position(Option::is_none);
            let any = open.map(|index| Term::new("in_hand", [peg_item(self.assembly, index)]));
            told.extend(first.or(any));
        }
        self.model.initial(&told, &[]).map_err(|refusal| self.refused(refusal, "the state"))
    }

    fn plan(&mut self, known: &Known) -> Result<Plan, PlanError> {
        let (transitions, steps, lower_bound) = self.search(known)?;
        let statistics =
            Statistics { solves: self.solver.solves, optimal: lower_bound == transitions.len(), lower_bound };
        Ok(Plan { entries: self.entries(&transitions), steps, statistics })
    }

    /// The coarse actions of the plan, with the states between them.
    pub(crate) fn transitions(&mut self, known: &Known) -> Result<Vec<Transition>, PlanError> {
        Ok(self.search(known)?.0)
    }

    /// Plans, and again with a beam to be regrasped where no link can be held all the way: which ones there is room for
    /// at a beam's place depends on what stands by then.
    fn search(&mut self, known: &Known) -> Result<(Vec<Transition>, Vec<CoarseStep>, usize), PlanError> {
        loop {
            let found = self.try_orders(known);
            let Some(beam) = self.ungrasped.take().filter(|_| found.is_err()) else { return found };
            if !self.regrasp(&[beam]) {
                return found;
            }
        }
    }

    /// Lets beams be regrasped on their way that the facts do not know to need it. Returns whether that is new for any.
    pub(crate) fn regrasp(&mut self, beams: &[usize]) -> bool {
        let mut facts = self.facts.all.clone();
        for &beam in beams {
            let fact = Term::new("awkward", [beam_name(self.assembly, beam)]);
            if !facts.contains(&fact) {
                facts.push(fact);
            }
        }
        if facts.len() == self.facts.all.len() {
            return false;
        }
        self.model = Model::new(self.domains.coarse(), &facts);
        self.facts = Facts::new(facts);
        true
    }

    /// Tries one order of the beams after another.
    fn try_orders(&mut self, known: &Known) -> Result<(Vec<Transition>, Vec<CoarseStep>, usize), PlanError> {
        let start = self.fluents(known)?;
        let mut refused: Vec<Order> = Vec::new();
        let mut first_error: Option<PlanError> = None;
        loop {
            let order = match self.order(known, &refused) {
                Ok(order) => order,
                // What the levels below said of the first order says more.
                Err(error) => return Err(first_error.unwrap_or(error)),
            };
            match self.build(&order, known, &start) {
                Ok(found) => return Ok(found),
                Err(error @ (PlanError::NoPlan { .. } | PlanError::Illegal { .. })) => {
                    let first = first_error.get_or_insert(error);
                    refused.push(order);
                    if refused.len() >= MOST_ORDERS {
                        return Err(std::mem::replace(
                            first,
                            PlanError::NoOrder { goal: self.assembly.name.clone() },
                        ));
                    }
                }
                Err(error) => return Err(error),
            }
        }
    }

    /// Coarse and fine actions for an order, and a number of coarse actions that no plan goes below.
    fn build(
        &mut self,
        order: &Order,
        known: &Known,
        start: &Fluents,
    ) -> Result<(Vec<Transition>, Vec<CoarseStep>, usize), PlanError> {
        let mut transitions = self.coarse(order, known, start)?;
        self.has_ways(&transitions)?;
        // What is known of the shipped rules need not be true of others.
        let shipped = self.domains.coarse().file().text() == include_str!("../../../data/domains/coarse.al");
        let mut lower_bound = if shipped { lower_bound(known).min(transitions.len()) } else { 0 };
        if self.options.optimal && lower_bound < transitions.len() {
            let (shorter, proven) = self.shorter(start, lower_bound, transitions.len() - 1)?;
            if let Some(actions) = shorter {
                transitions = self.walk(start, &actions)?;
            }
            lower_bound = proven.min(transitions.len());
        }
        let steps = self.steps(&transitions, known)?;
        Ok((transitions, steps, lower_bound))
    }

    /// Each beam has a straight way in past all that stands by then. The rules know which single beams are in a way;
    /// where one makes it longer and another one blocks it further out, only both together are.
    fn has_ways(&self, transitions: &[Transition]) -> Result<(), PlanError> {
        for transition in transitions {
            let Some((name @ ("assemble" | "assemble_deep" | "lay_down"), [beam])) =
                transition.action.parts()
            else {
                continue;
            };
            let Some(index) = beam.texts().first().and_then(|name| self.assembly.beam_index(name)) else {
                continue;
            };
            let (stands, _) = self.standing(&transition.before);
            if self.geometry.way(index, &stands, name == "lay_down").is_none() {
                let beam = &self.assembly.beams[index].beam.name;
                return Err(PlanError::Illegal {
                    goal: self.assembly.name.clone(),
                    why: format!("{beam} has no straight way to its place past all that stands by then"),
                    beams: vec![beam.clone()],
                });
            }
        }
        Ok(())
    }

    // ---- The order of the beams -------------------------------------------------------------------------------

    fn order(&mut self, known: &Known, refused: &[Order]) -> Result<Order, PlanError> {
        let rules = self.domains.order();
        let name = |beam: usize| beam_name(self.assembly, beam);
        let mut facts = self.facts.all.clone();
        for (rank, insertion) in self.assembly.insertions.iter().enumerate() {
            facts.push(Term::new("proven", [name(insertion.beam), rank.into()]));
        }
        for beam in (0..self.assembly.beams.len()).filter(|&beam| known.stands[beam]) {
            facts.push(Term::new("placed", [name(beam)]));
            if known.deep[beam] {
                facts.push(Term::new("is_deep", [name(beam)]));
            }
        }
        for (number, order) in refused.iter().enumerate() {
            facts.push(Term::new("refused", [number.into()]));
            let pairs = order.before.iter();
            facts.extend(pairs.map(|&(a, b)| Term::new("refused", [number.into(), name(a), name(b)])));
            let deep = order.deep.iter();
            facts.extend(deep.map(|&beam| Term::new("refused_deep", [number.into(), name(beam)])));
        }
        let solved = self.solver.best(rules, &facts).map_err(|error| PlanError::solver(rules, &error))?;
        let answer = solved.ok_or_else(|| PlanError::NoOrder { goal: self.assembly.name.clone() })?;
        let answers = Answers { assembly: self.assembly, pegs: &self.pegs, rules };

        let mut order = Order::default();
        let mut problems = Vec::new();
        for term in &answer {
            match term.parts() {
                Some(("before", [first, second])) => {
                    order.before.push((answers.beam(first)?, answers.beam(second)?));
                }
                Some(("deep", [beam])) => {
                    let beam = answers.beam(beam)?;
                    if !known.stands[beam] {
                        order.deep.push(beam);
                    }
                }
                Some(("laid", [_])) => {}
                Some(("problem", [words])) => problems.push(words),
                _ => return Err(meaningless(rules, term)),
            }
        }
        problems.sort();
        if let Some(words) = problems.first() {
            return Err(self.illegal(words));
        }
        // Again and again, the first beam of the proven order that waits for no other.
        let mut waits = vec![0usize; self.assembly.beams.len()];
        let mut after: Vec<Vec<usize>> = vec![Vec::new(); self.assembly.beams.len()];
        for &(first, second) in &order.before {
            if !known.stands[first] {
                waits[second] += 1;
                after[first].push(second);
            }
        }
        let mut rank = vec![usize::MAX; self.assembly.beams.len()];
        for (position, insertion) in self.assembly.insertions.iter().enumerate() {
            rank[insertion.beam] = position;
        }
        let mut ready: BTreeSet<(usize, usize)> = (0..waits.len())
            .filter(|&beam| !known.stands[beam] && waits[beam] == 0)
            .map(|beam| (rank[beam], beam))
            .collect();
        while let Some((_, next)) = ready.pop_first() {
            order.sequence.push(next);
            for &beam in &after[next] {
                waits[beam] -= 1;
                if waits[beam] == 0 {
                    ready.insert((rank[beam], beam));
                }
            }
        }
        if order.sequence.len() < known.stands.iter().filter(|stands| !**stands).count() {
            return Err(PlanError::NoOrder { goal: self.assembly.name.clone() });
        }
        Ok(order)
    }

    /// A problem in the words of the rules as an error.
    fn illegal(&self, words: &Term) -> PlanError {
        let texts = words.texts();
        let is_beam = |text: &&&str| self.assembly.beam_index(text).is_some();
        let mut beams: Vec<String> = texts.iter().filter(is_beam).map(|text| text.to_string()).collect();
        beams.dedup();
        PlanError::Illegal { goal: self.assembly.name.clone(), why: texts.join(" "), beams }
    }

    // ---- Coarse actions ---------------------------------------------------------------------------------------

    /// What is to be reached, one after the other: a beam placed, its connections pinned, beams slid forward.
    fn tasks(&self, order: &Order, known: &Known) -> Vec<Task> {
        let mut stands = known.stands.clone();
        let mut deep = known.deep.clone();
        let mut pinned: Vec<bool> = known.pinned.iter().map(Option::is_some).collect();
        let mut tasks = Vec::new();
        self.finish(&stands, &mut deep, &mut pinned, &mut tasks);
        for &beam in &order.sequence {
            stands[beam] = true;
            deep[beam] = order.deep.contains(&beam);
            let name = beam_name(self.assembly, beam);
            let fluents = [("in_assembly", true), ("deep", deep[beam])];
            tasks.push(fluents.map(|(fluent, truth)| (Term::new(fluent, [name.clone()]), truth)).to_vec());
            self.finish(&stands, &mut deep, &mut pinned, &mut tasks);
        }
        tasks
    }

    /// Pegs for what is closed, then beams slid forward where all is there that they go into, and pegs again.
    fn finish(&self, stands: &[bool], deep: &mut [bool], pinned: &mut [bool], tasks: &mut Vec<Task>) {
        loop {
            // First where a joint guides the male: around the first peg of any other, it turns.
            let mut indices: Vec<usize> = (0..self.assembly.connections.len()).collect();
            indices.sort_by_key(|&index| !facts::is_tight(self.assembly, index));
            for index in indices {
                let connection = &self.assembly.connections[index];
                let sides = [connection.female.beam, connection.male.beam];
                if !pinned[index] && sides.iter().all(|&beam| stands[beam] && !deep[beam]) {
                    pinned[index] = true;
                    tasks.push(vec![(Term::new("pinned", [connection_name(self.assembly, index)]), true)]);
                }
            }
            let ready = |beam: &usize| {
                deep[*beam] && facts::partners(self.assembly, *beam).all(|(_, other)| stands[other])
            };
            let Some(next) = (0..stands.len()).find(ready) else { return };
            deep[next] = false;
            tasks.push(vec![(Term::new("aligned", [beam_name(self.assembly, next)]), true)]);
        }
    }

    fn coarse(
        &mut self,
        order: &Order,
        known: &Known,
        start: &Fluents,
    ) -> Result<Vec<Transition>, PlanError> {
        let mut facts = self.facts.all.clone();
        let name = |beam: usize| beam_name(self.assembly, beam);
        facts.extend(order.before.iter().map(|&(a, b)| Term::new("before", [name(a), name(b)])));
        let facts = Facts::new(facts);
        let mut transitions: Vec<Transition> = Vec::new();
        let mut state = start.clone();
        for task in self.tasks(order, known) {
            self.reach(&task, &facts, &mut state, &mut transitions)?;
        }
        // What the domain asks of the end: a free hand that stands aside, and whatever else it says.
        for _ in 0..2 {
            let missing = self.model.missing(&state);
            if missing.is_empty() {
                return Ok(transitions);
            }
            self.reach(&missing, &facts, &mut state, &mut transitions)?;
        }
        match self.model.missing(&state).first() {
            None => Ok(transitions),
            Some((fluent, _)) => {
                Err(self.no_plan(self.domains.coarse().file().name(), &fluent.to_string(), 0))
            }
        }
    }

    /// Adds the fewest actions that reach a task.
    fn reach(
        &mut self,
        task: &Task,
        facts: &Facts,
        state: &mut Fluents,
        transitions: &mut Vec<Transition>,
    ) -> Result<(), PlanError> {
        let held = |fluent: &(Term, bool)| self.model.holds(state, &fluent.0) == fluent.1;
        if task.iter().all(held) {
            return Ok(());
        }
        // Where a beam is placed, those matter that it meets, and those that carry these; for a peg, its two beams.
        let places = task.iter().any(|(fluent, _)| name_of(fluent) == Some("in_assembly"));
        let reaches: &[usize] = match (self.options.zoom, places) {
            (false, _) => &[],
            (true, true) => &[1, 2],
            (true, false) => &[0, 2],
        };
        for &reach in reaches {
            if let Some(actions) = self.solve_task(task, facts, state, Some(reach))?
                && let Ok(walked) = self.walk(state, &actions)
                // Judged on the whole goal: what was left out made no difference.
                && let Some(last) = walked.last()
                && task.iter().all(|(fluent, truth)| self.model.holds(&last.after, fluent) == *truth)
            {
                *state = last.after.clone();
                transitions.extend(walked);
                return Ok(());
            }
        }
        let name = self.domains.coarse().file().name().to_string();
        let words = task.iter().map(|(fluent, truth)| format!("{}{fluent}", if *truth { "" } else { "-" }));
        let words = words.collect::<Vec<_>>().join(", ");
        let actions = self
            .solve_task(task, facts, state, None)?
            .ok_or_else(|| self.no_plan(&name, &words, most_steps(self.assembly)))?;
        let walked = self.walk(state, &actions)?;
        if let Some(last) = walked.last() {
            *state = last.after.clone();
        }
        transitions.extend(walked);
        Ok(())
    }

    fn solve_task(
        &mut self,
        task: &Task,
        facts: &Facts,
        state: &Fluents,
        reach: Option<usize>,
    ) -> Result<Option<Vec<Term>>, PlanError> {
        let mut problem: Vec<Term> = Vec::new();
        let goal = |(fluent, truth): &(Term, bool)| {
            Term::new(if *truth { "goal" } else { "avoid" }, [fluent.clone()])
        };
        let keep = reach.map(|reach| self.around(task, state, reach));
        problem.extend(facts.about(keep.as_ref()).cloned());
        let told = self.model.inertial_about(state, keep.as_ref());
        problem.extend(told.into_iter().map(|fluent| Term::new("told", [fluent])));
        problem.extend(task.iter().map(goal));
        let shape = Shape::of(&problem, &self.coarse_names);
        let most = most_steps(self.assembly);
        let found = self.coarse_answers.shortest(&mut self.solver, self.domains.coarse(), &shape, most)?;
        let Some(Found { mut actions, .. }) = found else { return Ok(None) };
        // Pushes that follow each other may come in any order; it is the same one every time.
        for run in actions.chunk_by_mut(|a, b| is_push(a) && is_push(b)) {
            run.sort_by_key(|action| action.texts().first().and_then(|name| self.assembly.beam_index(name)));
        }
        Ok(Some(actions))
    }

    /// The names that a task can have to do with: its beams and those around them, so many joints away.
    fn around(&self, task: &Task, state: &Fluents, reach: usize) -> BTreeSet<String> {
        let mut names = self.coarse_names.clone();
        let in_hand = ["in_hand", "stuck"].map(|name| self.model.true_of(state, name)).concat();
        let texts = task.iter().map(|(fluent, _)| fluent).chain(&in_hand).flat_map(Term::texts);
        let mut beams: BTreeSet<usize> = BTreeSet::new();
        for text in texts {
            beams.extend(self.assembly.beam_index(text));
            if let Some(index) = self.assembly.connection_index(text) {
                let connection = &self.assembly.connections[index];
                beams.extend([connection.female.beam, connection.male.beam]);
            }
        }
        let in_the_way: Vec<usize> = beams
            .iter()
            .flat_map(|&beam| (0..self.geometry.ways[beam].len()).map(move |way| (beam, way)))
            .flat_map(|(beam, way)| self.geometry.blocked(beam, way))
            .collect();
        for _ in 0..reach {
            let next: Vec<usize> = beams
                .iter()
                .flat_map(|&beam| facts::partners(self.assembly, beam))
                .map(|(_, other)| other)
                .collect();
            beams.extend(next);
        }
        if reach > 0 {
            beams.extend(in_the_way);
        }
        names.extend(beams.iter().map(|&beam| self.assembly.beams[beam].beam.name.clone()));
        for connection in &self.assembly.connections {
            if beams.contains(&connection.female.beam) && beams.contains(&connection.male.beam) {
                names.insert(connection.name.clone());
            }
        }
        names
    }

    /// The states along some actions, by the definition of the language.
    pub(crate) fn walk(&self, start: &Fluents, actions: &[Term]) -> Result<Vec<Transition>, PlanError> {
        let mut before = start.clone();
        let mut transitions = Vec::new();
        for action in actions {
            let after = self
                .model
                .after(&before, action)
                .map_err(|refusal| self.refused(refusal, &action.to_string()))?;
            transitions.push(Transition { action: action.clone(), before, after: after.clone() });
            before = after;
        }
        Ok(transitions)
    }

    /// A plan of at most so many coarse actions for the whole goal, if there is one; and no plan is shorter than
    /// the number that comes with it.
    fn shorter(
        &mut self,
        start: &Fluents,
        least: usize,
        most: usize,
    ) -> Result<(Option<Vec<Term>>, usize), PlanError> {
        let mut problem = self.facts.all.clone();
        let told = self.model.inertial(start);
        problem.extend(told.into_iter().map(|fluent| Term::new("told", [fluent])));
        let goal = |(fluent, truth)| Term::new(if truth { "goal" } else { "avoid" }, [fluent]);
        problem.extend(self.model.goals().into_iter().map(goal));
        let mut solver = Solver { thorough: true, ..Solver::default() };
        let found = solve(&mut solver, self.domains.coarse(), &problem, [least, most]);
        self.solver.solves += solver.solves;
        match found {
            Ok(Some(found)) => {
                let steps = found.actions.len();
                Ok((Some(found.actions), steps))
            }
            Ok(None) => Ok((None, most + 1)),
            Err(PlanError::GaveUp { steps, .. }) => Ok((None, steps)),
            Err(error) => Err(error),
        }
    }

    // ---- Fine actions -----------------------------------------------------------------------------------------

    /// The coarse actions, each with the fine actions under it.
    pub(crate) fn steps(
        &mut self,
        transitions: &[Transition],
        known: &Known,
    ) -> Result<Vec<CoarseStep>, PlanError> {
        let above = Term::new("above", [state::area_name(known.area)]);
        let mut own = vec![Term::new("hand_at", [above])];
        let mut pegs = Pegs::new(self.assembly, known);
        let mut steps = Vec::new();
        for transition in transitions {
            let actions = if self.options.fine { self.refine(transition, &mut own)? } else { Vec::new() };
            let answers =
                Answers { assembly: self.assembly, pegs: &self.pegs, rules: self.domains.fine().file() };
            let (stands, deep) = self.standing(&transition.before);
            let coarse = answers.coarse_action(&transition.action, &mut pegs)?;
            let fine = actions.iter().map(|term| answers.fine_action(term, &stands, &deep, &mut pegs));
            steps.push(CoarseStep { coarse, fine: fine.collect::<Result<_, _>>()? });
        }
        Ok(steps)
    }

    /// Which beams stand in a coarse state, and which of them are pushed back.
    pub(crate) fn standing(&self, state: &Fluents) -> (Vec<bool>, Vec<bool>) {
        let beams = |fluent: &str| {
            let mut flags = vec![false; self.assembly.beams.len()];
            for term in self.model.true_of(state, fluent) {
                let index = term.texts().first().and_then(|name| self.numbers.get(*name));
                if let Some(flag) = index.and_then(|&index| flags.get_mut(index)) {
                    *flag = true;
                }
            }
            flags
        };
        (beams("in_assembly"), beams("deep"))
    }

    /// The fine actions for one coarse action. `own`: the fine fluents that have no coarse ones of their name,
    /// before and then after it.
    fn refine(&mut self, transition: &Transition, own: &mut Vec<Term>) -> Result<Vec<Term>, PlanError> {
        let fine = self.domains.fine();
        let mut names = self.model.relevant(&transition.before, &transition.action, &transition.after);
        for fluent in own.iter().filter(|fluent| matches!(fluent.parts(), Some(("hand_at", _)))) {
            names.extend(fluent.texts().into_iter().map(str::to_string));
        }
        let (stands, _) = self.standing(&transition.before);
        let pins = self.model.true_of(&transition.before, "pinned");
        let pins: BTreeSet<&str> = pins.iter().flat_map(Term::texts).collect();
        let connections = self.assembly.connections.iter();
        let pinned: Vec<bool> =
            connections.map(|connection| pins.contains(connection.name.as_str())).collect();
        let all = 0..self.assembly.beams.len();
        let zoom = self.options.zoom;
        let beams: Vec<usize> =
            all.filter(|&beam| !zoom || names.contains(&self.assembly.beams[beam].beam.name)).collect();
        let named = transition.action.texts();
        let handled = |beam: usize| !zoom || named.contains(&self.assembly.beams[beam].beam.name.as_str());
        let facts = facts::fine(self.assembly, &self.geometry, &beams, &handled, &stands, &pinned);
        // What belongs to a relevant thing is relevant.
        for fact in &facts {
            if let Some(("component", [part, whole])) = fact.parts()
                && whole.texts().iter().all(|text| names.contains(*text))
            {
                names.extend(part.texts().into_iter().map(str::to_string));
            }
        }
        let matters = |term: &Term| !zoom || term.texts().into_iter().all(|text| names.contains(text));
        let names = zoom.then_some(&names);
        let mut problem: Vec<Term> = self.facts.about(names).cloned().collect();
        problem.extend(facts.into_iter().filter(matters));
        let before = self.model.inertial_about(&transition.before, names);
        let shared =
            before.iter().filter(|fluent| name_of(fluent).is_some_and(|name| fine.kind(name).is_some()));
        let told = shared.chain(own.iter().filter(|fluent| matters(fluent)));
        problem.extend(told.map(|fluent| Term::new("told", [fluent.clone()])));
        // The coarse fluents that become true, as far as the fine domain knows of them.
        for fluent in self.model.gained(&transition.before, &transition.after) {
            let Some(name) = name_of(&fluent) else { continue };
            if fine.kind(name) == Some(Kind::Fluent(FluentKind::Inertial)) {
                problem.push(Term::new("goal", [fluent]));
            } else if fine.bridges(name) {
                problem.push(Term::new("goal", [Term::new("coarse", [fluent])]));
            }
        }
        let shape = Shape::of(&problem, &self.fine_names);
        let found = self.fine_answers.shortest(&mut self.solver, fine, &shape, MOST_FINE_STEPS)?;
        let Some(Found { actions, mut end }) = found else { return Err(self.no_fine_plan(transition)) };
        // Where the hand ends up, the next action begins. What was left out of sight stays, unless something else of
        // the kind has come: one hand has one place.
        end.retain(|fluent| name_of(fluent).is_some_and(|name| self.domains.coarse().kind(name).is_none()));
        end.sort();
        let names: BTreeSet<&str> = end.iter().filter_map(name_of).collect();
        own.retain(|fluent| !matters(fluent) && !name_of(fluent).is_some_and(|name| names.contains(name)));
        drop(names);
        own.extend(end);
        Ok(actions)
    }

    fn no_fine_plan(&mut self, transition: &Transition) -> PlanError {
        let texts = transition.action.texts();
        let beam = texts.iter().find(|text| self.assembly.beam_index(text).is_some());
        if let (Some(("pick_up", _)), Some(beam)) = (transition.action.parts(), beam) {
            self.ungrasped = self.ungrasped.or(self.assembly.beam_index(beam));
        }
        match (transition.action.parts(), beam) {
            (Some(("pick_up", _)), Some(beam)) => PlanError::Illegal {
                goal: self.assembly.name.clone(),
                why: format!(
                    "{beam} has no link that the hand can hold both where it starts and at its place"
                ),
                beams: vec![beam.to_string()],
            },
            (Some(("push" | "slide", _)), Some(beam)) => PlanError::Illegal {
                goal: self.assembly.name.clone(),
                why: format!("{beam} has no link that the hand can push it by"),
                beams: vec![beam.to_string()],
            },
            _ => self.no_plan(
                self.domains.fine().file().name(),
                &transition.action.to_string(),
                MOST_FINE_STEPS,
            ),
        }
    }

    /// How the beams of some transitions get to their places.
    fn entries(&self, transitions: &[Transition]) -> Vec<Entry> {
        let mut entries = Vec::new();
        for transition in transitions {
            let Some((name @ ("assemble" | "assemble_deep" | "lay_down"), [beam])) =
                transition.action.parts()
            else {
                continue;
            };
            let Some(beam) = beam.texts().first().and_then(|name| self.assembly.beam_index(name)) else {
                continue;
            };
            let (stands, _) = self.standing(&transition.before);
            if let Some((way, distance)) = self.geometry.way(beam, &stands, name == "lay_down") {
                let shuttles = self.geometry.shuttles.iter().filter(|shuttle| shuttle.beam == beam);
                let depth = shuttles.map(|shuttle| shuttle.depth).fold(0.0, f64::max);
                entries.push(Entry {
                    beam: self.assembly.beams[beam].beam.name.clone(),
                    direction: way.direction.into(),
                    distance,
                    depth: if name == "assemble_deep" { depth } else { 0.0 },
                });
            }
        }
        entries
    }

    // ---- Errors -----------------------------------------------------------------------------------------------

    fn no_plan(&self, file: &str, task: &str, steps: usize) -> PlanError {
        PlanError::NoPlan {
            goal: self.assembly.name.clone(),
            file: file.to_string(),
            task: task.to_string(),
            steps,
        }
    }

    /// The interpreter refuses what clingo found, or a state that was told.
    pub(crate) fn refused(&self, refusal: Refusal, what: &str) -> PlanError {
        let file = self.domains.coarse().file().name().to_string();
        PlanError::Refused { file, why: refusal_words(refusal, what) }
    }
}

fn refusal_words(refusal: Refusal, what: &str) -> String {
    match refusal {
        Refusal::Unknown(name) => format!("there is no action {name}"),
        Refusal::Impossible(reason) => {
            format!("{what} is impossible by line {}: {}", reason.line, reason.law)
        }
        Refusal::Contradiction(fluent) => format!("{what} makes {fluent} both true and false"),
    }
}

fn is_push(action: &Term) -> bool {
    name_of(action) == Some("push")
}

fn name_of(fluent: &Term) -> Option<&str> {
    fluent.parts().map(|(name, _)| name)
}

/// To the assembly and back with a push for every beam, the way there and back again, and the task itself.
fn most_steps(assembly: &Assembly) -> usize {
    assembly.beams.len().min(24) + 14
}

/// The hand begins over the sheet and every item costs it six actions: pick up, two moves, one to build it in, two
/// moves back. The last item does not need those two, but one move that leaves the hand free.
fn lower_bound(known: &Known) -> usize {
    let beams = known.stands.iter().filter(|stands| !**stands).count();
    let pegs = known.pinned.iter().filter(|pinned| pinned.is_none()).count();
    let held = usize::from(known.held_beam.is_some() || known.held_peg.is_some());
    // What is in the hand already needs to be built in, and the hand may be there.
    (6 * (beams + pegs)).saturating_sub(1 + 3 * held)
}

/// Which peg belongs to which connection.
pub(crate) struct Pegs {
    /// What is left of the pegs, by index, the next one last.
    free: Vec<usize>,
    /// The peg of each connection.
    of: Vec<Option<usize>>,
}

impl Pegs {
    pub(crate) fn new(assembly: &Assembly, known: &Known) -> Pegs {
        let of =
            if known.pinned.len() == assembly.connections.len() { known.pinned.clone() } else { Vec::new() };
        Pegs { free: known.pegs.iter().rev().copied().collect(), of }
    }

    /// The name of the peg for a connection: at the first mention, the next free one.
    pub(crate) fn name(&mut self, names: &[String], connection: usize) -> String {
        let chosen = self.of[connection].or_else(|| self.free.pop());
        self.of[connection] = chosen;
        // There are enough: they were counted before.
        chosen.map_or_else(String::new, |index| names[index].clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::shortest_by_clingo;
    use crate::{State, plan::CoarseAction};
    use std::path::Path;

    fn data() -> (Kit, Domains) {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
        (ramp_kit::read_kit(&data.join("kit.xml")).unwrap(), Domains::read(&data.join("domains")).unwrap())
    }

    fn goal(name: &str, kit: &Kit) -> Assembly {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../data/goals/{name}.xml"));
        ramp_assembly::read_goal(&file, kit).unwrap()
    }

    /// The program that is solved and the one that people read are the same.
    #[test]
    fn unrolling_agrees_with_clingos_own_grounder() {
        let (kit, domains) = data();
        let mut compared = 0;
        for name in ["easy-3", "medium-3", "hard-3"] {
            let assembly = goal(name, &kit);
            let known = state::look_up(&assembly, &kit, &State::default()).unwrap();
            let mut planner = Planner::new(&assembly, &kit, &domains, Options::default());
            planner.plan(&known).unwrap();
            for (answers, domain) in
                [(&planner.coarse_answers, domains.coarse()), (&planner.fine_answers, domains.fine())]
            {
                let program = domain.to_asp();
                for (problem, found) in &answers.0 {
                    let problem: String = problem.iter().map(|fact| format!("{fact}.\n")).collect();
                    let steps =
                        shortest_by_clingo(&format!("{program}#program base.\nresumed.\n{problem}"), 14);
                    let expected = found.as_ref().map(|found| found.actions.len());
                    assert_eq!(steps, expected, "{name}:\n{problem}");
                    compared += 1;
                }
            }
        }
        assert!(compared > 50, "only {compared} problems were compared");
    }

    #[test]
    fn looking_at_everything_gives_no_shorter_plan() {
        let (kit, domains) = data();
        for name in
            ["easy-1", "easy-2", "easy-3", "medium-1", "medium-2", "medium-3", "hard-1", "hard-2", "hard-3"]
        {
            let assembly = goal(name, &kit);
            let plan = |zoom| {
                let options = Options { zoom, ..Options::default() };
                plan_with(&assembly, &kit, &State::default(), &domains, options).unwrap()
            };
            let (zoomed, whole) = (plan(true), plan(false));
            assert_eq!(zoomed.steps.len(), whole.steps.len(), "{name}");
            assert_eq!(zoomed.fine().count(), whole.fine().count(), "{name}");
            assert!(whole.steps.iter().any(|step| matches!(step.coarse, CoarseAction::Fasten { .. })));
        }
    }
}
