//! Frames that only look finished, in the real physics: pegs that fell, flew or were pushed into their place,
//! and pegs that only the hand holds.

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3, Vector6};
use ramp_episode::run_episode_in;
use ramp_kit::Pose;
use ramp_kit::joint::FEMALE_HEIGHT;
use ramp_motion::Kinematics;
use ramp_result::EpisodeResult;
use ramp_result::episode::RejectReason;
use ramp_robot::{Account, Agent, ArmCommand, Command, GripperCommand, Impedance, Robot, RobotError, Track};
use ramp_testing::GoalFiles;
use ramp_testing::episode::label;
use ramp_twin::{Layout, Setup, Twin, World};

/// A start with the two beams of the first connection of easy-1 in their place.
struct Stage {
    goal: GoalFiles,
    /// Pose of a peg that is seated in the first connection, in the world.
    seat: Pose,
}

impl Stage {
    fn new() -> Stage {
        let goal = GoalFiles::new("easy-1");
        let assembly = &goal.assembly;
        let hole = assembly.kit.x_wa() * assembly.p_a_hole(assembly.connections[0].female);
        let seat = Pose::translation(hole.x, hole.y, hole.z + FEMALE_HEIGHT / 2.0);
        Stage { goal, seat }
    }

    /// With the hand above the seat at the start, so that it closes on the head of a peg there.
    fn with_hand_over_seat() -> Stage {
        let stage = Stage::new();
        let tip = stage.seat.translation.vector + Vector3::new(0.0, 0.0, OVER_SEAT);
        stage.with_hand_at(tip, 0.0)
    }

    /// With the tip of the hand at `tip` (m, world) at the start, pointing down and turned by `yaw` (rad). At
    /// 0 it closes along y.
    fn with_hand_at(mut self, tip: Vector3<f64>, yaw: f64) -> Stage {
        let kinematics = Kinematics::new(&self.goal.arm);
        let down = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw)
            * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        let home = self.goal.arm.home.into();
        let q = kinematics.inverse(&Pose::from_parts(Translation3::from(tip), down), &home, &home).unwrap();
        self.goal.arm.home = q.into();
        self
    }

    fn setup(&self, world: &'static World) -> Setup<'_> {
        Setup { world, ..self.goal.setup(Track::State, 1) }
    }

    /// The twin with the peg p1 at `x_peg` in the frame of the seat.
    fn twin(&self, setup: &Setup, x_peg: Pose) -> Twin {
        Twin::with_layout(setup, self.layout(setup, x_peg)).unwrap()
    }

    fn layout(&self, setup: &Setup, x_peg: Pose) -> Layout {
        let assembly = setup.assembly;
        let mut layout = Layout::new(assembly, setup.start, setup.seed);
        for joint in [assembly.connections[0].female, assembly.connections[0].male] {
            let placed = &assembly.beams[joint.beam];
            let (_, x_wb) = layout.beams.iter_mut().find(|(name, _)| *name == placed.beam.name).unwrap();
            *x_wb = assembly.kit.x_wa() * placed.x_ab;
        }
        let (_, x_wp) = layout.pegs.iter_mut().find(|(name, _)| name == "p1").unwrap();
        *x_wp = self.seat * x_peg;
        layout
    }

    /// The result of an episode that only waits.
    fn wait(&self, setup: &Setup, twin: &mut Twin, periods: u32, width: f64) -> EpisodeResult {
        let mut agent = Waiter { periods, width, planning: 0.0 };
        run_episode_in(twin, setup, &mut agent, &label(), &mut |_, _| {})
    }
}

/// An agent that lets the arm stand, with the fingers at this distance (m).
struct Waiter {
    periods: u32,
    width: f64,
    /// The time that it reports as planning, s.
    planning: f64,
}

impl Agent for Waiter {
    fn name(&self) -> (&str, &str) {
        ("waiter", "1")
    }

    fn account(&self) -> Account {
        Account { planning: self.planning, ..Account::default() }
    }

    fn run(&mut self, robot: &mut dyn Robot) -> Result<(), RobotError> {
        let arm = ArmCommand::JointPositions(robot.observe().positions);
        let command = Command { arm, gripper: GripperCommand { width: self.width, force: 20.0 } };
        (0..self.periods).try_for_each(|_| robot.step(&command).map(|_| ()))
    }
}

/// An agent that closes the hand, moves the setpoint of an impedance `by` so many metres within a second, and
/// ends there.
struct Pusher {
    by: Vector3<f64>,
}

impl Agent for Pusher {
    fn name(&self) -> (&str, &str) {
        ("pusher", "1")
    }

    fn account(&self) -> Account {
        Account::default()
    }

    fn run(&mut self, robot: &mut dyn Robot) -> Result<(), RobotError> {
        let seen = robot.observe();
        (1..=1500).try_for_each(|period| {
            let shift = Translation3::from(self.by * (f64::from(period) / 1000.0 - 0.5).max(0.0));
            let impedance = Impedance {
                x_wt: shift * seen.x_wt,
                stiffness: Vector6::new(1500.0, 1500.0, 1500.0, 50.0, 50.0, 50.0),
                damping_ratio: 1.0,
                feed_forward: Vector6::zeros(),
                posture: seen.positions,
            };
            let arm = ArmCommand::CartesianImpedance(impedance);
            robot.step(&Command { arm, gripper: GripperCommand { width: 0.0, force: 20.0 } }).map(|_| ())
        })
    }
}

/// The tip of a hand whose fingers are clear of the plate, over that plate, m.
const OVER_SEAT: f64 = 21e-3;
/// The width of the open hand at the start, m.
const OPEN: f64 = 0.04;

fn up(height: f64) -> Pose {
    Pose::translation(0.0, 0.0, height)
}

fn worlds() -> [&'static World; 2] {
    [World::ideal(), World::shipped("real").unwrap()]
}

fn reasons(result: &EpisodeResult) -> Vec<&RejectReason> {
    result.rejected.iter().map(|rejected| &rejected.reason).collect()
}

/// A peg in its place counts, also one that has still to fall the last half of a millimetre, and one that
/// falls in cleanly from inside its hole.
#[test]
fn a_peg_that_stands_counts() {
    let stage = Stage::new();
    for world in worlds() {
        let setup = stage.setup(world);
        for height in [0.0, 0.4e-3, 20e-3] {
            let result = stage.wait(&setup, &mut stage.twin(&setup, up(height)), 400, OPEN);
            assert_eq!((result.counted(), reasons(&result)), (1, vec![]), "{} {height}", world.name);
        }
    }
}

/// Contacts give, and a fast peg goes into a plate that it hits: its head into the upper one, or its stem
/// through it beside the hole. It ends in its place, and is rejected.
#[test]
fn a_peg_that_was_flung_through_a_plate_does_not_count() {
    let stage = Stage::new();
    let mut rejected = 0;
    for world in worlds() {
        let setup = stage.setup(world);
        for aside in [0.0, 1e-3, 3e-3] {
            let mut twin = stage.twin(&setup, Pose::translation(0.0, aside, 0.25));
            let result = stage.wait(&setup, &mut twin, 1500, OPEN);
            assert_eq!(result.counted(), 0, "{} {aside}", world.name);
            for reason in reasons(&result) {
                rejected += 1;
                let RejectReason::Penetration { parts, depth } = reason else { panic!("{reason:?}") };
                // A plate of either beam that the peg joins.
                assert!(["b4", "b7"].contains(&parts[0].as_str()) && parts[1] == "p1", "{parts:?}");
                assert!(*depth > 1.5e-3 && *depth <= twin.deepest_penetration(), "{depth}");
            }
        }
    }
    assert!(rejected >= 3, "{rejected} pegs ended in their place");
}

/// A peg that is on its way out when the episode ends: slowly, and it falls back; fast, and it is in the air
/// a moment later.
#[test]
fn a_peg_that_flies_out_does_not_count() {
    let stage = Stage::new();
    for world in worlds() {
        let setup = stage.setup(world);
        for (speed, counted) in [(8e-3, 1), (1.0, 0)] {
            let mut twin = stage.twin(&setup, up(0.0));
            twin.settle(400).unwrap();
            twin.knock("p1", &Vector3::new(0.0, 0.0, speed), &Vector3::zeros());
            twin.begin();
            let before = twin.state_hash();
            let result = stage.wait(&setup, &mut twin, 0, OPEN);
            assert_eq!(result.counted(), counted, "{} {speed}", world.name);
            let expected = if counted == 0 { vec![&RejectReason::Fell {}] } else { vec![] };
            assert_eq!(reasons(&result), expected, "{} {speed}", world.name);
            assert_eq!(twin.state_hash(), before, "the last look changed the episode");
        }
    }
}

/// The hand holds a peg over its seat. Within the tolerance, it counts, since it falls into the seat when the
/// hand is gone; above, it does not count, though it would fall in as well.
#[test]
fn a_peg_in_the_hand_is_judged_without_the_hand() {
    let stage = Stage::with_hand_over_seat();
    let setup = stage.setup(World::ideal());
    for (height, counted) in [(0.4e-3, 1), (3e-3, 0)] {
        let mut twin = stage.twin(&setup, up(height));
        let peg = twin.part_names().position(|name| name == "p1").unwrap();
        let result = stage.wait(&setup, &mut twin, 500, 0.0);
        let gap = |x_wp: &Pose| x_wp.translation.z - stage.seat.translation.z;
        let held = gap(&twin.truth().x_wp[peg]);
        let rested = gap(&twin.without_arm(2.0, 10).last().unwrap().truth.x_wp[peg]);
        assert!((held - height).abs() < 0.3e-3, "the hand does not hold the peg: {held}");
        assert!(rested.abs() < 0.1e-3, "the peg does not fall: {rested}");
        assert_eq!(result.counted(), counted, "{height}");
    }
}

/// The hand holds up the end of a frame: the beam b4, in b7 and pinned, with its far end 5 mm over its place.
/// The peg is in its place, in the raised frame and in the one that has fallen.
#[test]
fn a_frame_that_the_hand_holds_up_is_judged_where_it_falls() {
    const RAISED: f64 = 5e-3;
    let stage = Stage::new();
    let assembly = &stage.goal.assembly;
    let placed = &assembly.beams[assembly.connections[0].male.beam];
    let beam = placed.beam.clone();
    let link = beam.links.last().unwrap().grasp;
    let grip = assembly.kit.x_wa() * placed.x_ab * Point3::new((link[0] + link[1]) / 2.0, 0.0, 0.0);
    let stage = stage.with_hand_at(grip.coords + Vector3::new(0.0, 0.0, 17e-3), 0.0);
    let setup = stage.setup(World::ideal());
    let mut twin = stage.twin(&setup, up(0.0));
    let mut agent = Pusher { by: Vector3::new(0.0, 0.0, RAISED) };
    let result = run_episode_in(&mut twin, &setup, &mut agent, &label(), &mut |_, _| {});
    let index = twin.part_names().position(|name| name == beam.name).unwrap();
    let end = |x_wb: &Pose| (x_wb * Point3::new(beam.span(), 0.0, 0.0)).z;
    let held = end(&twin.truth().x_wp[index]);
    let rested = end(&twin.without_arm(2.0, 10).last().unwrap().truth.x_wp[index]);
    assert!(held - rested > 0.5 * RAISED, "the frame does not fall: {held} {rested}");
    assert_eq!((result.counted(), reasons(&result)), (1, vec![]));
}

/// The arm pushes the clamped beam aside with 40 N while the episode ends: the clamp gives a little, and the
/// peg is judged where the beam is when the arm is gone.
#[test]
fn a_clamped_beam_that_is_pushed_springs_back() {
    let beside = Vector3::new(0.31 + 45e-3, -0.2, 0.035);
    let stage = Stage::new().with_hand_at(beside, std::f64::consts::FRAC_PI_2);
    let setup = stage.setup(World::shipped("real").unwrap());
    let mut twin = stage.twin(&setup, up(0.0));
    let index = twin.part_names().position(|name| name == "b7").unwrap();
    let place = twin.truth().x_wp[index].translation.vector;
    let off = |x_wb: &Pose| (x_wb.translation.vector - place).norm();
    let mut agent = Pusher { by: Vector3::new(-60e-3, 0.0, 0.0) };
    let result = run_episode_in(&mut twin, &setup, &mut agent, &label(), &mut |_, _| {});
    let pushed = off(&twin.truth().x_wp[index]);
    let rested = off(&twin.without_arm(2.0, 10).last().unwrap().truth.x_wp[index]);
    assert!(pushed > 10e-6 && rested < 0.1 * pushed, "{pushed} {rested}");
    assert_eq!((result.counted(), reasons(&result)), (1, vec![]), "{:?}", result.ended);
}

/// An agent that reports more planning than it thought, or less than nothing: the parts of the time stay
/// parts, and their sum is that of the clocks.
#[test]
fn reported_planning_is_part_of_the_thinking_time() {
    let stage = Stage::new();
    let setup = stage.setup(World::ideal());
    for planning in [1e9, -1e9] {
        let mut twin = stage.twin(&setup, up(0.0));
        let mut agent = Waiter { periods: 100, width: OPEN, planning };
        let time = run_episode_in(&mut twin, &setup, &mut agent, &label(), &mut |_, _| {}).time;
        assert!(time.planning >= 0.0 && time.compute >= 0.0, "{time:?}");
        assert_eq!(if planning > 0.0 { time.compute } else { time.planning }, 0.0, "{time:?}");
        assert_eq!(time.robot, 0.1);
        assert!((time.planning + time.compute + time.robot - time.total).abs() < 1e-9, "{time:?}");
    }
}
