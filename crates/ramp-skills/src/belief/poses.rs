//! The believed places of the parts: their poses, points and holes, and how well they are known.

use nalgebra::Point3;
use ramp_assembly::{Assembly, Connection, JointRef};

use super::part::Frame;
use super::parts::Belief;
use crate::Pose;
use crate::fault::{Fault, SkillError};

impl Belief {
    /// The pose of a part in the world.
    ///
    /// # Errors
    /// [`Fault::Unseen`].
    pub fn pose(&self, part: &str) -> Result<Pose, SkillError> {
        self.find(part).ok_or_else(|| Fault::Unseen { part: part.to_string() }.into())
    }

    pub(super) fn find(&self, part: &str) -> Option<Pose> {
        let part = self.parts.get(part).filter(|part| part.seen)?;
        Some(match part.frame {
            Frame::Tip => self.x_wt * part.estimate.x,
            Frame::World | Frame::Clamped => part.estimate.x,
        })
    }

    /// Uncertainty of a point of a part (m, in the part's frame): the standard deviation in the direction of
    /// the table in which it is largest, and that of its height, m. Infinite for a part that was never
    /// detected.
    pub fn deviation(&self, part: &str, p: &Point3<f64>) -> [f64; 2] {
        let Some(part) = self.parts.get(part).filter(|part| part.seen && part.odd.is_none()) else {
            return [f64::INFINITY; 2];
        };
        let covariance = match part.frame {
            Frame::Tip => part.estimate.seen_from(&self.x_wt).point_covariance(p),
            Frame::World | Frame::Clamped => part.estimate.point_covariance(p),
        };
        let [xx, yy, xy] = [covariance[(0, 0)], covariance[(1, 1)], covariance[(0, 1)]];
        let largest = (xx + yy) / 2.0 + ((xx - yy) / 2.0).hypot(xy);
        [largest, covariance[(2, 2)]].map(|variance| variance.max(0.0).sqrt())
    }

    /// The hole of a joint: its point on the beam's axis, in the world.
    ///
    /// # Errors
    /// [`Fault::Unseen`].
    pub fn hole(&self, assembly: &Assembly, joint: JointRef) -> Result<Point3<f64>, SkillError> {
        let beam = &assembly.beams[joint.beam].beam;
        Ok(self.pose(&beam.name)? * beam.p_b_hole(joint.joint))
    }

    /// Horizontal distance between the two holes of a connection, m.
    ///
    /// # Errors
    /// [`Fault::Unseen`].
    pub fn offset(&self, assembly: &Assembly, connection: &Connection) -> Result<f64, SkillError> {
        let female = self.hole(assembly, connection.female)?;
        let male = self.hole(assembly, connection.male)?;
        Ok((female.xy() - male.xy()).norm())
    }
}
