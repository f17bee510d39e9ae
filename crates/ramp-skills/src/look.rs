//! Looking: as often as it takes to know well enough what the next step needs.

use nalgebra::Point3;
use ramp_assembly::JointRef;

use crate::fault::SkillError;
use crate::transport::Workcell;

/// Longest series of looks, s: what is not known well enough by then has to be found by feel.
const LONGEST: f64 = 15.0;

/// How well a part must be known before it is gripped, along the table and in height, m.
const GRASPABLE: [f64; 2] = [0.5e-3, 0.2e-3];

/// A point of a part: its name, and the point in its frame, m.
pub type Point = (String, Point3<f64>);

impl Workcell<'_, '_> {
    /// Looks once, and on until the place of each of these points on the table is known to a standard deviation of
    /// `within`, m.
    ///
    /// # Errors
    /// The robot's.
    pub fn see(&mut self, points: &[Point], within: f64) -> Result<(), SkillError> {
        self.see_until(points, [within, f64::INFINITY])
    }

    /// As [`Workcell::see`], for a part that is to be gripped. The fingers centre it, so that half a millimetre is
    /// well enough along the table; but their ribs have only 1 mm of room above and below in a beam's slots.
    ///
    /// # Errors
    /// The robot's.
    pub fn see_to_grip(&mut self, part: &str) -> Result<(), SkillError> {
        self.see_until(&[self.middle(part)], GRASPABLE)
    }

    /// As [`Workcell::see`], for the heights of the points.
    ///
    /// # Errors
    /// The robot's.
    pub fn see_height(&mut self, points: &[Point], within: f64) -> Result<(), SkillError> {
        self.see_until(points, [f64::INFINITY, within])
    }

    fn see_until(&mut self, points: &[Point], within: [f64; 2]) -> Result<(), SkillError> {
        let begin = self.hand.time();
        loop {
            self.belief.update(&mut self.hand)?;
            for (part, off) in self.belief.astray() {
                self.note("seen", format!("{part} is {:.1} mm from where it was believed", off * 1e3));
            }
            let known = points.iter().all(|(part, p)| {
                let deviation = self.belief.deviation(part, p);
                deviation[0] <= within[0] && deviation[1] <= within[1]
            });
            if known || self.hand.sight_cost <= 0.0 || self.hand.time() - begin > LONGEST {
                return Ok(());
            }
        }
    }

    /// Looks where that costs no time, and otherwise reckons on from what is known: for use within a motion.
    ///
    /// # Errors
    /// The robot's.
    pub fn glance(&mut self) -> Result<(), SkillError> {
        if self.hand.sight_cost > 0.0 {
            self.belief.follow(&self.hand);
        } else {
            self.belief.update(&mut self.hand)?;
        }
        Ok(())
    }

    /// The middle of a part.
    pub fn middle(&self, part: &str) -> Point {
        let x = self.kit.beam(part).map_or(0.0, |beam| beam.span() / 2.0);
        (part.to_string(), Point3::new(x, 0.0, 0.0))
    }

    /// The hole of a joint of the assembly.
    pub fn hole(&self, joint: JointRef) -> Point {
        let beam = &self.assembly.beams[joint.beam].beam;
        (beam.name.clone(), beam.p_b_hole(joint.joint))
    }
}
