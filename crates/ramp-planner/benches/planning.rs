//! CPU time, wall time and memory of planning: `cargo bench -p ramp-planner`.
//!
//! Every goal is planned from nothing, five times; the fastest counts. Generated frames have 20 to
//! 200 beams. `--optimal` also proves the easy goals optimal, one horizon after another. `--short`
//! plans each goal once and fewer frames, as a smoke test.

#![allow(clippy::print_stdout, clippy::print_stderr)]

use ramp_assembly::{Assembly, Request, generate, read_goal, read_goal_str};
use ramp_kit::{read_kit, read_kit_str};
use ramp_planner::{Domains, Options, State, plan, plan_with};
use std::error::Error;
use std::path::Path;
use std::time::{Duration, Instant};

/// Runs per goal; the fastest counts.
const REPEATS: usize = 5;

fn main() -> Result<(), Box<dyn Error>> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let kit = read_kit(&data.join("kit.xml"))?;
    let domains = Domains::read(&data.join("domains"))?;
    let short = std::env::args().any(|argument| argument == "--short");
    let repeats = if short { 1 } else { REPEATS };
    println!(
        "{:18} {:>7} {:>7} {:>7} {:>8} {:>9} {:>9} {:>11}",
        "goal", "coarse", "bound", "fine", "solves", "CPU, ms", "wall, ms", "memory, MiB"
    );
    for class in ["easy", "medium", "hard"] {
        for number in 1..=3 {
            let name = format!("{class}-{number}");
            let assembly = read_goal(&data.join(format!("goals/{name}.xml")), &kit)?;
            measure(&name, &assembly, &domains, repeats)?;
        }
    }
    for beams in if short { vec![20, 100] } else { vec![20, 50, 100, 200] } {
        let made = generate(&kit, Request { beams, seed: 1, class: None })?;
        let text = made.kit.as_deref().ok_or("a frame comes with a kit")?;
        let larger = read_kit_str("kit.xml", text)?;
        let assembly = read_goal_str("frame.xml", &made.goal, &larger)?;
        measure(&format!("{beams} beams"), &assembly, &domains, 1)?;
    }
    if std::env::args().any(|argument| argument == "--optimal") {
        for name in ["easy-1", "easy-2", "easy-3"] {
            let assembly = read_goal(&data.join(format!("goals/{name}.xml")), &kit)?;
            let begin = cpu_time();
            let options = Options { optimal: true, ..Options::default() };
            let found = plan_with(&assembly, &State::default(), &domains, options)?;
            let (steps, optimal) = (found.steps.len(), found.statistics.optimal);
            println!("{name}: {steps} coarse actions, proven optimal: {optimal}, {:?}", cpu_time() - begin);
        }
    }
    Ok(())
}

fn measure(name: &str, assembly: &Assembly, domains: &Domains, repeats: usize) -> Result<(), Box<dyn Error>> {
    let mut fastest = [Duration::MAX; 2];
    let mut found = None;
    for _ in 0..repeats {
        let (begin, wall) = (cpu_time(), Instant::now());
        found = Some(plan(assembly, &State::default(), domains)?);
        fastest = [fastest[0].min(cpu_time() - begin), fastest[1].min(wall.elapsed())];
    }
    let found = found.ok_or("nothing was planned")?;
    let [cpu, wall] = fastest.map(|time| time.as_secs_f64() * 1e3);
    println!(
        "{name:18} {:7} {:7} {:7} {:8} {cpu:9.0} {wall:9.0} {:11.0}",
        found.steps.len(),
        found.statistics.lower_bound,
        found.fine().count(),
        found.statistics.solves,
        memory()
    );
    Ok(())
}

/// CPU time of this thread, or wall time where the system does not report it.
fn cpu_time() -> Duration {
    static BEGIN: std::sync::LazyLock<Instant> = std::sync::LazyLock::new(Instant::now);
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.as_deref().and_then(|text| text.split(' ').next()?.parse().ok());
    nanoseconds.map_or_else(|| BEGIN.elapsed(), Duration::from_nanos)
}

/// Peak memory of the process so far, MiB; 0 where the system does not report it.
fn memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak =
        status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.split_whitespace().next()?.parse().ok());
    peak.unwrap_or(0.0) / 1024.0
}
