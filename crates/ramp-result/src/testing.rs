//! Results made by hand, for tests.

use crate::episode::{
    AgentInfo, Ended, EpisodeResult, Host, PegResult, Physics, PlanInfo, RULES, SCHEMA, Software, Time,
};

/// An episode of `pegs` pegs, of which some count since the given total times, s.
pub fn episode(goal: &str, seed: u64, since: &[f64], pegs: usize) -> EpisodeResult {
    let end = since.last().map_or(10.0, |last| last + 1.0);
    let planning = 0.5;
    EpisodeResult {
        schema: SCHEMA.into(),
        rules: RULES.into(),
        goal: goal.into(),
        class: Some("easy".into()),
        track: "state".into(),
        real: None,
        arm: None,
        world: None,
        start: None,
        state: None,
        task: None,
        parts: Vec::new(),
        seed,
        secret: None,
        repeat: seed as u32,
        agent: AgentInfo { name: "hand".into(), version: "1".into(), sha256: None, asynchronous: false },
        software: Software { version: "0.1.0".into(), commit: "abc".into() },
        host: Host { cpu: "cpu".into(), cores: 2 },
        rejected: Vec::new(),
        completion: since.len() as f64 / pegs as f64,
        pegs: (0..pegs)
            .map(|index| {
                since.get(index).map(|t| PegResult {
                    connection: format!("C{}", index + 1),
                    joints: ["b7j1".into(), "b4j1".into()],
                    peg: format!("p{}", index + 1),
                    t_robot: t - planning,
                    t_total: *t,
                })
            })
            .collect(),
        time: Time {
            planning,
            compute: 0.0,
            robot: end - planning,
            total: end,
            agent_cpu: None,
            waiting: None,
        },
        robot_time: None,
        plan: PlanInfo { coarse: 1, fine: 1, replans: 0 },
        events: Vec::new(),
        log: None,
        physics: Some(Physics {
            deepest_penetration: 0.0,
            largest_force: 0.0,
            stops: 0,
            state: "0".repeat(16),
        }),
        fault: None,
        ended: Ended { reason: "done".into(), kind: None },
    }
}
