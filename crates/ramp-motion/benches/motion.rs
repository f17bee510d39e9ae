//! Speed of motion planning, and how far its motions are from the fastest possible.
//!
//! A hundred moves between random hovers over the table, among boxes of the size of joints. Printed beside:
//! the obvious algorithm (RRT-Connect in joint space for every move) and a lower bound on the motion's time
//! (each joint straight to its end at its largest speed).
//!
//! Then the closed-form inverse on random poses: all branches at one q7, and the quickest solution over all
//! q7, each beside one call of the iterative inverse for the same pose.

#![allow(clippy::print_stdout, clippy::print_stderr)]

use std::path::Path;
use std::time::Instant;

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_motion::{Analytic, Checker, Joints, Obstacle, Pace, PathPlanner, Pose, Terms, TimeLaw};
use ramp_robot::DOF;
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // `-- --short` asks whether it still runs to its end.
    let short = std::env::args().any(|argument| argument == "--short");
    let moves = if short { 5 } else { 100 };
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/arms/panda.json");
    let arm: ArmModel = ArmModel::read(&file)?;
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
    inverse(&arm, &planner, if short { 100 } else { 10_000 }, &mut stream)
}

/// Times the inverses on `count` poses that joint positions uniform in their ranges give.
fn inverse(
    arm: &ArmModel,
    planner: &PathPlanner,
    count: usize,
    stream: &mut Stream,
) -> Result<(), Box<dyn std::error::Error>> {
    let analytic = Analytic::new(arm)?;
    let goals: Vec<(Joints, Pose)> = (0..count)
        .map(|_| {
            let q = Joints::from_fn(|joint, _| {
                let [low, high] = arm.joints[joint].range;
                low + (high - low) * stream.uniform()
            });
            (q, planner.kinematics.tip(&q))
        })
        .collect();
    let home = Joints::from(arm.home);
    let timed = |call: &dyn Fn(&Joints, &Pose) -> usize| {
        let begin = Instant::now();
        let found: usize = goals.iter().map(|(q, x_wt)| call(q, x_wt)).sum();
        (begin.elapsed().as_secs_f64() * 1e6 / count as f64, found as f64 / count as f64)
    };
    let (numeric, solved) =
        timed(&|_, x_wt| usize::from(planner.kinematics.inverse(x_wt, &home, &home).is_some()));
    println!("{count} random poses");
    println!("iterative inverse      {numeric:8.2} µs a call, {solved:.2} solutions");
    let (all, found) = timed(&|q, x_wt| analytic.all(x_wt, q[6]).len());
    println!("all branches, one q7   {all:8.2} µs a call, {found:.2} solutions, ratio {:.4}", all / numeric);
    let (within, found) = timed(&|q, x_wt| analytic.within(x_wt, q[6], 0.0).len());
    println!(
        "those within ranges    {within:8.2} µs a call, {found:.2} solutions, ratio {:.4}",
        within / numeric
    );
    let (quickest, found) = timed(&|_, x_wt| usize::from(analytic.quickest(x_wt, &home, 0.05).is_some()));
    println!(
        "quickest over all q7   {quickest:8.2} µs a call, {found:.2} solutions, ratio {:.4}",
        quickest / numeric
    );
    if solved == 0.0 || found == 0.0 {
        return Err("no pose was solved".into());
    }
    Ok(())
}
