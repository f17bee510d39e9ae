//! The twin itself: MuJoCo's model and state behind the `Robot` seam, and the truth beside it.

pub mod snapshot;

use std::collections::VecDeque;
use std::sync::Arc;

use mujoco_rs::prelude::*;
use mujoco_rs::wrappers::mj_model::MjtObjBase;
use nalgebra::{SMatrix, Translation3, UnitQuaternion, Vector3, Vector6};
use ramp_assembly::Truth;
use ramp_render::looks::HOUSING;
use ramp_render::{Looks, Scene};
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;
use ramp_robot::{
    ArmCommand, Camera, CameraModel, Command, DOF, GripperCommand, Image, MOST_EXPOSURES, Observation,
    PERIOD, PartReading, Pose, Robot, RobotError, TIME_LIMIT, Track,
};
use ramp_world::Physics;

use crate::broad_phase::BroadPhase;
use crate::cameras::{Cameras, Exposure, Moment};
use crate::command::{check_command, fed_forward};
use crate::drive::{Drive, believed};
use crate::engine::{GRAVITY, body_pose, rotation_from_rows};
use crate::fault::{FaultReport, Injector, Start};
use crate::layout::Layout;
use crate::scene::{Printed, SceneOptions, scene_xml};
use crate::setup::{Setup, TwinError};
use crate::slow_gripper::SlowGripper;
use ramp_control::{
    ArmState, GripperLoop, Jacobian, JointMotion, JointVector, PoseMotion, impedance, pose_impedance,
    track_joints, track_velocities,
};

/// How far a joint may overshoot a soft stop before the robot reports it, rad.
const POSITION_MARGIN: f64 = 0.005;
/// Share of a new reading in the wrist sensor's low-pass filter: a time constant of 20 ms.
const WRENCH_FILTER: f64 = 0.05;
/// Standard deviation on track `noisy` of the position of a part, m along each axis, and of its rotation, rad about
/// each axis, per reading.
pub const READING_NOISE: [f64; 2] = [1.0e-3, std::f64::consts::PI / 180.0];
/// Share of the parts that a reading on track `noisy` leaves out.
pub const READING_DROPPED: f64 = 0.05;
/// What a reading on track `noisy` costs in control periods: as much as an image at 30 a second.
pub const READING_STEPS: u32 = 33;
/// Width the gripper starts with, m.
const START_WIDTH: f64 = 0.04;
/// What the gripper does before it is told anything.
const START_GRIPPER: GripperCommand = GripperCommand { width: START_WIDTH, force: 10.0 };

/// The simulated world with its robot.
pub struct Twin {
    data: MjData<Arc<MjModel>>,
    broad_phase: BroadPhase,
    xml: Arc<str>,
    arm: ArmModel,
    track: Track,
    /// Name and MuJoCo body of each beam and peg.
    parts: Vec<(String, usize)>,
    /// For each geom: does it belong to a beam, a peg or a holder?
    is_part: Vec<bool>,
    wrist_site: usize,
    tip_site: usize,
    /// Bodies that hang from the wrist, whose weight the sensor's reading is freed of.
    hand_bodies: [usize; 3],
    gripper: GripperLoop,
    slow_gripper: SlowGripper,
    /// What the episode drew from its world.
    physics: Physics,
    drive: Drive,
    /// Whether anything differs between the motors' torques and the joints', so that it must be reckoned with.
    loaded: bool,
    /// The joint targets of the last period, if joint positions or velocities were commanded.
    last_joints: Option<JointMotion>,
    /// Command of the last period.
    last_command: Option<Command>,
    /// The target of the tip of the last period, if a pose or an impedance was commanded, and whether it was a pose.
    last_pose: Option<(PoseMotion, bool)>,
    /// Is the last command held, without the agent commanding it?
    holding: bool,
    /// Posture that a bare pose command keeps.
    posture: [f64; DOF],
    state: ArmState,
    torques: JointVector,
    wrench: Vector6<f64>,
    noise: Stream,
    /// Noise of the readings of parts.
    reading_noise: Stream,
    cameras: Cameras,
    /// Exposures of the cameras whose images have not all been handed out, the oldest first.
    exposures: VecDeque<Exposure>,
    /// The period in which the cameras can begin the next one.
    shutters_free: u64,
    fault: Option<Injector>,
    failed: Option<RobotError>,
    deepest: f64,
    /// Force of the hand on the world through the sensor's filter, without its noise, N.
    pressed: Vector3<f64>,
    /// The largest of it so far, N.
    largest_force: f64,
    steps: u64,
    observation: Observation,
}

impl Twin {
    /// Builds the scene and puts every part at its start.
    ///
    /// # Errors
    /// When MuJoCo refuses the scene.
    pub fn new(setup: &Setup) -> Result<Twin, TwinError> {
        Twin::with_layout(setup, Layout::new(setup.assembly, setup.disturbance, setup.seed))
    }

    /// Builds the scene with every part where `layout` says.
    ///
    /// # Errors
    /// When MuJoCo refuses the scene.
    pub fn with_layout(setup: &Setup, layout: Layout) -> Result<Twin, TwinError> {
        Twin::with_options(setup, layout, &SceneOptions::default())
    }

    /// As [`Twin::with_layout`], with a scene of one's own choice. `layout` may leave out parts, but not the clamped beam.
    ///
    /// # Errors
    /// When MuJoCo refuses the scene.
    pub fn with_options(
        setup: &Setup,
        mut layout: Layout,
        options: &SceneOptions,
    ) -> Result<Twin, TwinError> {
        let start = Start::new(setup);
        let physics = setup.world.draw(setup.seed);
        layout.tilt(&physics.table);
        layout.pegs.retain(|(name, _)| Some(name) != start.missing.as_ref());
        let base = &setup.assembly.beams[setup.assembly.base].beam.name;
        let printed = Printed { physics: &physics, seed: setup.seed };
        let xml =
            scene_xml(&setup.assembly.kit, setup.arm, &layout, base, start.loose_holders, &printed, options);
        let model = MjModel::from_xml_string(&xml).map_err(|error| TwinError::Scene(error.to_string()))?;
        let find = |kind, name: &str| {
            model.name_to_id(kind, name).ok_or_else(|| TwinError::Missing(name.to_string()))
        };
        let body = |name: &str| find(MjtObjBase::mjOBJ_BODY, name);
        let mut parts = Vec::new();
        for name in layout.beams.iter().chain(&layout.pegs).map(|(name, _)| name) {
            parts.push((name.clone(), body(name)?));
        }
        let mut part_bodies: Vec<usize> = parts.iter().map(|(_, id)| *id).collect();
        let mut holders = Vec::new();
        for (name, _) in &layout.holders {
            holders.push((name.clone(), body(name)?));
        }
        part_bodies.extend(holders.iter().map(|(_, id)| *id));
        let is_part = model.geom_bodyid().iter().map(|id| part_bodies.contains(&(*id as usize))).collect();
        let wrist_site = find(MjtObjBase::mjOBJ_SITE, "wrist")?;
        let tip_site = find(MjtObjBase::mjOBJ_SITE, "tip")?;
        let hand_bodies = [body("hand")?, body("finger1")?, body("finger2")?];
        let fingers = [hand_bodies[1], hand_bodies[2]];
        let fault = Injector::new(setup, &start, &model, &parts, holders, fingers);
        let broad_phase = BroadPhase::new(&model);
        let mut data = MjData::new(Arc::new(model));
        data.qpos_mut()[..DOF].copy_from_slice(&setup.arm.home);
        data.qpos_mut()[DOF..DOF + 2].copy_from_slice(&[START_WIDTH / 2.0; 2]);
        data.forward();
        let mut twin = Twin {
            data,
            broad_phase,
            xml: xml.into(),
            arm: setup.arm.clone(),
            track: setup.track,
            parts,
            is_part,
            wrist_site,
            tip_site,
            hand_bodies,
            gripper: GripperLoop::new(START_WIDTH / 2.0),
            slow_gripper: SlowGripper::new(&physics.gripper, START_WIDTH),
            drive: Drive::new(&physics, &setup.arm.home, setup.seed),
            loaded: physics.friction.coulomb != [0.0; DOF] || physics.arm.unknown_mass != 0.0,
            last_joints: None,
            last_command: None,
            last_pose: None,
            holding: false,
            posture: setup.arm.home,
            state: ArmState {
                positions: JointVector::from(setup.arm.home),
                velocities: JointVector::zeros(),
                x_wt: Pose::identity(),
                jacobian: Jacobian::zeros(),
                inertia: SMatrix::identity(),
            },
            torques: JointVector::zeros(),
            wrench: Vector6::zeros(),
            noise: Stream::new(setup.seed, "wrist"),
            reading_noise: Stream::new(setup.seed, "readings"),
            cameras: Cameras::new(
                &setup.assembly.kit,
                setup.arm,
                setup.seed,
                start.covered.map(|(tag, _)| tag),
                &physics.cameras,
            ),
            physics,
            exposures: VecDeque::new(),
            shutters_free: 0,
            fault,
            failed: None,
            deepest: 0.0,
            pressed: Vector3::zeros(),
            largest_force: 0.0,
            steps: 0,
            observation: Observation {
                time: 0.0,
                positions: setup.arm.home,
                velocities: [0.0; DOF],
                torques: [0.0; DOF],
                x_wt: Pose::identity(),
                wrench: Vector6::zeros(),
                width: START_WIDTH,
                gripper_busy: false,
            },
        };
        if setup.track == Track::Tags {
            twin.cameras.looks()?;
        }
        twin.state = twin.arm_state();
        if twin.has_wrist_sensor() {
            twin.wrench = twin.read_wrist();
        }
        twin.sense();
        Ok(twin)
    }

    /// Gives a part that nothing clamps a velocity: of its frame's origin, m/s, and about it, rad/s, axes of the world.
    /// For starts that are not the sheet's, before [`Twin::begin`].
    pub fn knock(&mut self, part: &str, linear: &Vector3<f64>, angular: &Vector3<f64>) {
        let Some((_, body)) = self.parts.iter().find(|(name, _)| name == part) else { return };
        let Ok(from) = usize::try_from(self.data.model().body_dofadr()[*body]) else { return };
        // MuJoCo counts the turn of a free body in its own axes.
        let turn = body_pose(&self.data, *body).rotation.inverse() * angular;
        let velocity = &mut self.data.qvel_mut()[from..from + 6];
        velocity[..3].copy_from_slice(linear.as_slice());
        velocity[3..].copy_from_slice(turn.as_slice());
    }

    /// Lets so many periods pass with the arm at home.
    ///
    /// # Errors
    /// When the physics diverge.
    pub fn settle(&mut self, periods: u32) -> Result<(), RobotError> {
        self.hold(periods)
    }

    /// The episode's time begins now, and what was so far does not count.
    pub fn begin(&mut self) {
        self.steps = 0;
        self.deepest = 0.0;
        self.largest_force = 0.0;
        self.sense();
    }

    /// The scene as MJCF.
    pub fn scene(&self) -> &str {
        &self.xml
    }

    /// The scene as MJCF with named keyframes, each a full set of positions ([`Twin::qpos`]).
    pub fn scene_with_keyframes(&self, keyframes: &[(&str, &[f64])]) -> String {
        let mut block = String::from("<keyframe>\n");
        for (name, qpos) in keyframes {
            let numbers: Vec<String> = qpos.iter().map(f64::to_string).collect();
            block.push_str(&format!("<key name=\"{name}\" qpos=\"{}\"/>\n", numbers.join(" ")));
        }
        block.push_str("</keyframe>\n</mujoco>\n");
        self.xml.replace("</mujoco>\n", &block)
    }

    /// MuJoCo's model, to be looked at.
    pub fn model(&self) -> &MjModel {
        self.data.model()
    }

    /// The full physics state: joint positions of the arm, the fingers and all parts.
    pub fn qpos(&self) -> &[f64] {
        self.data.qpos()
    }

    /// Actuator commands of the last step.
    pub fn ctrl(&self) -> &[f64] {
        self.data.ctrl()
    }

    /// Names of all beams and pegs, in the order of [`Truth::x_wp`].
    pub fn part_names(&self) -> impl Iterator<Item = &str> {
        self.parts.iter().map(|(name, _)| name.as_str())
    }

    /// Where everything really is.
    pub fn truth(&self) -> Truth {
        Truth {
            time: self.time(),
            x_wp: self.parts.iter().map(|(_, id)| body_pose(&self.data, *id)).collect(),
        }
    }

    /// A camera as it really is, its error of calibration included: for judging perception, never for an agent.
    pub fn true_camera(&self, camera: Camera) -> CameraModel {
        self.cameras.true_camera(camera)
    }

    /// Where everything is now, for pictures from any place with these looks. What hangs on the hand is where the hand
    /// is.
    pub fn picture(&self, looks: &Looks) -> Scene {
        let model = self.data.model();
        let place = |(index, body): (usize, &ramp_render::looks::Body)| {
            let name = if body.name == HOUSING { "hand" } else { &body.name };
            Some((index, body_pose(&self.data, model.name_to_id(MjtObjBase::mjOBJ_BODY, name)?)))
        };
        Scene { bodies: looks.bodies().iter().enumerate().filter_map(place).collect() }
    }

    /// Deepest penetration between two parts in any step so far, m.
    pub fn deepest_penetration(&self) -> f64 {
        self.deepest
    }

    /// The largest force between the hand and what it touches or holds so far, N: at the wrist, through the sensor's
    /// filter (time constant 20 ms), without its noise.
    pub fn largest_force(&self) -> f64 {
        self.largest_force
    }

    /// What became of the episode's fault so far; `None` without one.
    pub fn fault(&self) -> Option<&FaultReport> {
        self.fault.as_ref().map(Injector::report)
    }

    /// Robot time, s: counted in steps, so that it carries no rounding.
    pub fn time(&self) -> f64 {
        self.steps as f64 * PERIOD
    }

    /// A number that two runs share only if they share every bit of their physics state.
    pub fn state_hash(&self) -> u64 {
        let mut hash: u64 = 0xcbf2_9ce4_8422_2325;
        for value in self.data.qpos().iter().chain(self.data.qvel()) {
            for byte in value.to_bits().to_le_bytes() {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
            }
        }
        hash
    }

    /// The arm's joint-space inertia: the first rows of MuJoCo's sparse lower triangle.
    fn arm_inertia(&self) -> SMatrix<f64, DOF, DOF> {
        let model = self.data.model();
        let values = self.data.m();
        let mut inertia = SMatrix::<f64, DOF, DOF>::zeros();
        for row in 0..DOF {
            let from = model.m_rowadr()[row] as usize;
            let to = from + model.m_rownnz()[row] as usize;
            for (value, column) in values[from..to].iter().zip(&model.m_colind()[from..to]) {
                inertia[(row, *column as usize)] = *value;
                inertia[(*column as usize, row)] = *value;
            }
        }
        inertia
    }

    fn arm_state(&self) -> ArmState {
        let p_wt = Vector3::from(self.data.site_xpos()[self.tip_site]);
        let rotation = rotation_from_rows(&self.data.site_xmat()[self.tip_site]);
        let mut jacobian = Jacobian::zeros();
        for joint in 0..DOF {
            let axis = Vector3::from(self.data.xaxis()[joint]);
            let anchor = Vector3::from(self.data.xanchor()[joint]);
            let linear = axis.cross(&(p_wt - anchor));
            jacobian.fixed_view_mut::<3, 1>(0, joint).copy_from(&linear);
            jacobian.fixed_view_mut::<3, 1>(3, joint).copy_from(&axis);
        }
        let state = ArmState {
            positions: JointVector::from_column_slice(&self.data.qpos()[..DOF]),
            velocities: JointVector::from_column_slice(&self.data.qvel()[..DOF]),
            x_wt: Pose::from_parts(Translation3::from(p_wt), rotation),
            jacobian,
            inertia: self.arm_inertia(),
        };
        believed(&self.physics.arm, state)
    }

    /// What the wrist sensor would read without noise: the hand's wrench on what it touches and holds, at the
    /// wrist, axes of the world; the weight of the hand itself taken off.
    fn read_wrist(&self) -> Vector6<f64> {
        let sensor = self.data.sensordata();
        let rotation = rotation_from_rows(&self.data.site_xmat()[self.wrist_site]);
        let p_wrist = Vector3::from(self.data.site_xpos()[self.wrist_site]);
        let mut force = rotation * Vector3::new(sensor[0], sensor[1], sensor[2]);
        let mut moment = rotation * Vector3::new(sensor[3], sensor[4], sensor[5]);
        // MuJoCo gives the wrench that carries the hand: up, at rest. The hand's own weight is known.
        for body in self.hand_bodies {
            let weight = Vector3::new(0.0, 0.0, self.data.model().body_mass()[body] * GRAVITY);
            force -= weight;
            moment -= (Vector3::from(self.data.xipos()[body]) - p_wrist).cross(&weight);
        }
        // Carried from outside with +f, the hand presses on the outside with −f.
        Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z)
    }

    /// By how much a fault has what is felt at the wrist off, N and N·m, axes of the world.
    fn wrist_bias(&self) -> Vector6<f64> {
        let Some(fault) = &self.fault else { return Vector6::zeros() };
        let force = rotation_from_rows(&self.data.site_xmat()[self.wrist_site]) * fault.bias();
        Vector6::new(force.x, force.y, force.z, 0.0, 0.0, 0.0)
    }

    /// By how much the wrist sensor of this world is off, N and N·m, axes of the world.
    fn sensor_bias(&self) -> Vector6<f64> {
        let rotation = rotation_from_rows(&self.data.site_xmat()[self.wrist_site]);
        let sensing = &self.physics.sensing;
        let [force, moment] =
            [sensing.force_bias, sensing.moment_bias].map(|it| rotation * Vector3::from(it));
        Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z)
    }

    fn has_wrist_sensor(&self) -> bool {
        self.physics.sensing.wrist_sensor >= 0.5
    }

    /// The Jacobian of the wrist, as MuJoCo has it.
    fn wrist_jacobian(&self, state: &ArmState) -> Jacobian {
        let lever = Vector3::from(self.data.site_xpos()[self.wrist_site])
            - Vector3::from(self.data.site_xpos()[self.tip_site]);
        let mut jacobian = state.jacobian;
        for joint in 0..DOF {
            let axis = Vector3::from(jacobian.fixed_view::<3, 1>(3, joint));
            let linear = jacobian.fixed_view::<3, 1>(0, joint) + axis.cross(&lever);
            jacobian.fixed_view_mut::<3, 1>(0, joint).copy_from(&linear);
        }
        jacobian
    }

    /// What is felt at the wrist after a period from `before`: by the sensor there, or as the arm estimates it.
    fn feel(&mut self, before: &ArmState, reading: &Vector6<f64>) {
        let sensing = &self.physics.sensing;
        let (force, moment) = (sensing.force_noise, sensing.moment_noise);
        let noise = Vector6::from_fn(|axis, _| self.noise.normal(if axis < 3 { force } else { moment }));
        let told = self.physics.sensing.torque_sensors >= 0.5;
        if told || !self.has_wrist_sensor() {
            // Coriolis and centrifugal torques: what the engine's bias has beside the weights that it compensates.
            let coriolis = JointVector::from_column_slice(&self.data.qfrc_bias()[..DOF])
                - JointVector::from_column_slice(&self.data.qfrc_gravcomp()[..DOF]);
            let after = JointVector::from_column_slice(&self.data.qvel()[..DOF]);
            self.drive.sensed(&before.inertia, [&before.velocities, &after], &coriolis, &before.positions);
        }
        if told {
            self.torques = *self.drive.torques();
        }
        if self.has_wrist_sensor() {
            let wrench = reading + self.wrist_bias() + self.sensor_bias() + noise;
            self.wrench += (wrench - self.wrench) * WRENCH_FILTER;
        } else {
            self.wrench = self.drive.wrench(&self.wrist_jacobian(&self.state)) + self.wrist_bias();
        }
    }

    fn sense(&mut self) {
        let width = self.data.qpos()[DOF] + self.data.qpos()[DOF + 1];
        let gripper = self.last_command.as_ref().map(|command| command.gripper);
        let (width, gripper_busy) = match gripper {
            Some(gripper) => self.slow_gripper.sensed(width, gripper),
            None => (width, false),
        };
        let state = &self.state;
        self.observation = Observation {
            time: self.time(),
            positions: state.positions.into(),
            velocities: state.velocities.into(),
            torques: self.torques.into(),
            x_wt: state.x_wt,
            wrench: self.wrench,
            width,
            gripper_busy,
        };
    }

    /// The torques of a command; refuses one that cannot follow the one before.
    fn command_torques(&mut self, state: &ArmState, command: &ArmCommand) -> Result<JointVector, RobotError> {
        let before = self.last_joints.take();
        let pose_before = self.last_pose.take();
        Ok(match command {
            ArmCommand::JointPositions(positions) => {
                let positions = JointVector::from(*positions);
                let target = match before {
                    // A target that is held rests: nothing of the motion before is fed forward.
                    Some(_) if self.holding => JointMotion::at_rest(positions),
                    Some(before) => {
                        let target = before.next(positions);
                        target.check(&before, &self.arm)?;
                        target
                    }
                    None => {
                        let target = JointMotion::at_rest(positions);
                        target.check_start(&state.positions)?;
                        target
                    }
                };
                self.last_joints = Some(target);
                self.posture = target.positions.into();
                track_joints(state, &target.positions, &target.velocities, &target.accelerations)
            }
            ArmCommand::JointVelocities(velocities) => {
                track_velocities(state, &JointVector::from(*velocities))
            }
            ArmCommand::JointTorques(torques) => JointVector::from(*torques),
            ArmCommand::CartesianPose(x_wt) => {
                let target = match pose_before {
                    Some((_, true)) if self.holding => PoseMotion::at_rest(*x_wt),
                    Some((before, true)) => {
                        let target = before.next(*x_wt);
                        if let Some(limits) = &self.arm.cartesian {
                            target.check(&before, limits)?;
                        }
                        target
                    }
                    _ => {
                        let target = PoseMotion::at_rest(*x_wt);
                        target.check_start(&state.x_wt)?;
                        target
                    }
                };
                self.last_pose = Some((target, true));
                let [velocity, acceleration] = fed_forward(&target);
                impedance(state, &pose_impedance(x_wt, self.posture), &velocity, &acceleration)
            }
            ArmCommand::CartesianImpedance(command) => {
                let target = match pose_before {
                    Some((before, _)) if !self.holding => before.next(command.x_wt),
                    _ => PoseMotion::at_rest(command.x_wt),
                };
                self.last_pose = Some((target, false));
                let [velocity, acceleration] = fed_forward(&target);
                impedance(state, command, &velocity, &acceleration)
            }
        })
    }

    /// The line was silent for so long that the arm has stopped: it brakes, and stands until somebody has made it work again.
    /// The motion that was commanded goes on from there.
    fn recover(&mut self) -> Result<(), RobotError> {
        self.drive.begin_anew();
        let gripper = self.last_command.as_ref().map_or(START_GRIPPER, |command| command.gripper);
        let motion = (self.last_joints, self.last_pose, self.last_command.clone(), self.posture);
        let here = Command { arm: ArmCommand::JointPositions(self.state.positions.into()), gripper };
        let periods = (self.physics.line.recovery / PERIOD).round() as u32;
        self.holding = true;
        self.last_joints = Some(JointMotion::at_rest(self.state.positions));
        let stood = (0..periods).try_for_each(|_| self.advance(&here));
        self.holding = false;
        (self.last_joints, self.last_pose, self.last_command, self.posture) = motion;
        stood
    }

    /// One period, and what may follow from it.
    fn period(&mut self, command: &Command) -> Result<(), RobotError> {
        self.advance(command)?;
        if self.drive.has_stopped() && !self.holding { self.recover() } else { Ok(()) }
    }

    fn check_arm(&self) -> Result<(), RobotError> {
        let state = &self.state;
        for (index, joint) in self.arm.joints.iter().enumerate() {
            let (position, velocity) = (state.positions[index], state.velocities[index]);
            let [low, high] = joint.range;
            if !position.is_finite() || !velocity.is_finite() {
                return Err(RobotError::Diverged { time: self.time() });
            }
            if position < low - POSITION_MARGIN || position > high + POSITION_MARGIN {
                return Err(RobotError::JointPosition { joint: index + 1, position, low, high });
            }
            if velocity.abs() > joint.velocity {
                return Err(RobotError::JointVelocity { joint: index + 1, velocity, limit: joint.velocity });
            }
        }
        Ok(())
    }

    fn watch_penetration(&mut self) {
        for contact in self.data.contact() {
            if -contact.dist > self.deepest {
                let both = contact.geom.iter().all(|geom| {
                    usize::try_from(*geom).ok().and_then(|geom| self.is_part.get(geom)).copied() == Some(true)
                });
                if both {
                    self.deepest = -contact.dist;
                }
            }
        }
    }

    /// Lets periods pass under the last command; before the first one the arm stays where it starts. A motion that is
    /// commanded goes on afterwards as if none had passed.
    fn hold(&mut self, periods: u32) -> Result<(), RobotError> {
        let command = self
            .last_command
            .clone()
            .unwrap_or(Command { arm: ArmCommand::JointPositions(self.arm.home), gripper: START_GRIPPER });
        let motion = (self.last_joints, self.last_pose);
        self.holding = true;
        let held = (0..periods).try_for_each(|_| self.step(&command).map(|_| ()));
        self.holding = false;
        (self.last_joints, self.last_pose) = motion;
        held
    }

    /// A reading of all parts with noise, some left out.
    fn noisy_reading(&mut self) -> Vec<PartReading> {
        let [position, rotation] = READING_NOISE;
        let noise = &mut self.reading_noise;
        let mut readings = Vec::new();
        for (name, id) in &self.parts {
            // As many numbers for a reading that is dropped as for any other.
            let dropped = noise.uniform() < READING_DROPPED;
            let shift = Vector3::from_fn(|_, _| noise.normal(position));
            let turn = Vector3::from_fn(|_, _| noise.normal(rotation));
            if !dropped {
                let x_wp = body_pose(&self.data, *id);
                let p = x_wp.translation.vector + shift;
                let rotation = UnitQuaternion::from_scaled_axis(turn) * x_wp.rotation;
                let x_wp = Pose::from_parts(Translation3::from(p), rotation);
                readings.push(PartReading { part: name.clone(), x_wp, sigma: READING_NOISE });
            }
        }
        readings
    }

    /// Opens the shutters of both cameras as soon as they are free; whether the images are `kept` until somebody asks for them.
    /// Of as many as are kept, the oldest whose images are there makes room; when there is none, nothing is done.
    fn open_shutters(&mut self, kept: bool) {
        if self.exposures.len() >= MOST_EXPOSURES {
            let there = |exposure: &Exposure| exposure.there <= self.steps;
            let Some(oldest) = self.exposures.iter().position(there) else { return };
            self.exposures.remove(oldest);
        }
        let begin = self.steps.max(self.shutters_free);
        self.shutters_free = begin + self.cameras.interval();
        self.exposures.push_back(Exposure::new(begin, self.cameras.latency(), kept));
    }

    /// Keeps where everything is for the exposures that go on.
    fn keep_moment(&mut self) {
        let steps = self.steps;
        if !self.exposures.iter().any(|exposure| exposure.is_due(steps)) {
            return;
        }
        let Ok(looks) = self.cameras.looks() else { return };
        let moment = Moment { scene: self.picture(&looks), x_wt: self.state.x_wt, time: self.time() };
        let frozen = self.fault.as_ref().is_some_and(Injector::freezes_cameras);
        for exposure in &mut self.exposures {
            if exposure.is_due(steps) {
                exposure.add(moment.clone(), frozen);
            }
        }
    }

    /// The image of a camera from the exposure with this number.
    fn image(&mut self, camera: Camera, number: usize) -> Result<Image, RobotError> {
        let stopped = RobotError::CameraStopped { camera };
        let exposure = &mut self.exposures[number];
        exposure.taken.push(camera);
        let exposure = exposure.clone();
        if Camera::ALL.iter().all(|camera| exposure.taken.contains(camera)) {
            self.exposures.remove(number);
        }
        let Some(middle) = exposure.middle() else { return Err(stopped) };
        let (width, height, pixels) = self.cameras.take(camera, &exposure).map_err(|_| stopped)?;
        Ok(Image { camera, time: middle.time, x_wt: middle.x_wt, width, height, pixels })
    }

    fn advance(&mut self, command: &Command) -> Result<(), RobotError> {
        check_command(command)?;
        if self.time() >= TIME_LIMIT {
            return Err(RobotError::OutOfTime { limit: TIME_LIMIT });
        }
        let before = self.state.clone();
        let wanted = self.command_torques(&before, &command.arm)?;
        let motors = self.drive.command(&self.arm, &command.arm, wanted)?;
        self.torques = motors;
        let q = [self.data.qpos()[DOF], self.data.qpos()[DOF + 1]];
        let v = [self.data.qvel()[DOF], self.data.qvel()[DOF + 1]];
        let mut gripper = self.slow_gripper.step(command.gripper);
        if let Some(fault) = &mut self.fault {
            let fingers = [q[0] + q[1], v[0] + v[1]];
            gripper = fault.step(&mut self.data, &before.x_wt, self.steps, fingers, gripper);
        }
        let fingers = self.gripper.forces(gripper.width, gripper.force, q, v, PERIOD);
        if self.loaded {
            let hand = rotation_from_rows(&self.data.site_xmat()[self.wrist_site]);
            let p_unknown = Vector3::from(self.data.site_xpos()[self.wrist_site])
                + hand * Vector3::from(self.physics.arm.unknown_centre);
            let load = self.drive.load(&before, &p_unknown);
            self.data.qfrc_applied_mut()[..DOF].copy_from_slice(load.as_slice());
        }
        let ctrl = self.data.ctrl_mut();
        ctrl[..DOF].copy_from_slice(motors.as_slice());
        ctrl[DOF..DOF + 2].copy_from_slice(&fingers);
        self.broad_phase.step(&mut self.data);
        self.last_command = Some(command.clone());
        self.steps += 1;
        self.watch_penetration();
        let reading = self.read_wrist();
        self.state = self.arm_state();
        self.feel(&before, &reading);
        self.pressed += (reading.fixed_rows::<3>(0) - self.pressed) * WRENCH_FILTER;
        self.largest_force = self.largest_force.max(self.pressed.norm());
        self.sense();
        self.keep_moment();
        self.drive.check_reflex(self.wrench.fixed_rows::<3>(0).norm())?;
        self.check_arm()
    }
}

impl Robot for Twin {
    fn step(&mut self, command: &Command) -> Result<Observation, RobotError> {
        if let Some(error) = &self.failed {
            return Err(error.clone());
        }
        match self.period(command) {
            Ok(()) => Ok(self.observation.clone()),
            Err(error) => {
                self.failed = Some(error.clone());
                Err(error)
            }
        }
    }

    fn observe(&self) -> Observation {
        self.observation.clone()
    }

    fn read_parts(&mut self) -> Result<Vec<PartReading>, RobotError> {
        if let Some(error) = &self.failed {
            return Err(error.clone());
        }
        match self.track {
            Track::State => Ok(self
                .parts
                .iter()
                .map(|(name, id)| PartReading {
                    part: name.clone(),
                    x_wp: body_pose(&self.data, *id),
                    sigma: [0.0; 2],
                })
                .collect()),
            Track::Noisy => {
                self.hold(READING_STEPS)?;
                Ok(self.noisy_reading())
            }
            Track::Tags => Err(RobotError::NotOnTrack { track: self.track, what: "poses of parts" }),
        }
    }

    fn expose(&mut self) -> Result<(), RobotError> {
        if let Some(error) = &self.failed {
            return Err(error.clone());
        }
        if self.track == Track::Noisy {
            return Err(RobotError::NotOnTrack { track: self.track, what: "images" });
        }
        self.open_shutters(true);
        Ok(())
    }

    fn look(&mut self, camera: Camera) -> Result<Image, RobotError> {
        if let Some(error) = &self.failed {
            return Err(error.clone());
        }
        if self.track == Track::Noisy {
            return Err(RobotError::NotOnTrack { track: self.track, what: "images" });
        }
        // The image of the other camera from a look is there as long as no time passes.
        self.exposures.retain(|exposure| exposure.kept || exposure.there == self.steps);
        let waits = |exposure: &Exposure| !exposure.taken.contains(&camera);
        let number = self.exposures.iter().position(waits).unwrap_or_else(|| {
            // Those of which this camera has given its image are there, and make room.
            self.open_shutters(false);
            self.exposures.len() - 1
        });
        let wait = self.exposures[number].there.saturating_sub(self.steps);
        self.hold(u32::try_from(wait).unwrap_or(u32::MAX))?;
        self.image(camera, number)
    }

    fn camera(&self, camera: Camera) -> CameraModel {
        CameraModel::nominal(camera, self.arm.hand.tip)
    }
}
