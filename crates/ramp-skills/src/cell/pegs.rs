//! Positions of the holes, and the height of a peg in one.

use nalgebra::Vector3;
use ramp_kit::joint::{FEMALE_HEIGHT, STEM_LENGTH};

use super::assembly_belief::AssemblyBelief;
use crate::fault::SkillError;

impl AssemblyBelief<'_> {
    /// The pinned connections, by name, each with its peg.
    pub fn fastened(&self) -> Vec<(String, String)> {
        let name = |connection: usize| self.assembly.connections[connection].name.clone();
        self.pinned.iter().map(|(connection, peg)| (name(*connection), peg.clone())).collect()
    }

    /// The pose of the top of a connection's hole in the world: on the female's top plate, z up.
    pub fn mouth(&self, connection: usize) -> Result<Vector3<f64>, SkillError> {
        let hole = self.parts.hole(self.assembly, self.assembly.connections[connection].female)?;
        Ok(Vector3::new(hole.x, hole.y, hole.z + FEMALE_HEIGHT / 2.0))
    }

    /// The connection, if any, whose hole contains a peg that fell into it.
    ///
    /// # Errors
    /// [`Fault::Unseen`](crate::Fault::Unseen).
    pub fn fallen_into(&self, peg: &str) -> Result<Option<usize>, SkillError> {
        let x_wp = self.parts.pose(peg)?;
        if (x_wp.rotation * Vector3::z()).z < 0.99 {
            return Ok(None);
        }
        for (index, connection) in self.assembly.connections.iter().enumerate() {
            let stands =
                [connection.female, connection.male].iter().all(|it| self.standing.contains(&it.beam));
            if !stands || self.pinned.iter().any(|(pinned, _)| *pinned == index) {
                continue;
            }
            let off = x_wp.translation.vector - self.mouth(index)?;
            if off.xy().norm() < self.parameters.alignment.fallen && off.z < STEM_LENGTH / 2.0 {
                return Ok(Some(index));
            }
        }
        Ok(None)
    }

    /// Height of the peg's head over the female's top plate, m.
    pub fn gap(&self, connection: usize, peg: &str) -> Result<f64, SkillError> {
        Ok(self.parts.pose(peg)?.translation.z - self.mouth(connection)?.z)
    }

    /// Standard deviation of [`AssemblyBelief::gap`], m.
    pub fn gap_deviation(&self, connection: usize, peg: &str) -> f64 {
        let (beam, p) = self.hole(self.assembly.connections[connection].female);
        let (part, underside) = self.middle(peg);
        self.parts.deviation(&part, &underside)[1].hypot(self.parts.deviation(&beam, &p)[1])
    }
}
