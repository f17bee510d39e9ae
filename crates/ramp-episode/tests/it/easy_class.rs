//! The easy class, from goal file to result, in the real physics.
//!
//! `RAMP_SEEDS="1 2 3"` chooses other seeds than the two that every test run takes.

use ramp_robot::Track;
use ramp_testing::GoalFiles;

fn seeds() -> Vec<u64> {
    let text = std::env::var("RAMP_SEEDS").unwrap_or_else(|_| "1 101".to_string());
    text.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

fn completes(goal: &str) {
    let world = GoalFiles::new(goal);
    for seed in seeds() {
        let result = world.run(Track::State, seed);
        let faults: Vec<_> = result.events.iter().filter(|event| event.kind == "fault").collect();
        assert_eq!(result.ended.reason, "done", "{goal}, seed {seed}: {faults:?}");
        assert!((result.completion - 1.0).abs() < 1e-12, "{goal}, seed {seed}: {faults:?}");
        assert!(result.physics.as_ref().unwrap().deepest_penetration < 0.3e-3, "{goal}, seed {seed}");
        assert!(result.time.robot < 300.0);
        // Every peg's time lies within the episode, and thinking only adds to it.
        for peg in result.pegs.iter().flatten() {
            assert!(peg.t_robot > 0.0 && peg.t_robot <= result.time.robot && peg.t_total >= peg.t_robot);
        }
    }
}

#[test]
fn easy_1_is_built() {
    completes("easy-1");
}

#[test]
fn easy_2_is_built() {
    completes("easy-2");
}

#[test]
fn easy_3_is_built() {
    completes("easy-3");
}
