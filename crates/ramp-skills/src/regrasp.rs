//! Taking a beam by another link: it is laid down on a free place of the table, let go of, and picked up again.

use std::f64::consts::FRAC_PI_4;

use nalgebra::{Translation3, UnitQuaternion, Vector3};

use crate::Pose;
use crate::fault::{Fault, SkillError};
use crate::grasp::{BEAM_OPEN, BEAM_RELEASE, beam_grasp, points_on};
use crate::transport::{TRAVEL, Workcell};

/// Where places are tried on the table, m in the world, and how far apart.
const TABLE: ([f64; 2], [f64; 2], f64) = ([0.25, 0.70], [-0.45, 0.55], 0.05);
/// Height over the table at which a held beam's place is checked, m.
const OVER: f64 = 3.0e-3;
/// Height from which it is set down slowly, m.
const DROP: f64 = 20.0e-3;
/// Force on the table at which it lies, N.
const LIMIT: f64 = 8.0;
/// Speed, m/s.
const SPEED: f64 = 0.03;
/// Sine of how far a beam in the hand may be from level.
const ASLANT: f64 = 0.035;
/// How far the joints must stay from the ends of their ranges, rad.
const ROOM: f64 = 0.1;

impl Workcell<'_, '_> {
    /// Changes the hold of the beam in the hand to `link`.
    ///
    /// # Errors
    /// [`Fault::NoGrasp`] when there is no free place for it, or what stopped the motion.
    pub fn regrasp(&mut self, beam: usize, link: &str) -> Result<(), SkillError> {
        let name = self.assembly.beams[beam].beam.name.clone();
        self.rise()?;
        self.regrip(&name)?;
        let place = self.free_place(beam, link)?;
        let down = self.bring_above(place, |down| TRAVEL.max(down))?;
        self.hand.relax();
        let mut low = down;
        low.translation.z += DROP;
        self.hand.go(&low, 0.2)?;
        self.hand.zero()?;
        // The beam may sit in the hand otherwise than is believed: the table says when it lies.
        let mut under = down;
        under.translation.z -= DROP / 2.0;
        self.hand.drive(&under, SPEED, |hand| -hand.force().z > LIMIT)?;
        self.release()?;
        self.rise()?;
        self.pick_up(&name, Some(link))?;
        self.rise()
    }

    /// Does the held beam sit aslant in the hand?
    pub fn is_aslant(&self) -> bool {
        self.hand.held.as_ref().is_some_and(|held| (held.x_tp.rotation * Vector3::x()).z.abs() > ASLANT)
    }

    /// Takes a beam anew that sits aslant in the hand: laid on the table, it lies level.
    ///
    /// # Errors
    /// As [`Workcell::regrasp`].
    pub fn level(&mut self, beam: usize) -> Result<(), SkillError> {
        if self.is_aslant() { self.take_anew(beam) } else { Ok(()) }
    }

    /// Lays the held beam down and takes it by the same link again.
    ///
    /// # Errors
    /// As [`Workcell::regrasp`].
    pub(crate) fn take_anew(&mut self, beam: usize) -> Result<(), SkillError> {
        let Some(held) = &self.hand.held else { return Ok(()) };
        // Where the hand holds it now.
        let s = held.x_tp.inverse_transform_point(&nalgebra::Point3::origin()).x;
        let links = &self.assembly.beams[beam].beam.links;
        let off = |link: &ramp_kit::Link| (s - s.clamp(link.grasp[0], link.grasp[1])).abs();
        let Some(link) = links.iter().min_by(|a, b| off(a).total_cmp(&off(b))) else { return Ok(()) };
        let link = link.name.clone();
        self.note("retry", format!("take {link} anew"));
        self.regrasp(beam, &link)
    }

    /// The pose of the tip at which the held beam lies on the table beside everything else, with room for the hand now
    /// and when it takes the beam by `link`; the nearest one. The hand leans when the beam sits aslant in it.
    fn free_place(&self, beam: usize, link: &str) -> Result<Pose, SkillError> {
        let beam = &self.assembly.beams[beam].beam;
        let no_grasp = || Fault::NoGrasp { part: beam.name.clone() };
        let link = beam.links.iter().find(|candidate| candidate.name == link).ok_or_else(no_grasp)?;
        let held = self.hand.held.as_ref().ok_or_else(no_grasp)?;
        let tip = self.hand.seen.x_wt;
        let height = beam.axis_height_on_table();
        let ([x0, x1], [y0, y1], step) = TABLE;
        let along = |from: f64, to: f64| {
            (0..=((to - from) / step).round() as usize).map(move |index| from + index as f64 * step)
        };
        let mut places: Vec<(f64, Pose)> = Vec::new();
        for (x, y) in along(x0, x1).flat_map(|x| along(y0, y1).map(move |y| (x, y))) {
            for turn in -4..4 {
                let angle = f64::from(turn) * FRAC_PI_4;
                let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle) * tip.rotation;
                let mut x_wt = Pose::from_parts(Translation3::new(x, y, 0.0), turned);
                if self.is_aslant() {
                    let axis = x_wt.rotation * held.x_tp.rotation * Vector3::x();
                    let level = Vector3::new(axis.x, axis.y, 0.0);
                    let lean = UnitQuaternion::rotation_between(&axis, &level).unwrap_or_default();
                    x_wt.rotation = lean * x_wt.rotation;
                }
                x_wt.translation.z = height - (x_wt * held.x_tp).translation.z;
                let way = (x - tip.translation.x).hypot(y - tip.translation.y);
                // A turn of the hand takes about as long as this way.
                places.push((way + 0.1 * angle.abs(), x_wt));
            }
        }
        places.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let q = self.hand.joints();
        let now = self.checker(None);
        let place = places.into_iter().map(|(_, x_wt)| x_wt).find(|x_wt| {
            let over = Translation3::new(0.0, 0.0, OVER) * x_wt;
            if !self.planner.solve(&over, &q).is_ok_and(|q| {
                self.planner.kinematics.range_margin(&q) > ROOM
                    && now.is_free(&self.planner.kinematics.frames(&q))
            }) {
                return false;
            }
            let x_wb = x_wt * held.x_tp;
            self.has_room(x_wt, BEAM_RELEASE, &beam.name)
                && points_on(link, beam.span() / 2.0).first().is_some_and(|s| {
                    [false, true].into_iter().any(|reverse| {
                        let x_wt = beam_grasp(&x_wb, *s, reverse);
                        self.reach(&x_wt, &q) > ROOM && self.has_room(&x_wt, BEAM_OPEN, &beam.name)
                    })
                })
        });
        place.ok_or_else(|| no_grasp().into())
    }
}
