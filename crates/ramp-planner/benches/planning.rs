//! CPU time of planning, and what the obvious way costs: `cargo bench -p ramp-planner`.
//!
//! The obvious way hands the whole goal to the coarse rules at once, in one program for each number of steps from
//! one up, until there is a plan. It has no fine actions, and the order of the beams is given to it. Its plan is
//! proven to be the shortest, so it also says whether planning from task to task loses anything.

use clingo::{Part, SolveMode, Symbol, TruthValue};
use ramp_assembly::{Assembly, JointRef, read_goal};
use ramp_kit::read_kit;
use ramp_planner::{Domains, State, plan};
use std::error::Error;
use std::fmt::Write;
use std::path::Path;
use std::time::{Duration, Instant};

/// How often each goal is planned; the fastest counts.
const REPEATS: usize = 5;

fn main() -> Result<(), Box<dyn Error>> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let kit = read_kit(&data.join("kit.xml"))?;
    let domains = Domains::read(&data.join("domains"))?;
    println!(
        "{:10} {:>7} {:>7} {:>10} {:>13} {:>7}",
        "goal", "coarse", "fine", "CPU, ms", "obvious, ms", "ratio"
    );
    for name in ["easy-1", "easy-2", "easy-3", "medium-1", "hard-2", "hard-1"] {
        let assembly = read_goal(&data.join(format!("goals/{name}.xml")), &kit)?;
        let state = State::default();
        let found = plan(&assembly, &kit, &state, &domains)?;
        let mut fastest = Duration::MAX;
        for _ in 0..REPEATS {
            let begin = cpu_time();
            plan(&assembly, &kit, &state, &domains)?;
            fastest = fastest.min(cpu_time() - begin);
        }
        let ms = |time: Duration| time.as_secs_f64() * 1e3;
        print!("{name:10} {:7} {:7} {:10.0}", found.steps.len(), found.fine().count(), ms(fastest));
        // With more items the obvious way takes minutes.
        if name.starts_with("easy") {
            let begin = cpu_time();
            let steps = obvious(&assembly, &domains)?;
            let time = cpu_time() - begin;
            assert_eq!(steps, found.steps.len(), "{name}: the obvious way finds another length");
            print!(" {:13.0} {:7.1}", ms(time), ms(time) / ms(fastest));
        }
        println!();
    }
    Ok(())
}

/// The length of the shortest coarse plan, by one program after another.
fn obvious(assembly: &Assembly, domains: &Domains) -> Result<usize, Box<dyn Error>> {
    let facts = whole_goal(assembly)?;
    for steps in 1..200 {
        let mut control = clingo::control(vec!["--warn=none".to_string()])?;
        control.add("base", &[], domains.coarse().text())?;
        control.add("base", &[], &facts)?;
        let at = |part: &str, time: i32| Part::new(part, vec![Symbol::create_number(time)]);
        let mut parts = vec![Part::new("base", vec![])?, at("state", 0)?];
        for time in 1..=steps {
            parts.extend([at("step", time)?, at("state", time)?]);
        }
        control.ground(&parts)?;
        let query = clingo::parse_term(&format!("query({steps})"))?;
        let atom = control.symbolic_atoms()?.iter()?.find(|atom| atom.symbol().is_ok_and(|s| s == query));
        let literal = atom.ok_or("the rules have no query")?.literal()?;
        control.assign_external(literal, TruthValue::True)?;
        let mut handle = control.solve(SolveMode::YIELD, &[])?;
        if handle.model()?.is_some() {
            return Ok(usize::try_from(steps)?);
        }
    }
    Err("no plan".into())
}

/// The facts that `coarse.lp` reads, with all that is to be reached as one goal.
fn whole_goal(assembly: &Assembly) -> Result<String, std::fmt::Error> {
    let mut facts = "initially(at(input)). goal(at(intermediate)).\n".to_string();
    for (index, placed) in assembly.beams.iter().enumerate() {
        let name = &placed.beam.name;
        writeln!(facts, "beam({name:?}).")?;
        match assembly.insertions.iter().position(|insertion| insertion.beam == index) {
            Some(position) => writeln!(
                facts,
                "position({name:?},{position}). initially(on_sheet(beam({name:?}))). goal(in_assembly({name:?}))."
            )?,
            None => writeln!(facts, "base({name:?}). initially(in_assembly({name:?})).")?,
        }
    }
    for (rank, pair) in assembly.connections.iter().enumerate() {
        let name = &pair.name;
        let side = |joint: JointRef| (&assembly.beams[joint.beam].beam.name, assembly.joint_name(joint));
        let ((f, j), (m, k)) = (side(pair.female), side(pair.male));
        writeln!(facts, "connection({name:?},{f:?},{j:?},{m:?},{k:?}). rank({name:?},{rank}).")?;
        writeln!(facts, "initially(on_sheet(peg({name:?}))). goal(pinned({name:?})).")?;
    }
    Ok(facts)
}

/// CPU time of this thread where the system tells it, otherwise the time that passes.
fn cpu_time() -> Duration {
    static BEGIN: std::sync::LazyLock<Instant> = std::sync::LazyLock::new(Instant::now);
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.as_deref().and_then(|text| text.split(' ').next()?.parse().ok());
    nanoseconds.map_or_else(|| BEGIN.elapsed(), Duration::from_nanos)
}
