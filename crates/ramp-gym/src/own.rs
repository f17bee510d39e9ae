//! A skill of one's own in place of one of the baseline's: what drives the robot is anything that implements
//! [`Body`], such as a Python object or a program in another process.

use ramp_planner::Impossible;
use ramp_robot::{
    Camera, CameraModel, Command, Image, ImageWidth, Observation, PartReading, Robot, RobotError,
};
use ramp_skills::cell::Workcell;
use ramp_skills::hand::Hand;
use ramp_skills::rehearsal::{Outline, Scene};
use ramp_skills::skill::{ActionKind, Call, Effect, Need, Skill};
use ramp_skills::{Fault, SkillError, SkillTable};

use crate::known::Known;

/// The kinds of actions that a skill of one's own can carry out: those that work on the assembly.
pub fn kinds() -> impl Iterator<Item = ActionKind> {
    ActionKind::ALL.iter().copied().filter(|kind| kind.is_assembling())
}

/// The kind of that name ([`ActionKind::name`]) that a skill of one's own can carry out, with `-` for `_` as
/// well.
pub fn kind(name: &str) -> Option<ActionKind> {
    ActionKind::named(name).filter(|kind| kind.is_assembling())
}

/// The request to a skill.
#[derive(Clone, Debug)]
pub struct Moment {
    /// The kind of the action.
    pub kind: ActionKind,
    /// The action in words.
    pub action: String,
    /// The knowledge of the agent.
    pub known: Known,
}

/// Why a body ended early.
#[derive(Clone, Debug, thiserror::Error)]
pub enum BodyError {
    /// The robot stopped it.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// It has given up; the baseline goes on from there as after any fault.
    #[error("{0}")]
    GaveUp(String),
}

/// Drives the robot while a skill runs.
pub trait Body: Send + Sync {
    /// Brings about what `moment` asks for. What is held is let go of afterwards.
    ///
    /// # Errors
    /// When the robot stopped, or the body gives up.
    fn run(&self, robot: &mut dyn Robot, moment: &Moment) -> Result<(), BodyError>;

    /// The motions that [`Body::run`] will ask for in the moment that is expected, with alternatives
    /// ([`Skill::rehearse`]). A body that cannot say is not rehearsed.
    fn rehearse(&self, _expected: &Moment) -> Outline {
        Outline::Unknown
    }
}

/// A skill of one's own for one kind of action. It needs and promises what the baseline's does.
pub struct OwnSkill {
    name: String,
    kind: [ActionKind; 1],
    needs: Vec<Need>,
    expects: Vec<Effect>,
    body: Box<dyn Body>,
}

impl OwnSkill {
    /// The name in results of a skill for actions of `kind`.
    pub fn name_of(kind: ActionKind, name: &str) -> String {
        format!("{}-by-{name}", kind.name().replace('_', "-"))
    }

    /// A skill for actions of `kind`. Its name stands in results: it begins with the action, as in
    /// `fasten-by-my-policy`.
    pub fn new(kind: ActionKind, name: &str, body: Box<dyn Body>) -> OwnSkill {
        let table = SkillTable::default();
        let own = table.get(kind);
        OwnSkill {
            name: OwnSkill::name_of(kind, name),
            kind: [kind],
            needs: own.map(|skill| skill.needs().to_vec()).unwrap_or_default(),
            expects: own.map(|skill| skill.expects().to_vec()).unwrap_or_default(),
            body,
        }
    }
}

impl Skill for OwnSkill {
    fn name(&self) -> &str {
        &self.name
    }

    fn serves(&self) -> &[ActionKind] {
        &self.kind
    }

    fn needs(&self) -> &[Need] {
        &self.needs
    }

    fn expects(&self) -> &[Effect] {
        &self.expects
    }

    fn rehearse(&self, scene: &Scene, call: &Call) -> Outline {
        let Some(known) = Known::expected(scene, call) else { return Outline::Unknown };
        self.body.rehearse(&Moment { kind: call.kind(), action: call.action.to_string(), known })
    }

    /// As the baseline's skill would.
    fn blame(&self, call: &Call) -> Option<Impossible> {
        SkillTable::default().get(call.kind())?.blame(call)
    }

    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let known = Known::of(cell, call)?;
        let moment = Moment { kind: call.kind(), action: call.action.to_string(), known };
        let outcome = self.body.run(&mut HandRobot(&mut cell.hand), &moment);
        // Wherever the hand is now, the baseline goes on from there.
        cell.hand.relax();
        match outcome {
            Ok(()) => Ok(()),
            Err(BodyError::Robot(error)) => Err(error.into()),
            Err(BodyError::GaveUp(why)) => Err(Fault::Own { skill: self.name.clone(), why }.into()),
        }
    }

    fn let_go(&self, cell: &mut Workcell, _: &Call) -> Result<(), SkillError> {
        if cell.hand.held.is_some() { cell.release() } else { Ok(()) }
    }
}

/// The hand as a robot.
struct HandRobot<'h, 'r>(&'h mut Hand<'r>);

impl Robot for HandRobot<'_, '_> {
    fn step(&mut self, command: &Command) -> Result<Observation, RobotError> {
        self.0.obey(command.clone())?;
        Ok(self.0.seen.clone())
    }

    fn observe(&self) -> Observation {
        self.0.seen.clone()
    }

    fn read_parts(&mut self) -> Result<Vec<PartReading>, RobotError> {
        self.0.read_parts()
    }

    fn expose(&mut self) -> Result<(), RobotError> {
        self.0.expose()
    }

    fn look_sized(&mut self, camera: Camera, width: Option<ImageWidth>) -> Result<Image, RobotError> {
        self.0.look_sized(camera, width)
    }

    fn camera(&self, camera: Camera) -> CameraModel {
        self.0.camera(camera)
    }
}
