//! Puts the held beam as a cap over males of the assembly.

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_planner::{End, Impossible};
use ramp_robot::Cause;

use super::contract::{ActionKind, Call, Effect, Need, Skill};
use super::insertion::{Insertion, rehearse_insertion};
use crate::Pose;
use crate::cell::Workcell;
use crate::fault::SkillError;
use crate::parameters::Parameters;
use crate::parameters::insertions::CapParameters;
use crate::rehearsal::outline::Outline;
use crate::rehearsal::scene::Scene;

/// Puts the held beam as a cap over males of the assembly: pressed on the table a little, pulled past its
/// goal so that each end seats on its stop wall, and swept to and fro at the end.
#[derive(Clone)]
pub struct Cap {
    parameters: CapParameters,
    insertion: Insertion,
}

impl Skill for Cap {
    fn name(&self) -> &str {
        "cap"
    }

    fn serves(&self) -> &[ActionKind] {
        &[ActionKind::AssembleCap]
    }

    fn needs(&self) -> &[Need] {
        &[Need::HoldsPart, Need::InsertionPath]
    }

    fn parameters(&self) -> &[&'static str] {
        &["cap", "insertion", "search_cap"]
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

impl Cap {
    /// With these numbers.
    pub fn new(parameters: &Parameters) -> Cap {
        Cap { parameters: parameters.cap.clone(), insertion: Insertion::new(parameters) }
    }

    fn once(&self, cell: &mut Workcell, beam: usize, attempt: usize) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        // Pressed on the table.
        let height = -self.parameters.down;
        let aim = self.insertion.begin(cell, beam, height, attempt)?;
        cell.glance()?;
        let mut target = cell.hand.corrected(&cell.belief.parts.pose(&name)?, &aim.goal);
        target.translation.vector += aim.direction * self.parameters.overdrive;
        target.translation.z += height;
        if self.meets_angled(cell, beam, &aim.direction) {
            self.pass_under(cell, beam, &aim.goal, height)?;
        }
        let pushed = self.insertion.push_in(cell, beam, &aim, &target, None, self.parameters.limit)?;
        self.finish(cell, beam, &(Translation3::new(0.0, 0.0, height) * aim.goal), pushed.force)
    }

    /// Does a beam take in ends that come at an angle to its insertion path?
    fn meets_angled(&self, cell: &Workcell, beam: usize, direction: &Vector3<f64>) -> bool {
        cell.assembly.connections.iter().filter_map(|connection| cell.assembly.sides(connection, beam)).any(
            |(_, theirs)| {
                let other = &cell.assembly.beams[theirs.beam];
                let along = cell.belief.x_wa().rotation * other.x_ab.rotation * Vector3::x();
                let angle = along.dot(direction).abs().min(1.0).acos();
                cell.belief.meets(theirs, beam)
                    && other.beam.joints[theirs.joint].kind.is_end()
                    && angle > self.parameters.angled
            },
        )
    }

    /// Brings a cap, from where its insertion begins, with its lower plate under the ends that come at an
    /// angle: pressed on the table first, and with its nose down until they are past the plate's edge. Stops
    /// where it is blocked.
    fn pass_under(
        &self,
        cell: &mut Workcell,
        beam: usize,
        goal: &Pose,
        height: f64,
    ) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        let direction = cell.belief.insertion_direction(beam, goal)?;
        let lean = UnitQuaternion::from_scaled_axis(Vector3::z().cross(&direction) * self.parameters.lean);
        let leaning = Pose::from_parts(goal.translation, lean * goal.rotation);
        let x_wp = cell.belief.parts.pose(&name)?;
        let stations =
            [cell.belief.remaining(&name, goal, &direction)?, self.parameters.under].map(|before| {
                let mut target = cell.hand.corrected(&x_wp, &leaning);
                target.translation.vector += Vector3::z() * height - direction * before;
                target
            });
        for target in stations {
            if cell.hand.drive(&target, cell.parameters.insertion.speed, |hand| {
                hand.force().dot(&direction) > self.parameters.limit
            })? {
                break;
            }
        }
        Ok(())
    }

    /// Ends a cap that has been pushed as far as it went, at `goal` if all is well: searches compliantly for
    /// an end that is blocked, then sweeps both ends to their stop walls. An end that is still short after
    /// that is searched for once more.
    fn finish(&self, cell: &mut Workcell, beam: usize, goal: &Pose, force: f64) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        let direction = cell.belief.insertion_direction(beam, goal)?;
        for enough in [self.parameters.blocked, self.parameters.short] {
            if cell.belief.remaining(&name, goal, &direction)? > enough {
                self.free(cell, beam, goal, force)?;
            }
            self.sweep(cell)?;
            cell.belief.parts.update(&mut cell.hand)?;
            if cell.belief.remaining(&name, goal, &direction)? < self.parameters.short {
                break;
            }
        }
        Ok(())
    }

    /// Searches compliantly for an end that is blocked, and presses the cap on.
    ///
    /// # Errors
    /// [`Fault::Jammed`](crate::Fault::Jammed) with the cap backed out, or the fault that stopped the motion.
    fn free(&self, cell: &mut Workcell, beam: usize, goal: &Pose, force: f64) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        let direction = cell.belief.insertion_direction(beam, goal)?;
        let remaining = cell.belief.remaining(&name, goal, &direction)?;
        let met = format!("{name} meets {force:.0} N {:.1} mm before its place", remaining * 1e3);
        let stood = cell.compliant_search(&name, goal, &direction, &cell.parameters.search_cap.clone())?;
        let mut home = cell.hand.corrected(&cell.belief.parts.pose(&name)?, goal);
        home.translation.vector += direction * self.parameters.overdrive;
        cell.hand.drive(&home, cell.parameters.insertion.speed, |hand| {
            hand.force().dot(&direction) > self.parameters.press
        })?;
        cell.hand.wait(cell.parameters.insertion.rest)?;
        cell.glance()?;
        let remaining = cell.belief.remaining(&name, goal, &direction)?;
        let blocked = remaining > self.parameters.blocked;
        if stood > cell.parameters.insertion.stuck || blocked {
            cell.diagnose(Cause::Jam, name.as_str(), met);
        }
        if blocked {
            return self.insertion.back_out(cell, beam, &direction, remaining, force);
        }
        Ok(())
    }

    /// Turns a capped beam to and fro about its grasp while it is pressed on, so that both ends find their
    /// walls.
    fn sweep(&self, cell: &mut Workcell) -> Result<(), SkillError> {
        let centre = cell.hand.setpoint;
        let sweep = self.parameters.sweep;
        for angle in [sweep, -sweep, 0.0] {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
            let target = Pose::from_parts(centre.translation, turn * centre.rotation);
            cell.hand.drive(&target, self.parameters.sweep_speed, |hand| {
                hand.force().norm() > 1.5 * self.parameters.press
            })?;
            cell.hand.settle()?;
        }
        Ok(())
    }
}
