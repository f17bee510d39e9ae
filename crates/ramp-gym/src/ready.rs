//! The moment at which a skill begins: the baseline does what comes before it, and stops there.
//!
//! A task of `ramp trials` begins with the arm at home. Most of its time is fetching and carrying. Here the
//! baseline does that part: the peg is in the hand over its hole, the beam is where its insertion begins.
//! The baseline's belief at that moment is kept beside the state of the twin, since an agent on its track can
//! know no more.

use std::sync::{Arc, Mutex, PoisonError};

use ramp_robot::Agent;
use ramp_skills::cell::Workcell;
use ramp_skills::rehearsal::{Outline, Scene};
use ramp_skills::skill::{ActionKind, Call, Effect, Need, Skill};
use ramp_skills::{Baseline, Fault, Piece, SkillError, SkillTable};
use ramp_twin::{Setup, Twin};

use crate::benchmark::Benchmark;
use crate::known::Known;
use crate::tasks::Step;

/// The skill that notes what is known, and ends the work.
struct Pause {
    kind: [ActionKind; 1],
    needs: Vec<Need>,
    known: Arc<Mutex<Option<Known>>>,
}

impl Skill for Pause {
    fn name(&self) -> &str {
        "pause"
    }

    fn serves(&self) -> &[ActionKind] {
        &self.kind
    }

    fn needs(&self) -> &[Need] {
        &self.needs
    }

    fn expects(&self) -> &[Effect] {
        &[]
    }

    fn rehearse(&self, _: &Scene, _: &Call) -> Outline {
        Outline::Unknown
    }

    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let known = Known::of(cell, call)?;
        *self.known.lock().unwrap_or_else(PoisonError::into_inner) = Some(known);
        Err(Fault::NoSkill { action: call.action.to_string() }.into())
    }
}

/// Lets the baseline do what comes before the contact action of `step`; what it knows then, or why it did not
/// get there.
pub(crate) fn bring(
    benchmark: &Benchmark,
    setup: &Setup,
    step: &Step,
    twin: &mut Twin,
) -> Result<Known, String> {
    let known = Arc::new(Mutex::new(None));
    let table = SkillTable::default();
    let needs = table.get(step.kind).map(|skill| skill.needs().to_vec()).unwrap_or_default();
    let pause = Pause { kind: [step.kind], needs, known: Arc::clone(&known) };
    let baseline = Baseline::new(setup.assembly, &benchmark.arm, &benchmark.domains, setup.seed)
        .on_track(setup.track)
        .from_start(setup.start)
        .with_skills(table.with(pause));
    let mut agent = Piece::new(baseline, step.state.clone(), step.plan.clone(), Vec::new());
    let outcome = agent.run(twin);
    let known = known.lock().unwrap_or_else(PoisonError::into_inner).take();
    match (known, outcome) {
        (Some(known), Ok(())) => Ok(known),
        (_, Err(error)) => Err(error.to_string()),
        (None, Ok(())) => Err(agent.failure().unwrap_or_else(|| "the skill did not begin".to_string())),
    }
}
