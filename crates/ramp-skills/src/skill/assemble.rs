//! Inserts a male of the held beam into the assembly.

use nalgebra::{Translation3, Vector3};
use ramp_planner::{End, Impossible};
use ramp_robot::{Cause, Retry, Search};

use super::contract::{ActionKind, Call, Effect, Need, Skill};
use super::insertion::{Aim, Insertion, Pushed, rehearse_insertion};
use crate::Pose;
use crate::cell::Workcell;
use crate::fault::{Fault, SkillError};
use crate::parameters::Parameters;
use crate::parameters::insertions::AssembleParameters;
use crate::rehearsal::outline::Outline;
use crate::rehearsal::scene::Scene;

/// Inserts a male of the held beam into the assembly, along the beam's insertion path: square, at an angle,
/// through sleeves, or deeper than its place.
#[derive(Clone)]
pub struct Assemble {
    parameters: AssembleParameters,
    insertion: Insertion,
}

impl Skill for Assemble {
    fn name(&self) -> &str {
        "assemble"
    }

    fn serves(&self) -> &[ActionKind] {
        &[
            ActionKind::AssembleSquare,
            ActionKind::AssembleAngled,
            ActionKind::AssembleThrough,
            ActionKind::AssembleDeep,
        ]
    }

    fn needs(&self) -> &[Need] {
        &[Need::HoldsPart, Need::InsertionPath]
    }

    fn parameters(&self) -> &[&'static str] {
        &["assemble", "insertion", "search"]
    }

    fn expects(&self) -> &[Effect] {
        &[Effect::BeamStands, Effect::HandEmpty]
    }

    fn rehearse(&self, scene: &Scene, call: &Call) -> Outline {
        rehearse_insertion(scene, call)
    }

    fn blame(&self, call: &Call) -> Option<Impossible> {
        call.cannot_grasp(End::Place)
    }

    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let beam = call.beam(cell.assembly)?;
        self.insertion.tries(cell, beam, |cell, attempt| self.once(cell, beam, attempt))
    }

    fn let_go(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let beam = call.beam(cell.assembly)?;
        self.insertion.let_go(cell, beam)
    }
}

impl Assemble {
    /// With these numbers.
    pub fn new(parameters: &Parameters) -> Assemble {
        Assemble { parameters: parameters.assemble.clone(), insertion: Insertion::new(parameters) }
    }

    fn once(&self, cell: &mut Workcell, beam: usize, attempt: usize) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        let stands = cell.assembly.beams[beam].beam.stands_at_assembled_height();
        let height = if stands { self.parameters.height } else { 0.0 };
        let mut aim = self.insertion.begin(cell, beam, height, attempt)?;
        let loose = !aim.loose.is_empty();
        let limit = self.limit(cell, loose);
        cell.glance()?;
        let raised = Translation3::new(0.0, 0.0, height) * aim.goal;
        let target = cell.hand.corrected(&cell.belief.parts.pose(&name)?, &raised);
        self.insertion.approach_mouths(cell, beam, &aim, &target)?;
        cell.glance()?;
        // A beam that has entered a loose sleeve aligns itself in it.
        let arrive = (!loose || aim.watched).then_some(&raised);
        let mut pushed = self.insertion.push_in(cell, beam, &aim, &target, arrive, limit)?;
        if loose {
            self.push_on(cell, beam, &mut aim, &mut pushed)?;
        }
        if pushed.stopped {
            let direction = aim.direction;
            let enough = 2.0 * cell.parameters.search.seated;
            let mut remaining = cell.belief.remaining(&name, &aim.goal, &direction)?;
            let met =
                format!("{name} meets {:.0} N {:.1} mm before its place", pushed.force, remaining * 1e3);
            let mut stuck = remaining > enough;
            if remaining > enough {
                let sleeve = cell.belief.sleeves(beam).next();
                if let Some(sleeve) = sleeve {
                    aim.goal.translation.z += cell.touch_floor(&name, sleeve, &direction)?;
                }
                let stood = cell.compliant_search(&name, &aim.goal, &direction, &cell.compliance(loose))?;
                remaining = cell.belief.remaining(&name, &aim.goal, &direction)?;
                // The search gets past edges. What holds a beam for longer is an obstacle.
                stuck = stood > cell.parameters.insertion.stuck || remaining > enough;
                // A mouth is at least as far from the place: an edge that the swing has not passed.
                if !loose && remaining > cell.parameters.insertion.mouth / 2.0 {
                    remaining = self.enter(cell, beam, &aim, (remaining, limit))?;
                    stuck = remaining > enough;
                }
            }
            if stuck {
                cell.diagnose(Cause::Jam, name.as_str(), met);
            }
            if remaining > enough {
                return self.insertion.back_out(cell, beam, &direction, remaining, pushed.force);
            }
        }
        self.seat(cell, beam, &aim.goal, height, (limit, loose), pushed.stopped)
    }

    /// The force at which a push stops, N.
    fn limit(&self, cell: &Workcell, loose: bool) -> f64 {
        let own = &self.parameters;
        if loose { own.loose_limit.max(own.loose_usual * cell.hand.usual_force) } else { own.limit }
    }

    /// Goes on with a beam that has stopped in a sleeve that little holds: aims again at where the sleeve is
    /// by now, and pushes. Where a push gains nothing, the next one comes from a little back, and a little
    /// higher or lower.
    fn push_on(
        &self,
        cell: &mut Workcell,
        beam: usize,
        aim: &mut Aim,
        pushed: &mut Pushed,
    ) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        let mut before = f64::INFINITY;
        let mut offsets = self.parameters.loose_offsets.iter();
        let mut offset = 0.0;
        let mut pushes = 0;
        while pushed.stopped && pushes < self.parameters.loose_pushes {
            pushes += 1;
            cell.see(&cell.belief.meeting(beam), cell.parameters.insertion.known)?;
            aim.goal = cell.belief.target(beam)?;
            aim.direction = cell.belief.insertion_direction(beam, &aim.goal)?;
            let remaining = cell.belief.remaining(&name, &aim.goal, &aim.direction)?;
            if remaining < cell.parameters.search.seated {
                break;
            }
            if pushed.dragged || before - remaining < self.parameters.loose_gain {
                let Some(next) = offsets.next() else { break };
                offset = *next;
                let mut back = cell.hand.setpoint;
                back.translation.vector = cell.hand.seen.x_wt.translation.vector
                    - aim.direction * self.parameters.loose_back
                    + Vector3::z() * offset;
                cell.hand.go(&back, cell.parameters.insertion.back_speed)?;
            }
            before = remaining;
            let raised = Translation3::from(Vector3::z() * offset) * aim.goal;
            let target = cell.hand.corrected(&cell.belief.parts.pose(&name)?, &raised);
            let limit = self.limit(cell, true);
            let arrive = aim.watched.then_some(&raised);
            *pushed = self.insertion.push_in(cell, beam, aim, &target, arrive, limit)?;
        }
        if pushes > 0 {
            let method = "push".to_string();
            cell.record(Search { method, part: name, duration: None, attempts: Some(pushes) });
        }
        Ok(())
    }

    /// Probes for a mouth that the compliant search has not found, and pushes the beam on from there. Returns
    /// how far the beam is from its place then, m.
    fn enter(
        &self,
        cell: &mut Workcell,
        beam: usize,
        aim: &Aim,
        (mut remaining, limit): (f64, f64),
    ) -> Result<f64, SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        let enough = 2.0 * cell.parameters.search.seated;
        while remaining > enough {
            // With a beam that has moved in the hand, no probe would find a mouth.
            cell.see(&[cell.belief.middle(&name)], cell.parameters.insertion.known)?;
            if cell.belief.beside_path(&name, &aim.goal, &aim.direction)? > self.parameters.beside
                || !cell.probe(&name, &aim.goal, &aim.direction)?
            {
                break;
            }
            let target = cell.hand.corrected(&cell.belief.parts.pose(&name)?, &aim.goal);
            self.insertion.push_in(cell, beam, aim, &target, Some(&aim.goal), limit)?;
            let now = cell.belief.remaining(&name, &aim.goal, &aim.direction)?;
            if remaining - now < cell.parameters.search.pace_distance {
                break;
            }
            remaining = now;
        }
        cell.belief.remaining(&name, &aim.goal, &aim.direction)
    }

    /// Brings a held beam that is in its joints to `goal` by detections. The remaining distance is mostly a
    /// fraction of a millimetre; a larger one needs the compliant search. A push that nothing has `stopped`
    /// has brought the beam to where its place was known to be: it needs another one only if a look tells so.
    fn seat(
        &self,
        cell: &mut Workcell,
        beam: usize,
        goal: &Pose,
        height: f64,
        (limit, loose): (f64, bool),
        stopped: bool,
    ) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        let direction = cell.belief.insertion_direction(beam, goal)?;
        // A gap that the cone of a peg closes: another push is worthwhile, but not a search, which swings the
        // beam at its far end.
        let enough = 2.0 * cell.parameters.search.seated;
        let mut before = f64::INFINITY;
        for attempt in 0..cell.parameters.insertion.tries {
            if stopped || attempt > 0 {
                let x_wp = cell.belief.parts.pose(&name)?;
                let fine = cell.hand.corrected(&x_wp, &(Translation3::new(0.0, 0.0, height) * goal));
                cell.hand.drive(&fine, self.parameters.seat_speed, |hand| hand.force().norm() > limit)?;
                cell.hand.wait(cell.parameters.insertion.rest)?;
            }
            cell.see(&[cell.belief.middle(&name)], cell.parameters.insertion.known)?;
            let remaining = cell.belief.remaining(&name, goal, &direction)?;
            // Over its joints or beside them, it has only come as far.
            let beside = cell.belief.beside_path(&name, goal, &direction)?;
            if beside > self.parameters.beside {
                let met = format!("{name} is {:.0} mm beside its insertion path", beside * 1e3);
                cell.diagnose(Cause::Jam, name.as_str(), met);
                let force = cell.hand.force().dot(&direction);
                return self.insertion.back_out(cell, beam, &direction, remaining, force);
            }
            if remaining < cell.parameters.search.seated
                || remaining < enough && before - remaining < cell.parameters.search.progress
            {
                return Ok(());
            }
            before = remaining;
            cell.record(Retry::new("insert", &name).off(remaining));
            if remaining > enough {
                cell.compliant_search(&name, goal, &direction, &cell.compliance(loose))?;
            }
        }
        let (remaining, force) =
            (cell.belief.remaining(&name, goal, &direction)?, cell.hand.force().dot(&direction));
        if remaining < enough {
            return Ok(());
        }
        Err(Fault::Jammed { part: name, remaining, force }.into())
    }

    /// Grasps a beam that stands short of its place on its insertion path, and moves it there.
    ///
    /// # Errors
    /// [`Fault::Jammed`], or the fault that stopped the motion.
    pub fn reinsert(&self, cell: &mut Workcell, beam: usize, s: f64) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        cell.grasp_standing(beam, s)?;
        let goal = cell.belief.target(beam)?;
        let direction = cell.belief.insertion_direction(beam, &goal)?;
        let loose = !cell.belief.loose_sleeves(beam, 1).is_empty();
        cell.hand.zero()?;
        cell.compliant_search(&name, &goal, &direction, &cell.compliance(loose))?;
        let limit = self.limit(cell, loose);
        let seated = self.seat(cell, beam, &goal, 0.0, (limit, loose), true);
        cell.settle(beam)?;
        cell.release()?;
        cell.belief.reckon_heights(beam);
        seated
    }
}
