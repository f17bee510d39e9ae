//! Speed of motion planning, and how far its motions are from the fastest possible.
//!
//! A hundred moves between random hovers over the table, among boxes of the size of joints. Printed beside: the
//! obvious algorithm (RRT-Connect in joint space for every move) and a lower bound on the motion's time (each joint
//! straight to its end at its largest speed).

use std::path::Path;
use std::time::Instant;

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_motion::{Checker, Joints, Obstacle, Pace, PathPlanner, Pose, Terms, TimeLaw};
use ramp_robot::DOF;
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // `-- --short` asks whether it still runs to its end.
    let short = std::env::args().any(|argument| argument == "--short");
    let moves = if short { 5 } else { 100 };
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/arms/panda.json");
    let arm = ArmModel::read(&file)?;
    let planner = PathPlanner::new(&arm);
    let mut stream = Stream::new(1, "bench");
    let around: Vec<Obstacle> = (0..150)
        .map(|number| Obstacle {
            name: format!("box {number}"),
            x: Pose::translation(0.45 + stream.symmetric(0.25), stream.symmetric(0.5), 0.0166),
            half: [0.03, 0.0133, 0.0166],
        })
        .collect();
    let checker = Checker::new(&arm, 0.04, Vec::new(), &around, 0.5e-3);
    let law = TimeLaw::new(&arm, &Pace { velocity: 1.0, acceleration: 1.0, jerk: 1.0, ramp: 0.0 });
    let terms = Terms { height: 0.15, level: true, checker: &checker, law: &law };
    let hover = |stream: &mut Stream| {
        let down = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), stream.symmetric(1.5))
            * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        let (x, y) = (0.48 + stream.symmetric(0.15), stream.symmetric(0.45));
        Pose::from_parts(Translation3::new(x, y, 0.1), down)
    };
    let mut q = Joints::from(arm.home);
    let (mut level, mut tree, mut moving, mut bound) = (0.0, 0.0, 0.0, 0.0);
    let (mut planned, mut found) = (0, 0);
    for _ in 0..moves {
        let goal = hover(&mut stream);
        let begin = Instant::now();
        let motion = planner.plan(&q, &goal, &terms, &mut stream);
        level += begin.elapsed().as_secs_f64();
        let Ok(motion) = motion else { continue };
        planned += 1;
        let end = motion.end();
        let begin = Instant::now();
        found += usize::from(planner.connect(&q, &end, &checker, &mut stream).is_some());
        tree += begin.elapsed().as_secs_f64();
        moving += motion.duration();
        bound += (0..DOF).map(|j| (end[j] - q[j]).abs() / arm.joints[j].velocity).fold(0.0, f64::max);
        q = end;
    }
    let each = 1e3 / f64::from(planned.max(1));
    println!("{planned} of {moves} moves planned, 150 boxes around");
    println!("level path first  {:8.2} ms a move", level * each);
    println!("RRT-Connect       {:8.2} ms a move ({found} found), ratio {:.1}", tree * each, tree / level);
    println!(
        "motion            {:8.2} s a move; lower bound {:.2} s, ratio {:.1}",
        moving * each * 1e-3,
        bound * each * 1e-3,
        moving / bound
    );
    if planned == 0 {
        return Err("no move was planned".into());
    }
    Ok(())
}
