//! Any external plan or observation is accepted or refused, without a panic and without a hang.

use crate::common::{domains, goal};
use ramp_planner::{History, Record, State, diagnose, pddl_plan};
use ramp_testing::mangle::{Dice, mangled};

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
