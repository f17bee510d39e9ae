//! Speed of a whole easy-3 episode on one core, beside raw MuJoCo stepping the same scene with the same
//! commands.
//!
//! Raw stepping walks through all shapes, also those that nothing can meet. Prints the real-time factors and
//! their ratio, and until when the states are equal to the last bit: until the first peg is seated, whose
//! stem the twin lets meet a simpler hole. Then the steps a second of the twin in the world `real` over those
//! in `ideal`.
//!
//! `-- --profile [GOAL] [WORLD]` prints another table: where the engine's steps go, by situation.

#![allow(clippy::print_stdout, clippy::print_stderr)]

mod profile;

use std::time::{Duration, Instant};

use mujoco_rs::prelude::*;
use ramp_episode::{Label, Progress, run_episode};
use ramp_result::episode::Software;
use ramp_robot::{Account, Agent, Command, Observation, RobotError, Track};
use ramp_testing::GoalFiles;
use ramp_testing::robot::{Alteration, Altered};
use ramp_twin::Twin;

/// Commands between two states that are compared: 0.5 s.
const EVERY: usize = 500;
/// For so long the states are equal at least, s: the first peg is seated later.
const EQUAL: f64 = 5.0;

/// The joint torques and finger forces of every command, as the twin applied them.
#[derive(Default)]
struct Recorder {
    commands: Vec<[f64; 9]>,
    begin: Option<Instant>,
    /// Positions after every [`EVERY`] commands.
    states: Vec<Vec<f64>>,
    /// The time that the twin's steps took.
    stepping: Duration,
}

impl Recorder {
    fn over(robot: &mut Twin) -> Altered<'_, Twin, Recorder> {
        Altered { robot, alteration: Recorder::default() }
    }

    fn steps_a_second(&self) -> f64 {
        self.commands.len() as f64 / self.stepping.as_secs_f64()
    }
}

impl Alteration<Twin> for Recorder {
    fn before(&mut self, _twin: &Twin, _command: &mut Command) -> Result<(), RobotError> {
        self.begin = Some(Instant::now());
        Ok(())
    }

    fn after(&mut self, twin: &Twin, _command: &Command, _seen: &Observation) -> Result<(), RobotError> {
        self.stepping += self.begin.take().map_or(Duration::ZERO, |begin| begin.elapsed());
        let mut applied = [0.0; 9];
        applied.copy_from_slice(&twin.ctrl()[..9]);
        self.commands.push(applied);
        if self.commands.len().is_multiple_of(EVERY) {
            self.states.push(twin.qpos().to_vec());
        }
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // `-- --short` asks whether it still runs to its end.
    let arguments: Vec<String> = std::env::args().skip(1).filter(|it| it != "--bench").collect();
    if let Some(at) = arguments.iter().position(|it| it == "--profile") {
        let named = |offset: usize| arguments.get(at + offset).map(String::as_str);
        return profile::print(named(1).unwrap_or("hard-1"), named(2).unwrap_or("real"));
    }
    let short = arguments.iter().any(|it| it == "--short");
    let repeats = if short { 1 } else { 3 };
    let world = GoalFiles::new("easy-3");
    let label = Label::new(Software { version: "bench".into(), commit: "bench".into() }, 1);
    let mut whole = Vec::new();
    let mut robot_time = 0.0;
    for _ in 0..repeats {
        let mut agent = world.baseline(Track::State, 1);
        let begin = Instant::now();
        let result =
            run_episode(&world.setup(Track::State, 1), &mut agent, &label, &mut |_: &Progress, _: &Twin| {});
        whole.push(begin.elapsed().as_secs_f64());
        robot_time = result?.time.robot;
    }
    // Once more, noting what MuJoCo was given.
    let mut twin = Twin::new(&world.setup(Track::State, 1))?;
    let start = twin.qpos().to_vec();
    let scene = twin.scene().to_string();
    let mut recorder = Recorder::over(&mut twin);
    let mut agent = world.baseline(Track::State, 1);
    agent.run(&mut recorder)?;
    let _: Account = agent.account();
    let Recorder { commands, states, .. } = recorder.alteration;
    let model = MjModel::from_xml_string(&scene).map_err(|error| format!("{error:?}"))?;
    let mut raw = Vec::new();
    let mut equal = 0;
    for _ in 0..repeats {
        let mut data = MjData::new(&model);
        data.qpos_mut().copy_from_slice(&start);
        data.forward();
        let begin = Instant::now();
        let mut reached = Vec::new();
        for (index, command) in commands.iter().enumerate() {
            data.ctrl_mut().copy_from_slice(command);
            data.step();
            if (index + 1).is_multiple_of(EVERY) {
                reached.push(data.qpos().to_vec());
            }
        }
        raw.push(begin.elapsed().as_secs_f64());
        let is_same =
            |(a, b): &(&Vec<f64>, &Vec<f64>)| a.iter().zip(*b).all(|(a, b)| a.to_bits() == b.to_bits());
        equal = reached.iter().zip(&states).take_while(is_same).count();
    }
    let best = |times: &[f64]| times.iter().copied().fold(f64::MAX, f64::min);
    let (whole, raw) = (best(&whole), best(&raw));
    println!("easy-3, seed 1, one core, best of {repeats}");
    println!(
        "whole episode  {robot_time:7.1} s of robot time in {whole:6.2} s: {:5.1} x real time",
        robot_time / whole
    );
    println!(
        "raw MuJoCo     {robot_time:7.1} s of robot time in {raw:6.2} s: {:5.1} x real time",
        robot_time / raw
    );
    let equal = (equal * EVERY) as f64 * ramp_robot::PERIOD;
    println!("ratio {:.2}; states equal to the last bit until {equal:.1} s", raw / whole);
    if equal < EQUAL {
        return Err("raw MuJoCo reaches another state than the episode".into());
    }
    worlds(&world, repeats)
}

/// Steps a second of the twin in both worlds, the same agent on the same goal; the fastest of the
/// repeats counts.
fn worlds(goal: &GoalFiles, repeats: usize) -> Result<(), Box<dyn std::error::Error>> {
    let mut fastest = [0.0_f64; 2];
    for _ in 0..repeats {
        for (name, fastest) in ["ideal", "real"].into_iter().zip(&mut fastest) {
            let world = ramp_twin::World::shipped(name).ok_or("the world is not built in")?;
            let mut twin = Twin::new(&ramp_twin::Setup { world, ..goal.setup(Track::State, 1) })?;
            let mut agent = goal.baseline(Track::State, 1);
            let mut recorder = Recorder::over(&mut twin);
            agent.run(&mut recorder)?;
            *fastest = fastest.max(recorder.alteration.steps_a_second());
        }
    }
    let [ideal, real] = fastest;
    println!("steps a second {ideal:.0} in `ideal`, {real:.0} in `real`, ratio {:.2}", real / ideal);
    Ok(())
}
