//! Any external plan or observation is accepted or refused, without a panic and without a hang.

// A helper may panic as its test may.
#![allow(clippy::unwrap_used)]

mod common;
#[path = "../../ramp-action-language/tests/mangle/mod.rs"]
mod mangle;

use common::{domains, goal};
use mangle::{Dice, mangled};
use ramp_planner::{History, Record, State, diagnose, pddl_plan};

#[test]
fn plans_and_observations_are_read_or_refused() {
    let mut dice = Dice(2);
    let assembly = goal("easy-1");
    let plan = "(pick_up b4)\n(move intermediate)\n(move assembly)\n(assemble b4)\n";
    let observation = "-in_hand(beam(\"b4\"))";
    for _ in 0..60 {
        assert!(pddl_plan(&assembly, &State::default(), domains(), &mangled(plan, &mut dice)).is_err());
        let records = vec![Record::Saw(mangled(observation, &mut dice))];
        let _ = diagnose(&assembly, domains(), &History { records, ..History::default() });
    }
}
