//! Motions through free space, and which poses of the tip the arm reaches.

use nalgebra::{Translation3, Vector3};
use ramp_motion::{Checker, Joints, MotionError, Pace, Terms, TimeLaw, Trajectory};
use ramp_robot::{GripperCommand, Retry};

use crate::Pose;
use crate::belief::obstacles::held_boxes;
use crate::cell::Workcell;
use crate::fault::SkillError;
use crate::hand::{Arrival, Rise};
use crate::way::Way;

/// Number of stops of the arm after which its motions become no slower.
const MOST_CALM: i32 = 4;

impl Workcell<'_, '_> {
    /// Moves the tip through free space to `x_wt`, keeping clear of everything but the held part. A hand that
    /// stands too near to something to begin is raised first.
    ///
    /// # Errors
    /// When no motion is found or the robot stops.
    pub fn travel(&mut self, x_wt: &Pose) -> Result<(), SkillError> {
        self.travel_and(x_wt, &Arrival::default())
    }

    /// The same, to a place from which something is looked at: the cameras are exposed as the hand arrives,
    /// so that their images are on the way while it comes to rest.
    ///
    /// # Errors
    /// As [`Workcell::travel`].
    pub fn travel_to_look(&mut self, x_wt: &Pose) -> Result<(), SkillError> {
        let look = self.belief.parts.eyes.images().then_some(self.parameters.look.ahead);
        self.travel_and(x_wt, &Arrival { look, ..Arrival::default() })
    }

    /// As [`Workcell::travel`], but the motion comes to a halt on its way when something pushes the held
    /// part.
    ///
    /// # Errors
    /// As [`Workcell::travel`].
    pub fn travel_until_pushed(&mut self, x_wt: &Pose) -> Result<(), SkillError> {
        self.travel_and(x_wt, &Arrival { halts: true, ..Arrival::default() })
    }

    fn travel_and(&mut self, x_wt: &Pose, arrival: &Arrival) -> Result<(), SkillError> {
        self.glance()?;
        match self.plan(x_wt) {
            Err(MotionError::Blocked("start")) => self.retreat()?,
            planned => return self.hand.follow_and(&planned?, arrival),
        }
        let planned = match self.plan(x_wt) {
            Err(MotionError::Blocked("start")) if self.back_out()? => self.plan(x_wt),
            planned => planned,
        };
        self.hand.follow_and(&planned?, arrival)
    }

    /// Moves a hand that stands where nothing can begin to the nearest place beside it that is free, upwards
    /// first. False when there is none.
    ///
    /// # Errors
    /// [`Fault::Overload`](crate::Fault::Overload), and the robot's.
    fn back_out(&mut self) -> Result<bool, SkillError> {
        let checker = self.checker(None);
        let (here, q) = (self.hand.seen.x_wt, self.hand.joints());
        let back = here.rotation * -Vector3::z();
        let aside =
            [Vector3::x(), -Vector3::x(), Vector3::y(), -Vector3::y()].map(|axis| here.rotation * axis);
        let directions = [Vector3::z(), back].into_iter().chain(aside);
        let places = self
            .parameters
            .travel
            .back_out
            .into_iter()
            .flat_map(|far| directions.clone().map(move |along| Translation3::from(along * far) * here));
        let is_free = |x_wt: &Pose| {
            self.planner.solve(x_wt, &q).is_ok_and(|q| checker.is_free(&self.planner.kinematics.frames(&q)))
        };
        let Some(free) = places.into_iter().find(is_free) else { return Ok(false) };
        let because = Some("the hand is too near to something, and backs out".to_string());
        self.record(Retry { step: "travel".into(), because, ..Retry::default() });
        self.hand.relax();
        self.hand.go(&free, self.parameters.travel.back_out_speed)?;
        Ok(true)
    }

    /// The motion through free space to `x_wt`.
    fn plan(&mut self, x_wt: &Pose) -> Result<Trajectory, MotionError> {
        let (checker, law) = (self.checker(None), self.law());
        let level = self.hand.held.as_ref().is_some_and(|held| self.kit.beam(&held.part).is_some());
        let terms = Terms { height: self.parameters.travel.height, level, checker: &checker, law: &law };
        let mut stream = self.stream.clone();
        let planned = self.planner.plan(&self.hand.start(), x_wt, &terms, &mut self.stream)?;
        let returns_to_sheet = self.hand.held.as_ref().is_some_and(|held| held.returns_to_sheet);
        if !level || !returns_to_sheet || !self.leans(&planned) {
            return Ok(planned);
        }
        // A beam in a hand that leans turns about its axis between the fingers, unless the motion is slow. On
        // the table, unlike in a joint, nothing would hold it back when they open.
        let Pace { velocity, acceleration, .. } = self.pace();
        let share = self.parameters.travel.leaning;
        let pace = Pace { velocity: share * velocity, acceleration: share * acceleration, ..self.pace() };
        let law = TimeLaw::new(self.arm, &pace);
        self.planner.plan(&self.hand.start(), x_wt, &Terms { law: &law, ..terms }, &mut stream)
    }

    /// Whether the hand leans in the course of a motion.
    fn leans(&self, motion: &Trajectory) -> bool {
        /// Periods between two looks: 50 ms.
        const EVERY: usize = 50;
        let lean = |q: &Joints| {
            let down = self.planner.kinematics.tip(q).rotation * Vector3::z();
            down.angle(&-Vector3::z())
        };
        let from = self.parameters.travel.leaning_from;
        motion.samples().iter().step_by(EVERY).any(|q| lean(q) > from)
    }

    /// Moves the tip in a straight line through free space to `x_wt`, keeping clear of everything but the
    /// held part and `part`.
    ///
    /// # Errors
    /// When the arm cannot follow the line, or something is in its way;
    /// [`Fault::Overload`](crate::Fault::Overload), and the robot's.
    pub fn travel_straight(&mut self, x_wt: &Pose, part: Option<&str>) -> Result<(), SkillError> {
        self.travel_and_grip(x_wt, part, None)
    }

    /// The same, with a command to a slow gripper before the end.
    fn travel_and_grip(
        &mut self,
        x_wt: &Pose,
        part: Option<&str>,
        closing: Option<GripperCommand>,
    ) -> Result<(), SkillError> {
        let checker = self.checker(part);
        let line = self
            .planner
            .straight(&self.hand.start(), x_wt)
            .ok_or(MotionError::Unreachable(x_wt.translation.vector.into()))?;
        if !line.iter().all(|q| checker.is_free(&self.planner.kinematics.frames(q))) {
            return Err(MotionError::Blocked("end").into());
        }
        let trajectory = self.law().time(&line);
        self.hand.follow_and(&trajectory, &Arrival { closing, ..Arrival::default() })
    }

    /// Speed limits of free-space motions for the current load.
    pub fn law(&self) -> TimeLaw {
        TimeLaw::new(self.arm, &self.pace())
    }

    fn pace(&self) -> Pace {
        let travel = &self.parameters.travel;
        let (velocity, acceleration) = match self.hand.held {
            Some(_) => (travel.held_velocity, travel.held_acceleration),
            None => (travel.velocity, travel.acceleration),
        };
        // An arm that has stopped forgives less than its limits promise.
        let calm = travel.calmer.powi(self.hand.stops.min(MOST_CALM));
        Pace {
            velocity: calm * velocity,
            acceleration: calm * acceleration,
            jerk: travel.jerk,
            ramp: travel.ramp,
        }
    }

    /// Moves the open hand from above down to `x_wt`, around `part`, and sends a slow gripper the command
    /// `closing` during the motion.
    pub fn descend(&mut self, x_wt: &Pose, part: &str, closing: GripperCommand) -> Result<(), SkillError> {
        let mut above = *x_wt;
        above.translation.z = above.translation.z.max(self.parameters.travel.height);
        self.travel(&above)?;
        // A rough arm is elsewhere as much too low as it was too high at the last grasp.
        let unknown = self.height_off.is_none() || self.is_rough();
        if unknown && self.feel_down(x_wt, part)? {
            return Ok(());
        }
        let down = match self.travel_and_grip(x_wt, Some(part), Some(closing)) {
            // If there is no room for fingers that are still closing from a wider grasp, they close first.
            Err(SkillError::Motion(MotionError::Blocked("end")))
                if self.hand.seen.width > self.hand.gripper.width + self.parameters.grip.width_tolerance =>
            {
                self.hand.relax();
                let GripperCommand { width, force } = self.hand.gripper;
                self.hand.grip(width, force)?;
                self.travel_and_grip(x_wt, Some(part), Some(closing))
            }
            down => down,
        };
        match down {
            Err(SkillError::Motion(MotionError::Unreachable(_))) => {}
            other => return other,
        }
        // Not from the posture in which the arm has arrived: it takes another one.
        let here = self.hand.seen.x_wt;
        let turned = self.planner.posture_for(&here, x_wt);
        self.take_posture(&turned.ok_or(MotionError::Unreachable(x_wt.translation.vector.into()))?)?;
        self.travel_and_grip(x_wt, Some(part), Some(closing))
    }

    /// First contact: the hand comes down the last stretch to `x_wt`, around `part`, so slowly that what it
    /// meets too early does no harm. Such a contact ends the descent. False where the arm cannot go straight
    /// down: nothing has moved then.
    fn feel_down(&mut self, x_wt: &Pose, part: &str) -> Result<bool, SkillError> {
        let feel = &self.parameters.feel;
        let slow = Pace { velocity: feel.velocity, ..self.pace() };
        let limit = feel.limit;
        let mut near = *x_wt;
        near.translation.z += feel.over;
        let start = self.hand.start();
        let Some(line) = self.planner.straight(&start, &near) else { return Ok(false) };
        let arrived = line.last().copied().unwrap_or(start);
        let Some(last) = self.planner.straight(&arrived, x_wt) else { return Ok(false) };
        let checker = self.checker(Some(part));
        if !line.iter().chain(&last).all(|q| checker.is_free(&self.planner.kinematics.frames(q))) {
            return Ok(false);
        }
        let trajectory = self.law().time(&line);
        self.hand.follow(&trajectory)?;
        let trajectory = TimeLaw::new(self.arm, &slow).time(&last);
        let mut rise = Rise::over_beginning(-Vector3::z(), &self.parameters.rise);
        self.hand.follow_until(&trajectory, |hand| rise.sense(hand) > limit)?;
        Ok(true)
    }

    /// Moves the arm to joint positions (rad), around everything.
    ///
    /// # Errors
    /// When no motion is found or the robot stops.
    pub fn take_posture(&mut self, q: &Joints) -> Result<(), SkillError> {
        let (checker, law) = (self.checker(None), self.law());
        let terms =
            Terms { height: self.parameters.travel.height, level: false, checker: &checker, law: &law };
        let trajectory = self.planner.plan_to(&self.hand.start(), q, &terms, &mut self.stream)?;
        self.hand.follow(&trajectory)
    }

    /// Current obstacles of the arm: all parts except the held one and `without`.
    pub fn checker(&self, without: Option<&str>) -> Checker {
        let mut left_out: Vec<&str> = without.into_iter().collect();
        let mut boxes = Vec::new();
        if let Some(held) = &self.hand.held {
            left_out.push(&held.part);
            boxes = held_boxes(self.kit, &held.part, &held.x_tp);
        }
        let around = self.belief.parts.obstacles(self.kit, &left_out);
        // The fingers may still be opening: check with the larger of the current and the commanded width.
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
        let around = self.belief.parts.obstacles(self.kit, &[part]);
        let checker = Checker::new(self.arm, open, Vec::new(), &around, self.parameters.travel.margin);
        self.planner
            .solve(x_wt, &self.hand.joints())
            .is_ok_and(|q| checker.is_free(&self.planner.kinematics.frames(&q)))
    }

    /// Cost of moving the tip to `stops`, one after another.
    pub fn way(&self, stops: &[Pose]) -> Way {
        Way::along(stops, &self.hand.joints(), self.planner, &self.law())
    }

    /// The best of several candidates, each with the way of the tip to it and on, by [`Way::compare`]. `None`
    /// where all are out of reach.
    pub fn choose<T: Copy>(&self, candidates: &[(T, Way)]) -> Option<T> {
        candidates
            .iter()
            .filter(|(_, way)| way.margin > 0.0)
            .max_by(|(_, a), (_, b)| a.compare(b, &self.parameters.travel))
            .map(|(candidate, _)| *candidate)
    }

    /// Distance of the joints from their limits at a pose, rad; negative when it is out of reach.
    pub fn reach(&self, x_wt: &Pose, q: &Joints) -> f64 {
        self.planner.solve(x_wt, q).map_or(-1.0, |q| self.planner.kinematics.range_margin(&q))
    }
}
