//! Droop of a beam that only one female holds, and the resulting heights of a standing beam.

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_assembly::JointRef;
use ramp_kit::joint::{self, BODY_WIDTH, FEMALE_HEIGHT};

use super::assembly_belief::AssemblyBelief;
use crate::Pose;

impl AssemblyBelief<'_> {
    /// Pose of a drooping beam that only one female holds, rotated about the joint in it: its other end lies
    /// on the table. `None` for a beam that stands level.
    fn drooping(&self, beam: usize) -> Option<(JointRef, f64)> {
        let placed = &self.assembly.beams[beam].beam;
        if placed.stands_at_assembled_height() {
            return None;
        }
        let sides = self.assembly.connections.iter();
        let sides = sides.filter_map(|connection| self.assembly.sides(connection, beam));
        // A deep beam is short of the joint that it is to be slid into.
        let mut met = sides.filter(|(mine, theirs)| {
            self.standing.contains(&theirs.beam) && !(self.deep.contains(&beam) && self.leads(*mine))
        });
        let (joint, _) = met.next().filter(|_| met.next().is_none())?;
        let pivot = placed.joints[joint.joint].offset;
        // Measured from the table's height to where the axis is at the other end.
        let far = placed.far_end(joint.joint);
        let drop = (FEMALE_HEIGHT - BODY_WIDTH) / 2.0;
        let reach = (far - pivot).abs() + BODY_WIDTH / 2.0;
        Some((joint, (drop / reach).asin() * (far - pivot).signum()))
    }

    /// Resting pose of a beam at `x_wb` that droops about the joint that holds it; `None` when it stands
    /// level.
    pub fn drooped(&self, beam: usize, x_wb: &Pose) -> Option<Pose> {
        let (joint, angle) = self.drooping(beam)?;
        let pivot = Translation3::from((x_wb * self.assembly.beams[beam].beam.p_b_hole(joint.joint)).coords);
        let along = x_wb.rotation * Vector3::x();
        let up = self.x_wa().rotation * Vector3::z();
        let level = UnitQuaternion::rotation_between(&along, &(along - up * along.dot(&up)))?;
        let turn = UnitQuaternion::from_scaled_axis(up.cross(&along).normalize() * angle);
        Some(pivot * turn * level * pivot.inverse() * x_wb)
    }

    /// Known heights of a beam released in the assembly: on females or feet it stands level on the table;
    /// otherwise its males hang in their females, as low as the clearance lets them, and a beam that only one
    /// female holds lies on the table with its other end.
    pub fn reckon_heights(&mut self, beam: usize) {
        let placed = &self.assembly.beams[beam];
        let nominal = self.x_wa() * placed.x_ab;
        let stands = placed.beam.stands_at_assembled_height();
        let joints: Vec<usize> = if stands {
            vec![0, placed.beam.joints.len() - 1]
        } else {
            let sides = self.assembly.connections.iter();
            let sides = sides.filter_map(|connection| self.assembly.sides(connection, beam));
            let short = |mine: JointRef| self.deep.contains(&beam) && self.leads(mine);
            let met = sides.filter(|(mine, theirs)| self.standing.contains(&theirs.beam) && !short(*mine));
            met.map(|(mine, _)| mine.joint).collect()
        };
        let hang = if stands { 0.0 } else { joint::CLEARANCE };
        // A deep beam rests in its female with the section equally far behind its hole.
        let depth =
            self.paths.get(&beam).filter(|_| self.deep.contains(&beam)).map_or(0.0, |path| path.depth);
        let behind = if self.free_end(beam) > 0.0 { depth } else { -depth };
        for joint in joints {
            let p = placed.beam.p_b_hole(joint);
            let p = Point3::new(p.x + behind, p.y, p.z);
            self.parts.stands_at(
                &placed.beam.name,
                &p,
                (nominal * p).z - hang,
                self.parameters.alignment.level,
            );
        }
        if let (Some((held, _)), Some(drooped)) = (self.drooping(beam), self.drooped(beam, &nominal)) {
            let p = Point3::new(placed.beam.far_end(held.joint), 0.0, 0.0);
            self.parts.stands_at(&placed.beam.name, &p, (drooped * p).z, self.parameters.alignment.level);
        }
    }
}
