//! Picks up a part and lifts it a little.

use nalgebra::Point3;
use ramp_planner::{End, FineAction, Impossible, Item};

use super::contract::{ActionKind, Call, Effect, Need, Skill};
use crate::cell::Workcell;
use crate::fault::SkillError;
use crate::grasp::{BEAM_HEIGHT, lean_of_beam};
use crate::parameters::Parameters;
use crate::parameters::skills::PickUpParameters;
use crate::primitive::grip::rehearse_grasps;
use crate::rehearsal::outline::Outline;
use crate::rehearsal::scene::Scene;

/// Grasps a part where it stands, and lifts it.
#[derive(Clone)]
pub struct PickUp {
    parameters: PickUpParameters,
}

impl Skill for PickUp {
    fn name(&self) -> &str {
        "pick_up"
    }

    fn serves(&self) -> &[ActionKind] {
        &[ActionKind::PickUp]
    }

    fn needs(&self) -> &[Need] {
        &[Need::HandEmpty]
    }

    fn parameters(&self) -> &[&'static str] {
        &["pick_up"]
    }

    fn expects(&self) -> &[Effect] {
        &[Effect::HoldsPart]
    }

    fn rehearse(&self, scene: &Scene, call: &Call) -> Outline {
        let Some(part) = call.part() else { return Outline::nothing() };
        rehearse_grasps(scene, part, scene.grasps(part, call.link()))
    }

    fn blame(&self, call: &Call) -> Option<Impossible> {
        match call.action {
            FineAction::PickUp { item: Item::Beam(_), .. } => call.cannot_grasp(End::Start),
            _ => None,
        }
    }

    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let part = call.part().ok_or_else(|| call.no_skill())?;
        self.pick_up(cell, part, call.link())
    }
}

impl PickUp {
    /// With these numbers.
    pub fn new(parameters: &Parameters) -> PickUp {
        PickUp { parameters: parameters.pick_up.clone() }
    }

    /// Picks up a part and lifts it a little.
    ///
    /// # Errors
    /// As [`Workcell::grasp`].
    pub fn pick_up(&self, cell: &mut Workcell, part: &str, link: Option<&str>) -> Result<(), SkillError> {
        cell.see_to_grip(part)?;
        let grasp = cell.choose_grasp(part, link)?;
        let x_wp = cell.belief.parts.pose(part)?;
        cell.grasp(part, &grasp)?;
        let mut up = cell.hand.setpoint;
        // A peg must leave its holder altogether, a beam only the table.
        up.translation.z +=
            if cell.kit.beam(part).is_some() { self.parameters.lift } else { self.parameters.peg_lift };
        let lean = cell.kit.beam(part).map(|beam| (beam.span(), lean_of_beam(&x_wp)));
        if let Some((span, Some(lean))) = lean {
            // Its axis over its higher end, so that it comes level over what it leaned on.
            let ends = [0.0, span].map(|along| (x_wp * Point3::new(along, 0.0, 0.0)).z);
            up.translation.z += ends[0].max(ends[1]) - (grasp.x_wt.translation.z - BEAM_HEIGHT);
            cell.hand.go(&up, self.parameters.leaning_speed)?;
            up.rotation = lean.inverse() * up.rotation;
            cell.hand.go(&up, self.parameters.leaning_speed)?;
        } else {
            cell.hand.go(&up, self.parameters.speed)?;
        }
        cell.check_grip(part)
    }
}
