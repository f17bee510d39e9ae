//! Custom skills: programs in any language, or policies behind a server, each replacing one skill inside the
//! baseline.
//!
//! The program uses the agent protocol. It starts when its action begins. Its goal message has a `task` with
//! the action and the current knowledge. It drives the robot until it sends `done`. It reports a failure by
//! an event of the kind `fault` before `done`.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use miette::{IntoDiagnostic, Report, miette};
use ramp_assembly::Assembly;
use ramp_data::Texts;
use ramp_external_agent::observation::pose;
use ramp_external_agent::{AgentFile, ExternalAgent, GoalMessage, Patience};
use ramp_gym::known::Known;
use ramp_gym::outline::read_outline;
use ramp_gym::own::{Body, BodyError, Moment, OwnSkill, kind, kinds};
use ramp_kit::source::to_name;
use ramp_log::Sources;
use ramp_policy_client::{PolicyServer, PolicySkill, PolicyUrl, UrlError};
use ramp_robot::arm::ArmModel;
use ramp_robot::{Agent, EventKind, Robot, Track};
use ramp_skills::rehearsal::Outline;
use ramp_skills::skill::ActionKind;
use ramp_twin::{Setup, Start};
use serde_json::{Value, json};

use crate::command::program::{command_of, find_policy};

/// Time that a server has for its metadata, s.
const HANDSHAKE: f64 = 10.0;
/// Largest length of the file name within the agent's name, characters.
const LONGEST_STEM: usize = 24;

/// `ACTION=FILE` or `ACTION=ws://HOST:PORT`, as on the command line.
#[derive(Clone, Debug)]
pub struct Replacement {
    kind: ActionKind,
    place: Place,
}

/// The place of the program.
#[derive(Clone, Debug)]
enum Place {
    File(PathBuf),
    Server(PolicyUrl),
}

/// The program of a skill.
#[derive(Clone)]
pub enum Source {
    File(AgentFile),
    Server(Arc<PolicyServer>),
}

impl Source {
    /// Returns true if it is a program that is started here.
    pub fn is_program(&self) -> bool {
        matches!(self, Source::File(_))
    }

    /// The name of the program, with the start of its hash.
    fn label(&self) -> String {
        match self {
            Source::File(file) => label(file),
            Source::Server(server) => server.metadata().name.clone(),
        }
    }
}

impl std::str::FromStr for Replacement {
    type Err = String;

    fn from_str(text: &str) -> Result<Replacement, String> {
        let (name, file) = text.split_once('=').ok_or("expected ACTION=FILE, such as fasten=my.py")?;
        let kind = kind(name).ok_or_else(|| {
            let known: Vec<String> = kinds().map(|it| it.name().replace('_', "-")).collect();
            format!("there is no action `{name}` for a skill; there are {}", known.join(", "))
        })?;
        let is_url = file.starts_with("ws://") || file.starts_with("wss://");
        let place = match is_url {
            true => Place::Server(file.parse().map_err(|error: UrlError| error.to_string())?),
            false => Place::File(file.into()),
        };
        Ok(Replacement { kind, place })
    }
}

/// Context that skill programs receive, and the time limit for their messages.
#[derive(Clone)]
pub struct SkillHost {
    assembly: Assembly,
    arm: ArmModel,
    track: Track,
    start: Start,
    goal: String,
    kit_text: String,
    arm_text: String,
    patience: Duration,
}

impl SkillHost {
    /// The host of one episode, with the program's time limit for a message in seconds.
    pub fn new(setup: &Setup, texts: &Texts, limit: f64) -> SkillHost {
        let Sources { goal, kit: kit_text, arm: arm_text } = texts.sources();
        SkillHost {
            assembly: setup.assembly.clone(),
            arm: setup.arm.clone(),
            track: setup.track,
            start: setup.start.clone(),
            goal: goal.to_string(),
            kit_text: kit_text.to_string(),
            arm_text: arm_text.to_string(),
            patience: Duration::from_secs_f64(limit),
        }
    }

    /// Starts an external program with this task.
    ///
    /// # Errors
    /// If the system cannot start it.
    pub fn start(&self, file: &AgentFile, task: Value) -> Result<ExternalAgent<'_>, Report> {
        let texts = Sources { goal: &self.goal, kit: &self.kit_text, arm: &self.arm_text };
        let goal =
            GoalMessage::new(&self.assembly, &self.arm, self.track, &self.start, texts).with_task(task);
        let patience = Patience { answer: self.patience, end: None };
        ExternalAgent::start(file, &command_of(file, None)?, goal, patience, None).into_diagnostic()
    }
}

/// A program that executes an action.
struct Program {
    file: AgentFile,
    cell: SkillHost,
}

impl Body for Program {
    fn rehearse(&self, expected: &Moment) -> Outline {
        let asked = self.cell.start(&self.file, task(expected)).ok();
        let answer = asked.and_then(|program| program.rehearse(task(expected)).ok().flatten());
        answer.and_then(|alternatives| read_outline(&alternatives).ok()).unwrap_or(Outline::Unknown)
    }

    fn run(&self, robot: &mut dyn Robot, moment: &Moment) -> Result<(), BodyError> {
        let started = self.cell.start(&self.file, task(moment));
        let mut program = started.map_err(|error| BodyError::GaveUp(error.to_string()))?;
        program.run(robot)?;
        if let Some(why) = program.failure() {
            return Err(BodyError::GaveUp(why));
        }
        let gave_up = program.account().events.into_iter().rev().find_map(|event| match event.kind {
            EventKind::Fault(fault) => Some(fault),
            _ => None,
        });
        gave_up.map_or(Ok(()), |fault| Err(BodyError::GaveUp(fault.to_string())))
    }
}

/// The task message for a program.
fn task(moment: &Moment) -> Value {
    let Known { held, part, x_wp, x_goal, gripper, posture } = &moment.known;
    let held = held.as_ref().map(|held| {
        json!({
            "part": held.part,
            "x_tp": pose(&held.x_tp),
            "mass": held.mass,
            "p_centre": held.p_centre.coords.as_slice(),
        })
    });
    json!({
        "kind": moment.kind.name(),
        "action": moment.action,
        "part": part,
        "x_wp": pose(x_wp),
        "x_goal": pose(x_goal),
        "gripper": {"width": gripper.width, "force": gripper.force},
        "posture": posture,
        "held": held,
    })
}

/// The skill for an action.
pub fn skill(kind: ActionKind, source: &Source, cell: &SkillHost) -> Result<OwnSkill, Report> {
    if !kind.is_assembling() {
        return Err(miette!("no skill of one's own can carry out `{}`", kind.name().replace('_', "-")));
    }
    let body: Box<dyn Body> = match source {
        Source::File(file) => Box::new(Program { file: file.clone(), cell: cell.clone() }),
        Source::Server(server) => {
            let patience = Patience { answer: cell.patience, end: None };
            Box::new(PolicySkill::new(Arc::clone(server), patience, cell.arm.clone()))
        }
    };
    Ok(OwnSkill::new(kind, &source.label(), body))
}

/// The name of the skill in results: the action, the file's name and the start of its hash.
pub fn name(kind: ActionKind, source: &Source) -> String {
    to_name(&OwnSkill::name_of(kind, &source.label()))
}

/// The name of a file and the start of its hash.
fn label(file: &AgentFile) -> String {
    let stem = file.path().file_stem().map(|stem| stem.to_string_lossy()).unwrap_or_default();
    let short: String = to_name(&stem).chars().take(LONGEST_STEM).collect();
    format!("{short}.{}", &file.sha256()[..8])
}

/// The program in a file.
pub fn file(path: &Path) -> Result<AgentFile, Report> {
    AgentFile::find(path).into_diagnostic()
}

impl Replacement {
    /// Returns true if it is a program that is started here.
    pub fn is_program(&self) -> bool {
        matches!(self.place, Place::File(_))
    }

    /// The action, and the program in its file or behind its server.
    pub fn read(&self) -> Result<(ActionKind, Source), Report> {
        let source = match &self.place {
            Place::File(path) => Source::File(file(path)?),
            Place::Server(url) => Source::Server(Arc::new(find_policy(url, HANDSHAKE)?)),
        };
        Ok((self.kind, source))
    }

    /// As on the command line.
    pub fn word(&self, place: &mut dyn FnMut(&Path) -> PathBuf) -> OsString {
        let mut word = OsString::from(format!("{}=", self.kind.name().replace('_', "-")));
        match &self.place {
            Place::File(path) => word.push(place(path)),
            Place::Server(url) => word.push(url.to_string()),
        }
        word
    }
}
