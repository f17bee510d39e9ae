//! Speed of motion planning on the motions that the nine goals ask for, and how long those motions take.
//!
//! The rehearsal goes through the plan of every goal, with the parts and the arm a little off their nominal
//! places by one seed after another. Its motions through free space are the queries: with and without a part
//! in the hand, among all parts and the current assembly. All are planned with the full limits of the arm's
//! velocities and accelerations.
//!
//! Printed: how many queries are solved, of those that have a free end at all; median and 99th percentile of
//! the planning time; and the time of the motions over that of a double integrator, which goes straight in
//! joint space at the arm's limits through everything: to the same end, and to whichever free end posture is
//! nearest. A motion that has to go up, across and down is longer than that.
//!
//! In the same run, with the same collision checks and the same law of time, the same queries go to
//! RRT-Connect as this software has it for a last resort (with shortcuts) and as the crate `oxmpl` has it
//! (without). Neither keeps a held beam level.

#![allow(clippy::print_stdout, clippy::print_stderr)]

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use oxmpl::base::error::StateSamplingError;
use oxmpl::base::goal::{Goal, GoalRegion, GoalSampleableRegion};
use oxmpl::base::planner::{Planner, PlannerConfig};
use oxmpl::base::problem_definition::ProblemDefinition;
use oxmpl::base::space::RealVectorStateSpace;
use oxmpl::base::state::RealVectorState;
use oxmpl::base::validity::StateValidityChecker;
use oxmpl::geometric::RRTConnect;
use ramp_motion::{Analytic, Checker, Joints, Kinematics, MotionError, Pace, PathPlanner, Terms, TimeLaw};
use ramp_planner::{Domains, State};
use ramp_robot::DOF;
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;
use ramp_skills::rehearsal::{Leg, Rehearsal};
use ramp_skills::{Parameters, Pose};

/// Number of times each query is planned; the fastest counts, since other programs share the processor.
const REPEATS: usize = 3;
/// Offset of the parts from their places, m and rad.
const OFF: (f64, f64) = (2e-3, 0.03);
/// Offset of the arm from its home pose, rad.
const AWAY: f64 = 0.1;
/// Distance of end postures from the ends of the joints' ranges, rad.
const RANGE_MARGIN: f64 = 0.05;
/// Time after which `oxmpl` gives up.
const LONGEST: Duration = Duration::from_millis(500);
/// Largest step of its trees, rad, and the share of samples that are the goal; samples on an edge are as far
/// from each other as in this software's search.
const OXMPL: (f64, f64) = (0.5, 0.05);
/// Distance of those samples, rad.
const EDGE_SAMPLE: f64 = 0.05;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // `-- --short` asks whether it still runs to its end.
    let short = std::env::args().any(|argument| argument == "--short");
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let arm = ArmModel::read(&data.join("arms/panda.json"))?;
    let queries = queries(&data, &arm, if short { 1 } else { 5 })?;
    let queries: Vec<Leg> = if short { queries.into_iter().step_by(20).collect() } else { queries };
    let bench = Bench::new(&arm)?;
    let (mut answers, mut blocked, mut unsolved) = (Vec::new(), 0, Vec::new());
    for (number, query) in queries.iter().enumerate() {
        match bench.ask(number, query) {
            Ok(answer) => answers.push((query, answer)),
            Err(None) => blocked += 1,
            Err(Some(error)) => unsolved.push(format!("query {number}: {error}")),
        }
    }
    if answers.is_empty() {
        return Err("no query was solved".into());
    }
    let feasible = answers.len() + unsolved.len();
    println!("{} queries; {blocked} have no free start or end", queries.len());
    println!(
        "solved {} of {feasible} ({:.1} %)",
        answers.len(),
        100.0 * answers.len() as f64 / feasible as f64
    );
    unsolved.iter().for_each(|line| println!("  {line}"));
    println!(
        "{:26} {:>7} {:>9} {:>9} {:>9} {:>12} {:>12}",
        "", "solved", "median", "p99", "largest", "over double", "integrator"
    );
    println!(
        "{:26} {:>7} {:>9} {:>9} {:>9} {:>12} {:>12}",
        "", "", "ms", "ms", "ms", "same ends", "best ends"
    );
    let all: Vec<&Answer> = answers.iter().map(|(_, answer)| answer).collect();
    let of = |which: fn(&Leg) -> bool| -> Vec<&Answer> {
        answers.iter().filter(|(leg, _)| which(leg)).map(|(_, answer)| answer).collect()
    };
    let own = row("this planner", &all, |answer| Some(answer.own));
    row("  empty hand", &of(|leg| leg.held.is_empty()), |answer| Some(answer.own));
    row("  with a part", &of(|leg| !leg.held.is_empty()), |answer| Some(answer.own));
    let tree = row("RRT-Connect, shortcuts", &all, |answer| answer.tree);
    let oxmpl = row("RRT-Connect of oxmpl", &all, |answer| answer.oxmpl);
    println!("median over that of this planner: RRT-Connect {:.1}, oxmpl {:.1}", tree / own, oxmpl / own);
    Ok(())
}

/// A motion that was found: the time that planning took and that of the motion, s.
#[derive(Clone, Copy)]
struct Found {
    planning: f64,
    motion: f64,
}

/// The outcome of a query.
struct Answer {
    own: Found,
    tree: Option<Found>,
    oxmpl: Option<Found>,
    /// Time of the double integrator to the end of this planner's motion, s.
    same: f64,
    /// Its time to the nearest free end, s.
    best: f64,
}

/// Prints a line of the table; the median planning time, ms.
fn row(name: &str, answers: &[&Answer], found: impl Fn(&Answer) -> Option<Found>) -> f64 {
    let solved: Vec<(Found, &Answer)> =
        answers.iter().filter_map(|answer| Some((found(answer)?, *answer))).collect();
    let mut times: Vec<f64> = solved.iter().map(|(found, _)| found.planning * 1e3).collect();
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times.get((share * times.len() as f64) as usize).copied().unwrap_or(f64::NAN);
    let motion: f64 = solved.iter().map(|(found, _)| found.motion).sum();
    let over =
        |bound: fn(&Answer) -> f64| motion / solved.iter().map(|(_, answer)| bound(answer)).sum::<f64>();
    println!(
        "{name:26} {:>7} {:>9.2} {:>9.2} {:>9.2} {:>12.2} {:>12.2}",
        solved.len(),
        at(0.5),
        at(0.99),
        times.last().unwrap_or(&f64::NAN),
        over(|answer| answer.same),
        over(|answer| answer.best),
    );
    at(0.5)
}

/// The motions that the nine goals ask for, once for each seed.
fn queries(data: &Path, arm: &ArmModel, seeds: u64) -> Result<Vec<Leg>, Box<dyn std::error::Error>> {
    let kit = ramp_kit::read_kit(&data.join("kit.xml"))?;
    let domains = Domains::read(&data.join("domains"))?;
    let (planner, state) = (PathPlanner::new(arm), State::default());
    let mut legs = Vec::new();
    for class in ["easy", "medium", "hard"] {
        for number in 1..=3 {
            let name = format!("{class}-{number}");
            let goal = ramp_assembly::read_goal(&data.join(format!("goals/{name}.xml")), &kit)?;
            let plan = ramp_planner::plan(&goal, &state, &domains)?;
            for seed in 0..seeds {
                let mut stream = Stream::new(seed, &name);
                let mut off = |x: Pose| {
                    let shift = Vector3::new(stream.symmetric(OFF.0), stream.symmetric(OFF.0), 0.0);
                    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), stream.symmetric(OFF.1));
                    let place = Translation3::from(x.translation.vector + shift);
                    Pose::from_parts(place, turn * x.rotation)
                };
                let beams =
                    kit.beams.iter().filter_map(|beam| Some((beam.name.clone(), kit.x_wb_start(beam)?)));
                let pegs = kit.pegs.iter().filter_map(|peg| Some((peg.name.clone(), kit.x_wp_start(peg)?)));
                let base = goal.beams[goal.base].beam.name.clone();
                let believed: Vec<(String, Pose)> = beams
                    .filter(|(name, _)| *name != base)
                    .chain(pegs)
                    .map(|(name, x)| (name, off(x)))
                    .collect();
                let home = Joints::from(arm.home).map(|angle| angle + stream.symmetric(AWAY));
                let rehearsal = Rehearsal::of_baseline(&goal, arm, &planner, &state);
                legs.extend(rehearsal.from_here(believed, home, seed).legs(&plan));
            }
        }
    }
    Ok(legs)
}

/// The inputs that all queries share.
struct Bench<'a> {
    arm: &'a ArmModel,
    planner: PathPlanner,
    analytic: Analytic,
    law: TimeLaw,
    parameters: Arc<Parameters>,
}

impl<'a> Bench<'a> {
    fn new(arm: &'a ArmModel) -> Result<Bench<'a>, Box<dyn std::error::Error>> {
        let law = TimeLaw::new(arm, &Pace { velocity: 1.0, acceleration: 1.0, jerk: 1.0, ramp: 0.0 });
        let (planner, analytic) = (PathPlanner::new(arm), Analytic::new(arm)?);
        Ok(Bench { arm, planner, analytic, law, parameters: Parameters::baseline() })
    }

    /// The reason for a missing answer: the planner's error, or `None` when the start or every end touches
    /// something or is out of reach.
    fn ask(&self, number: usize, query: &Leg) -> Result<Answer, Option<MotionError>> {
        let travel = &self.parameters.travel;
        let checker = Checker::new(self.arm, query.open, query.held.clone(), &query.around, travel.margin);
        let free = |q: &Joints| checker.is_free(&self.planner.kinematics.frames(q));
        let nearest = self.analytic.best(&query.x_wt, RANGE_MARGIN, |end| {
            if free(end) { self.double_integrator(&query.q, end) } else { f64::INFINITY }
        });
        let best = nearest.filter(|_| free(&query.q)).ok_or(None)?.cost;
        let terms = Terms { height: travel.height, level: query.level, checker: &checker, law: &self.law };
        let stream = || Stream::new(number as u64, "query");
        let (motion, planning) = fastest(|| self.planner.plan(&query.q, &query.x_wt, &terms, &mut stream()));
        let motion = motion?;
        let own = Found { planning, motion: motion.duration() };
        let (tree, planning) =
            fastest(|| self.planner.plan_to(&query.q, &motion.end(), &terms, &mut stream()));
        let tree = tree.ok().map(|tree| Found { planning, motion: tree.duration() });
        let same = self.double_integrator(&query.q, &motion.end());
        let oxmpl = self.oxmpl(number, query, checker, &motion.end());
        Ok(Answer { own, tree, oxmpl, same, best })
    }

    /// Time of every joint straight from rest to rest at its largest velocity and acceleration, s; the
    /// largest of all joints.
    fn double_integrator(&self, from: &Joints, to: &Joints) -> f64 {
        let joint = |joint: usize| {
            let (way, limits) = ((to[joint] - from[joint]).abs(), &self.arm.joints[joint]);
            let (v, a) = (limits.velocity, limits.acceleration);
            if way < v * v / a { 2.0 * (way / a).sqrt() } else { way / v + v / a }
        };
        (0..DOF).map(joint).fold(0.0, f64::max)
    }

    /// The same query by `oxmpl`, to one end posture.
    fn oxmpl(&self, number: usize, query: &Leg, checker: Checker, end: &Joints) -> Option<Found> {
        let ranges = self.arm.joints.iter().map(|joint| (joint.range[0], joint.range[1])).collect();
        let mut space = RealVectorStateSpace::new(DOF, Some(ranges)).ok()?;
        // It samples edges at a tenth of this share of the space's extent.
        space.set_longest_valid_segment_fraction(10.0 * EDGE_SAMPLE / space.get_maximum_extent());
        let state = |q: &Joints| RealVectorState { values: q.iter().copied().collect() };
        let problem = Arc::new(ProblemDefinition {
            space: Arc::new(space),
            start_states: vec![state(&query.q)],
            goal: Arc::new(End(state(end))),
        });
        let valid: Arc<dyn StateValidityChecker<RealVectorState>> =
            Arc::new(Valid { kinematics: self.planner.kinematics.clone(), checker });
        let (way, planning) = fastest(|| {
            let config = PlannerConfig { seed: Some(number as u64) };
            let mut planner = RRTConnect::new(OXMPL.0, OXMPL.1, &config);
            planner.setup(problem.clone(), valid.clone());
            let way = planner.solve(LONGEST)?.0;
            let corners: Vec<Joints> =
                way.iter().map(|state| Joints::from_iterator(state.values.iter().copied())).collect();
            let parts = corners.windows(2).map(|pair| {
                let count = ((pair[1] - pair[0]).amax() / EDGE_SAMPLE).ceil().max(1.0) as usize;
                let line: Vec<Joints> =
                    (0..=count).map(|i| pair[0].lerp(&pair[1], i as f64 / count as f64)).collect();
                self.law.time(&line).duration()
            });
            Ok::<f64, oxmpl::base::error::PlanningError>(parts.sum())
        });
        Some(Found { planning, motion: way.ok()? })
    }
}

/// The answer of a call, and the shortest time that it took, s.
fn fastest<T>(call: impl Fn() -> T) -> (T, f64) {
    let timed = || {
        let begin = Instant::now();
        let answer = call();
        (answer, begin.elapsed().as_secs_f64())
    };
    let (mut answer, mut least) = timed();
    for _ in 1..REPEATS {
        let (again, time) = timed();
        if time < least {
            (answer, least) = (again, time);
        }
    }
    (answer, least)
}

/// One end posture.
struct End(RealVectorState);

impl Goal<RealVectorState> for End {
    fn is_satisfied(&self, state: &RealVectorState) -> bool {
        self.distance_goal(state) < 1e-9
    }
}

impl GoalRegion<RealVectorState> for End {
    fn distance_goal(&self, state: &RealVectorState) -> f64 {
        let apart = state.values.iter().zip(&self.0.values).map(|(a, b)| (a - b).abs());
        apart.fold(0.0, f64::max)
    }
}

impl GoalSampleableRegion<RealVectorState> for End {
    fn sample_goal(&self, _: &mut impl rand::Rng) -> Result<RealVectorState, StateSamplingError> {
        Ok(self.0.clone())
    }
}

/// True if the arm is collision-free at the joint positions.
struct Valid {
    kinematics: Kinematics,
    checker: Checker,
}

impl StateValidityChecker<RealVectorState> for Valid {
    fn is_valid(&self, state: &RealVectorState) -> bool {
        let q = Joints::from_iterator(state.values.iter().copied());
        self.checker.is_free(&self.kinematics.frames(&q))
    }
}
