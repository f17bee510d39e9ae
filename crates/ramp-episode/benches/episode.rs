//! Speed of a whole easy-3 episode on one core, beside raw MuJoCo stepping the same scene with the same
//! commands.
//!
//! Raw stepping is the lower bound: what is above it is the controller, the sensors, the referee, planning
//! and motion planning together. Prints the real-time factors and their ratio. Then the steps a second of the
//! twin in the world `real` over those in `ideal`.

#[path = "../tests/common/mod.rs"]
mod common;

use std::time::{Duration, Instant};

use common::World;
use mujoco_rs::prelude::*;
use ramp_episode::{Label, Progress, run_episode};
use ramp_result::episode::Software;
use ramp_robot::{
    Account, Agent, Camera, CameraModel, Command, Image, Observation, PartReading, Robot, RobotError,
};
use ramp_skills::Baseline;
use ramp_twin::Twin;

/// Notes every command's joint torques and finger forces as the twin applied them.
struct Recorder<'r> {
    robot: &'r mut Twin,
    commands: Vec<[f64; 9]>,
    /// The time that the twin's steps took.
    stepping: Duration,
}

impl Recorder<'_> {
    fn over(robot: &mut Twin) -> Recorder<'_> {
        Recorder { robot, commands: Vec::new(), stepping: Duration::ZERO }
    }

    fn steps_a_second(&self) -> f64 {
        self.commands.len() as f64 / self.stepping.as_secs_f64()
    }
}

impl Robot for Recorder<'_> {
    fn step(&mut self, command: &Command) -> Result<Observation, RobotError> {
        let begin = Instant::now();
        let result = self.robot.step(command);
        self.stepping += begin.elapsed();
        let mut applied = [0.0; 9];
        applied.copy_from_slice(&self.robot.ctrl()[..9]);
        self.commands.push(applied);
        result
    }

    fn observe(&self) -> Observation {
        self.robot.observe()
    }

    fn read_parts(&mut self) -> Result<Vec<PartReading>, RobotError> {
        self.robot.read_parts()
    }

    fn expose(&mut self) -> Result<(), RobotError> {
        self.robot.expose()
    }

    fn look(&mut self, camera: Camera) -> Result<Image, RobotError> {
        self.robot.look(camera)
    }

    fn camera(&self, camera: Camera) -> CameraModel {
        self.robot.camera(camera)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // `-- --short` asks whether it still runs to its end.
    let short = std::env::args().any(|argument| argument == "--short");
    let repeats = if short { 1 } else { 3 };
    let world = World::new("easy-3");
    let label = Label::new(Software { version: "bench".into(), commit: "bench".into() }, 1);
    let mut whole = Vec::new();
    let mut robot_time = 0.0;
    for _ in 0..repeats {
        let mut agent = Baseline::new(&world.assembly, &world.arm, &world.domains, 1);
        let begin = Instant::now();
        let result = run_episode(&world.setup(1), &mut agent, &label, &mut |_: &Progress, _: &Twin| {});
        whole.push(begin.elapsed().as_secs_f64());
        robot_time = result?.time.robot;
    }
    // Once more, noting what MuJoCo was given.
    let mut twin = Twin::new(&world.setup(1))?;
    let start = twin.qpos().to_vec();
    let scene = twin.scene().to_string();
    let mut recorder = Recorder::over(&mut twin);
    let mut agent = Baseline::new(&world.assembly, &world.arm, &world.domains, 1);
    agent.run(&mut recorder)?;
    let _: Account = agent.account();
    let commands = recorder.commands;
    let model = MjModel::from_xml_string(&scene).map_err(|error| format!("{error:?}"))?;
    let mut raw = Vec::new();
    let mut same = true;
    for _ in 0..repeats {
        let mut data = MjData::new(&model);
        data.qpos_mut().copy_from_slice(&start);
        data.forward();
        let begin = Instant::now();
        for command in &commands {
            data.ctrl_mut().copy_from_slice(command);
            data.step();
        }
        raw.push(begin.elapsed().as_secs_f64());
        same &= data.qpos().iter().zip(twin.qpos()).all(|(a, b)| a.to_bits() == b.to_bits());
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
    println!("ratio {:.2}; final states equal to the last bit: {same}", raw / whole);
    if !same {
        return Err("raw MuJoCo ends in another state than the episode".into());
    }
    worlds(&world, repeats)
}

/// Steps a second of the twin in both worlds, the same agent on the same goal; the fastest of several
/// episodes counts.
fn worlds(goal: &World, repeats: usize) -> Result<(), Box<dyn std::error::Error>> {
    let mut fastest = [0.0_f64; 2];
    for _ in 0..repeats {
        for (name, fastest) in ["ideal", "real"].into_iter().zip(&mut fastest) {
            let world = ramp_twin::World::shipped(name).ok_or("the world is not built in")?;
            let mut twin = Twin::new(&ramp_twin::Setup { world, ..goal.setup(1) })?;
            let mut agent = Baseline::new(&goal.assembly, &goal.arm, &goal.domains, 1);
            let mut recorder = Recorder::over(&mut twin);
            agent.run(&mut recorder)?;
            *fastest = fastest.max(recorder.steps_a_second());
        }
    }
    let [ideal, real] = fastest;
    println!("steps a second {ideal:.0} in `ideal`, {real:.0} in `real`, ratio {:.2}", real / ideal);
    Ok(())
}
