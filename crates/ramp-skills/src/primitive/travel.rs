//! Motions through free space, and which poses of the tip the arm reaches.

use ramp_motion::{Checker, Joints, MotionError, Trajectory};

use crate::Pose;
use crate::belief::obstacles::held_boxes;
use crate::cell::Workcell;
use crate::fault::SkillError;

impl Workcell<'_, '_> {
    /// Moves the tip through free space to `x_wt`, keeping clear of everything but the held part.
    ///
    /// # Errors
    /// When no motion is found or the robot stops.
    pub fn travel(&mut self, x_wt: &Pose) -> Result<(), SkillError> {
        for leg in self.legs_to(x_wt)? {
            self.follow_leg(leg)?;
        }
        Ok(())
    }

    /// The legs of a path through free space to `x_wt`, keeping clear of everything but the held part: the hand rests between
    /// them.
    ///
    /// # Errors
    /// When no motion is found or the robot stops.
    pub fn legs_to(&mut self, x_wt: &Pose) -> Result<Vec<Vec<Joints>>, SkillError> {
        self.belief.update(&mut self.hand)?;
        let checker = self.checker(None);
        let q = self.hand.joints();
        Ok(self.planner.plan(&q, x_wt, self.parameters.travel.height, &checker, &mut self.stream)?)
    }

    /// Follows one leg of a path ([`Workcell::legs_to`]).
    ///
    /// # Errors
    /// [`Fault::Overload`](crate::Fault::Overload), and the robot's.
    pub fn follow_leg(&mut self, leg: Vec<Joints>) -> Result<(), SkillError> {
        self.hand.follow(&Trajectory::new(self.arm, leg, self.parameters.travel.share))
    }

    /// Moves the open hand from above down to `x_wt`, around `part`.
    pub fn descend(&mut self, x_wt: &Pose, part: &str) -> Result<(), SkillError> {
        let mut above = *x_wt;
        above.translation.z = above.translation.z.max(self.parameters.travel.height);
        self.travel(&above)?;
        let checker = self.checker(Some(part));
        let q = self.hand.joints();
        let mut leg = self.planner.straight(&q, x_wt);
        if leg.is_none()
            && let Some(turned) = self.planner.posture_for(&self.hand.seen.x_wt, x_wt)
        {
            // Not from the posture in which the arm has arrived: it takes another one.
            let way = self.planner.connect(&q, &turned, &checker, &mut self.stream);
            for corner in way.ok_or(MotionError::NoWay)?.windows(2) {
                self.follow_leg(corner.to_vec())?;
            }
            leg = self.planner.straight(&self.hand.joints(), x_wt);
        }
        let leg = leg.ok_or(MotionError::Unreachable(x_wt.translation.vector.into()))?;
        if !leg.iter().all(|q| checker.is_free(&self.planner.kinematics.frames(q))) {
            return Err(MotionError::Blocked("end").into());
        }
        self.follow_leg(leg)
    }

    /// What the arm must keep clear of now: everything but what it holds and `without`.
    pub fn checker(&self, without: Option<&str>) -> Checker {
        let mut left_out: Vec<&str> = without.into_iter().collect();
        let mut boxes = Vec::new();
        if let Some(held) = &self.hand.held {
            left_out.push(&held.part);
            boxes = held_boxes(self.kit, &held.part, &held.x_tp);
        }
        let around = self.belief.obstacles(self.kit, &left_out);
        // The fingers may still be opening: check with the wider of what they are and what they will be.
        let width = self.hand.gripper.width.max(self.hand.seen.width);
        Checker::new(self.arm, width, boxes, &around, self.parameters.travel.margin)
    }

    /// Retreats: raises the hand straight up to travelling height.
    ///
    /// # Errors
    /// The robot's.
    pub fn retreat(&mut self) -> Result<(), SkillError> {
        let mut up = self.hand.seen.x_wt;
        if up.translation.z < self.parameters.travel.height - 0.001 {
            self.hand.relax();
            up.translation.z = self.parameters.travel.height;
            self.hand.go(&up, self.parameters.travel.retreat_speed)?;
        }
        Ok(())
    }

    /// Does the hand, opened to `open` (m), touch nothing but `part` at a pose of the tip that it can reach?
    pub fn has_room(&self, x_wt: &Pose, open: f64, part: &str) -> bool {
        let around = self.belief.obstacles(self.kit, &[part]);
        let checker = Checker::new(self.arm, open, Vec::new(), &around, self.parameters.travel.margin);
        self.planner
            .solve(x_wt, &self.hand.joints())
            .is_ok_and(|q| checker.is_free(&self.planner.kinematics.frames(&q)))
    }

    /// Of several poses of the tip, each with its distance from the joints' ends (rad), the one to use: reachable
    /// with room to spare if any is, and of those the least turn of the hand.
    pub fn choose(&self, candidates: &[(Pose, f64)]) -> Option<Pose> {
        let now = self.hand.seen.x_wt.rotation;
        let score = |(x_wt, margin): &(Pose, f64)| {
            margin.min(self.parameters.travel.good_margin)
                - self.parameters.travel.turn_cost * now.angle_to(&x_wt.rotation)
        };
        candidates
            .iter()
            .filter(|(_, margin)| *margin > 0.0)
            .max_by(|a, b| score(a).total_cmp(&score(b)))
            .map(|(x_wt, _)| *x_wt)
    }

    /// How far the joints stay from their ends at a pose, rad; negative when it is out of reach.
    pub fn reach(&self, x_wt: &Pose, q: &Joints) -> f64 {
        self.planner.solve(x_wt, q).map_or(-1.0, |q| self.planner.kinematics.range_margin(&q))
    }
}
