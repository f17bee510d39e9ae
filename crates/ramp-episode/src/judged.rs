//! The layer between agent and twin: forwards every call, runs the referee, writes the log.

use std::time::Instant;

use ramp_assembly::Task;
use ramp_log::Recorder;
use ramp_referee::{REST, Reason, Referee, Seated};
use ramp_result::episode::{FaultInfo, PartResult, PegResult, Physics, RejectReason, RejectedPeg};
use ramp_robot::{
    Camera, CameraModel, Command, Image, ImageWidth, Observation, PartReading, Robot, RobotError,
};
use ramp_twin::{FaultReport, Moment, Setup, Twin};

use crate::answer;

/// Control periods between two looks of the referee (10 ms).
const WATCH_EVERY: u64 = 10;

/// State of a running episode, for a display.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Robot time, s.
    pub time: f64,
    /// Pegs, or parts of a frame that is to be taken apart, that count now.
    pub seated: usize,
    /// All of them.
    pub pegs: usize,
}

/// Called now and then with the progress and the twin, to be looked at.
pub type Watcher<'a> = dyn FnMut(&Progress, &Twin) + 'a;

/// The layer between agent and twin: forwards every call, runs the referee, keeps the log and the agent's
/// clock. An agent gets it as `&mut dyn Robot` and has no way past it.
pub(crate) struct Judged<'a, 'w> {
    pub(crate) twin: &'a mut Twin,
    referee: Referee,
    /// The agent's own time up to now, s.
    pub(crate) thought: f64,
    /// When the agent got the last answer.
    pub(crate) answered: Instant,
    /// The fatal error of the robot.
    stopped: Option<RobotError>,
    pub(crate) recorder: Option<Recorder>,
    watcher: &'a mut Watcher<'w>,
}

impl<'a, 'w> Judged<'a, 'w> {
    pub(crate) fn new(
        twin: &'a mut Twin,
        setup: &Setup,
        recorder: Option<Recorder>,
        watcher: &'a mut Watcher<'w>,
    ) -> Judged<'a, 'w> {
        let referee = Referee::for_task(setup.assembly, setup.task, twin.part_names());
        twin.record_moments(WATCH_EVERY);
        let mut judged = Judged {
            twin,
            referee,
            thought: 0.0,
            answered: Instant::now(),
            stopped: None,
            recorder,
            watcher,
        };
        judged.record();
        judged
    }

    /// The agent has called: what has passed since the last answer was its own time.
    pub(crate) fn called(&mut self) {
        self.thought += self.answered.elapsed().as_secs_f64();
    }

    /// The log, as long as the robot works.
    fn recorder(&mut self) -> Option<&mut Recorder> {
        self.recorder.as_mut().filter(|_| self.stopped.is_none())
    }

    /// Lets the log look at the world.
    fn record(&mut self) {
        if let Some(recorder) = &mut self.recorder {
            let due = recorder.due(self.twin.time());
            let seen = due.signals.then(|| self.twin.observe());
            let truth = due.truth.then(|| self.twin.truth());
            let state = due.state.then(|| self.twin.state_hash());
            recorder.watch(due, seen.as_ref(), truth.as_ref(), state);
        }
    }

    /// The log keeps answers and refusals. A fatal error of the robot is not an answer.
    fn record_answer<T>(&mut self, result: &Result<T, RobotError>, hash: impl Fn(&T) -> u64) {
        if let Some(recorder) = self.recorder() {
            match result {
                Ok(given) => recorder.answered(hash(given)),
                Err(error) if !error.is_final() => recorder.refused(),
                Err(_) => {}
            }
        }
    }

    /// The agent gets its answer.
    fn answer<T>(&mut self, result: Result<T, RobotError>) -> Result<T, RobotError> {
        if self.stopped.is_none() {
            self.record();
        }
        if let Err(error) = &result
            && error.is_final()
            && self.stopped.is_none()
        {
            self.stopped = Some(error.clone());
        }
        self.answered = Instant::now();
        result
    }

    /// Shows the referee all moments of a call that came due in it.
    fn judge(&mut self) {
        let moments = self.twin.moments();
        for moment in &moments {
            self.show(moment);
        }
        if !moments.is_empty() {
            self.report();
        }
    }

    /// The end: the referee looks once more, and, if a peg counts, at the parts while they rest without the
    /// arm.
    pub(crate) fn judge_end(&mut self) {
        self.judge();
        let last = self.twin.moment();
        self.show(&last);
        if self.referee.verdict().iter().any(Option::is_some) {
            for moment in self.twin.without_arm(REST, WATCH_EVERY) {
                self.referee.rested(&moment.truth, &moment.penetrations);
            }
            self.record_verdict();
        }
        self.report();
    }

    fn show(&mut self, moment: &Moment) {
        self.referee.penetrated(&moment.truth, &moment.penetrations);
        self.referee.watch(&moment.truth, self.thought);
        self.record_verdict();
    }

    fn record_verdict(&mut self) {
        if let Some(recorder) = &mut self.recorder {
            recorder.judge(&self.referee);
        }
    }

    /// The display gets the progress.
    fn report(&mut self) {
        let verdict = self.referee.verdict();
        let progress = Progress {
            time: self.twin.time(),
            seated: verdict.iter().flatten().count(),
            pegs: verdict.len(),
        };
        (self.watcher)(&progress, self.twin);
    }

    /// The pegs that count now, for each connection of the goal.
    pub(crate) fn pegs(&self, setup: &Setup) -> Vec<Option<PegResult>> {
        let assembly = setup.assembly;
        if setup.task != Task::Build {
            return Vec::new();
        }
        assembly
            .connections
            .iter()
            .zip(self.referee.verdict())
            .map(|(connection, seated)| {
                seated.as_ref().map(|seated| PegResult {
                    connection: connection.name.clone(),
                    joints: [connection.female, connection.male]
                        .map(|joint| assembly.joint_name(joint).to_string()),
                    peg: seated.peg.clone(),
                    t_robot: seated.since,
                    t_total: seated.since + seated.thought,
                })
            })
            .collect()
    }

    /// The parts of a frame that is to be taken apart; none where it is to be built.
    pub(crate) fn parts(&self, setup: &Setup) -> Vec<PartResult> {
        if setup.task != Task::TakeApart {
            return Vec::new();
        }
        let parts = setup.assembly.movable_parts().into_iter().zip(self.referee.verdict());
        let result = |(part, back): (&str, &Option<Seated>)| PartResult {
            part: part.to_string(),
            t_robot: back.as_ref().map(|back| back.since),
            t_total: back.as_ref().map(|back| back.since + back.thought),
        };
        parts.map(result).collect()
    }

    /// The pegs that are in their place and do not count.
    pub(crate) fn rejected(&self, setup: &Setup) -> Vec<RejectedPeg> {
        if setup.task != Task::Build {
            return Vec::new();
        }
        let connections = setup.assembly.connections.iter().zip(self.referee.rejected());
        let rejected =
            connections.filter_map(|(connection, rejected)| Some((connection, rejected.as_ref()?)));
        rejected
            .map(|(connection, rejected)| RejectedPeg {
                connection: connection.name.clone(),
                peg: rejected.peg.clone(),
                reason: match &rejected.reason {
                    Reason::Fell => RejectReason::Fell {},
                    Reason::Penetration { parts, depth } => {
                        RejectReason::Penetration { parts: parts.clone(), depth: *depth }
                    }
                },
            })
            .collect()
    }

    /// The outcome of the episode's fault.
    pub(crate) fn fault(&self) -> Option<FaultInfo> {
        self.twin.fault().map(fault_info)
    }

    pub(crate) fn physics(&self) -> Physics {
        Physics {
            deepest_penetration: self.twin.deepest_penetration(),
            largest_force: self.twin.largest_force(),
            stops: self.twin.stops().len(),
            state: format!("{:016x}", self.twin.state_hash()),
        }
    }
}

impl Robot for Judged<'_, '_> {
    fn step(&mut self, command: &Command) -> Result<Observation, RobotError> {
        self.called();
        if let Some(recorder) = self.recorder() {
            recorder.step(command);
        }
        let result = match &self.stopped {
            Some(error) => Err(error.clone()),
            None => command.check_limits().and_then(|()| self.twin.step(command)),
        };
        self.judge();
        self.answer(result)
    }

    fn observe(&self) -> Observation {
        self.twin.observe()
    }

    fn read_parts(&mut self) -> Result<Vec<PartReading>, RobotError> {
        self.called();
        if let Some(recorder) = self.recorder() {
            recorder.read_parts();
        }
        let result = match &self.stopped {
            Some(error) => Err(error.clone()),
            None => self.twin.read_parts(),
        };
        self.record_answer(&result, |parts| answer::of_readings(parts));
        self.judge();
        self.answer(result)
    }

    fn expose(&mut self) -> Result<(), RobotError> {
        self.called();
        if let Some(recorder) = self.recorder() {
            recorder.expose();
        }
        let result = match &self.stopped {
            Some(error) => Err(error.clone()),
            None => self.twin.expose(),
        };
        // Its answers are images, later.
        if result.is_err() {
            self.record_answer(&result, |()| 0);
        }
        self.answer(result)
    }

    fn look_sized(&mut self, camera: Camera, width: Option<ImageWidth>) -> Result<Image, RobotError> {
        self.called();
        if let Some(recorder) = self.recorder() {
            recorder.look(camera, width);
        }
        let result = match &self.stopped {
            Some(error) => Err(error.clone()),
            None => self.twin.look_sized(camera, width),
        };
        self.record_answer(&result, answer::of_image);
        self.judge();
        self.answer(result)
    }

    fn camera(&self, camera: Camera) -> CameraModel {
        self.twin.camera(camera)
    }
}

/// A result's entry about a fault.
fn fault_info(report: &FaultReport) -> FaultInfo {
    let FaultReport { kind, occasion, at, part, size, text } = report.clone();
    FaultInfo { kind: kind.name().to_string(), occasion, at, part, size, text }
}
