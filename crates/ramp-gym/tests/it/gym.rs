//! Environments: the same bits for any number of threads, after a reset, and as in a trial; what they refuse.

use std::path::Path;
use std::sync::Arc;

use ramp_abilities::manipulation::Aim;
use ramp_gym::start::Prepared;
use ramp_gym::{
    Batch, Begin, Benchmark, Env, EnvError, Frame, Mission, Options, SKILLS, Scenario, Step, Weights,
};
use ramp_robot::random::Stream;
use ramp_robot::{Robot, Track};
use ramp_twin::{Start, World};

fn benchmark() -> Arc<Benchmark> {
    Arc::new(Benchmark::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data")).unwrap())
}

fn scenario(skill: &str, goals: &[&str], track: Track) -> Scenario {
    let goals: Vec<String> = goals.iter().map(|it| (*it).to_string()).collect();
    Scenario::skill(
        benchmark(),
        skill,
        &goals,
        track,
        World::ideal().clone(),
        Start::sheet().clone(),
        Begin::Ready,
    )
    .unwrap()
}

fn fasten() -> Env {
    let options = Options { starts: (1, 2), weights: Weights::shaped(), ..Options::default() };
    Env::new(Arc::new(scenario("fasten", &["easy-3"], Track::State)), options).unwrap()
}

/// Random actions of one environment.
fn actions(seed: u64, count: usize, width: usize) -> Vec<Vec<f64>> {
    let mut stream = Stream::new(seed, "actions");
    (0..count).map(|_| (0..width).map(|_| stream.symmetric(1.0)).collect()).collect()
}

fn row(env: &Env) -> Vec<f32> {
    let mut row = vec![0.0; env.width()];
    env.observe(&mut row);
    row
}

#[test]
fn threads_change_no_bit() {
    let mut single = fasten();
    let mut alone = Vec::new();
    for seed in 5..9 {
        single.reset(Some(seed)).unwrap();
        let steps: Vec<Step> =
            actions(seed, 30, single.actions()).iter().map(|it| single.step(it).unwrap()).collect();
        alone.push((steps, row(&single), single.twin().unwrap().state_hash()));
    }
    for threads in [1, 2, 3, 64] {
        let mut batch = Batch::new(&single, 4, threads).unwrap();
        let seeds: Vec<_> = (5..9).map(|seed| Some(Some(seed))).collect();
        batch.reset(&seeds).unwrap();
        let rows: Vec<Vec<Vec<f64>>> = (5..9).map(|seed| actions(seed, 30, single.actions())).collect();
        let mut steps: Vec<Vec<Step>> = vec![Vec::new(); 4];
        for step in 0..30 {
            let flat: Vec<f64> = rows.iter().flat_map(|rows| rows[step].clone()).collect();
            for (index, outcome) in batch.step(&flat, false).unwrap().into_iter().enumerate() {
                steps[index].push(outcome.step);
            }
        }
        let mut observed = vec![0.0; 4 * single.width()];
        batch.observe(&mut observed);
        for (index, (steps_alone, row_alone, hash)) in alone.iter().enumerate() {
            assert_eq!(&steps[index], steps_alone, "{threads} threads");
            assert_eq!(&observed[index * single.width()..][..single.width()], row_alone.as_slice());
            assert_eq!(batch.state_hashes()[index], *hash);
        }
    }
}

#[test]
fn an_episode_is_the_same_after_others() {
    let mut env = fasten();
    let run = |env: &mut Env| {
        env.reset(Some(3)).unwrap();
        let first = row(env);
        let steps: Vec<Step> = actions(3, 20, env.actions()).iter().map(|it| env.step(it).unwrap()).collect();
        (first, steps, row(env), env.twin().unwrap().state_hash())
    };
    let once = run(&mut env);
    for seed in [8, 9, 10] {
        env.reset(Some(seed)).unwrap();
        env.step(&vec![0.3; env.actions()]).unwrap();
    }
    assert!(run(&mut env) == once);
}

/// A random agent: the arm may stop, a part may fall, and each says so; nothing panics and nothing else ends
/// an episode.
#[test]
fn random_actions_end_no_episode_without_a_cause() {
    let mut env = fasten();
    for seed in 0..3 {
        env.reset(Some(seed)).unwrap();
        for action in actions(seed, 250, env.actions()) {
            let step = env.step(&action).unwrap();
            assert!(row(&env).iter().all(|it| it.is_finite()));
            assert_eq!(step.terminated, step.success || step.cause.is_some());
            if step.terminated || step.truncated {
                assert!(env.step(&action).unwrap().terminated, "an episode that is over stays so");
                break;
            }
        }
    }
}

#[test]
fn what_is_no_action_is_refused_or_ends_the_episode() {
    let mut env = fasten();
    assert!(matches!(env.step(&[0.0; 7]), Err(EnvError::NotReset)));
    env.reset(Some(1)).unwrap();
    assert!(matches!(env.step(&[0.0; 3]), Err(EnvError::Length { found: 3, expected: 7 })));
    let mut action = vec![0.0; 7];
    action[2] = f64::NAN;
    let step = env.step(&action).unwrap();
    assert!(step.terminated && step.cause.is_some_and(|cause| cause.contains("finite")));
}

/// Each skill begins where the baseline starts it: something is to be done, and nothing is done yet.
#[test]
fn every_skill_has_a_start() {
    let benchmark = benchmark();
    for skill in SKILLS {
        let (world, start) = (World::ideal().clone(), Start::moved().clone());
        let scenario =
            Scenario::skill(Arc::clone(&benchmark), skill, &[], Track::State, world, start, Begin::Ready)
                .unwrap();
        let mut env = Env::new(Arc::new(scenario), Options { starts: (1, 1), ..Options::default() }).unwrap();
        env.reset(Some(1)).unwrap();
        let step = env.step(&vec![0.0; env.actions()]).unwrap();
        assert!(!step.terminated, "{skill}: {step:?}");
        assert!(step.progress.distance() > 1e-4, "{skill}: {step:?}");
        let start: &Prepared = env.start().unwrap();
        let known = start.known.as_ref().unwrap();
        let holds = !matches!(skill, "pick-up-peg" | "push" | "slide");
        assert_eq!(known.held.is_some(), holds, "{skill}");
    }
}

/// With the whole scene and the arm at home, the start is that of a trial to the last bit.
#[test]
fn a_start_at_home_is_that_of_a_trial() {
    let mut scenario = scenario("push", &["medium-1"], Track::State);
    scenario.begin = Begin::Home;
    scenario.whole_scene = true;
    scenario.frame = Frame::Free;
    let mut env = Env::new(Arc::new(scenario), Options { starts: (4, 1), ..Options::default() }).unwrap();
    env.reset(Some(1)).unwrap();
    let start = env.start().unwrap();
    let (goal, step) = start.task;
    let setup = env.scenario().setup(goal, start.seed);
    let task = &env.scenario().goals[goal].steps[step].task;
    let trial = ramp_abilities::manipulation::draw(&setup, task, &Default::default()).unwrap();
    assert_eq!(trial.twin.state_hash(), start.twin.state_hash());
    assert_eq!(trial.twin.observe(), start.twin.observe());
}

/// In a rigid frame the parts that stand have no joint, but for those that a step moves: the peg in the hand,
/// and the beam that it pins. In a free one all but the clamped beam have one.
#[test]
fn only_what_a_skill_moves_is_free_in_a_rigid_frame() {
    let free_parts = |frame: Frame| {
        let mut scenario = scenario("fasten", &["medium-2"], Track::State);
        let Mission::Skill { steps, .. } = &mut scenario.mission else { panic!("it is a skill") };
        steps.drain(..steps.len() - 1);
        scenario.frame = frame;
        let mut env = Env::new(Arc::new(scenario), Options { starts: (1, 1), ..Options::default() }).unwrap();
        env.reset(Some(1)).unwrap();
        let twin = env.twin().unwrap();
        let names: Vec<String> = twin.part_names().map(str::to_string).collect();
        let is_free = |name: &String| twin.scene().contains(&format!(r#"<freejoint name="{name}"/>"#));
        let (free, fixed): (Vec<String>, Vec<String>) = names.into_iter().partition(is_free);
        (free, fixed, env)
    };
    let (free, fixed, env) = free_parts(Frame::Rigid);
    let start = env.start().unwrap();
    let goal = &env.scenario().goals[start.task.0];
    let Aim::Pinned { connection } = goal.steps[start.task.1].task.aim else { panic!("it fastens") };
    let male = goal.assembly.connections[connection].male.beam;
    let peg = &start.known.as_ref().unwrap().held.as_ref().unwrap().part;
    let mut moved = vec![goal.assembly.beams[male].beam.name.clone(), peg.clone()];
    moved.sort();
    assert_eq!(free, moved, "fixed: {fixed:?}");
    let (free, fixed, _) = free_parts(Frame::Free);
    assert_eq!(fixed, [goal.assembly.beams[goal.assembly.base].beam.name.clone()], "free: {free:?}");
}

/// A peg that is moved straight down slides to its seat with little force, in both frames.
#[test]
fn a_straight_insertion_takes_little_force() {
    for frame in [Frame::Rigid, Frame::Free] {
        let mut scenario = scenario("fasten", &["easy-3"], Track::State);
        scenario.frame = frame;
        let options = Options { starts: (1, 1), periods: 10, ..Options::default() };
        let mut env = Env::new(Arc::new(scenario), options).unwrap();
        env.reset(Some(1)).unwrap();
        let weight = env.twin().unwrap().observe().wrench.z;
        let mut on_the_way = 0.0_f64;
        let mut is_done = false;
        for _ in 0..800 {
            let mut action = vec![0.0; env.actions()];
            action[2] = -0.5;
            let step = env.step(&action).unwrap();
            let force = weight - env.twin().unwrap().observe().wrench.z;
            if step.progress.off.z > 1e-3 && step.progress.off.z < 15e-3 {
                on_the_way = on_the_way.max(force.abs());
            }
            is_done = step.success;
            if step.terminated {
                break;
            }
        }
        assert!(is_done, "{frame:?}: it meets something before its seat");
        assert!(on_the_way < 5.0, "{frame:?}: {on_the_way} N on the way");
    }
}

/// Starts that were made ahead on threads are those of later resets.
#[test]
fn starts_made_ahead_are_those_of_resets() {
    let mut late = fasten();
    let mut early = fasten();
    early.prepare(2).unwrap();
    for seed in 1..4 {
        late.reset(Some(seed)).unwrap();
        early.reset(Some(seed)).unwrap();
        let hash = |env: &Env| env.twin().unwrap().state_hash();
        assert_eq!(hash(&late), hash(&early));
    }
}

/// A whole goal: the pegs that count are rewarded, and time ends it.
#[test]
fn a_goal_runs_out_of_time() {
    let benchmark = benchmark();
    let assembly = benchmark.goal("easy-1").unwrap();
    let scenario =
        Scenario::goal(benchmark, assembly, Track::Noisy, World::ideal().clone(), Start::moved().clone());
    let options = Options { limit: 0.5, ..Options::default() };
    let mut env = Env::new(Arc::new(scenario), options).unwrap();
    env.reset(Some(1)).unwrap();
    let mut steps = 0;
    loop {
        steps += 1;
        let step = env.step(&vec![0.0; env.actions()]).unwrap();
        assert!(!step.terminated && step.completion == 0.0);
        if step.truncated {
            break;
        }
    }
    assert_eq!(steps, 10);
}

/// A goal of the open class is one environment, by its name and by its file.
#[test]
fn goals_of_the_open_class_are_environments() {
    const GOAL: &str = "open-2026-small-01";
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../data/goals/open-2026/{GOAL}.xml"));
    let rows = [GOAL, file.to_str().unwrap()].map(|goal| {
        let options = Options { starts: (1, 1), ..Options::default() };
        let mut env = Env::new(Arc::new(scenario("fasten", &[goal], Track::State)), options).unwrap();
        env.reset(Some(3)).unwrap();
        for it in actions(3, 5, env.actions()) {
            env.step(&it).unwrap();
        }
        row(&env)
    });
    assert_eq!(rows[0], rows[1]);
    assert!(rows[0].iter().any(|value| *value != 0.0));
}
