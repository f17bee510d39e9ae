//! Looks until the parts are known accurately enough for the next step.

use std::f64::consts::FRAC_PI_4;

use nalgebra::{Point3, Translation3, Vector3};
use ramp_kit::tags::x_wg_sheet;
use ramp_robot::camera::Mount;
use ramp_robot::{Camera, Cause, EventKind, MOST_EXPOSURES};

use crate::Pose;
use crate::belief::Belief;
use crate::cell::{Point, Workcell};
use crate::fault::{Fault, SkillError};
use crate::grasp::hand_down;

impl Workcell<'_, '_> {
    /// Looks until the position of each of these points on the table is known to a standard deviation of
    /// `within`, m, at least once. It repeats the look if noise is the limit. With cameras and an empty hand,
    /// it takes close-up images.
    ///
    /// # Errors
    /// The robot's.
    pub fn see(&mut self, points: &[Point], within: f64) -> Result<(), SkillError> {
        self.see_until(points, [within, f64::INFINITY])
    }

    /// As [`Workcell::see`], for a part that is to be gripped. If the camera on the hand turns out not to be
    /// at its nominal place, it is calibrated. The fingers centre it, so that half a
    /// millimetre is well enough along the table; but their ribs have only 1 mm of room above and below in a
    /// beam's slots.
    ///
    /// # Errors
    /// The robot's.
    pub fn see_to_grip(&mut self, part: &str) -> Result<(), SkillError> {
        let within = [self.parameters.look.graspable, self.parameters.look.graspable_height];
        let middle = [self.belief.middle(part)];
        self.see_until(&middle, within)?;
        // Such a camera would be as far off with each image of a part in the hand.
        if self.belief.parts.camera_misplaced() && self.hand.held.is_none() {
            self.calibrate()?;
            self.see_until(&middle, within)?;
        }
        Ok(())
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
        let mut visits = 0;
        let excess = |belief: &Belief, (part, p): &Point| {
            let deviation = belief.deviation(part, p);
            (deviation[0] / within[0]).max(deviation[1] / within[1])
        };
        // A part that was just detected and is known well enough is not looked at again.
        if self.belief.parts.is_fresh(&self.hand)
            && points.iter().all(|point| excess(&self.belief.parts, point) <= 1.0)
        {
            return Ok(());
        }
        self.look_once()?;
        loop {
            let worst = points
                .iter()
                .max_by(|a, b| excess(&self.belief.parts, a).total_cmp(&excess(&self.belief.parts, b)))
                .filter(|worst| excess(&self.belief.parts, worst) > 1.0);
            let Some(worst) = worst else { return Ok(()) };
            if self.belief.parts.eyes.images() {
                // Images from one place have their errors in common: after some of them only another place
                // helps, and there is none for a hand that holds something.
                let again = if self.hand.held.is_some() { 1 } else { self.parameters.look.again };
                self.look_again(again)?;
                if excess(&self.belief.parts, worst) <= 1.0 {
                    continue;
                }
                if visits >= points.len() || self.hand.held.is_some() {
                    return Ok(());
                }
                visits += 1;
                self.visit_part(worst)?;
            } else if self.belief.parts.eyes.cost() <= 0.0
                || self.hand.time() - begin > self.parameters.look.longest
            {
                return Ok(());
            }
            self.look_once()?;
        }
    }

    /// Takes this many looks in a row. With cameras, all exposures are requested before the first image
    /// arrives.
    ///
    /// # Errors
    /// The robot's.
    pub fn look_again(&mut self, times: usize) -> Result<(), SkillError> {
        if self.belief.parts.eyes.images() {
            for _ in 0..times.min(MOST_EXPOSURES) {
                self.hand.expose()?;
            }
        }
        for _ in 0..times {
            self.look_once()?;
        }
        Ok(())
    }

    /// Looks once, and records oddities.
    pub fn look_once(&mut self) -> Result<(), SkillError> {
        self.belief.parts.update(&mut self.hand)?;
        for (part, off) in self.belief.parts.astray() {
            self.record(EventKind::Seen { part: part.clone(), off });
            self.diagnose_astray(&part, off);
        }
        self.tell_complaints();
        Ok(())
    }

    /// Records the oddities in images that are not yet recorded.
    pub fn tell_complaints(&mut self) {
        for complaint in self.belief.parts.eyes.complaints() {
            self.record(Fault::Sight { why: complaint.clone() });
            self.diagnose(Cause::Sight, None, complaint);
        }
    }

    /// Looks for the first time. Without tags nothing but the clamped beam tells where the camera on the hand
    /// is, so that is visited before the first grasp. Parts that are not where they should lie may stand in
    /// the frame: it looks until they are looked for there.
    ///
    /// # Errors
    /// The robot's.
    pub fn look_first(&mut self) -> Result<(), SkillError> {
        self.belief.parts.update(&mut self.hand)?;
        let eyes = &self.belief.parts.eyes;
        if !eyes.images() || eyes.tags() {
            return Ok(());
        }
        self.calibrate()?;
        for _ in 0..self.parameters.eyes.mislaid {
            let is_unseen = |name: &String| self.belief.parts.pose(name).is_err();
            let beams = self.assembly.beams.iter().map(|placed| &placed.beam.name);
            let pegs = self.kit.pegs.iter().map(|peg| &peg.name);
            if !beams.chain(pegs).any(is_unseen) {
                return Ok(());
            }
            self.look_once()?;
        }
        self.look_in_frame()
    }

    /// Brings the camera on the hand over the places in the frame of the parts that were not seen: beams of
    /// the goal first, then pegs in the connections if a beam stands there.
    fn look_in_frame(&mut self) -> Result<(), SkillError> {
        let mut visited = Vec::new();
        for pegs in [false, true] {
            while let Some(next) = self.place_of_unseen(pegs, &visited) {
                self.visit(&next)?;
                self.look_again(self.parameters.clear.looks)?;
                visited.push(next);
            }
        }
        Ok(())
    }

    /// A place in the frame that was not visited, of a beam or a peg that was not seen, m, in the world.
    fn place_of_unseen(&self, pegs: bool, visited: &[Point3<f64>]) -> Option<Point3<f64>> {
        let clamped = &self.assembly.beams[self.assembly.base].beam.name;
        let beams = || self.assembly.beams.iter().map(|placed| &placed.beam.name);
        let stands = |beam: &String| {
            beam != clamped && self.belief.parts.pose(beam).is_ok() && !self.is_on_sheet(beam)
        };
        if pegs && !beams().any(stands) {
            return None;
        }
        let is_meant =
            |part: &str| if pegs { self.kit.peg(part).is_some() } else { beams().any(|it| it == part) };
        let most = if pegs { self.assembly.connections.len() } else { 1 };
        let unseen = self.belief.parts.unseen_places().filter(|(part, _)| is_meant(part));
        let mut places = unseen.flat_map(|(_, places)| places.into_iter().take(most));
        let near = self.parameters.clear.visited;
        places.find(|p| visited.iter().all(|other| (other - p).norm() > near))
    }

    /// Shows the camera on the empty hand the tag of the sheet, or where that is not read the clamped beam,
    /// which calibrates that camera. During a build, the camera sees tags with known poses over the sheet and
    /// the assembly; a piece of a build starts without.
    ///
    /// # Errors
    /// The robot's.
    pub fn calibrate(&mut self) -> Result<(), SkillError> {
        if !self.belief.parts.eyes.images() {
            return Ok(());
        }
        if self.belief.parts.eyes.reads_the_sheet() {
            self.visit(&Point3::from(x_wg_sheet(self.kit).translation.vector))?;
        } else {
            let base = &self.assembly.beams[self.assembly.base].beam;
            let (part, p) = self.belief.middle(&base.name);
            self.visit(&(self.belief.parts.pose(&part)? * p))?;
        }
        self.look_again(self.parameters.look.calibrating)
    }

    /// Brings the camera on the empty hand over the tag of a part that is nearest to a point of it.
    fn visit_part(&mut self, (part, p): &Point) -> Result<(), SkillError> {
        // A beam that was never seen should lie on a free outline of its shape. An unseen peg has spares.
        let on_sheet = || {
            self.kit.beam(part)?;
            self.belief.parts.free_outlines(part).first().copied()
        };
        match self.belief.parts.pose(part).ok().or_else(on_sheet) {
            Some(x_wp) => self.visit(&(x_wp * self.belief.parts.eyes.nearest_tag(part, p).unwrap_or(*p))),
            None => Ok(()),
        }
    }

    /// Brings the camera on the empty hand over a point of the world.
    pub(crate) fn visit(&mut self, aim: &Point3<f64>) -> Result<(), SkillError> {
        let Mount::Tip(x_tc) = self.hand.camera(Camera::Wrist).mount else { return Ok(()) };
        let x = self.hand.seen.x_wt.rotation * Vector3::x();
        let yaw = x.y.atan2(x.x);
        let candidates = [0.0, 0.5, -0.5, 1.0, -1.0, 2.0, -2.0, 3.0].map(|step| {
            let rotation = hand_down(yaw + step * FRAC_PI_4);
            let aside = rotation * x_tc.translation.vector;
            let x_wt = Pose::from_parts(
                Translation3::new(aim.x - aside.x, aim.y - aside.y, self.parameters.travel.height),
                rotation,
            );
            (x_wt, self.way(&[x_wt]))
        });
        let Some(x_wt) = self.choose(&candidates) else { return Ok(()) };
        self.retreat()?;
        match self.travel_to_look(&x_wt) {
            // No motion leads there: then from where the hand is.
            Err(SkillError::Motion(_)) => Ok(()),
            other => other,
        }
    }

    /// Looks if that costs no time, and otherwise predicts from the belief: for use within a motion.
    ///
    /// # Errors
    /// The robot's.
    pub fn glance(&mut self) -> Result<(), SkillError> {
        if self.belief.parts.eyes.cost() > 0.0 {
            self.belief.parts.follow(&self.hand);
        } else {
            self.belief.parts.update(&mut self.hand)?;
        }
        Ok(())
    }

    /// Looks until it is known how high the peg's head is over the female's top plate.
    pub fn see_gap(&mut self, connection: usize, peg: &str) -> Result<(), SkillError> {
        let hole = self.belief.hole(self.assembly.connections[connection].female);
        self.see_height(&[self.belief.middle(peg), hole], self.parameters.look.seated_known)
    }

    /// Looks until it is known where the pinned joint and the far end of a beam are.
    pub fn see_ends(&mut self, beam: usize) -> Result<(), SkillError> {
        let placed = &self.assembly.beams[beam].beam;
        let far = Point3::new(self.belief.far_end(beam), 0.0, 0.0);
        let mut points = vec![(placed.name.clone(), far)];
        points.extend(self.belief.anchor(beam).map(|joint| self.belief.hole(joint)));
        self.see(&points, self.parameters.look.ends_known)
    }
}
