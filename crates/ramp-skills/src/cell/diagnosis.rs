//! Diagnoses the cause of deviations that skills measure and detect.
//!
//! A skill continues when it can. Each cause becomes an event of the kind `diagnosis` with the part and the
//! evidence, for people and for the campaigns that judge diagnoses.

use nalgebra::{Point3, Vector3};
use ramp_robot::{Cause, GRAVITY, RobotError};

use super::journal::Stand;
use super::workcell::Workcell;
use crate::Pose;
use crate::hand::Hand;

impl Workcell<'_, '_> {
    /// Diagnoses why a part is not where it was believed to be, `off` metres away.
    pub fn diagnose_astray(&mut self, part: &str, off: f64) {
        if self.hand.held.as_ref().is_some_and(|held| held.part == part) {
            return;
        }
        let words = format!("{part} is {:.1} mm from where it was", off * 1e3);
        match self.assembly.beam_index(part) {
            Some(beam) if self.belief.standing.contains(&beam) => {
                self.diagnose(Cause::BeamMoved, part, words)
            }
            Some(_) => self.diagnose(Cause::PartLost, part, words),
            None => self.diagnose_holder(part),
        }
    }

    /// Stores the poses of the beams of the assembly after the hand has worked on the given beams and on
    /// those they meet. The stored poses of the others stay.
    pub fn remember_standing(&mut self, touched: &[usize]) {
        let meets = |beam: usize| {
            touched.contains(&beam)
                || self.assembly.connections.iter().any(|connection| {
                    let sides = self.assembly.sides(connection, beam);
                    sides.is_some_and(|(_, theirs)| touched.contains(&theirs.beam))
                })
        };
        let seen = self.seen_standing();
        for (beam, stand) in seen {
            if meets(beam) || !self.journal.stood.contains_key(&beam) {
                self.journal.stood.insert(beam, stand);
            }
        }
    }

    /// Diagnoses which beams have moved since the hand left them.
    pub fn diagnose_standing(&mut self) {
        for (beam, now) in self.seen_standing() {
            let Some(before) = self.journal.stood.get(&beam) else { continue };
            let moved = now.ends.iter().zip(before.ends).map(|(now, before)| (now - before).norm());
            let moved = moved.fold(0.0, f64::max);
            if moved
                > self
                    .parameters
                    .diagnosis
                    .moved
                    .max(self.parameters.diagnosis.sure * now.deviation.hypot(before.deviation))
            {
                let name = &self.assembly.beams[beam].beam.name;
                let words = format!("{name} is {:.1} mm from where it stood", moved * 1e3);
                self.diagnose(Cause::BeamMoved, name.as_str(), words);
                self.journal.stood.insert(beam, now);
            }
        }
    }

    /// The beams of the assembly that can be seen, the clamped one aside.
    fn seen_standing(&self) -> Vec<(usize, Stand)> {
        let stand = |beam: usize| {
            let placed = &self.assembly.beams[beam].beam;
            let x_wb = self.belief.parts.pose(&placed.name).ok()?;
            let ends = [0.0, placed.span()].map(|x| Point3::new(x, 0.0, 0.0));
            let deviation = ends.map(|end| self.belief.parts.deviation(&placed.name, &end)[0]);
            let deviation = deviation[0].max(deviation[1]);
            Some((beam, Stand { ends: ends.map(|end| (x_wb * end).xy()), deviation }))
        };
        let standing = self.belief.standing.iter().copied().filter(|beam| *beam != self.assembly.base);
        standing.filter_map(stand).filter(|(_, stand)| stand.deviation.is_finite()).collect()
    }

    /// Looks whether a peg that is to be fetched has moved with its holder.
    pub fn diagnose_holder(&mut self, peg: &str) {
        let Some(holder) = self.holder_of(peg) else { return };
        let Some(off) =
            self.off_place(peg).filter(|off| off.norm() < 10.0 * self.parameters.diagnosis.in_place)
        else {
            return;
        };
        let in_holder = |name: &str| !self.belief.pinned.iter().any(|(_, pinned)| pinned == name);
        let in_it = |mate: &str| self.holder_of(mate).is_some_and(|it| it == holder) && in_holder(mate);
        let mates = self.kit.pegs.iter().filter(|mate| in_it(&mate.name));
        let shifts: Vec<Vector3<f64>> = mates.filter_map(|mate| self.off_place(&mate.name)).collect();
        let mean = shifts.iter().sum::<Vector3<f64>>() / shifts.len().max(1) as f64;
        if shifts.len() > 1 && mean.norm() > self.parameters.diagnosis.holder_off
            || shifts.len() == 1 && off.norm() > self.parameters.diagnosis.in_place
        {
            let words = format!("the pegs of {holder} are {:.1} mm from their places", mean.norm() * 1e3);
            self.diagnose(Cause::HolderMoved, holder.as_str(), words);
        }
    }

    /// The holder in which a peg stood at the start.
    fn holder_of(&self, peg: &str) -> Option<String> {
        let place = self.belief.parts.place(peg)?.translation.vector;
        let off = |x_wh: &Pose| (x_wh.translation.vector - place).xy().norm();
        let holders = self.belief.parts.holders(self.kit).into_iter();
        holders.min_by(|(_, a), (_, b)| off(a).total_cmp(&off(b))).map(|(name, _)| name)
    }

    /// Horizontal distance of an upright peg from the place where it was found, m.
    fn off_place(&self, peg: &str) -> Option<Vector3<f64>> {
        let start = self.belief.parts.place(peg)?;
        let x_wp = self.belief.parts.pose(peg).ok()?;
        let known = self.belief.parts.deviation(peg, &Point3::origin())[0]
            < self.parameters.diagnosis.holder_off / 3.0;
        let mut off = x_wp.translation.vector - start.translation.vector;
        let upright =
            (x_wp.rotation * Vector3::z()).z > 0.99 && off.z.abs() < self.parameters.diagnosis.in_place;
        off.z = 0.0;
        (known && upright).then_some(off)
    }

    /// Diagnoses that a part has moved in the hand, by `moved` (m) and `turned` (rad), if that is too far.
    pub fn diagnose_grip(&mut self, part: &str, moved: f64, turned: f64) {
        if turned > self.parameters.diagnosis.slip_turn {
            self.diagnose(
                Cause::GripMoved,
                part,
                format!("{part} has turned by {:.1}° in the hand", turned.to_degrees()),
            );
        } else if moved > self.parameters.diagnosis.slip {
            self.diagnose(
                Cause::GripMoved,
                part,
                format!("{part} has slipped by {:.1} mm in the hand", moved * 1e3),
            );
        }
    }

    /// In free space, compares the force at the wrist with the weight of the held part. The wrist force
    /// before the first grasp gives the normal error of an intact arm: the error of an estimated wrench
    /// varies by a newton between poses. Measures again at rest, since the hand's own mass acts on the sensor
    /// while the hand stops. Notes the cause once.
    ///
    /// # Errors
    /// The robot's.
    pub fn diagnose_force(&mut self) -> Result<(), RobotError> {
        let mass = self.hand.held.as_ref().map_or(0.0, |held| held.mass);
        let weight = Vector3::new(0.0, 0.0, mass * GRAVITY);
        let measured = |hand: &Hand| (hand.seen.wrench.fixed_rows::<3>(0) - weight).norm();
        if self.hand.held.is_none() && self.belief.standing.iter().all(|beam| *beam == self.assembly.base) {
            self.hand.usual_force = self.hand.usual_force.max(measured(&self.hand));
        }
        let biased =
            self.parameters.diagnosis.biased + self.parameters.diagnosis.usual * self.hand.usual_force;
        if self.journal.force_bias || measured(&self.hand) < biased {
            return Ok(());
        }
        self.hand.hold(self.parameters.diagnosis.rest)?;
        let measured = measured(&self.hand);
        if measured > biased {
            self.journal.force_bias = true;
            let evidence = format!("the wrist measures {measured:.1} N in free space");
            self.diagnose(Cause::ForceBias, None, evidence);
        }
        Ok(())
    }
}
