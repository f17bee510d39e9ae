//! What pushes: forces on a part from outside, with a limited speed and a limited force.

use std::sync::Arc;

use mujoco_rs::prelude::*;
use nalgebra::{Point3, Vector3};
use ramp_kit::Pose;

use crate::engine::body_pose;
use ramp_robot::PERIOD;

type Data = MjData<Arc<MjModel>>;

/// How long a push is at its hardest before it gives up, s.
const HARDEST: f64 = 0.3;
/// How long a body is left alone before it is measured how far it went, s.
const SETTLE: f64 = 0.4;

/// Which way a push goes, in the frame it is told in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Motion {
    /// Along a unit vector: force in N, distance in m.
    Line(Vector3<f64>),
    /// About a unit vector: moment in N·m, angle in rad.
    Turn(Vector3<f64>),
}

/// How a push is made: all in N, m, s, or N·m, rad, s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strength {
    /// How far.
    pub way: f64,
    /// How fast at most.
    pub speed: f64,
    /// The largest force or moment.
    pub most: f64,
    /// How fast it grows.
    pub growth: f64,
    /// What is left of it in the next period while the body moves too fast.
    pub back_off: f64,
    /// How long at most, s.
    pub longest: f64,
}

/// Something that pushes a body: harder while it moves too slowly, less while it moves too fast, until it has gone far
/// enough, it takes too long, or the push is as hard as it may be and nothing moves.
#[derive(Clone, Debug)]
pub(super) struct Push {
    body: usize,
    /// Where, in the body's frame.
    p_b: Point3<f64>,
    motion: Motion,
    strength: Strength,
    /// Whether the frame is that of the tip, and not the world's.
    in_hand: bool,
    /// Where the body was in that frame.
    x_start: Pose,
    force: f64,
    gone: f64,
    /// Since it began, and how long it has been at its hardest, s.
    time: f64,
    hardest: f64,
    /// Since the force ended, s.
    rest: Option<f64>,
}

/// How a push stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Progress {
    Pushing,
    Settling,
    /// It is over, and the body has gone so far, m or rad.
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

    /// How far the body has gone, m or rad.
    pub fn gone(&self) -> f64 {
        self.gone
    }

    /// Whether the force is still there.
    pub fn pushes(&self) -> bool {
        self.rest.is_none()
    }

    /// How far it is to go, m or rad.
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

/// How far a body moves against what is in its way until that gives way, m.
const GIVE: f64 = 1.5e-3;

/// An obstacle in the path of a part: it resists the harder the further the part comes, up to a force at which it gives
/// way.
#[derive(Clone, Debug)]
pub(super) struct Obstacle {
    body: usize,
    /// Where the part met it, in the part's frame and in the world.
    p_b: Point3<f64>,
    p_w: Point3<f64>,
    /// The insertion direction, in the world.
    direction: Vector3<f64>,
    /// At which it gives way, N.
    most: f64,
    /// What is left of its time, s.
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
