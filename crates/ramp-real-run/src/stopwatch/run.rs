//! One episode of a log.

use std::ops::Range;

use ramp_assembly::Assembly;

use ramp_result::episode::{
    AgentInfo, Ended, EpisodeResult, Host, PegResult, PlanInfo, RULES, RealRun, SCHEMA, Software, Time,
};
use ramp_robot::{Event, Fault};

/// An episode while its lines are read.
pub(super) struct Run<'a> {
    pub goal: &'a Assembly,
    pub repeat: u32,
    /// Time at which the robot was free to move, s.
    pub planning: Option<f64>,
    /// For each connection: the time at which its peg was seated, the peg, and the place in the
    /// log.
    pub pegs: Vec<Option<(f64, String, Range<usize>)>>,
    pub faults: Vec<(f64, String)>,
    pub ended: Option<String>,
    /// The time of its last line, s, and the place.
    pub now: f64,
    pub last: Range<usize>,
}

impl<'a> Run<'a> {
    pub fn new(goal: &'a Assembly, repeat: u32) -> Run<'a> {
        Run {
            goal,
            repeat,
            planning: None,
            pegs: vec![None; goal.connections.len()],
            faults: Vec::new(),
            ended: None,
            now: 0.0,
            last: 0..0,
        }
    }

    pub fn result(
        self,
        agent: &AgentInfo,
        track: &str,
        real: &RealRun,
        host: &Host,
        software: &Software,
    ) -> EpisodeResult {
        let planning = self.planning.unwrap_or(0.0);
        let goal = self.goal;
        let pegs: Vec<Option<PegResult>> = self
            .pegs
            .into_iter()
            .zip(&goal.connections)
            .map(|(seated, connection)| {
                seated.map(|(time, peg, _)| PegResult {
                    connection: connection.name.clone(),
                    joints: [connection.female, connection.male].map(|it| goal.joint_name(it).to_string()),
                    peg,
                    t_robot: time - planning,
                    t_total: time,
                })
            })
            .collect();
        let counted = pegs.iter().flatten().count();
        let event =
            |(time, why): (f64, String)| Event::new((time - planning).max(0.0), Fault::Other { why }.into());
        EpisodeResult {
            schema: SCHEMA.to_string(),
            rules: RULES.to_string(),
            goal: goal.name.clone(),
            class: goal.class.map(|class| class.name()),
            track: track.to_string(),
            real: Some(real.clone()),
            arm: None,
            world: None,
            start: None,
            state: None,
            task: None,
            parts: Vec::new(),
            seed: u64::from(self.repeat),
            secret: None,
            repeat: self.repeat,
            agent: agent.clone(),
            software: software.clone(),
            host: host.clone(),
            rejected: Vec::new(),
            completion: if pegs.is_empty() { 0.0 } else { counted as f64 / pegs.len() as f64 },
            pegs,
            time: Time {
                planning,
                compute: 0.0,
                robot: self.now - planning,
                total: self.now,
                agent_cpu: None,
                waiting: None,
            },
            robot_time: None,
            plan: PlanInfo { coarse: 0, fine: 0, replans: 0 },
            events: self.faults.into_iter().map(event).collect(),
            physics: None,
            fault: None,
            log: None,
            ended: Ended { reason: self.ended.unwrap_or_default(), kind: None },
        }
    }
}
