//! Carries out the motions of a rehearsal with the kinematics and the motion planner alone.

use nalgebra::Vector3;
use ramp_motion::{Checker, MotionError, Terms};
use ramp_robot::random::Stream;

use super::outline::{Done, Leg, Motion, Refusal, Stage};
use super::scene::Scene;
use crate::Pose;

/// Carries motions out in a scene.
pub struct Walk {
    /// Random numbers for the motion planner.
    pub stream: Stream,
    /// The motions through free space that were asked for, if the caller wants them.
    pub legs: Option<Vec<Leg>>,
}

impl Walk {
    /// Carries out a series of motions.
    ///
    /// # Errors
    /// The refusal of the first motion that does not exist. The scene is then left in the middle of the
    /// series.
    pub fn series(&mut self, scene: &mut Scene, motions: &[Motion]) -> Result<(), Refusal> {
        for motion in motions {
            match motion {
                Motion::Travel { x_wt, open, stage } => self.travel(scene, x_wt, *open, *stage)?,
                Motion::Straight { x_wt, open, around, stage, would_touch } => {
                    let around = scene.obstacles(around.as_deref());
                    let margin =
                        if *stage == Stage::Insertion { 0.0 } else { scene.parameters.travel.margin };
                    let checker = scene.checker(*open, Vec::new(), &around, margin);
                    straight(scene, x_wt, &checker, *stage, would_touch)?;
                }
                Motion::Contact(distance) => scene.now.done.push(Done::Contact(*distance)),
                Motion::Fingers(stroke) => {
                    let x_wt = scene.x_wt();
                    scene.now.done.push(Done::Fingers(x_wt, *stroke));
                }
                Motion::Hold(held) => scene.now.held = Some(held.clone()),
                Motion::Retreat => retreat(scene),
            }
        }
        Ok(())
    }

    /// Through free space to a pose of the tip, the fingers `open` (m) apart, around everything.
    fn travel(&mut self, scene: &mut Scene, x_wt: &Pose, open: f64, stage: Stage) -> Result<(), Refusal> {
        let level = stage > Stage::Grasp;
        let (held, around) = (scene.held_boxes(), scene.obstacles(None));
        if let Some(legs) = &mut self.legs {
            let (held, around) = (held.clone(), around.clone());
            legs.push(Leg { q: scene.now.q, x_wt: *x_wt, level, open, held, around });
        }
        let travel = &scene.parameters.travel;
        let checker = scene.checker(open, held, &around, travel.margin);
        let terms = Terms { height: travel.height, level, checker: &checker, law: &scene.law };
        match scene.planner.plan(&scene.now.q, x_wt, &terms, &mut self.stream) {
            Ok(trajectory) => {
                scene.now.q = trajectory.end();
                scene.now.done.push(Done::Free(trajectory.duration()));
                Ok(())
            }
            // The motion away from the current pose does not affect the plan's feasibility.
            Err(MotionError::Blocked("start")) => {
                scene.now.q = scene.planner.solve(x_wt, &scene.now.q).unwrap_or(scene.now.q);
                Ok(())
            }
            Err(error) => Err(refusal(scene, &error, x_wt, &checker, stage)),
        }
    }

    /// Time of the motion of the tip from one pose to another, by way of travelling height, s; `None` where
    /// there is none.
    pub fn time_between(&mut self, scene: &Scene, from: &Pose, to: &Pose) -> Option<f64> {
        let q = scene.planner.posture(&scene.raised(from));
        let travel = &scene.parameters.travel;
        let checker = scene.checker(scene.parameters.grip.peg_open, Vec::new(), &[], travel.margin);
        let terms = Terms { height: travel.height, level: false, checker: &checker, law: &scene.law };
        let motion = scene.planner.plan(&q, &scene.raised(to), &terms, &mut self.stream);
        Some(motion.ok()?.duration())
    }
}

/// The reason why there is no path to a pose of the tip.
fn refusal(scene: &Scene, error: &MotionError, x_wt: &Pose, checker: &Checker, stage: Stage) -> Refusal {
    let solved = scene.planner.solve(x_wt, &scene.now.q).ok();
    let touched =
        solved.and_then(|q| checker.touched(&scene.planner.kinematics.frames(&q)).map(str::to_string));
    match (error, &touched) {
        (MotionError::Unreachable(_), _) => {
            let stage = if stage == Stage::Grasp { stage } else { Stage::Reach };
            Refusal { because: error.to_string(), touched: None, stage }
        }
        (_, Some(name)) => Refusal { because: format!("the arm would touch {name}"), touched, stage },
        _ => Refusal { because: error.to_string(), touched, stage },
    }
}

/// Straight to a pose of the tip. Where the arm cannot follow from the posture in which it arrived, it takes
/// another one first, as the skills do.
fn straight(
    scene: &mut Scene,
    x_wt: &Pose,
    checker: &Checker,
    stage: Stage,
    would_touch: &str,
) -> Result<(), Refusal> {
    let planner = scene.planner;
    let line = planner
        .straight(&scene.now.q, x_wt)
        .or_else(|| planner.posture_for(&scene.x_wt(), x_wt).and_then(|q| planner.straight(&q, x_wt)));
    let Some(line) = line else {
        let because = "the arm cannot follow the straight motion".to_string();
        return Err(Refusal { because, touched: None, stage });
    };
    for q in &line {
        if let Some(name) = checker.touched(&planner.kinematics.frames(q)) {
            let because = format!("{would_touch} {name}");
            return Err(Refusal { because, touched: Some(name.to_string()), stage });
        }
    }
    let here: Vector3<f64> = scene.x_wt().translation.vector;
    scene.now.done.push(match stage {
        Stage::Insertion => Done::Contact((x_wt.translation.vector - here).norm()),
        _ => Done::Free(scene.law.time(&line).duration()),
    });
    scene.now.q = line.last().copied().unwrap_or(scene.now.q);
    Ok(())
}

/// The hand goes straight up to travelling height, on no planned path.
fn retreat(scene: &mut Scene) {
    let up = scene.raised(&scene.x_wt());
    if let Some(line) = scene.planner.straight(&scene.now.q, &up) {
        scene.now.done.push(Done::Free(scene.law.time(&line).duration()));
    }
    scene.now.q = scene.planner.solve(&up, &scene.now.q).unwrap_or(scene.now.q);
}
