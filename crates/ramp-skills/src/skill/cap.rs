//! Puts the held beam as a cap over males of the assembly.

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_robot::Cause;

use super::contract::{ActionKind, Call, Effect, Need, Skill};
use super::insertion::Insertion;
use crate::Pose;
use crate::cell::Workcell;
use crate::fault::SkillError;
use crate::primitive::search::Compliance;

/// Speed of an insertion, m/s.
const SPEED: f64 = 0.03;
/// Force against the motion at which a cap stops, N: one that finds its males takes 5 N, and more on one of them alone turns
/// it in the hand.
const CAP_LIMIT: f64 = 10.0;
/// Force with which a cap is pressed home over what it was felt past, N.
const CAP_PRESS: f64 = 25.0;
/// An end of a cap this far before its place is blocked, m: a male that stands on a face stands 22 mm before it.
const CAP_BLOCKED: f64 = 4.0e-3;
/// How far the spring is pulled past the goal of a cap, m: it seats each end on its stop wall.
const CAP_OVERDRIVE: f64 = 3.0e-3;
/// How far a cap's leading edge leans down while it passes over an end at an angle, rad: as much as a beam may hang turned
/// in the hand unseen, since that end's corner clears the edge of the plate by no more than its own sag.
const CAP_LEAN: f64 = 1.0 / 180.0 * std::f64::consts::PI;
/// So far before its place a cap's lower plate is under such an end, m: its corner reaches 15 mm past the hole, the plate
/// 13.3 mm. Nose down for longer, it would lift the end, which then falls into the hole of the plate.
const CAP_UNDER: f64 = 24.0e-3;
/// An end is at an angle when its axis is so far from the way in, rad.
const ANGLED: f64 = 10.0 / 180.0 * std::f64::consts::PI;
/// Turn to and fro at the end of a cap, rad.
const CAP_SWEEP: f64 = 2.0 / 180.0 * std::f64::consts::PI;
/// Standing still for so long while it is felt in, a beam has met more than an edge, s.
const STUCK: f64 = 2.5;
/// How far below its height a cap is pressed on the table, m.
const CAP_DOWN: f64 = -2.0e-3;

/// Puts the held beam as a cap over males of the assembly: pressed on the table a little, pulled past its goal so that
/// each end seats on its stop wall, and swept to and fro at the end.
#[derive(Clone, Default)]
pub struct Cap {
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

    fn expects(&self) -> &[Effect] {
        &[Effect::BeamStands, Effect::HandEmpty]
    }

    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let beam = call.beam(cell)?;
        self.insertion.tries(cell, beam, |cell, attempt| self.once(cell, beam, attempt))
    }

    fn let_go(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let beam = call.beam(cell)?;
        self.insertion.let_go(cell, beam)
    }
}

impl Cap {
    fn once(&self, cell: &mut Workcell, beam: usize, attempt: usize) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        let aim = self.insertion.begin(cell, beam, CAP_DOWN, attempt)?;
        cell.glance()?;
        let mut target = cell.hand.corrected(&cell.belief.pose(&name)?, &aim.goal);
        target.translation.vector += aim.direction * CAP_OVERDRIVE;
        target.translation.z += CAP_DOWN;
        if self.meets_angled(cell, beam, &aim.direction) {
            self.pass_under(cell, beam, &aim.goal, CAP_DOWN)?;
        }
        let pushed = self.insertion.push_in(cell, beam, &aim, &target, CAP_LIMIT)?;
        self.finish(cell, beam, &(Translation3::new(0.0, 0.0, CAP_DOWN) * aim.goal), pushed.force)
    }

    /// Does a beam take in ends that come at an angle to its way in?
    fn meets_angled(&self, cell: &Workcell, beam: usize, direction: &Vector3<f64>) -> bool {
        cell.assembly.connections.iter().filter_map(|connection| cell.assembly.sides(connection, beam)).any(
            |(_, theirs)| {
                let other = &cell.assembly.beams[theirs.beam];
                let along = cell.kit.x_wa().rotation * other.x_ab.rotation * Vector3::x();
                let angle = along.dot(direction).abs().min(1.0).acos();
                cell.meets(theirs, beam) && other.beam.joints[theirs.joint].kind.is_end() && angle > ANGLED
            },
        )
    }

    /// Brings a cap, from where its insertion begins, with its lower plate under the ends that come at an angle: pressed on
    /// the table first, and with its nose down until they are past the plate's edge. Stops where it is blocked.
    fn pass_under(
        &self,
        cell: &mut Workcell,
        beam: usize,
        goal: &Pose,
        height: f64,
    ) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        let direction = cell.insertion_direction(beam, goal)?;
        let lean = UnitQuaternion::from_scaled_axis(Vector3::z().cross(&direction) * CAP_LEAN);
        let leaning = Pose::from_parts(goal.translation, lean * goal.rotation);
        let x_wp = cell.belief.pose(&name)?;
        let way = [cell.remaining(&name, goal, &direction)?, CAP_UNDER].map(|before| {
            let mut target = cell.hand.corrected(&x_wp, &leaning);
            target.translation.vector += Vector3::z() * height - direction * before;
            target
        });
        for target in way {
            if cell.hand.drive(&target, SPEED, |hand| hand.force().dot(&direction) > CAP_LIMIT)? {
                break;
            }
        }
        Ok(())
    }

    /// Ends a cap that has been pushed as far as it went, at `goal` if all is well: searches compliantly for an end that is
    /// blocked, then sweeps both ends home.
    fn finish(&self, cell: &mut Workcell, beam: usize, goal: &Pose, force: f64) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        let direction = cell.insertion_direction(beam, goal)?;
        let mut remaining = cell.remaining(&name, goal, &direction)?;
        if remaining > CAP_BLOCKED {
            let met = format!("{name} meets {force:.0} N {:.1} mm before its place", remaining * 1e3);
            let stood = cell.compliant_search(&name, goal, &direction, &Compliance::CAP)?;
            let mut home = cell.hand.corrected(&cell.belief.pose(&name)?, goal);
            home.translation.vector += direction * CAP_OVERDRIVE;
            cell.hand.drive(&home, SPEED, |hand| hand.force().dot(&direction) > CAP_PRESS)?;
            cell.hand.wait(0.15)?;
            cell.glance()?;
            remaining = cell.remaining(&name, goal, &direction)?;
            if stood > STUCK || remaining > CAP_BLOCKED {
                cell.diagnose(Cause::Jam, met);
            }
            if remaining > CAP_BLOCKED {
                return self.insertion.back_out(cell, beam, &direction, remaining, force);
            }
        }
        self.sweep(cell)?;
        cell.belief.update(&mut cell.hand)?;
        Ok(())
    }

    /// Turns a capped beam to and fro about its grasp while it is pressed on, so that both ends find their walls.
    fn sweep(&self, cell: &mut Workcell) -> Result<(), SkillError> {
        let centre = cell.hand.setpoint;
        for angle in [CAP_SWEEP, -CAP_SWEEP, 0.0] {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
            let target = Pose::from_parts(centre.translation, turn * centre.rotation);
            cell.hand.drive(&target, 0.03, |hand| hand.force().norm() > 1.5 * CAP_PRESS)?;
            cell.hand.wait(0.1)?;
        }
        Ok(())
    }
}
