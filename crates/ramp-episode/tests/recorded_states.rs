//! Episodes end in the recorded state, to the last bit. A change that is not meant to change results keeps
//! them all.
//!
//! `cargo test` runs easy-3. All eighteen episodes on record, of the worlds `ideal` and `real`, take some
//! minutes: `cargo test --release --workspace --test recorded_states -- --ignored`. A change that is meant to
//! change results rewrites the record: `RAMP_WRITE=1` before that command.
//!
//! Processors differ in the last bits of sines and roots, so the record holds for one kind of them. Its first
//! line is a probe of these functions. On a processor with another probe the comparisons are skipped.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::print_stderr)]

use std::process::ExitCode;

use ramp_result::EpisodeResult;
use ramp_robot::Track;
use ramp_testing::GoalFiles;
use ramp_testing::trials::{check, check_unless, run};
use ramp_twin::{Setup, Start, World};

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/recorded_states.csv");
const HEAD: &str = "goal,world,start,track,seed,state";

/// A hash of what this processor makes of functions that the standard does not fix to the last bit.
fn probe() -> String {
    let mut bits = 0_u64;
    for step in 1..2000 {
        let x = f64::from(step) * 0.013;
        for y in [x.sin(), x.cos(), x.tan(), x.atan2(1.7), x.exp(), x.ln(), x.powf(0.37), (x / 30.0).acos()] {
            bits = bits.rotate_left(5) ^ y.to_bits().wrapping_mul(0x9e37_79b9_7f4a_7c15);
        }
    }
    format!("{bits:016x}")
}

/// The episodes on record: goal, world, start, track, seed and state.
fn record() -> (String, Vec<[String; 6]>) {
    let text = std::fs::read_to_string(FILE).unwrap();
    let mut lines = text.lines();
    let found = lines.next().unwrap().strip_prefix("probe,").unwrap().to_string();
    assert_eq!(lines.next().unwrap(), HEAD);
    let rows = lines.map(|line| {
        let cells: Vec<String> = line.split(',').map(str::to_string).collect();
        cells.try_into().unwrap()
    });
    (found, rows.collect())
}

fn episode([goal, world, start, track, seed, _]: &[String; 6]) -> EpisodeResult {
    let track = Track::ALL.into_iter().find(|it| it.name() == track).unwrap();
    let (world, start) = (World::shipped(world).unwrap(), Start::shipped(start).unwrap());
    let files = GoalFiles::new(goal);
    files.run_setup(&Setup { world, start, ..files.setup(track, seed.parse().unwrap()) })
}

fn state(result: &EpisodeResult) -> String {
    result.physics.as_ref().unwrap().state.clone()
}

/// Why nothing can be compared here.
fn missing() -> Option<String> {
    let (probed, _) = record();
    (probed != probe()).then(|| "the record is of another kind of processor".to_string())
}

/// Runs the wanted episodes, and `check`s the results of those that end in the recorded state.
fn compare(wanted: impl Fn(&[String; 6]) -> bool, check: impl Fn(&EpisodeResult)) {
    let (_, rows) = record();
    for row in rows.iter().filter(|row| wanted(row)) {
        let [goal, world, start, track, seed, recorded] = row;
        let name = format!("{goal}, world {world}, start {start}, track {track}, seed {seed}");
        let result = episode(row);
        let found = state(&result);
        println!("{name}: {found}");
        assert_eq!(found, *recorded, "{name}");
        check(&result);
    }
}

fn easy_3_ends_in_the_recorded_states() {
    compare(
        |[goal, world, _, _, seed, _]| goal == "easy-3" && world == "ideal" && seed == "1",
        |result| assert_eq!((result.ended.reason.as_str(), result.counted()), ("done", result.pegs.len())),
    );
}

fn all_episodes_end_in_the_recorded_states() {
    compare(|_| true, |_| {});
}

/// Runs all episodes on record and writes their states, with the probe of this processor.
fn write() {
    let (_, rows) = record();
    let lines = rows.iter().map(|row| {
        let [goal, world, start, track, seed, _] = row;
        format!("{goal},{world},{start},{track},{seed},{}\n", state(&episode(row)))
    });
    let text = format!("probe,{}\n{HEAD}\n{}", probe(), lines.collect::<String>());
    std::fs::write(FILE, text).unwrap();
}

fn main() -> ExitCode {
    let all = "all_episodes_end_in_the_recorded_states";
    let long = if std::env::var_os("RAMP_WRITE").is_some() {
        check(all, write)
    } else {
        check_unless(all, missing, all_episodes_end_in_the_recorded_states)
    };
    run(vec![
        check_unless("easy_3_ends_in_the_recorded_states", missing, easy_3_ends_in_the_recorded_states),
        long.with_ignored_flag(true),
    ])
}
