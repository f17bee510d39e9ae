//! Every arm in `data/arms` reaches the table, and its paths are planned.

use std::f64::consts::PI;
use std::path::Path;

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_motion::{
    Analytic, Checker, Dynamics, Joints, Kinematics, Obstacle, Pace, PathPlanner, Pose, Terms, TimeLaw,
};
use ramp_robot::PERIOD;
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;

/// Distance that joints keep from the ends of their ranges, rad.
const MARGIN: f64 = 0.05;

/// The arms of `data/arms` with seven joints.
const SEVEN: [&str; 2] = ["fr3", "panda"];
/// Those with six.
const SIX: [&str; 1] = ["ur5e"];

fn arm<const N: usize>(name: &str) -> ArmModel<N> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/arms");
    ArmModel::read(&folder.join(name).with_extension("json")).unwrap()
}

/// The hand down over the table, at a random place and turn.
fn hover(stream: &mut Stream) -> Pose {
    let down = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), stream.symmetric(1.5))
        * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
    let (x, y) = (0.48 + stream.symmetric(0.13), stream.symmetric(0.4));
    Pose::from_parts(Translation3::new(x, y, 0.1), down)
}

/// Every file is read, and each contains its name.
#[test]
fn names_are_those_of_the_files() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/arms");
    let mut files: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path().file_stem().unwrap().to_str().unwrap().to_string())
        .collect();
    files.sort();
    assert_eq!(files, [&SEVEN[..], &SIX].concat());
    assert_eq!(SEVEN.map(|name| arm::<7>(name).name), SEVEN);
    assert_eq!(SIX.map(|name| arm::<6>(name).name), SIX);
}

#[test]
fn the_table_is_reached_from_home() {
    for arm in SEVEN.map(arm::<7>) {
        let planner = PathPlanner::new(&arm);
        let analytic = Analytic::new(&arm).unwrap();
        let home = Joints::from(arm.home);
        assert!(planner.kinematics.range_margin(&home) > MARGIN, "{}", arm.name);
        let mut stream = Stream::new(1, "hover");
        for _ in 0..100 {
            let x_wt = hover(&mut stream);
            let choice = analytic.quickest(&x_wt, &home, MARGIN).unwrap();
            let reached = planner.kinematics.tip(&choice.solution.q);
            assert!((reached.translation.vector - x_wt.translation.vector).norm() < 1e-9);
            assert!(planner.kinematics.range_margin(&choice.solution.q) > MARGIN - 1e-12);
            // No slower than the motions that the iteration finds.
            let iterated = planner.solve(&x_wt, &home).unwrap();
            assert!(choice.cost <= analytic.least_time(&home, &iterated) + 1e-3, "{}", arm.name);
        }
    }
}

/// Without a closed form: by iteration, from a seed at home and from afar.
#[test]
fn an_arm_of_six_joints_reaches_the_table() {
    let arm: ArmModel<6> = arm("ur5e");
    let refused = Analytic::new(&arm).unwrap_err().to_string();
    assert_eq!(refused, "the arm ur5e has no closed-form inverse kinematics: it has 6 joints, not 7");
    let planner = PathPlanner::new(&arm);
    let mut stream = Stream::new(1, "hover");
    let mut seed = Joints::from(arm.home);
    for _ in 0..100 {
        let x_wt = hover(&mut stream);
        for seed in [Joints::from(arm.home), seed] {
            let q = planner.solve(&x_wt, &seed).unwrap();
            let reached = planner.kinematics.tip(&q);
            assert!((reached.translation.vector - x_wt.translation.vector).norm() < 1e-6);
            assert!(reached.rotation.angle_to(&x_wt.rotation) < 1e-6);
            assert!(planner.kinematics.range_margin(&q) > MARGIN - 1e-12);
        }
        seed = planner.solve(&x_wt, &seed).unwrap();
    }
}

/// The tool of the UR5e at angles zero, by its DH parameters: the arm stretched out, d1 − d5 high, and d4 +
/// d6 to the side.
#[test]
fn the_ur5e_stands_where_its_dh_parameters_say() {
    let arm: ArmModel<6> = arm("ur5e");
    let frames = Kinematics::new(&arm).frames(&Joints::zeros());
    let flange = Vector3::new(0.425 + 0.3922, 0.1333 + 0.0996, 0.1625 - 0.0997);
    assert!((frames.hand.translation.vector - flange).norm() < 1e-9, "{}", frames.hand);
    // Outstretched it asks for less than its shoulder can: 3.8 m·N/kg and less for each of the moving masses.
    let holding = Dynamics::new(&arm).at(&Joints::zeros()).holding();
    assert!((60.0..90.0).contains(&holding[1].abs()), "{holding}");
    assert!(holding[0].abs() < 1e-9, "{holding}");
}

/// A UR5e that folds its forearm down its upright upper arm touches itself within its ranges; at
/// home and in its usual posture it does not, nor does any other arm.
#[test]
fn an_arm_is_kept_from_touching_itself() {
    let arm: ArmModel<6> = arm("ur5e");
    let (kinematics, checker) = (Kinematics::new(&arm), Checker::new(&arm, 0.04, Vec::new(), &[], 0.0));
    let folded = Joints::<6>::from([0.0, -PI / 2.0, 2.7, 0.0, -PI / 2.0, 0.0]);
    assert_eq!(checker.touched(&kinematics.frames(&folded)), Some("itself"));
    fn is_free<const N: usize>(arm: &ArmModel<N>) {
        let (kinematics, checker) = (Kinematics::new(arm), Checker::new(arm, 0.04, Vec::new(), &[], 0.0));
        for q in [Some(arm.home), arm.posture].into_iter().flatten() {
            assert_eq!(checker.touched(&kinematics.frames(&q.into())), None, "{}", arm.name);
        }
    }
    is_free(&arm);
    SEVEN.map(self::arm::<7>).iter().for_each(is_free);
}

/// On the way every limit is kept at every control period, and speeds stay within those that hold at each
/// angle: the paths keep away from the ends.
#[test]
fn paths_are_planned_around_boxes() {
    SEVEN.map(arm::<7>).iter().for_each(around_boxes);
    SIX.map(arm::<6>).iter().for_each(around_boxes);
}

fn around_boxes<const N: usize>(arm: &ArmModel<N>) {
    let planner = PathPlanner::new(arm);
    let mut stream = Stream::new(2, "paths");
    let around: Vec<Obstacle> = (0..50)
        .map(|number| Obstacle {
            name: format!("box {number}"),
            x: Pose::translation(0.45 + stream.symmetric(0.25), stream.symmetric(0.5), 0.0166),
            half: [0.03, 0.0133, 0.0166],
        })
        .collect();
    let checker = Checker::new(arm, 0.04, Vec::new(), &around, 0.5e-3);
    let pace = Pace { velocity: 1.0, acceleration: 1.0, jerk: 1.0, ramp: 0.0 };
    let law = TimeLaw::new(arm, &pace);
    let terms = Terms { height: 0.15, level: false, checker: &checker, law: &law };
    let mut q = Joints::from(arm.home);
    for _ in 0..20 {
        let x_wt = hover(&mut stream);
        let trajectory = planner.plan(&q, &x_wt, &terms, &mut stream).unwrap();
        q = trajectory.end();
        let used = law.used(trajectory.samples());
        for share in [used.velocity, used.acceleration, used.jerk, used.torque, used.torque_rate] {
            assert!(share < 1.0 + 1e-5, "{}: {used:?}", arm.name);
        }
        assert!(trajectory.samples().iter().all(|q| checker.is_free(&planner.kinematics.frames(q))));
        for pair in trajectory.samples().windows(2) {
            for (index, joint) in arm.joints.iter().enumerate() {
                let velocity = (pair[1][index] - pair[0][index]) / PERIOD;
                let [backwards, forwards] = joint.velocity_at(pair[0][index]);
                assert!(
                    velocity > 1.001 * backwards - 1e-3 && velocity < 1.001 * forwards + 1e-3,
                    "{}: joint {} goes at {velocity} rad/s, limits {backwards} and {forwards}",
                    arm.name,
                    index + 1
                );
            }
        }
        let reached = planner.kinematics.tip(&q);
        assert!((reached.translation.vector - x_wt.translation.vector).norm() < 1e-5);
    }
}

/// From side to side the upper arm points straight up on its way, where a turn may be the first joint's as
/// well as the third's. A beam that is not carried level turns about its axis between the fingers.
#[test]
fn a_beam_is_carried_level_across_the_table() {
    let arm = arm::<7>("panda");
    let planner = PathPlanner::new(&arm);
    let checker = Checker::new(&arm, 0.012, Vec::new(), &[], 0.5e-3);
    let pace = Pace { velocity: 1.0, acceleration: 1.0, jerk: 1.0, ramp: 0.0 };
    let law = TimeLaw::new(&arm, &pace);
    let terms = Terms { height: 0.15, level: true, checker: &checker, law: &law };
    let down = |x: f64, y: f64| {
        let rotation = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
        Pose::from_parts(Translation3::new(x, y, 0.06), rotation)
    };
    // The elbow is aside, as where it lets a peg go in near to the base.
    let aside = Joints::from([-0.93, -0.89, 1.25, -2.90, 1.09, 2.16, 2.75]);
    let places = [
        ([0.271, 0.255], [0.566, 0.027]),
        ([0.220, 0.354], [0.310, -0.467]),
        ([0.444, 0.407], [0.310, -0.220]),
        ([0.082, 0.354], [0.456, -0.341]),
        ([0.519, 0.203], [0.566, -0.467]),
    ];
    for ([x, y], [to_x, to_y]) in places {
        let grasp = planner.solve(&down(x, y), &aside).unwrap();
        let mut stream = Stream::new(3, "level");
        let trajectory = planner.plan(&grasp, &down(to_x, to_y), &terms, &mut stream).unwrap();
        let lean = |q: &Joints| (planner.kinematics.tip(q).rotation * Vector3::z()).angle(&-Vector3::z());
        let most = trajectory.samples().iter().map(lean).fold(0.0, f64::max);
        assert!(most < 0.01, "from {x}, {y} to {to_x}, {to_y} the hand leans by {most} rad");
    }
}
