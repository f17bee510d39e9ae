//! Alignment: deviation of the beams of the assembly from their targets.

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_assembly::{Assembly, JointRef};

use super::assembly_belief::AssemblyBelief;
use crate::Pose;
use crate::fault::SkillError;

impl AssemblyBelief<'_> {
    /// The beams that one peg holds and that have swung from their place, by index.
    ///
    /// # Errors
    /// [`Fault::Unseen`](crate::Fault::Unseen).
    pub fn swung(&self) -> Result<Vec<usize>, SkillError> {
        let mut swung = Vec::new();
        for beam in self.standing.iter().copied().filter(|beam| *beam != self.assembly.base) {
            if self.anchor(beam).is_some()
                && self.straightened(beam)?.1 > 3.0 * self.parameters.alignment.good
            {
                swung.push(beam);
            }
        }
        Ok(swung)
    }

    /// The pinned connections whose holes are surely too far apart for one peg, by index: it holds the female
    /// alone.
    ///
    /// # Errors
    /// [`Fault::Unseen`](crate::Fault::Unseen).
    pub fn missed(&self) -> Result<Vec<usize>, SkillError> {
        let mut missed = Vec::new();
        for (index, _) in &self.pinned {
            let connection = &self.assembly.connections[*index];
            let deviation = [connection.female, connection.male].map(|joint| {
                let (beam, p) = self.hole(joint);
                self.parts.deviation(&beam, &p)[0]
            });
            let unsure = self.parameters.diagnosis.sure * deviation[0].hypot(deviation[1]);
            let offset = self.parts.offset(self.assembly, connection)?;
            if offset > self.parameters.alignment.missed + unsure {
                missed.push(*index);
            }
        }
        Ok(missed)
    }

    /// The beams of the assembly that no peg holds and that are off their place, by index: one that was laid
    /// down in any direction, one that was inserted short of it.
    ///
    /// # Errors
    /// [`Fault::Unseen`](crate::Fault::Unseen).
    pub fn displaced(&self) -> Result<Vec<usize>, SkillError> {
        let mut off = Vec::new();
        for beam in self.standing.iter().copied().filter(|beam| *beam != self.assembly.base) {
            if self.anchor(beam).is_some() {
                continue;
            }
            let away = if self.lies(beam) { self.straightened(beam)?.1 } else { self.short(beam)? };
            if away > self.parameters.alignment.displaced {
                off.push(beam);
            }
        }
        Ok(off)
    }

    /// A standing beam was moved: the parts joined to it may have moved by up to the given amounts (m, rad).
    pub fn drag(&mut self, beam: usize, bump: (f64, f64)) {
        let sides = self.assembly.connections.iter();
        let joined = sides.filter_map(|connection| Some(self.assembly.sides(connection, beam)?.1.beam));
        let joined: Vec<usize> = joined.filter(|other| self.standing.contains(other)).collect();
        for other in joined {
            self.parts.bumped(&self.assembly.beams[other].beam.name, bump);
        }
    }

    /// Target pose of a standing beam in the world, and the distance of its far end from it, m. A pinned beam
    /// is rotated about its peg so that the hole of its next peg comes to the other beam's, or else its far
    /// end to its nominal place; any other goes to its target.
    pub fn straightened(&self, beam: usize) -> Result<(Pose, f64), SkillError> {
        let placed = &self.assembly.beams[beam];
        let x_wb = self.parts.pose(&placed.beam.name)?;
        let far = Point3::new(self.far_end(beam), 0.0, 0.0);
        let Some(anchor) = self.anchor(beam) else {
            let mut goal = self.target(beam)?;
            goal.translation.z = x_wb.translation.z;
            return Ok((goal, self.off(beam, &x_wb, &goal)));
        };
        let pivot = x_wb * placed.beam.p_b_hole(anchor.joint);
        // If it is to be pinned next to a standing beam, that hole counts; else its far end.
        let open = self.open_joint(beam, anchor);
        let (now, wanted) = match open {
            Some((mine, theirs)) => {
                (x_wb * placed.beam.p_b_hole(mine.joint), self.parts.hole(self.assembly, theirs)?)
            }
            None => (x_wb * far, self.x_wa() * placed.x_ab * far),
        };
        let (now, wanted) = (now.xy() - pivot.xy(), wanted.xy() - pivot.xy());
        let angle = now.perp(&wanted).atan2(now.dot(&wanted));
        let about = Translation3::from(pivot.coords);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        let goal = about * turn * about.inverse() * x_wb;
        Ok((goal, angle.abs() * now.norm()))
    }

    /// Remaining distance of a standing beam to its place along its insertion path, m.
    pub fn short(&self, beam: usize) -> Result<f64, SkillError> {
        if !self.paths.contains_key(&beam) {
            return Ok(0.0);
        }
        let goal = self.target(beam)?;
        let x_wb = self.parts.pose(&self.assembly.beams[beam].beam.name)?;
        Ok((goal.translation.vector - x_wb.translation.vector).dot(&self.insertion_direction(beam, &goal)?))
    }

    /// The joint of a beam that a peg already pins, if any.
    pub fn anchor(&self, beam: usize) -> Option<JointRef> {
        anchor(self.assembly, self.pinned.iter().map(|(index, _)| *index), beam)
    }

    /// The joint of a pinned beam that is furthest from its peg among those that meet a standing beam and
    /// have no peg yet, and what it meets.
    fn open_joint(&self, beam: usize, anchor: JointRef) -> Option<(JointRef, JointRef)> {
        let offset = |joint: JointRef| self.assembly.beams[beam].beam.joints[joint.joint].offset;
        let lever = |joint: JointRef| (offset(joint) - offset(anchor)).abs();
        // One that nothing holds would only be dragged along.
        let held = |theirs: JointRef| theirs.beam == self.assembly.base || self.anchor(theirs.beam).is_some();
        let open = self.assembly.connections.iter().enumerate().filter_map(|(index, connection)| {
            let (mine, theirs) = self.assembly.sides(connection, beam)?;
            let pinned = self.pinned.iter().any(|(other, _)| *other == index);
            (!pinned
                && held(theirs)
                && self.meets(theirs, beam)
                && lever(mine) > self.parameters.alignment.short)
                .then_some((mine, theirs))
        });
        open.max_by(|(a, _), (b, _)| lever(*a).total_cmp(&lever(*b)))
    }

    /// Horizontal distance between the far ends of a beam at `x_wb` and at `goal`, m.
    pub fn off(&self, beam: usize, x_wb: &Pose, goal: &Pose) -> f64 {
        distance_at(self.far_end(beam), x_wb, goal)
    }

    /// The same for its other end: a beam that no peg holds can be right at one end, and where a peg would
    /// not go in at the other.
    pub fn near_off(&self, beam: usize, x_wb: &Pose, goal: &Pose) -> f64 {
        distance_at(self.assembly.beams[beam].beam.span() - self.far_end(beam), x_wb, goal)
    }

    /// See [`far_end`].
    pub fn far_end(&self, beam: usize) -> f64 {
        far_end(self.assembly, self.pinned.iter().map(|(index, _)| *index), beam)
    }

    /// Distance of a beam from its insertion path, across `direction`, m: the largest over its joints.
    pub fn beside_path(&self, part: &str, goal: &Pose, direction: &Vector3<f64>) -> Result<f64, SkillError> {
        let x_wp = self.parts.pose(part)?;
        let beside = |p: Point3<f64>| {
            let off = goal * p - x_wp * p;
            (off - direction * off.dot(direction)).norm()
        };
        let joints = self.assembly.kit.beam(part).map_or(&[][..], |beam| &beam.joints);
        let joints = joints.iter().map(|joint| Point3::new(joint.offset, 0.0, 0.0));
        Ok(joints.map(beside).fold(beside(Point3::origin()), f64::max))
    }

    /// Remaining distance of a beam to its place along `direction`, m: the largest over its joints.
    pub fn remaining(&self, part: &str, goal: &Pose, direction: &Vector3<f64>) -> Result<f64, SkillError> {
        let x_wp = self.parts.pose(part)?;
        let short = |p: Point3<f64>| (goal * p - x_wp * p).dot(direction);
        let joints = self.assembly.kit.beam(part).map_or(&[][..], |beam| &beam.joints);
        let joints = joints.iter().map(|joint| Point3::new(joint.offset, 0.0, 0.0));
        Ok(joints.map(short).fold(short(Point3::origin()), f64::max))
    }
}

/// Distance along the table between where a point on a beam's axis, `x` metres from its j1 hole, is with the
/// beam at one pose and at the other, m.
fn distance_at(x: f64, x_wb: &Pose, other: &Pose) -> f64 {
    let p = Point3::new(x, 0.0, 0.0);
    ((x_wb * p).xy() - (other * p).xy()).norm()
}

/// The joint of a beam that a peg pins, if any. `pinned`: connections, by index.
pub fn anchor(assembly: &Assembly, mut pinned: impl Iterator<Item = usize>, beam: usize) -> Option<JointRef> {
    pinned.find_map(|index| assembly.sides(&assembly.connections[index], beam).map(|(mine, _)| mine))
}

/// Distance from j1, m, of the end of a beam that is further from its pinned joint. `pinned`: connections, by
/// index.
pub fn far_end(assembly: &Assembly, pinned: impl Iterator<Item = usize>, beam: usize) -> f64 {
    assembly.beams[beam].beam.far_end(anchor(assembly, pinned, beam).map_or(0, |joint| joint.joint))
}
