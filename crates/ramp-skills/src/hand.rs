//! The hand: the only place that talks to the robot. Follows trajectories, moves in straight lines under
//! impedance, opens and closes, and measures forces. Every motion is guarded: one that meets more force than any skill needs is
//! broken off, and the hand yields.

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3, Vector6};
use ramp_motion::{Joints, Trajectory};
use ramp_robot::arm::ArmModel;
use ramp_robot::{
    ArmCommand, Camera, CameraModel, Command, GripperCommand, Image, Impedance, Observation, PERIOD,
    PartReading, Robot, RobotError,
};

use crate::Pose;
use crate::fault::{Fault, SkillError};
use crate::parameters::Parameters;
use crate::parameters::hand::{HandParameters, RiseParameters, TrimParameters};

/// After so many periods a gripper is no longer waited for.
const SLOWEST_GRIPPER: u32 = 10_000;
/// Fingers whose width has changed by so much have begun to move, m. Chosen: above what a held part gives.
const MOVED: f64 = 0.5e-3;
/// Fingers change their width at least so fast as they begin to move, m/s. Half of what two fingers of a Franka hand do.
const SLOWEST_FINGERS: f64 = 0.05;
/// Standard gravity, m/s².
pub const GRAVITY: f64 = 9.81;

/// A part between the fingers.
#[derive(Clone, Debug)]
pub struct Held {
    /// Its name.
    pub part: String,
    /// Its frame in the tip's frame.
    pub x_tp: Pose,
    /// Where it stood when it was gripped, in the world.
    pub x_wp_origin: Pose,
    /// kg.
    pub mass: f64,
    /// Centre of mass in the part's frame, m.
    pub p_centre: Point3<f64>,
}

/// What is done shortly before the end of a motion.
#[derive(Clone, Copy, Debug, Default)]
pub struct Arrival {
    /// What a gripper is told that is known to do nothing for a while after a command, and has nothing else to do.
    pub closing: Option<GripperCommand>,
    /// How long before the end the cameras are exposed, s.
    pub look: Option<f64>,
}

/// The robot with what the skills keep in mind about its hand.
pub struct Hand<'r> {
    robot: &'r mut dyn Robot,
    parameters: HandParameters,
    trim: TrimParameters,
    /// What was sensed last.
    pub seen: Observation,
    /// What the gripper is told.
    pub gripper: GripperCommand,
    /// Where the impedance pulls.
    pub setpoint: Pose,
    /// Stiffness of the impedance: N/m, N·m/rad, axes of the world.
    pub stiffness: Vector6<f64>,
    /// What is held.
    pub held: Option<Held>,
    posture: Joints,
    /// The largest velocity of each joint, rad/s.
    fastest: Joints,
    tare: Vector6<f64>,
    last: Option<Command>,
    /// The guard has struck, and the force has not fallen since.
    struck: bool,
    /// Something has pushed what is held, as a trajectory was followed, since it was gripped or last looked at.
    pub pushed: bool,
    /// The largest force at the wrist in free space before anything was grasped, N: how far off an arm in order may be.
    pub usual_force: f64,
    /// How long the gripper does nothing after a command.
    dead_time: DeadTime,
}

/// How long a gripper does nothing after a command, as its widths tell: never more than it is, and 0 until one was measured.
#[derive(Clone, Copy, Debug, Default)]
struct DeadTime {
    /// s.
    least: Option<f64>,
    /// When the command was given that is waited for (s), and the width then, m.
    waits: Option<(f64, f64)>,
}

impl DeadTime {
    /// The gripper is told something else. One that is at work does that later, and shows nothing.
    fn commanded(&mut self, seen: &Observation) {
        self.waits = (!seen.gripper_busy).then_some((seen.time, seen.width));
    }

    /// A width that was told at a time, with a gripper that tells its width every `told_every` (s).
    fn sensed(&mut self, time: f64, width: f64, told_every: f64) {
        let Some((since, before)) = self.waits else { return };
        if (width - before).abs() > MOVED {
            let least = (time - since - told_every - MOVED / SLOWEST_FINGERS).max(0.0);
            self.least = Some(self.least.map_or(least, |it| it.min(least)));
            self.waits = None;
        }
    }
}

/// A way that is begun and ended with an even acceleration.
struct Ramped {
    /// Time at full speed and in one of the ramps, s.
    even: f64,
    ramp: f64,
}

impl Ramped {
    fn new(way: f64, speed: f64, acceleration: f64) -> Ramped {
        let speed = speed.min((way * acceleration).sqrt());
        if speed <= 0.0 {
            return Ramped { even: 0.0, ramp: 0.0 };
        }
        let ramp = speed / acceleration;
        Ramped { even: (way / speed - ramp).max(0.0), ramp }
    }

    /// s.
    fn duration(&self) -> f64 {
        self.even + 2.0 * self.ramp
    }

    /// The share of the way that is done at a time (s) before its end.
    fn share(&self, time: f64) -> f64 {
        let whole = self.ramp * (self.even + self.ramp);
        let begun = time.min(self.ramp);
        let ended = (time - self.ramp - self.even).max(0.0);
        let done = begun * begun / 2.0 + self.ramp * (time - begun) - ended * ended / 2.0;
        (done / whole).clamp(0.0, 1.0)
    }
}

/// What keeps the tip on a line: how far it is off, summed up. All in the world.
struct Trim {
    parameters: TrimParameters,
    /// A setpoint of the motion, and where the tip is to be with it.
    setpoint: Pose,
    tip: Pose,
    /// The tip turns as the setpoint turns.
    turns: bool,
    /// Of the motion, a unit vector; along it nothing is trimmed.
    direction: Vector3<f64>,
    /// What the setpoint is moved by, m, and turned by: a rotation vector, rad.
    shift: Vector3<f64>,
    turn: Vector3<f64>,
}

impl Trim {
    /// For a motion of the hand to `x_wt`, where the tip `arrives` at a pose, or keeps the distance from the setpoint that it
    /// has at the beginning.
    fn new(hand: &Hand, x_wt: &Pose, arrives: Option<&Pose>) -> Trim {
        let way = x_wt.translation.vector - hand.setpoint.translation.vector;
        let (setpoint, tip) = arrives.map_or((hand.setpoint, hand.seen.x_wt), |arrives| (*x_wt, *arrives));
        Trim {
            parameters: hand.trim.clone(),
            setpoint,
            tip,
            turns: arrives.is_none(),
            direction: way.try_normalize(1e-9).unwrap_or_default(),
            shift: Vector3::zeros(),
            turn: Vector3::zeros(),
        }
    }

    /// The setpoint for a point of the line, with the tip at `seen`.
    fn trimmed(&mut self, line: &Pose, seen: &Pose) -> Pose {
        let wanted = self.tip.translation.vector + line.translation.vector - self.setpoint.translation.vector;
        let off = wanted - seen.translation.vector;
        let off = off - self.direction * off.dot(&self.direction);
        let with_line = line.rotation * self.setpoint.rotation.inverse();
        let turn = if self.turns { with_line } else { UnitQuaternion::identity() };
        let turned = turn * self.tip.rotation * seen.rotation.inverse();
        let gain = PERIOD / self.parameters.time;
        self.shift = (self.shift + off * gain).cap_magnitude(self.parameters.most);
        self.turn = (self.turn + turned.scaled_axis() * gain).cap_magnitude(self.parameters.most_turn);
        Pose::from_parts(
            Translation3::from(line.translation.vector + self.shift),
            UnitQuaternion::from_scaled_axis(self.turn) * line.rotation,
        )
    }
}

/// How much the force in one direction has risen over its running mean: what a motion meets, whatever bias and friction the
/// measured force has. A constant speed keeps friction constant.
pub struct Rise {
    direction: Vector3<f64>,
    /// The running mean (N) and how long it has been taken, s.
    mean: f64,
    time: f64,
    parameters: RiseParameters,
}

impl Rise {
    /// In a direction of the world, a unit vector.
    pub fn new(direction: Vector3<f64>, parameters: &RiseParameters) -> Rise {
        Rise { direction, mean: 0.0, time: 0.0, parameters: parameters.clone() }
    }

    /// Over the force at the beginning of the motion alone: for a slow one, whose force rises slowly.
    pub fn over_beginning(direction: Vector3<f64>, parameters: &RiseParameters) -> Rise {
        let parameters = RiseParameters { mean: f64::INFINITY, ..parameters.clone() };
        Rise { direction, mean: 0.0, time: 0.0, parameters }
    }

    /// The rise after another control period, N; 0 while the motion begins.
    pub fn sense(&mut self, hand: &Hand) -> f64 {
        self.over(hand.seen.wrench.fixed_rows::<3>(0).dot(&self.direction))
    }

    /// The rise of a force (N) in the direction, one control period after the last.
    fn over(&mut self, force: f64) -> f64 {
        self.time += PERIOD;
        if self.time < self.parameters.begin {
            self.mean = force;
        }
        let rise = force - self.mean;
        self.mean += rise * PERIOD / self.parameters.mean;
        rise
    }
}

impl<'r> Hand<'r> {
    /// Takes over a robot.
    pub fn new(robot: &'r mut dyn Robot, arm: &ArmModel, parameters: &Parameters) -> Hand<'r> {
        let (parameters, trim) = (&parameters.hand, parameters.trim.clone());
        let seen = robot.observe();
        Hand {
            gripper: GripperCommand { width: seen.width, force: 20.0 },
            setpoint: seen.x_wt,
            stiffness: Vector6::from(parameters.stiffness),
            parameters: parameters.clone(),
            trim,
            held: None,
            posture: Joints::from(seen.positions),
            fastest: Joints::from_fn(|joint, _| arm.joints[joint].velocity),
            tare: Vector6::zeros(),
            last: None,
            struck: false,
            pushed: false,
            usual_force: seen.wrench.fixed_rows::<3>(0).norm(),
            dead_time: DeadTime::default(),
            robot,
            seen,
        }
    }

    /// Reads where the parts are. Time may pass, during which the arm goes on with its last command.
    ///
    /// # Errors
    /// The robot's.
    pub fn read_parts(&mut self) -> Result<Vec<PartReading>, RobotError> {
        let readings = self.robot.read_parts();
        self.seen = self.robot.observe();
        readings
    }

    /// Opens the shutters of the cameras while the arm goes on: [`Hand::look`] gives the images later, the oldest first.
    ///
    /// # Errors
    /// The robot's.
    pub fn expose(&mut self) -> Result<(), RobotError> {
        self.robot.expose()
    }

    /// Takes an image. Time passes, during which the arm goes on with its last command.
    ///
    /// # Errors
    /// The robot's.
    pub fn look(&mut self, camera: Camera) -> Result<Image, RobotError> {
        let image = self.robot.look(camera);
        self.seen = self.robot.observe();
        image
    }

    /// What the robot tells of a camera.
    pub fn camera(&self, camera: Camera) -> CameraModel {
        self.robot.camera(camera)
    }

    /// Joint positions, rad.
    pub fn joints(&self) -> Joints {
        Joints::from(self.seen.positions)
    }

    /// Where a motion of the joints begins, rad: at what they were told last, if that were positions, and otherwise where
    /// they are.
    pub fn start(&self) -> Joints {
        match &self.last {
            Some(Command { arm: ArmCommand::JointPositions(positions), .. }) => Joints::from(*positions),
            _ => self.joints(),
        }
    }

    /// Robot time, s.
    pub fn time(&self) -> f64 {
        self.seen.time
    }

    /// Where the held part is now, if the grasp has not slipped; `None` with an empty hand.
    pub fn x_wp_held(&self) -> Option<Pose> {
        self.held.as_ref().map(|held| self.seen.x_wt * held.x_tp)
    }

    /// Runs a timed joint path and waits until the arm has come to rest at its end.
    ///
    /// # Errors
    /// [`Fault::Overload`], and the robot's.
    pub fn follow(&mut self, trajectory: &Trajectory) -> Result<(), SkillError> {
        self.follow_and(trajectory, &Arrival::default())
    }

    /// The same, with what is done shortly before the end.
    ///
    /// # Errors
    /// [`Fault::Overload`], and the robot's.
    pub fn follow_and(&mut self, trajectory: &Trajectory, arrival: &Arrival) -> Result<(), SkillError> {
        let measured = |seen: &Observation| {
            (seen.wrench.fixed_rows::<3>(0).norm(), seen.wrench.fixed_rows::<3>(3).norm())
        };
        let (force, moment) = measured(&self.seen);
        let samples = trajectory.samples();
        let early = (self.dead_time.least.unwrap_or(0.0) / PERIOD) as usize;
        let look = arrival.look.map(|ahead| samples.len().saturating_sub((ahead / PERIOD) as usize));
        for (index, q) in samples.iter().enumerate().skip(1) {
            if let Some(closing) =
                arrival.closing.filter(|_| samples.len() - index < early && !self.seen.gripper_busy)
            {
                self.gripper = closing;
            }
            if look == Some(index) {
                self.expose()?;
            }
            self.joint_step(*q)?;
            self.guard()?;
            let (now, turning) = measured(&self.seen);
            self.pushed |= (now - force).abs() > self.parameters.pushed_force
                || (turning - moment).abs() > self.parameters.pushed_moment;
        }
        let end = trajectory.end();
        for _ in 0..300 {
            self.joint_step(end)?;
            self.guard()?;
            if Joints::from(self.seen.velocities).amax() < 0.002 && (self.joints() - end).amax() < 0.004 {
                break;
            }
        }
        Ok(())
    }

    fn joint_step(&mut self, q: Joints) -> Result<(), RobotError> {
        self.command(Command { arm: ArmCommand::JointPositions(q.into()), gripper: self.gripper })
    }

    /// One control period under a command of a skill's own making. Nothing guards it.
    ///
    /// # Errors
    /// The robot's.
    pub fn obey(&mut self, command: Command) -> Result<(), RobotError> {
        self.gripper = command.gripper;
        self.command(command)
    }

    fn command(&mut self, command: Command) -> Result<(), RobotError> {
        if self.last.as_ref().is_some_and(|last| last.gripper != command.gripper) {
            self.dead_time.commanded(&self.seen);
        }
        self.seen = self.robot.step(&command)?;
        self.dead_time.sensed(self.seen.time, self.seen.width, self.parameters.told_every);
        self.last = Some(command);
        Ok(())
    }

    /// Goes on with the last command, s.
    ///
    /// # Errors
    /// The robot's.
    pub fn hold(&mut self, seconds: f64) -> Result<(), RobotError> {
        for _ in 0..(seconds / PERIOD).round() as usize {
            match self.last.clone() {
                Some(command) => self.command(command)?,
                None => self.joint_step(self.joints())?,
            }
        }
        Ok(())
    }

    /// Begins to move under impedance from where the tip is: setpoint and posture become the present ones.
    pub fn relax(&mut self) {
        self.setpoint = self.seen.x_wt;
        self.posture = self.joints();
        self.stiffness = Vector6::from(self.parameters.stiffness);
    }

    /// One control period under impedance at the present setpoint.
    ///
    /// # Errors
    /// [`Fault::Overload`], and the robot's.
    pub fn tick(&mut self) -> Result<(), SkillError> {
        self.impedance_step()?;
        self.guard()
    }

    /// Breaks a motion off that meets more force than any skill needs: the hand yields to where it is. It does so once
    /// until the force has fallen to half of that, so that it can be led away.
    fn guard(&mut self) -> Result<(), SkillError> {
        let force = self.seen.wrench.fixed_rows::<3>(0).norm();
        if force < 0.5 * self.parameters.guard {
            self.struck = false;
        }
        if force < self.parameters.guard || self.struck {
            return Ok(());
        }
        self.struck = true;
        self.relax();
        for _ in 0..(self.parameters.yield_time / PERIOD).round() as usize {
            self.impedance_step()?;
        }
        Err(Fault::Overload { force }.into())
    }

    fn impedance_step(&mut self) -> Result<(), RobotError> {
        let impedance = Impedance {
            x_wt: self.setpoint,
            stiffness: self.stiffness,
            damping_ratio: 1.0,
            feed_forward: self.weight(),
            posture: self.posture.into(),
        };
        self.command(Command { arm: ArmCommand::CartesianImpedance(impedance), gripper: self.gripper })
    }

    /// The wrench at the tip that carries the held part.
    fn weight(&self) -> Vector6<f64> {
        let Some(held) = &self.held else { return Vector6::zeros() };
        let lift = Vector3::new(0.0, 0.0, held.mass * GRAVITY);
        let lever = self.seen.x_wt.rotation * (held.x_tp * held.p_centre).coords;
        let moment = lever.cross(&lift);
        Vector6::new(0.0, 0.0, lift.z, moment.x, moment.y, moment.z)
    }

    /// Waits under impedance, s.
    ///
    /// # Errors
    /// [`Fault::Overload`], and the robot's.
    pub fn wait(&mut self, seconds: f64) -> Result<(), SkillError> {
        for _ in 0..(seconds / PERIOD).round() as usize {
            self.tick()?;
        }
        Ok(())
    }

    /// Waits under impedance until the arm is still. A hand that is still but not where it is pulled to may only be stuck by
    /// friction, and about to go on.
    ///
    /// # Errors
    /// [`Fault::Overload`], and the robot's.
    pub fn settle(&mut self) -> Result<(), SkillError> {
        let [near, near_turn] = self.parameters.arrived;
        let mut still = 0.0;
        for _ in 0..(self.parameters.settled / PERIOD).round() as usize {
            self.tick()?;
            let moves = Joints::from(self.seen.velocities).amax() >= self.parameters.at_rest;
            still = if moves { 0.0 } else { still + PERIOD };
            let off = (self.setpoint.translation.vector - self.seen.x_wt.translation.vector).norm();
            let turned = self.setpoint.rotation.angle_to(&self.seen.x_wt.rotation);
            if still > self.parameters.stuck || (still > 0.0 && off < near && turned < near_turn) {
                break;
            }
        }
        Ok(())
    }

    /// Moves the setpoint in a straight line to `x_wt` with `speed` (m/s) as its largest speed, until it is there
    /// or `stop` says so: it speeds up evenly, goes on, and slows down evenly, and it waits for joints that hurry. Returns
    /// whether it was stopped; the setpoint then stays where it was.
    ///
    /// # Errors
    /// [`Fault::Overload`], and the robot's.
    pub fn drive(
        &mut self,
        x_wt: &Pose,
        speed: f64,
        stop: impl FnMut(&Hand) -> bool,
    ) -> Result<bool, SkillError> {
        self.drive_trimmed(x_wt, speed, None, stop)
    }

    /// The same along a line that must be kept: friction turns a hand aside as it moves, and the setpoint is trimmed against
    /// that until the tip is on its line again, but by no more than the trim's bounds. The line is the one that ends where the
    /// tip `arrives` (world), turned as there all along; without that, the one on which the tip keeps its distance from the
    /// setpoint.
    ///
    /// # Errors
    /// [`Fault::Overload`], and the robot's.
    pub fn drive_in_line(
        &mut self,
        x_wt: &Pose,
        arrives: Option<&Pose>,
        speed: f64,
        stop: impl FnMut(&Hand) -> bool,
    ) -> Result<bool, SkillError> {
        let trim = Trim::new(self, x_wt, arrives);
        self.drive_trimmed(x_wt, speed, Some(trim), stop)
    }

    fn drive_trimmed(
        &mut self,
        x_wt: &Pose,
        speed: f64,
        mut trim: Option<Trim>,
        mut stop: impl FnMut(&Hand) -> bool,
    ) -> Result<bool, SkillError> {
        let from = self.setpoint;
        let distance = (x_wt.translation.vector - from.translation.vector).norm();
        let angle = from.rotation.angle_to(&x_wt.rotation);
        let acceleration =
            trim.as_ref().map_or(self.parameters.acceleration, |trim| trim.parameters.acceleration);
        let shift = Ramped::new(distance, speed, acceleration);
        let turn = Ramped::new(angle, self.parameters.turn_speed, self.parameters.turn_acceleration);
        let way = if shift.duration() > turn.duration() { shift } else { turn };
        let duration = way.duration();
        let (mut time, mut s) = (0.0, 0.0);
        while s < 1.0 {
            time += PERIOD * self.pace();
            s = if time >= duration { 1.0 } else { way.share(time) };
            let p = from.translation.vector.lerp(&x_wt.translation.vector, s);
            let rotation = from.rotation.try_slerp(&x_wt.rotation, s, 1e-9).unwrap_or(x_wt.rotation);
            let line = Pose::from_parts(Translation3::from(p), rotation);
            self.setpoint = match &mut trim {
                Some(trim) => trim.trimmed(&line, &self.seen.x_wt),
                None => line,
            };
            self.tick()?;
            if stop(self) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The share of its speed at which a straight motion goes on: less than 1 where the fastest joint comes near to its largest
    /// velocity, as it may where a straight line bends the arm much.
    fn pace(&self) -> f64 {
        const CREEP: f64 = 0.05;
        let [slower, creep] = self.parameters.hurry;
        let hurry = Joints::from(self.seen.velocities).component_div(&self.fastest).amax();
        ((creep - hurry) / (creep - slower).max(f64::EPSILON)).clamp(CREEP, 1.0)
    }

    /// Moves without a condition to stop.
    ///
    /// # Errors
    /// [`Fault::Overload`], and the robot's.
    pub fn go(&mut self, x_wt: &Pose, speed: f64) -> Result<(), SkillError> {
        self.drive(x_wt, speed, |_| false).map(|_| ())
    }

    /// Opens or closes to `width` (m) with at most `force` (N) and waits until the fingers are still.
    ///
    /// # Errors
    /// [`Fault::Overload`], and the robot's.
    pub fn grip(&mut self, width: f64, force: f64) -> Result<(), SkillError> {
        self.gripper = GripperCommand { width, force };
        let opens = width > self.seen.width;
        let mut still = 0;
        let mut before = self.seen.width;
        let mut period = 0;
        let mut busy = 0;
        while period < 3000 {
            self.tick()?;
            // A gripper that tells when it is done needs not be watched.
            if self.seen.gripper_busy && busy < SLOWEST_GRIPPER {
                busy += 1;
                continue;
            }
            if busy > 0 {
                break;
            }
            period += 1;
            still = if (self.seen.width - before).abs() < 2e-6 { still + 1 } else { 0 };
            before = self.seen.width;
            // Fingers that squeeze a part hold still for a while before they open.
            let unloading = opens && period <= 600 && width - self.seen.width > self.parameters.opened;
            if still > (self.parameters.still / PERIOD).round() as u32 && !unloading {
                break;
            }
        }
        Ok(())
    }

    /// Goes on with the last command until the gripper has done what it was told.
    ///
    /// # Errors
    /// The robot's.
    pub fn wait_for_gripper(&mut self) -> Result<(), RobotError> {
        for _ in 0..SLOWEST_GRIPPER {
            if !self.seen.gripper_busy {
                break;
            }
            self.hold(PERIOD)?;
        }
        Ok(())
    }

    /// Takes the present reading of the wrist as zero.
    ///
    /// # Errors
    /// [`Fault::Overload`], and the robot's.
    pub fn zero(&mut self) -> Result<(), SkillError> {
        // The sensor's filter has a time constant of 20 ms: let the last motion fade out of it.
        self.wait(self.parameters.rest)?;
        self.tare = self.seen.wrench;
        Ok(())
    }

    /// Force of the hand on the world since [`Hand::zero`], axes of the world, N.
    pub fn force(&self) -> Vector3<f64> {
        (self.seen.wrench - self.tare).fixed_rows::<3>(0).into_owned()
    }

    /// Wrench of the hand on the world at the wrist since [`Hand::zero`], axes of the world: N, N·m.
    pub fn wrench(&self) -> Vector6<f64> {
        self.seen.wrench - self.tare
    }

    /// Shifts the setpoint so that what the hand holds, now at `x_wp`, comes to `x_wp_goal`, and moves there at
    /// `speed` (m/s). Keeps whatever lead the setpoint has over the tip.
    ///
    /// # Errors
    /// [`Fault::Overload`], and the robot's.
    pub fn correct(&mut self, x_wp: &Pose, x_wp_goal: &Pose, speed: f64) -> Result<(), SkillError> {
        let target = self.corrected(x_wp, x_wp_goal);
        self.go(&target, speed)
    }

    /// The setpoint that brings a held part from `x_wp` to `x_wp_goal`.
    pub fn corrected(&self, x_wp: &Pose, x_wp_goal: &Pose) -> Pose {
        self.corrected_from(&self.setpoint, x_wp, x_wp_goal)
    }

    /// The same, where the tip is told to be at `told`.
    pub fn corrected_from(&self, told: &Pose, x_wp: &Pose, x_wp_goal: &Pose) -> Pose {
        let x_wt = self.seen.x_wt;
        let x_wt_goal = x_wp_goal * x_wp.inverse() * x_wt;
        let shift = x_wt_goal.translation.vector - x_wt.translation.vector;
        let turn: UnitQuaternion<f64> = x_wt_goal.rotation * x_wt.rotation.inverse();
        Pose::from_parts(Translation3::from(told.translation.vector + shift), turn * told.rotation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a push into a loose sleeve measures: a bias, a step of friction as the hand begins to move, a slow drift, and
    /// then an edge. Only the edge is told, and soon.
    #[test]
    fn an_edge_is_told_from_bias_and_friction() {
        let parameters = Parameters::baseline();
        let limit = parameters.assemble.loose_limit;
        let mut rise = Rise::new(Vector3::x(), &parameters.rise);
        let mut told = None;
        for period in 0..2000 {
            let time = f64::from(period) * PERIOD;
            let friction = if time < 0.03 { 0.0 } else { 1.3 };
            let edge = (time - 1.5).max(0.0) * 75.0;
            if told.is_none() && rise.over(-2.0 + friction + 0.5 * time + edge) > limit {
                told = Some(time);
            }
        }
        assert!(told.is_some_and(|time| (1.5..1.52).contains(&time)), "{told:?}");
    }

    /// A slow touch is told by its rise since the beginning, which a running mean would follow.
    #[test]
    fn a_slow_touch_is_told() {
        let parameters = Parameters::baseline();
        let force = |time: f64| 2.0 + (time - 0.5).max(0.0) * 15.0;
        let largest = |mut rise: Rise| {
            (0..1200).map(|period| rise.over(force(f64::from(period) * PERIOD))).fold(0.0, f64::max)
        };
        let limit = parameters.touch.press;
        assert!(largest(Rise::new(Vector3::x(), &parameters.rise)) < limit);
        assert!(largest(Rise::over_beginning(Vector3::x(), &parameters.rise)) > limit);
    }

    /// Joint friction holds the tip a third of a millimetre and 3 mrad off its line: the setpoint goes the other way until the
    /// tip is back, along the motion it stays as it was, and it goes no further than its bounds.
    #[test]
    fn the_trim_brings_the_tip_back_to_its_line() {
        let parameters = Parameters::baseline().trim.clone();
        let trim = |direction| Trim {
            parameters: parameters.clone(),
            setpoint: Pose::identity(),
            tip: Pose::identity(),
            turns: true,
            direction,
            shift: Vector3::zeros(),
            turn: Vector3::zeros(),
        };
        let friction = Pose::new(Vector3::new(-0.4e-3, 0.0, -0.3e-3), Vector3::new(0.0, 3.0e-3, 0.0));
        let mut kept = trim(Vector3::x());
        let mut setpoint = Pose::identity();
        for _ in 0..2000 {
            setpoint = kept.trimmed(&Pose::identity(), &(setpoint * friction));
        }
        let tip = setpoint * friction;
        assert!(tip.translation.z.abs() < 0.01e-3 && tip.rotation.angle() < 0.1e-3, "{tip}");
        assert!(setpoint.translation.x.abs() < 1e-6, "{setpoint}");
        let mut held = trim(Vector3::x());
        for _ in 0..20_000 {
            setpoint = held.trimmed(&Pose::identity(), &Pose::translation(0.0, 0.0, -5.0e-3));
        }
        assert!((setpoint.translation.z - parameters.most).abs() < 1e-9, "{setpoint}");
    }

    /// A hand that stands beside its line when the motion begins, turned by 2 mrad, is on it before it has gone 30 mm: the end of
    /// a long beam would else meet its joint a millimetre too high.
    #[test]
    fn the_trim_brings_the_tip_onto_the_line_on_which_it_arrives() {
        let setpoint = Pose::translation(45.0e-3, 0.0, 0.0);
        let mut trim = Trim {
            parameters: Parameters::baseline().trim.clone(),
            setpoint,
            tip: setpoint,
            turns: false,
            direction: Vector3::x(),
            shift: Vector3::zeros(),
            turn: Vector3::zeros(),
        };
        let off = Pose::new(Vector3::new(0.0, 0.3e-3, 1.0e-3), Vector3::new(0.0, 2.0e-3, 0.0));
        let mut seen = off;
        for period in 0..600 {
            let line = Pose::translation(50.0e-3 * f64::from(period) * PERIOD, 0.0, 0.0);
            seen = trim.trimmed(&line, &seen) * off;
        }
        let left = seen.translation.vector.yz().norm();
        assert!(left < 0.05e-3 && seen.rotation.angle() < 0.1e-3, "{seen}");
        assert!((seen.translation.x - 30.0e-3).abs() < 0.1e-3, "{seen}");
    }
}
