//! Sliding a beam that stands deeper than its place forward into the joint that has meanwhile come in front of it.
//!
//! A beam whose ends are all male droops while one female alone holds it, and no other beam can be put over an end
//! that hangs on the table. So it is put in deeper than its place, the other beam is brought, and then this one is
//! lifted level and slid forward.

use nalgebra::{Point3, Translation3};

use crate::fault::{Fault, SkillError};
use crate::feel::Feel;
use crate::grasp;
use crate::transport::Workcell;

/// Speed, m/s.
const SPEED: f64 = 0.02;
/// Force at which lifting stops, N.
const LIFT_LIMIT: f64 = 20.0;
/// Force against the motion at which sliding stops, N.
const LIMIT: f64 = 6.0;
/// Distance from its place at which the beam is home, m.
const HOME: f64 = 0.8e-3;
/// How well the joints that are to meet must be known, m.
const KNOWN: f64 = 0.2e-3;
/// Steps aside, in turn, when the end meets an edge, m.
const ASIDE: [f64; 5] = [0.0, 0.8e-3, -0.8e-3, 1.6e-3, -1.6e-3];

impl Workcell<'_, '_> {
    /// Slides a deep beam forward to its place, holding it by `link`, and lets go.
    ///
    /// # Errors
    /// [`Fault::Jammed`] when it does not get there, or what stopped the motion.
    pub fn slide(&mut self, beam: usize, link: &str) -> Result<(), SkillError> {
        let placed = &self.assembly.beams[beam];
        let name = placed.beam.name.clone();
        let link = placed.beam.links.iter().find(|candidate| candidate.name == link);
        let link = link.ok_or_else(|| Fault::NoGrasp { part: name.clone() })?;
        let s = grasp::point_on(link, self.free_end(beam));
        self.see(&self.meeting(beam), KNOWN)?;
        self.see_to_grip(&name)?;
        // How it hangs is known better than seen: 0.2° lower, and its end would go under the joint.
        self.reckon_heights(beam);
        self.seize_standing(beam, s)?;
        self.hand.zero()?;
        let mut jam = None;
        for (attempt, aside) in ASIDE.into_iter().enumerate() {
            if attempt > 0 {
                self.note("retry", format!("slide {name}, {:.1} mm aside", aside * 1e3));
            }
            jam = self.slide_once(beam, aside)?;
            if jam.is_none() {
                break;
            }
        }
        if let Some(fault) = jam {
            self.release()?;
            return Err(fault.into());
        }
        self.deep.retain(|other| *other != beam);
        self.release()?;
        self.reckon_heights(beam);
        Ok(())
    }

    /// One try of a beam that is in the hand, its free end aimed `aside` (m) of where its female is.
    fn slide_once(&mut self, beam: usize, aside: f64) -> Result<Option<Fault>, SkillError> {
        let placed = &self.assembly.beams[beam];
        let name = placed.beam.name.clone();
        let goal = self.target(beam)?;
        let out = -self.way_in(beam, &goal)?;
        let across = nalgebra::Vector3::z().cross(&out);
        let depth = self.way(beam)?.depth;
        self.glance()?;
        let x_wb = self.belief.pose(&name)?;
        let end = Point3::new(self.free_end(beam), 0.0, 0.0);
        // Level, and in line with its place, as far in as it is.
        let to_go = (goal * end - x_wb * end).dot(&out).min(depth);
        let shift = across * aside - out * to_go;
        let level = Translation3::from(shift) * goal;
        let lifted = self.hand.corrected(&x_wb, &level);
        self.hand.drive(&lifted, SPEED, |hand| hand.force().norm() > LIFT_LIMIT)?;
        self.hand.wait(0.1)?;
        self.glance()?;
        let here = self.hand.corrected(&self.belief.pose(&name)?, &level);
        self.hand.go(&here, SPEED)?;
        let forward = Translation3::from(out * to_go) * here;
        let stopped = self.hand.drive(&forward, SPEED, |hand| hand.force().dot(&out) > LIMIT)?;
        let force = self.hand.force().dot(&out);
        self.hand.wait(0.15)?;
        self.belief.update(&mut self.hand)?;
        let remaining = (goal * end - self.belief.pose(&name)? * end).dot(&out);
        if stopped && remaining > HOME {
            // Back to where it began.
            let mut back = self.hand.setpoint;
            back.translation.vector -= out * (to_go - remaining).max(0.0);
            self.hand.go(&back, SPEED)?;
            return Ok(Some(Fault::Jammed { part: name, remaining_mm: remaining * 1e3, force }));
        }
        let fine = self.hand.corrected(&self.belief.pose(&name)?, &goal);
        self.hand.drive(&fine, 0.01, |hand| hand.force().norm() > LIMIT)?;
        self.hand.wait(0.15)?;
        self.see(&[(name.clone(), end)], KNOWN)?;
        let remaining = self.remaining(&name, &goal, &out)?;
        if remaining > HOME {
            self.note("retry", format!("slide {name}, {:.1} mm short", remaining * 1e3));
            self.feel_in(&name, &goal, &out, Feel::into(false))?;
        }
        Ok(None)
    }

    /// Distance from j1, m, of the end of a deep beam that is to go into the other joint: the one that leads the way
    /// out.
    pub fn free_end(&self, beam: usize) -> f64 {
        let placed = &self.assembly.beams[beam];
        let along = placed.x_ab.rotation * nalgebra::Vector3::x();
        let into = self.ways.get(&beam).map_or(0.0, |way| along.dot(&way.direction));
        if into > 0.0 { 0.0 } else { placed.beam.span() }
    }
}
