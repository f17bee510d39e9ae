//! The fault of an episode at work: waits for its occasion, strikes once, and keeps what it did.

mod strike;

use std::sync::Arc;

use mujoco_rs::prelude::*;
use nalgebra::Vector3;
use ramp_kit::Pose;
use ramp_robot::GripperCommand;

use super::act::{Motion, Obstacle, Progress, Push};
use super::draws::{Draws, Start};
use super::kind::FaultKind;
use super::occasion::{Cell, Watch};
use super::spec::FaultReport;
use crate::twin::{PERIOD, Setup};

type Data = MjData<Arc<MjModel>>;

/// What is left of the fingers' force while something is moved in the grip.
const WEAKENED: f64 = 0.15;

/// What goes on.
#[derive(Clone, Debug)]
enum Action {
    Waiting,
    /// A part was lifted; in so many seconds it is struck.
    Lifted {
        part: usize,
        left: f64,
    },
    /// The fingers have no force for so many seconds.
    Limp {
        left: f64,
    },
    /// A part is pushed in the grip; the other way, if it has not been tried.
    InGrip {
        push: Push,
        other: Option<Push>,
    },
    /// A standing beam is pushed; the sides that are left to push it from.
    Bump {
        push: Push,
        part: usize,
        at: f64,
        left: Vec<(usize, Motion)>,
    },
    /// A holder is pushed.
    Shift(Push),
    /// An obstacle blocks an insertion.
    Jam(Obstacle),
    /// The cameras repeat their images for so many seconds.
    Frozen {
        left: f64,
    },
    /// The fingers close no further than this width, m.
    Short {
        width: f64,
    },
    /// The sensor's bias grows: N so far, in the sensor's frame.
    Drift {
        force: f64,
        growth: f64,
        most: f64,
        direction: Vector3<f64>,
    },
    Over,
}

/// The fault of an episode.
#[derive(Clone, Debug)]
pub(crate) struct Injector {
    cell: Cell,
    draws: Draws,
    watch: Watch,
    /// Occasions so far.
    count: u32,
    action: Action,
    report: FaultReport,
}

impl Injector {
    /// The fault of `setup`, if it has one. `parts` and `holders` are names and bodies.
    pub fn new(
        setup: &Setup,
        start: &Start,
        model: &MjModel,
        parts: &[(String, usize)],
        holders: Vec<(String, usize)>,
        fingers: [usize; 2],
    ) -> Option<Injector> {
        let fault = setup.fault?;
        let draws = Draws::new(fault, setup);
        let mut report = FaultReport {
            kind: fault.kind,
            occasion: draws.occasion,
            at: None,
            part: None,
            size: None,
            text: "the occasion has not come".to_string(),
        };
        if let Some(peg) = &start.missing {
            report.at = Some(0.0);
            report.part = Some(peg.clone());
            report.text = format!("{peg} is not there");
        }
        if let Some((tag, beam)) = &start.covered {
            report.at = Some(0.0);
            report.part = Some(beam.clone());
            report.text = format!("tag {tag} of {beam} is covered");
        }
        let at_start = matches!(fault.kind, FaultKind::PegMissing | FaultKind::TagCovered);
        Some(Injector {
            cell: Cell::new(setup, model, parts, holders, fingers),
            draws,
            watch: Watch::new(fault.kind),
            count: 0,
            action: if at_start { Action::Over } else { Action::Waiting },
            report,
        })
    }

    /// What became of it so far.
    pub fn report(&self) -> &FaultReport {
        &self.report
    }

    /// Whether the cameras repeat their images.
    pub fn freezes_cameras(&self) -> bool {
        matches!(self.action, Action::Frozen { .. })
    }

    /// What is added to the force that the wrist sensor reads, N, in the sensor's frame.
    pub fn bias(&self) -> Vector3<f64> {
        match &self.action {
            Action::Drift { force, direction, .. } => *force * direction,
            _ => Vector3::zeros(),
        }
    }

    /// Before each step of the physics: `fingers` are the width of the hand, m, and the speed at which it opens, m/s.
    /// Returns what the gripper does with its command.
    pub fn step(
        &mut self,
        data: &mut Data,
        x_wt: &Pose,
        steps: u64,
        fingers: [f64; 2],
        mut gripper: GripperCommand,
    ) -> GripperCommand {
        let time = steps as f64 * PERIOD;
        if steps.is_multiple_of(self.watch.every()) && !matches!(self.action, Action::Over) {
            let occasion = self.watch.look(&self.cell, data, x_wt, fingers[1]);
            if let Some(occasion) = occasion.filter(|_| matches!(self.action, Action::Waiting)) {
                self.count += 1;
                if self.count >= self.draws.occasion {
                    self.strike(&occasion, data, time, fingers[0]);
                }
            }
        }
        self.action = match std::mem::replace(&mut self.action, Action::Over) {
            Action::Lifted { part, left } if left > 0.0 => Action::Lifted { part, left: left - PERIOD },
            Action::Lifted { part, .. } => self.strike_in_grip(part, data, x_wt, time),
            Action::Limp { left } if left > 0.0 => {
                gripper.force = 0.0;
                Action::Limp { left: left - PERIOD }
            }
            Action::InGrip { push, other } => {
                if push.pushes() {
                    gripper.force *= WEAKENED;
                }
                self.push_in_grip(push, other, data, x_wt)
            }
            Action::Bump { push, part, at, left } => self.bump(push, part, at, left, data, x_wt),
            Action::Shift(mut push) => {
                let progress = push.step(data, x_wt);
                self.report.size = Some(push.gone());
                if matches!(progress, Progress::Over(_)) { Action::Over } else { Action::Shift(push) }
            }
            Action::Jam(mut obstacle) => {
                if obstacle.step(data) {
                    Action::Jam(obstacle)
                } else {
                    Action::Over
                }
            }
            Action::Frozen { left } if left > 0.0 => Action::Frozen { left: left - PERIOD },
            Action::Short { width } if gripper.width < width => {
                gripper.width = width;
                Action::Short { width }
            }
            Action::Drift { force, growth, most, direction } => {
                Action::Drift { force: (force + growth * PERIOD).min(most), growth, most, direction }
            }
            Action::Waiting => Action::Waiting,
            _ => Action::Over,
        };
        gripper
    }
}
