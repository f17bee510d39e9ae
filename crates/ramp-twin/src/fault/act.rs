//! External forces on a part, with limited speed and limited force.

use std::sync::Arc;

use mujoco_rs::prelude::*;
use nalgebra::{Point3, Vector3};
use ramp_kit::Pose;

use crate::engine::body_pose;
use ramp_robot::PERIOD;

type Data = MjData<Arc<MjModel>>;

/// Time at the largest force after which a push ends, s.
const HARDEST: f64 = 0.3;
/// Time without force before the displacement of a body is measured, s.
const SETTLE: f64 = 0.4;

/// Direction of a push, in the frame of the push.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Motion {
    /// Along a unit vector: force in N, distance in m.
    Line(Vector3<f64>),
    /// About a unit vector: moment in N·m, angle in rad.
    Turn(Vector3<f64>),
}

/// Parameters of a push, in N, m, s, or N·m, rad, s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strength {
    /// Distance to push.
    pub way: f64,
    /// Largest speed.
    pub speed: f64,
    /// The largest force or moment.
    pub most: f64,
    /// Growth of the force per second.
    pub growth: f64,
    /// Factor on the force in each period in which the body moves too fast.
    pub back_off: f64,
    /// Longest duration, s.
    pub longest: f64,
}

/// A push of a body. The force grows while the body is too slow and shrinks while it is too fast. The push
/// ends when the body has moved far enough, when it takes too long, or when the largest force moves nothing.
#[derive(Clone, Debug)]
pub(super) struct Push {
    body: usize,
    /// Point of application, in the body's frame, m.
    p_b: Point3<f64>,
    motion: Motion,
    strength: Strength,
    /// Whether the frame is that of the tip, and not the world's.
    in_hand: bool,
    /// Pose of the body in that frame at the start.
    x_start: Pose,
    force: f64,
    gone: f64,
    /// Since it began, and how long it has been at its hardest, s.
    time: f64,
    hardest: f64,
    /// Since the force ended, s.
    rest: Option<f64>,
}

/// Progress of a push.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Progress {
    Pushing,
    Settling,
    /// Finished, with the distance that the body has moved, m or rad.
    Over(f64),
}

impl Push {
    /// A push of `body` at `p_b`; with `x_wt` in the frame of the tip, otherwise in the world's.
    pub fn new(
        data: &Data,
        body: usize,
        p_b: Point3<f64>,
        motion: Motion,
        strength: Strength,
        x_wt: Option<&Pose>,
    ) -> Push {
        let x_wb = body_pose(data, body);
        Push {
            body,
            p_b,
            motion,
            strength,
            in_hand: x_wt.is_some(),
            x_start: x_wt.map_or(x_wb, |x_wt| x_wt.inverse() * x_wb),
            force: 0.0,
            gone: 0.0,
            time: 0.0,
            hardest: 0.0,
            rest: None,
        }
    }

    /// Distance that the body has moved, m or rad.
    pub fn gone(&self) -> f64 {
        self.gone
    }

    /// Whether the force still acts.
    pub fn pushes(&self) -> bool {
        self.rest.is_none()
    }

    /// Distance to push, m or rad.
    pub fn way(&self) -> f64 {
        self.strength.way
    }

    /// Pushes for a period, or lets the body rest.
    pub fn step(&mut self, data: &mut Data, x_wt: &Pose) -> Progress {
        let x_wb = body_pose(data, self.body);
        let x_now = if self.in_hand { x_wt.inverse() * x_wb } else { x_wb };
        let (gone, axis) = match self.motion {
            Motion::Line(axis) => ((x_now * self.p_b - self.x_start * self.p_b).dot(&axis), axis),
            Motion::Turn(axis) => {
                ((x_now.rotation * self.x_start.rotation.inverse()).scaled_axis().dot(&axis), axis)
            }
        };
        let speed = (gone - self.gone) / PERIOD;
        self.gone = gone;
        self.time += PERIOD;
        if let Some(rest) = &mut self.rest {
            *rest += PERIOD;
            return if *rest < SETTLE { Progress::Settling } else { Progress::Over(gone) };
        }
        let Strength { way, speed: fastest, most, growth, back_off, longest } = self.strength;
        if gone >= way || self.time > longest || self.hardest > HARDEST {
            self.end(data);
            return Progress::Settling;
        }
        self.force = if speed > fastest {
            self.force * back_off.powf((speed / fastest).min(5.0))
        } else {
            (self.force + growth * PERIOD).min(most)
        };
        self.hardest = if self.force < most { 0.0 } else { self.hardest + PERIOD };
        let along = self.force * if self.in_hand { x_wt.rotation * axis } else { axis };
        match self.motion {
            Motion::Line(_) => press(data, self.body, &(x_wb * self.p_b), &along),
            Motion::Turn(_) => {
                data.xfrc_applied_mut()[self.body] = [0.0, 0.0, 0.0, along.x, along.y, along.z];
            }
        }
        Progress::Pushing
    }

    /// Takes the force away.
    pub fn end(&mut self, data: &mut Data) {
        data.xfrc_applied_mut()[self.body] = [0.0; 6];
        self.rest = self.rest.or(Some(0.0));
    }
}

/// A force (N) on a body at a point, both in the world.
fn press(data: &mut Data, body: usize, p_w: &Point3<f64>, force: &Vector3<f64>) {
    let lever = p_w.coords - Vector3::from(data.xipos()[body]);
    let moment = lever.cross(force);
    data.xfrc_applied_mut()[body] = [force.x, force.y, force.z, moment.x, moment.y, moment.z];
}

/// Distance that a body moves against an obstacle until that gives way, m.
const GIVE: f64 = 1.5e-3;

/// An obstacle in the path of a part. Its force grows with the depth of the part, up to a force at which it
/// gives way.
#[derive(Clone, Debug)]
pub(super) struct Obstacle {
    body: usize,
    /// Point of first contact, in the part's frame and in the world.
    p_b: Point3<f64>,
    p_w: Point3<f64>,
    /// The insertion direction, in the world.
    direction: Vector3<f64>,
    /// At which it gives way, N.
    most: f64,
    /// Remaining time, s.
    left: f64,
}

impl Obstacle {
    /// In the path of `body` at `p_w` along `direction`, for `time` seconds, up to `most` newtons.
    pub fn new(
        data: &Data,
        body: usize,
        p_w: Point3<f64>,
        direction: Vector3<f64>,
        most: f64,
        time: f64,
    ) -> Obstacle {
        let p_b = body_pose(data, body).inverse() * p_w;
        Obstacle { body, p_b, p_w, direction, most, left: time }
    }

    /// Resists for a period; false when it is gone.
    pub fn step(&mut self, data: &mut Data) -> bool {
        self.left -= PERIOD;
        if self.left <= 0.0 {
            data.xfrc_applied_mut()[self.body] = [0.0; 6];
            return false;
        }
        let p_w = body_pose(data, self.body) * self.p_b;
        let depth = (p_w - self.p_w).dot(&self.direction);
        let force = (depth / GIVE).clamp(0.0, 1.0) * self.most;
        press(data, self.body, &p_w, &(-force * self.direction));
        true
    }
}
