//! An agent in a process of its own, behind the same seam as any other.

use ramp_control::Smoother;
use ramp_robot::{Account, Agent, Command, Event, EventKind, MOST_EVENTS, Observation, Robot, RobotError};

use crate::file::{AgentFile, AgentFileError};
use crate::goal::GoalMessage;
use crate::limits::{MOST_IDLE, Patience};
use crate::process::{Process, Silence};
use crate::protocol::{self, Answer, Request};
use crate::sandbox::Sandbox;
use crate::still::Pace;

/// An agent in a process of its own.
pub struct ExternalAgent<'a> {
    process: Process,
    /// Its sandbox, whose folder must exist for as long as the process.
    _sandbox: Option<Sandbox>,
    goal: GoalMessage<'a>,
    name: String,
    version: String,
    sha256: String,
    account: Account,
    /// Plans the agent has told of.
    plans: usize,
    failure: Option<String>,
    /// Whether the failure is that the episode's time on the wall was over.
    late: bool,
    /// Messages in a row that moved nothing.
    idle: u32,
    /// Messages so far.
    messages: u64,
    /// Makes its commands smooth, if it asked for that.
    smoother: Option<Smoother>,
    /// A clipped command has been reported.
    clipped: bool,
    /// It can rehearse its action.
    rehearses: bool,
    /// When its processes stand still.
    pace: Pace,
    /// The last message to it, until it is sent.
    farewell: Option<String>,
    on_event: Box<dyn FnMut(&Event) + 'a>,
}

/// Why the talk with the agent is over.
enum End {
    /// It said that it is done.
    Done,
    /// The robot stopped it.
    Robot(RobotError),
    /// It could not go on.
    Failure(String),
}

impl From<String> for End {
    fn from(why: String) -> End {
        End::Failure(why)
    }
}

impl<'a> ExternalAgent<'a> {
    /// Starts an agent and waits until it has said hello: until then no clock of the episode runs. What goes
    /// wrong with that is the agent's failure, told by [`Agent::failure`]. `command` is what starts it,
    /// usually [`AgentFile::command`]; with a sandbox, a program that goes [`Inside`](crate::sandbox::Inside)
    /// and then becomes the agent.
    ///
    /// # Errors
    /// When the system does not start the program.
    pub fn start(
        file: &AgentFile,
        command: &[std::ffi::OsString],
        goal: GoalMessage<'a>,
        patience: Patience,
        sandbox: Option<Sandbox>,
    ) -> Result<ExternalAgent<'a>, AgentFileError> {
        let process = Process::start(command, patience, sandbox.as_ref())
            .map_err(|source| AgentFileError::Start { path: file.path().to_path_buf(), source })?;
        let name = file.path().file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
        let mut agent = ExternalAgent {
            process,
            _sandbox: sandbox,
            goal,
            name: ramp_kit::source::to_name(&name),
            version: "unknown".to_string(),
            sha256: file.sha256().to_string(),
            account: Account::default(),
            plans: 0,
            failure: None,
            late: false,
            idle: 0,
            messages: 0,
            smoother: None,
            clipped: false,
            rehearses: false,
            pace: Pace::new(),
            farewell: None,
            on_event: Box::new(|_| {}),
        };
        agent.failure = agent.greet().err();
        Ok(agent)
    }

    /// Calls `listener` for every event as it comes, for a progress display.
    #[must_use]
    pub fn with_listener(mut self, listener: impl FnMut(&Event) + 'a) -> ExternalAgent<'a> {
        self.on_event = Box::new(listener);
        self
    }

    fn greet(&mut self) -> Result<(), String> {
        let Request::Hello(hello) = self.hear()? else {
            return Err("the agent's first message is not hello".to_string());
        };
        hello.check()?;
        self.name = hello.name;
        self.version = hello.version;
        self.rehearses = hello.rehearses;
        self.smoother = hello.clip.then(|| Smoother::new(self.goal.arm()));
        Ok(())
    }

    /// Asks a program for a single action for the motions that it will ask for, as JSON; `None` where it
    /// cannot rehearse. The program is ended.
    ///
    /// # Errors
    /// A description of the error in its answer, for a person.
    pub fn rehearse(mut self, task: serde_json::Value) -> Result<Option<serde_json::Value>, String> {
        if let Some(why) = self.failure.take() {
            return Err(why);
        }
        if !self.rehearses {
            self.process.end();
            return Ok(None);
        }
        self.tell(&Answer::Rehearse(task))?;
        let request = self.hear()?;
        self.process.dismiss(Answer::End("done".to_string()).to_bytes());
        self.process.end();
        match request {
            Request::Rehearsal(text) => Ok(Some(text.alternatives)),
            _ => Err(format!("message {} of the agent is not a rehearsal", self.messages)),
        }
    }

    /// The agent's next message.
    fn hear(&mut self) -> Result<Request, String> {
        let line = self.process.hear().map_err(|silence| self.failed(&silence))?;
        self.messages += 1;
        protocol::parse(&line).map_err(|what| format!("message {} of the agent {what}", self.messages))
    }

    fn tell(&mut self, answer: &Answer) -> Result<(), String> {
        self.process.tell(answer.to_bytes()).map_err(|silence| self.failed(&silence))
    }

    /// The failure of an agent that says or hears nothing more.
    fn failed(&mut self, silence: &Silence) -> String {
        self.late |= matches!(silence, Silence::Late);
        silence.to_string()
    }

    fn talk(&mut self, robot: &mut dyn Robot) -> Result<(), End> {
        let welcome = Answer::Goal(self.goal.to_json(robot));
        self.tell(&welcome)?;
        loop {
            let time = robot.observe().time;
            let request = self.hear()?;
            // An image takes the twin longer than the robot.
            let image = matches!(request, Request::Look(_));
            self.pace.begin(time, image, self.process.before());
            let answer = self.serve(request, robot);
            self.pace.end(robot.observe().time);
            let answer = answer?;
            self.idle = if robot.observe().time > time { 0 } else { self.idle + 1 };
            if self.idle > MOST_IDLE {
                let why = format!("the agent sent {MOST_IDLE} messages in a row that let no robot time pass");
                return Err(End::Failure(why));
            }
            self.tell(&answer)?;
        }
    }

    /// One period under a command, made smooth if the agent asked for that. The first one that had to be
    /// changed is noted.
    fn step(&mut self, command: &Command, robot: &mut dyn Robot) -> Result<Observation, RobotError> {
        let Some(smoother) = &mut self.smoother else { return robot.step(command) };
        let (smooth, changed) = smoother.smooth(command, &robot.observe());
        if changed && !self.clipped {
            self.clipped = true;
            let event = Event::new(robot.observe().time, EventKind::Clipped {});
            (self.on_event)(&event);
            self.account.events.push(event);
        }
        robot.step(&smooth)
    }

    /// The answer to the agent after an error of the robot.
    fn told(&mut self, error: RobotError, robot: &dyn Robot) -> Result<Answer, End> {
        match error {
            RobotError::Recovered { why, after } => {
                // Its next motion begins where the arm stands.
                if let Some(smoother) = &mut self.smoother {
                    smoother.begin_anew();
                }
                Ok(Answer::Recovered { why, after, seen: robot.observe() })
            }
            error if error.is_final() => Err(End::Robot(error)),
            error => Ok(Answer::Refused(error)),
        }
    }

    /// Does what is asked.
    fn serve(&mut self, request: Request, robot: &mut dyn Robot) -> Result<Answer, End> {
        let here = |number: u64| move |what| End::Failure(format!("message {number} of the agent {what}"));
        let wrong = here(self.messages);
        match request {
            Request::Hello(_) => Err(wrong("is a second hello".to_string())),
            Request::Step(step) => {
                let commands = step.commands().map_err(wrong)?;
                let mut seen: Option<Observation> = None;
                for (command, periods) in commands {
                    for _ in 0..periods {
                        let after = match self.step(&command, robot) {
                            Ok(after) => after,
                            // The rest of the message is not carried out.
                            Err(error) => return self.told(error, robot),
                        };
                        self.pace.check(after.time, self.process.before());
                        seen = Some(after);
                    }
                }
                Ok(Answer::Observation(seen.unwrap_or_else(|| robot.observe())))
            }
            Request::Observe {} => Ok(Answer::Observation(robot.observe())),
            Request::ReadParts {} => match robot.read_parts() {
                Ok(parts) => Ok(Answer::Parts(parts)),
                Err(error) => self.told(error, robot),
            },
            Request::Expose {} => match robot.expose() {
                Ok(()) => Ok(Answer::Noted),
                Err(error) => self.told(error, robot),
            },
            Request::Look(look) => match robot.look_sized(look.camera(), look.width().map_err(wrong)?) {
                Ok(image) => Ok(Answer::Image(image)),
                Err(error) => self.told(error, robot),
            },
            Request::Plan(plan) => {
                plan.check().map_err(wrong)?;
                if self.plans == 0 {
                    (self.account.coarse, self.account.fine) = (plan.coarse, plan.fine);
                } else {
                    self.account.replans += 1;
                }
                self.plans += 1;
                self.account.planning += plan.planning;
                Ok(Answer::Noted)
            }
            Request::Event(event) => {
                let event = event.at(robot.observe().time).map_err(wrong)?;
                if self.account.events.len() >= MOST_EVENTS {
                    return Err(End::Failure(format!("the agent reported more than {MOST_EVENTS} events")));
                }
                (self.on_event)(&event);
                self.account.events.push(event);
                Ok(Answer::Noted)
            }
            Request::Rehearsal(_) => Err(wrong("is a rehearsal that nobody has asked for".to_string())),
            Request::Done {} => Err(End::Done),
        }
    }
}

impl Drop for ExternalAgent<'_> {
    fn drop(&mut self) {
        self.finish();
    }
}

impl Agent for ExternalAgent<'_> {
    fn name(&self) -> (&str, &str) {
        (&self.name, &self.version)
    }

    fn account(&self) -> Account {
        self.account.clone()
    }

    fn file_hash(&self) -> Option<&str> {
        Some(&self.sha256)
    }

    fn failure(&self) -> Option<String> {
        self.failure.clone()
    }

    fn is_late(&self) -> bool {
        self.late
    }

    fn run(&mut self, robot: &mut dyn Robot) -> Result<(), RobotError> {
        let outcome = match &self.failure {
            Some(_) => Ok(()),
            None => self.talk(robot),
        };
        let outcome = match outcome {
            Ok(()) | Err(End::Done) => Ok(()),
            Err(End::Robot(error)) => Err(error),
            Err(End::Failure(why)) => {
                self.failure = Some(why);
                Ok(())
            }
        };
        if self.failure.is_none() {
            self.farewell = Some(outcome.as_ref().err().map_or("done".to_string(), RobotError::to_string));
        }
        outcome
    }

    fn finish(&mut self) {
        if let Some(reason) = self.farewell.take() {
            self.process.dismiss(Answer::End(reason).to_bytes());
        }
        // Output after this is not for the agent.
        self.process.end();
    }

    fn processor_time(&self) -> Option<f64> {
        self.process.time()
    }
}
