//! Changes the grasp of a beam: the arm lays it on a free place of the table and picks it up by another link.

use std::f64::consts::FRAC_PI_4;

use nalgebra::{Translation3, UnitQuaternion, Vector2, Vector3};
use ramp_kit::Beam;
use ramp_robot::Retry;

use super::contract::{ActionKind, Call, Effect, Need, Skill};
use super::pick_up::PickUp;
use crate::Pose;
use crate::cell::Workcell;
use crate::fault::{Fault, SkillError};
use crate::grasp::{beam_grasp, points_on};
use crate::parameters::Parameters;
use crate::parameters::skills::RegraspParameters;
use crate::rehearsal::outline::{InHand, Motion, Outline};
use crate::rehearsal::scene::Scene;

/// Changes the grasp of the held beam to another link: lays it on a free place of the table, and picks it up
/// again.
#[derive(Clone)]
pub struct Regrasp {
    parameters: RegraspParameters,
    pick_up: PickUp,
}

impl Skill for Regrasp {
    fn name(&self) -> &str {
        "regrasp"
    }

    fn serves(&self) -> &[ActionKind] {
        &[ActionKind::Regrasp]
    }

    fn needs(&self) -> &[Need] {
        &[Need::HoldsPart]
    }

    fn parameters(&self) -> &[&'static str] {
        &["regrasp"]
    }

    fn expects(&self) -> &[Effect] {
        &[Effect::HoldsPart]
    }

    /// The beam lies on a free place of the table when the hand takes it again: any grasp of the link will do
    /// there.
    fn rehearse(&self, scene: &Scene, call: &Call) -> Outline {
        let Some(part) = call.part().filter(|part| scene.holds(part).is_some()) else {
            return Outline::nothing();
        };
        let Some(x_wp) = scene.x_wp(part) else { return Outline::nothing() };
        let grasps = scene.grasps(part, call.link()).into_iter();
        Outline::Alternatives(
            grasps.map(|grasp| vec![Motion::Hold(InHand::by(part, &x_wp, &grasp))]).collect(),
        )
    }

    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let beam = call.beam(cell.assembly)?;
        let link = call.link().ok_or_else(|| call.no_skill())?;
        self.regrasp(cell, beam, link)
    }
}

impl Regrasp {
    /// With these numbers.
    pub fn new(parameters: &Parameters) -> Regrasp {
        Regrasp { parameters: parameters.regrasp.clone(), pick_up: PickUp::new(parameters) }
    }

    /// Changes the hold of the beam in the hand to `link`.
    ///
    /// # Errors
    /// [`Fault::NoGrasp`] when there is no free place for it, or the fault that stopped the motion.
    pub fn regrasp(&self, cell: &mut Workcell, beam: usize, link: &str) -> Result<(), SkillError> {
        let beam = &cell.assembly.beams[beam].beam;
        self.lay_aside(cell, beam, link, |_| true)?;
        self.pick_up.pick_up(cell, &beam.name, Some(link))?;
        cell.laid_at.pop();
        cell.retreat()
    }

    /// Lays the held beam down on the nearest free place of the table at which `link` can be gripped, among
    /// the poses of the beam in the world that are allowed. The place is the last of those in
    /// `cell.laid_at`.
    ///
    /// # Errors
    /// As [`Regrasp::regrasp`].
    pub fn lay_aside(
        &self,
        cell: &mut Workcell,
        beam: &Beam,
        link: &str,
        allowed: impl Fn(&Pose) -> bool,
    ) -> Result<(), SkillError> {
        cell.retreat()?;
        cell.check_grip(&beam.name)?;
        let place = self.free_place(cell, beam, link, allowed)?;
        // Should the hand fail to take the beam there, it lays it down in another place next time.
        cell.laid_at.push(place.translation.vector.xy());
        let travel = cell.parameters.travel.height;
        let down = cell.carry_above(place, |down| travel.max(down))?;
        cell.hand.relax();
        let mut low = down;
        low.translation.z += self.parameters.drop;
        cell.hand.go(&low, self.parameters.down_speed)?;
        cell.hand.zero()?;
        // The beam may sit in the hand otherwise than is believed: the table says when it lies.
        let mut under = down;
        under.translation.z -= self.parameters.drop / 2.0;
        cell.hand.drive(&under, self.parameters.speed, |hand| -hand.force().z > self.parameters.limit)?;
        cell.release()?;
        cell.retreat()
    }

    /// Grasps a beam again that is tilted in the hand: laid on the table, it lies level.
    ///
    /// # Errors
    /// As [`Regrasp::regrasp`].
    pub fn level(&self, cell: &mut Workcell, beam: usize) -> Result<(), SkillError> {
        if cell.is_tilted() { self.grasp_again(cell, beam) } else { Ok(()) }
    }

    /// Lays the held beam down and takes it by the same link again.
    ///
    /// # Errors
    /// As [`Regrasp::regrasp`].
    pub fn grasp_again(&self, cell: &mut Workcell, beam: usize) -> Result<(), SkillError> {
        let Some(held) = &cell.hand.held else { return Ok(()) };
        // The current grasp.
        let s = held.x_tp.inverse_transform_point(&nalgebra::Point3::origin()).x;
        let links = &cell.assembly.beams[beam].beam.links;
        let off = |link: &ramp_kit::Link| (s - s.clamp(link.grasp[0], link.grasp[1])).abs();
        let Some(link) = links.iter().min_by(|a, b| off(a).total_cmp(&off(b))) else { return Ok(()) };
        let link = link.name.clone();
        cell.record(Retry::new("regrasp", &link));
        self.regrasp(cell, beam, &link)
    }

    /// The pose of the tip at which the held beam lies on the table beside everything else, with room for the
    /// hand now and when it takes the beam by `link`; the nearest one. The hand leans when the beam is tilted
    /// in it.
    fn free_place(
        &self,
        cell: &Workcell,
        beam: &Beam,
        link: &str,
        allowed: impl Fn(&Pose) -> bool,
    ) -> Result<Pose, SkillError> {
        let no_grasp = || Fault::NoGrasp { part: beam.name.clone() };
        let link = beam.links.iter().find(|candidate| candidate.name == link).ok_or_else(no_grasp)?;
        let held = cell.hand.held.as_ref().ok_or_else(no_grasp)?;
        let tip = cell.hand.seen.x_wt;
        let height = beam.axis_height_on_table();
        let ([x0, x1], [y0, y1]) = (self.parameters.table_x, self.parameters.table_y);
        let step = self.parameters.step;
        let along = |from: f64, to: f64| {
            (0..=((to - from) / step).round() as usize).map(move |index| from + index as f64 * step)
        };
        let mut places: Vec<(f64, Pose)> = Vec::new();
        let near = |p: &Vector2<f64>| cell.laid_at.iter().any(|other| (p - other).norm() < 1.5 * step);
        let table = along(x0, x1).flat_map(|x| along(y0, y1).map(move |y| (x, y)));
        for (x, y) in table.filter(|(x, y)| !near(&Vector2::new(*x, *y))) {
            for turn in -4..4 {
                let angle = f64::from(turn) * FRAC_PI_4;
                let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle) * tip.rotation;
                let mut x_wt = Pose::from_parts(Translation3::new(x, y, 0.0), turned);
                if cell.is_tilted() {
                    let axis = x_wt.rotation * held.x_tp.rotation * Vector3::x();
                    let level = Vector3::new(axis.x, axis.y, 0.0);
                    let lean = UnitQuaternion::rotation_between(&axis, &level).unwrap_or_default();
                    x_wt.rotation = lean * x_wt.rotation;
                }
                x_wt.translation.z = height - (x_wt * held.x_tp).translation.z;
                let distance = (x - tip.translation.x).hypot(y - tip.translation.y);
                // A turn of the hand takes about as long as this distance.
                places.push((distance + 0.1 * angle.abs(), x_wt));
            }
        }
        places.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let q = cell.hand.joints();
        let now = cell.checker(None);
        let place = places.into_iter().map(|(_, x_wt)| x_wt).find(|x_wt| {
            let over = Translation3::new(0.0, 0.0, self.parameters.over) * x_wt;
            if !allowed(&(x_wt * held.x_tp)) {
                return false;
            }
            if !cell.planner.solve(&over, &q).is_ok_and(|q| {
                cell.planner.kinematics.range_margin(&q) > self.parameters.room
                    && now.is_free(&cell.planner.kinematics.frames(&q))
            }) {
                return false;
            }
            let x_wb = x_wt * held.x_tp;
            cell.has_room(x_wt, cell.parameters.grip.beam_release, &beam.name)
                && points_on(link, beam.span() / 2.0, &cell.parameters.grip).first().is_some_and(|s| {
                    [false, true].into_iter().any(|reverse| {
                        let x_wt = beam_grasp(&x_wb, *s, reverse);
                        let mut above = x_wt;
                        above.translation.z = above.translation.z.max(cell.parameters.travel.height);
                        cell.reach(&x_wt, &q) > self.parameters.room
                            && cell.reach(&above, &q) > self.parameters.room
                            && cell.has_room(&x_wt, cell.parameters.grip.beam_open, &beam.name)
                    })
                })
        });
        place.ok_or_else(|| no_grasp().into())
    }
}
