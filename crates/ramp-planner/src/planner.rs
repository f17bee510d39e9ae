//! From an assembly and a state to a plan: the order of the beams, then coarse actions, then fine ones.
//!
//! What may be done, and how, stands in the rule files; here their answers are carried from level to level.

use crate::domains::Domains;
use crate::error::PlanError;
use crate::facts;
use crate::plan::{
    Area, CoarseAction, CoarseStep, FineAction, Grasp, Item, Place, Plan, State, Statistics, Target,
};
use crate::shape::Shape;
use crate::solver::{Shortest, Solver};
use crate::state::{self, Known};
use crate::term::Term;
use ramp_assembly::Assembly;
use ramp_kit::Kit;
use ramp_kit::source::SourceFile;
use std::collections::HashMap;

/// The most fine actions in one coarse action; the rules never need more than four.
const MOST_FINE_STEPS: i32 = 8;

/// Plans what is left to do to build an assembly.
///
/// The same input always gives the same plan. The beams follow the assembly's proven order; from task to task (a
/// beam placed, a peg in its hole) the coarse actions are the fewest that the rules allow.
///
/// # Errors
/// When the state cannot be, when the rules say that the goal cannot be built or needs what they do not model yet,
/// when the pegs do not suffice, or when a rule file gives an answer that means nothing here.
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
    let known = state::look_up(assembly, kit, state)?;
    let needed = known.pinned.iter().filter(|pinned| !**pinned).count();
    if needed > known.pegs.len() {
        return Err(PlanError::Pegs { goal: assembly.name.clone(), needed, left: known.pegs.len() });
    }
    let mut planner = Planner { assembly, kit, domains, solver: Solver::default() };
    let order = planner.order(&known)?;
    let coarse = planner.coarse(&order, &known)?;
    let steps = planner.fine(&coarse, &known)?;
    let statistics = Statistics { solves: planner.solver.solves, optimal: is_shortest(&steps) };
    Ok(Plan { steps, statistics })
}

/// Is no plan shorter, for this order of the beams?
///
/// The hand begins over the sheet and every item costs it six actions: pick up, two moves, one to build it in, two
/// moves back. The last item does not need those two, but one move that leaves the hand free. A push is only ever
/// made where the next insertion or peg is not allowed without it. More actions than these may have been necessary
/// for a push before the first item; that is not proven.
fn is_shortest(steps: &[CoarseStep]) -> bool {
    let count = |wanted: fn(&CoarseAction) -> bool| steps.iter().filter(|step| wanted(&step.coarse)).count();
    let items = count(|action| matches!(action, CoarseAction::PickUp { .. }));
    let pushes = count(|action| matches!(action, CoarseAction::Push { .. }));
    steps.is_empty() || steps.len() < 6 * items + pushes
}

/// What every step of planning needs.
struct Planner<'a> {
    assembly: &'a Assembly,
    kit: &'a Kit,
    domains: &'a Domains,
    solver: Solver,
}

/// A coarse action in the terms of the rules, with the fluents before it.
struct CoarseTerm {
    action: Term,
    before: Vec<Term>,
}

impl Planner<'_> {
    /// The beams that are not in yet, by index, in the order in which they are to be placed.
    fn order(&mut self, known: &Known) -> Result<Vec<usize>, PlanError> {
        let rules = self.domains.order();
        let mut facts = facts::goal(self.assembly);
        facts::order(&mut facts, self.assembly, known);
        let solved = self.solver.best(rules, &facts).map_err(|error| PlanError::solver(rules, &error))?;
        let no_order = || self.no_plan(rules, "an order of the beams", 0);
        let answer = solved.ok_or_else(no_order)?;
        self.raise_problem(rules, &answer)?;

        let mut before = Vec::new();
        for term in &answer {
            if let Some(("before", arguments)) = term.parts() {
                let [first, second] = arguments else { return Err(meaningless(rules, term)) };
                before.push((self.beam(rules, first)?, self.beam(rules, second)?));
            }
        }
        // Again and again, the first beam of the proven order that waits for no other.
        let rank = |beam: usize| {
            let proven = self.assembly.insertions.iter().position(|insertion| insertion.beam == beam);
            (proven.unwrap_or(usize::MAX), beam)
        };
        let mut placed = known.stands.clone();
        let mut order = Vec::new();
        while let Some(next) = (0..placed.len())
            .filter(|&beam| !placed[beam])
            .filter(|&beam| before.iter().all(|&(first, second)| second != beam || placed[first]))
            .min_by_key(|&beam| rank(beam))
        {
            placed[next] = true;
            order.push(next);
        }
        if placed.contains(&false) { Err(no_order()) } else { Ok(order) }
    }

    /// The coarse actions, task by task.
    fn coarse(&mut self, order: &[usize], known: &Known) -> Result<Vec<CoarseTerm>, PlanError> {
        let rules = self.domains.coarse();
        let failed = |error| PlanError::solver(rules, &error);
        let mut facts = facts::goal(self.assembly);
        for (position, &beam) in order.iter().enumerate() {
            let name = self.assembly.beams[beam].beam.name.as_str();
            facts.push(Term::new("position", [name.into(), position.into()]));
        }
        let problem = |state: &[Term]| [&facts[..], &initially(state)[..]].concat();
        let mut state = facts::state(self.assembly, known);

        let answer = self.solver.best(rules, &problem(&state)).map_err(failed)?.unwrap_or_default();
        self.raise_problem(rules, &answer)?;
        let mut tasks = Vec::new();
        for term in &answer {
            if let Some(("task", arguments)) = term.parts() {
                let [key, task] = arguments else { return Err(meaningless(rules, term)) };
                tasks.push((key, task));
            }
        }
        tasks.sort();

        // To the assembly and back with a push for every beam, the way there and back again, and the task itself.
        let most = i32::try_from(self.assembly.beams.len()).unwrap_or(i32::MAX).saturating_add(12);
        let mut actions = Vec::new();
        for (_, task) in tasks {
            let mut problem = problem(&state);
            problem.push(Term::new("goal", [task.clone()]));
            let found = self.solver.shortest(rules, &problem, most).map_err(failed)?;
            let found = found.ok_or_else(|| self.no_plan(rules, &task.to_string(), most))?;
            let timeline = Timeline::of(rules, found)?;
            let steps = timeline.actions.into_iter().zip(timeline.before);
            actions.extend(steps.map(|(action, before)| CoarseTerm { action, before }));
            // Where this task ends, the next begins.
            state = timeline.end;
        }
        Ok(actions)
    }

    /// The fine actions under each coarse action.
    fn fine(&mut self, coarse: &[CoarseTerm], known: &Known) -> Result<Vec<CoarseStep>, PlanError> {
        let rules = self.domains.fine();
        let failed = |error| PlanError::solver(rules, &error);
        let mut pegs = Pegs { free: known.pegs.iter(), of: vec![None; self.assembly.connections.len()] };
        let mut state = vec![Term::new("at", [Term::new("above", [Term::new("input", [])])])];
        let mut solved: HashMap<String, Shortest> = HashMap::new();
        let mut steps = Vec::new();
        for CoarseTerm { action, before } in coarse {
            let facts = [self.zoom(action, before), initially(&state)].concat();
            let shape = Shape::of(&facts);
            let key = shape.facts.iter().map(Term::to_string).collect();
            let mut found = match solved.get(&key) {
                Some(found) => found.clone(),
                None => match self.solver.shortest(rules, &shape.facts, MOST_FINE_STEPS).map_err(failed)? {
                    Some(found) => solved.entry(key).or_insert(found).clone(),
                    None => {
                        // Without a goal there is an answer, and in it the rules may say why.
                        let answer = self.solver.best(rules, &facts).map_err(failed)?.unwrap_or_default();
                        self.raise_problem(rules, &answer)?;
                        return Err(self.no_plan(rules, &action.to_string(), MOST_FINE_STEPS));
                    }
                },
            };
            found.shown = found.shown.iter().map(|term| shape.name(term)).collect();

            let receives = self.receives(&found);
            let timeline = Timeline::of(rules, found)?;
            state = timeline.end;
            let coarse = self.coarse_action(action, &mut pegs)?;
            let fine = timeline.actions.iter().map(|term| self.fine_action(term, &receives, &mut pegs));
            steps.push(CoarseStep { coarse, fine: fine.collect::<Result<_, _>>()? });
        }
        Ok(steps)
    }

    /// What the fine rules see of a coarse action: only the beams that it names, and of the state before it only
    /// what concerns the beams that those meet.
    fn zoom(&self, action: &Term, before: &[Term]) -> Vec<Term> {
        let mut facts = vec![Term::new("coarse", [action.clone()])];
        for beam in action.texts().into_iter().filter_map(|name| self.assembly.beam_index(name)) {
            facts::beam(&mut facts, self.assembly, self.kit, beam);
            let partners: Vec<&str> = facts::partners(self.assembly, beam)
                .map(|(_, other)| self.assembly.beams[other].beam.name.as_str())
                .collect();
            let concerns = |fluent: &&Term| fluent.texts().iter().any(|text| partners.contains(text));
            facts.extend(before.iter().filter(concerns).map(|fluent| Term::new("before", [fluent.clone()])));
        }
        facts
    }

    /// The joints that a cap puts over males, from j1 to jn.
    fn receives(&self, found: &Shortest) -> Vec<String> {
        let shown = found.shown.iter().filter(|term| matches!(term.parts(), Some(("receives", _))));
        let received: Vec<&str> = shown.flat_map(Term::texts).collect();
        let joints = self.assembly.beams.iter().flat_map(|placed| &placed.beam.joints);
        joints.map(|joint| joint.name.clone()).filter(|name| received.contains(&name.as_str())).collect()
    }

    fn no_plan(&self, rules: &SourceFile, task: &str, steps: i32) -> PlanError {
        PlanError::NoPlan {
            goal: self.assembly.name.clone(),
            file: rules.name().to_string(),
            task: task.to_string(),
            steps,
        }
    }

    /// The first problem of an answer as an error; what cannot be comes before what is not modelled.
    fn raise_problem(&self, rules: &SourceFile, answer: &[Term]) -> Result<(), PlanError> {
        let mut problems = Vec::new();
        for term in answer {
            let Some(("problem", arguments)) = term.parts() else { continue };
            match arguments {
                [kind, words] => problems.push((kind, words.texts().join(" "))),
                _ => return Err(meaningless(rules, term)),
            }
        }
        problems.sort();
        let goal = self.assembly.name.clone();
        match problems.into_iter().next() {
            None => Ok(()),
            Some((kind, why)) => match kind.parts() {
                Some(("illegal", [])) => Err(PlanError::Illegal { goal, why }),
                Some(("unmodelled", [])) => Err(PlanError::NotModelled { goal, why }),
                _ => Err(meaningless(rules, kind)),
            },
        }
    }

    fn coarse_action(&self, term: &Term, pegs: &mut Pegs) -> Result<CoarseAction, PlanError> {
        let rules = self.domains.coarse();
        Ok(match term.parts() {
            Some(("move", [to])) => CoarseAction::Move { to: area(rules, to)? },
            Some(("pick_up", [item])) => CoarseAction::PickUp { item: self.item(rules, item, pegs)? },
            Some(("put_down", [item])) => CoarseAction::PutDown { item: self.item(rules, item, pegs)? },
            Some(("assemble", [beam])) => CoarseAction::Assemble { beam: self.beam_name(rules, beam)? },
            Some(("fasten", [connection])) => {
                let index = self.connection(rules, connection)?;
                let peg = self.peg(index, pegs);
                CoarseAction::Fasten { connection: self.assembly.connections[index].name.clone(), peg }
            }
            Some(("push", [beam])) => CoarseAction::Push { beam: self.beam_name(rules, beam)? },
            _ => return Err(meaningless(rules, term)),
        })
    }

    fn fine_action(
        &self,
        term: &Term,
        receives: &[String],
        pegs: &mut Pegs,
    ) -> Result<FineAction, PlanError> {
        let rules = self.domains.fine();
        Ok(match term.parts() {
            Some(("move", [to])) => FineAction::Move { to: self.place(rules, to, pegs)? },
            Some(("pick_up", [item, grasp])) => {
                let grasp = match grasp.parts() {
                    Some(("link", [link])) => Grasp::Link(text(rules, link)?),
                    Some(("head", [])) => Grasp::Head,
                    _ => return Err(meaningless(rules, term)),
                };
                FineAction::PickUp { item: self.item(rules, item, pegs)?, grasp }
            }
            Some(("put_down", [item])) => FineAction::PutDown { item: self.item(rules, item, pegs)? },
            Some(("assemble_square", [beam, joint])) => {
                FineAction::AssembleSquare { beam: self.beam_name(rules, beam)?, joint: text(rules, joint)? }
            }
            Some(("assemble_cap", [beam])) => {
                FineAction::AssembleCap { beam: self.beam_name(rules, beam)?, joints: receives.to_vec() }
            }
            Some(("fasten", [connection])) => {
                let index = self.connection(rules, connection)?;
                let pair = &self.assembly.connections[index];
                FineAction::Fasten {
                    connection: pair.name.clone(),
                    female: self.assembly.joint_name(pair.female).to_string(),
                    male: self.assembly.joint_name(pair.male).to_string(),
                    peg: self.peg(index, pegs),
                }
            }
            Some(("push", [beam, link])) => {
                FineAction::Push { beam: self.beam_name(rules, beam)?, link: text(rules, link)? }
            }
            _ => return Err(meaningless(rules, term)),
        })
    }

    fn place(&self, rules: &SourceFile, term: &Term, pegs: &mut Pegs) -> Result<Place, PlanError> {
        match term.parts() {
            Some(("above", [of])) => Ok(Place::Above(area(rules, of)?)),
            Some(("input", [item])) => Ok(Place::Input(self.item(rules, item, pegs)?)),
            Some(("approach", [of])) => Ok(Place::Approach(self.target(rules, of)?)),
            Some(("target", [of])) => Ok(Place::Target(self.target(rules, of)?)),
            _ => Err(meaningless(rules, term)),
        }
    }

    fn target(&self, rules: &SourceFile, term: &Term) -> Result<Target, PlanError> {
        match term.parts() {
            Some(("beam", [beam])) => Ok(Target::Beam(self.beam_name(rules, beam)?)),
            Some(("hole", [connection])) => {
                let index = self.connection(rules, connection)?;
                Ok(Target::Connection(self.assembly.connections[index].name.clone()))
            }
            _ => Err(meaningless(rules, term)),
        }
    }

    fn item(&self, rules: &SourceFile, term: &Term, pegs: &mut Pegs) -> Result<Item, PlanError> {
        match term.parts() {
            Some(("beam", [beam])) => Ok(Item::Beam(self.beam_name(rules, beam)?)),
            Some(("peg", [connection])) => {
                let index = self.connection(rules, connection)?;
                Ok(Item::Peg(self.peg(index, pegs)))
            }
            _ => Err(meaningless(rules, term)),
        }
    }

    /// The name of the peg for a connection: at the first mention, the next free one of the kit.
    fn peg(&self, connection: usize, pegs: &mut Pegs) -> String {
        let chosen = pegs.of[connection].or_else(|| pegs.free.next().copied());
        pegs.of[connection] = chosen;
        // There are enough: they were counted before.
        chosen.map_or_else(String::new, |index| self.kit.pegs[index].name.clone())
    }

    fn beam(&self, rules: &SourceFile, term: &Term) -> Result<usize, PlanError> {
        self.assembly.beam_index(&text(rules, term)?).ok_or_else(|| meaningless(rules, term))
    }

    fn beam_name(&self, rules: &SourceFile, term: &Term) -> Result<String, PlanError> {
        Ok(self.assembly.beams[self.beam(rules, term)?].beam.name.clone())
    }

    fn connection(&self, rules: &SourceFile, term: &Term) -> Result<usize, PlanError> {
        self.assembly.connection_index(&text(rules, term)?).ok_or_else(|| meaningless(rules, term))
    }
}

/// Which peg belongs to which connection.
struct Pegs<'a> {
    /// What is left of the kit's pegs, by index.
    free: std::slice::Iter<'a, usize>,
    /// The peg of each connection.
    of: Vec<Option<usize>>,
}

/// The answer of a level, sorted by time.
struct Timeline {
    /// What is done at times 1, 2, …
    actions: Vec<Term>,
    /// What holds before each of them.
    before: Vec<Vec<Term>>,
    /// What holds in the end.
    end: Vec<Term>,
}

impl Timeline {
    /// Sorts the terms `do(action,t)` and `holds(fluent,t)` of a plan.
    fn of(rules: &SourceFile, plan: Shortest) -> Result<Timeline, PlanError> {
        let length = usize::try_from(plan.steps).unwrap_or(0);
        let mut actions: Vec<Option<Term>> = vec![None; length];
        let mut before = vec![Vec::new(); length];
        let mut end = Vec::new();
        for term in plan.shown {
            let Some((name @ ("do" | "holds"), arguments)) = term.parts() else { continue };
            let [what, Term::Number(time)] = arguments else { return Err(meaningless(rules, &term)) };
            let time = usize::try_from(*time).unwrap_or(usize::MAX);
            if name == "holds" {
                let fluents = if time == length { Some(&mut end) } else { before.get_mut(time) };
                fluents.ok_or_else(|| meaningless(rules, &term))?.push(what.clone());
            } else {
                // An action at time t leads from time t - 1 to time t.
                let slot = actions.get_mut(time.wrapping_sub(1)).filter(|slot| slot.is_none());
                *slot.ok_or_else(|| meaningless(rules, &term))? = Some(what.clone());
            }
        }
        before.iter_mut().for_each(|fluents| fluents.sort());
        end.sort();
        let actions = actions.into_iter().collect::<Option<Vec<Term>>>();
        let actions = actions.ok_or_else(|| PlanError::Answer {
            file: rules.name().to_string(),
            answer: "a time without an action".to_string(),
        })?;
        Ok(Timeline { actions, before, end })
    }
}

/// Fluents as the facts from which a problem begins.
fn initially(fluents: &[Term]) -> Vec<Term> {
    fluents.iter().map(|fluent| Term::new("initially", [fluent.clone()])).collect()
}

fn text(rules: &SourceFile, term: &Term) -> Result<String, PlanError> {
    match term {
        Term::Text(text) => Ok(text.clone()),
        _ => Err(meaningless(rules, term)),
    }
}

fn area(rules: &SourceFile, term: &Term) -> Result<Area, PlanError> {
    match term.parts() {
        Some(("input", [])) => Ok(Area::Input),
        Some(("intermediate", [])) => Ok(Area::Intermediate),
        Some(("assembly", [])) => Ok(Area::Assembly),
        _ => Err(meaningless(rules, term)),
    }
}

fn meaningless(rules: &SourceFile, term: &Term) -> PlanError {
    PlanError::Answer { file: rules.name().to_string(), answer: term.to_string() }
}
