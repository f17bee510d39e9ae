//! Every arm in `data/arms` reaches the table, and its paths are planned.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_motion::{Analytic, Checker, Joints, Obstacle, Pace, PathPlanner, Pose, Terms, TimeLaw};
use ramp_robot::PERIOD;
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;

/// Distance that joints keep from the ends of their ranges, rad.
const MARGIN: f64 = 0.05;

fn arms() -> Vec<ArmModel> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/arms");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.iter().map(|file| ArmModel::read(file).unwrap()).collect()
}

/// The hand down over the table, at a random place and turn.
fn hover(stream: &mut Stream) -> Pose {
    let down = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), stream.symmetric(1.5))
        * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
    let (x, y) = (0.48 + stream.symmetric(0.13), stream.symmetric(0.4));
    Pose::from_parts(Translation3::new(x, y, 0.1), down)
}

#[test]
fn names_are_those_of_the_files() {
    let names: Vec<String> = arms().into_iter().map(|arm| arm.name).collect();
    assert_eq!(names, ["fr3", "panda"]);
}

#[test]
fn the_table_is_reached_from_home() {
    for arm in arms() {
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
            // No slower than what the iteration finds.
            let iterated = planner.solve(&x_wt, &home).unwrap();
            assert!(choice.cost <= analytic.least_time(&home, &iterated) + 1e-3, "{}", arm.name);
        }
    }
}

/// On the way speeds stay within the limits that hold at each angle: the paths keep away from the ends.
#[test]
fn paths_are_planned_around_boxes() {
    for arm in arms() {
        let planner = PathPlanner::new(&arm);
        let mut stream = Stream::new(2, "paths");
        let around: Vec<Obstacle> = (0..50)
            .map(|number| Obstacle {
                name: format!("box {number}"),
                x: Pose::translation(0.45 + stream.symmetric(0.25), stream.symmetric(0.5), 0.0166),
                half: [0.03, 0.0133, 0.0166],
            })
            .collect();
        let checker = Checker::new(&arm, 0.04, Vec::new(), &around, 0.5e-3);
        let pace = Pace { velocity: 1.0, acceleration: 1.0, jerk: 1.0, ramp: 0.0 };
        let law = TimeLaw::new(&arm, &pace);
        let terms = Terms { height: 0.15, level: false, checker: &checker, law: &law };
        let mut q = Joints::from(arm.home);
        for _ in 0..20 {
            let x_wt = hover(&mut stream);
            let trajectory = planner.plan(&q, &x_wt, &terms, &mut stream).unwrap();
            q = trajectory.end();
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
}
