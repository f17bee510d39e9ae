//! Time in the stages of the engine's steps, by situation: from its own timers, on track `state`, seed 1.

use std::collections::BTreeMap;
use std::time::Instant;

use ramp_robot::{Agent, Command, Observation, RobotError, Track};
use ramp_testing::GoalFiles;
use ramp_testing::robot::{Alteration, Altered};
use ramp_twin::profile::{Load, Situation, StageTimes, measure_stages};
use ramp_twin::{Setup, Twin, World};

/// The periods of one situation.
#[derive(Default)]
struct Sum {
    times: StageTimes,
    loads: Vec<Load>,
}

/// Sums by situation, and the times so far.
#[derive(Default)]
struct Profiler {
    sums: BTreeMap<Situation, Sum>,
    before: StageTimes,
}

impl Alteration<Twin> for Profiler {
    fn after(&mut self, twin: &Twin, _command: &Command, _seen: &Observation) -> Result<(), RobotError> {
        let (now, load) = (twin.stage_times(), twin.load());
        let sum = self.sums.entry(load.situation).or_default();
        for (total, now, before) in [
            (&mut sum.times.step, now.step, self.before.step),
            (&mut sum.times.kinematics, now.kinematics, self.before.kinematics),
            (&mut sum.times.broad, now.broad, self.before.broad),
            (&mut sum.times.narrow, now.narrow, self.before.narrow),
            (&mut sum.times.constraints, now.constraints, self.before.constraints),
            (&mut sum.times.solver, now.solver, self.before.solver),
        ] {
            *total += now - before;
        }
        sum.loads.push(load);
        self.before = now;
        Ok(())
    }
}

/// The mean of some numbers, and the number that 95 % of them do not exceed.
fn mean_and_most(mut numbers: Vec<usize>) -> String {
    numbers.sort_unstable();
    let mean = numbers.iter().sum::<usize>() as f64 / numbers.len() as f64;
    format!("{mean:.0}, {}", numbers[(numbers.len() - 1) * 95 / 100])
}

/// Lets the baseline build the goal, and prints the table.
pub fn print(goal: &str, world: &str) -> Result<(), Box<dyn std::error::Error>> {
    let files = GoalFiles::new(goal);
    let world = World::shipped(world).ok_or("the world is not built in")?;
    measure_stages();
    let mut twin = Twin::new(&Setup { world, ..files.setup(Track::State, 1) })?;
    let mut agent = files.baseline(Track::State, 1);
    let mut robot = Altered { robot: &mut twin, alteration: Profiler::default() };
    let begin = Instant::now();
    agent.run(&mut robot)?;
    let whole = begin.elapsed().as_secs_f64();
    let sums = robot.alteration.sums;
    let steps: usize = sums.values().map(|sum| sum.loads.len()).sum();
    let engine: f64 = sums.values().map(|sum| sum.times.step).sum();
    println!("{goal}, {}, state, seed 1: {steps} steps", world.name);
    println!("{whole:.1} s, {:.0} % of them in the engine\n", 1e2 * engine / whole);
    println!(
        "| situation | steps, % | time, % | µs a step | poses | broad | narrow | rows | solver | rest | contacts, 95 % | rows, 95 % | awake |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for situation in Situation::ALL {
        let Some(Sum { times, loads }) = sums.get(&situation) else { continue };
        let count = loads.len() as f64;
        let stages = [times.kinematics, times.broad, times.narrow, times.constraints, times.solver];
        let rest = times.step - stages.iter().sum::<f64>();
        let columns: Vec<String> =
            stages.iter().chain([&rest]).map(|time| format!("{:.0}", 1e6 * time / count)).collect();
        println!(
            "| {} | {:.1} | {:.0} | {:.0} | {} | {} | {} | {:.1} |",
            situation.name(),
            1e2 * count / steps as f64,
            1e2 * times.step / engine,
            1e6 * times.step / count,
            columns.join(" | "),
            mean_and_most(loads.iter().map(|load| load.contacts).collect()),
            mean_and_most(loads.iter().map(|load| load.rows).collect()),
            loads.iter().map(|load| load.awake).sum::<usize>() as f64 / count,
        );
    }
    Ok(())
}
