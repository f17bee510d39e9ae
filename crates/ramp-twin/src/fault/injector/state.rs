//! State of a fault, and its report.

use crate::fault::act::{Motion, Obstacle, Push};
use crate::fault::draws::{Draws, Start};
use crate::fault::kind::FaultKind;
use crate::fault::occasion::{Bodies, Watch};
use crate::fault::spec::FaultReport;
use crate::scene::Scene;
use crate::setup::Setup;
use mujoco_rs::prelude::*;
use nalgebra::Vector3;
use std::sync::Arc;

/// The physics.
pub(super) type Data = MjData<Arc<MjModel>>;

/// The current stage of a fault.
#[derive(Clone, Debug)]
pub(super) enum Action {
    Waiting,
    /// A part was lifted. It is struck when `left` seconds have passed.
    Lifted {
        part: usize,
        left: f64,
    },
    /// The fingers have no force for another `left` seconds.
    Limp {
        left: f64,
    },
    /// A part is pushed in the grip. `other` is the push in the other direction, if it has not been tried.
    InGrip {
        push: Push,
        other: Option<Push>,
    },
    /// A standing beam is pushed. `left` are the remaining directions.
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
    /// The cameras repeat their images for another `left` seconds.
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
    pub(super) bodies: Arc<Bodies>,
    pub(super) draws: Draws,
    pub(super) watch: Watch,
    /// Occasions so far.
    pub(super) count: u32,
    pub(super) action: Action,
    pub(super) report: FaultReport,
}

impl Injector {
    /// The fault of `setup`, if it has one.
    pub fn new(setup: &Setup, start: &Start, scene: &Scene) -> Option<Injector> {
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
            report.text = format!("{peg} is missing");
        }
        if let Some((tag, beam)) = &start.covered {
            report.at = Some(0.0);
            report.part = Some(beam.clone());
            report.text = format!("tag {tag} of {beam} is covered");
        }
        let at_start = matches!(fault.kind, FaultKind::PegMissing | FaultKind::TagCovered);
        Some(Injector {
            bodies: Arc::new(Bodies::new(setup, scene)),
            draws,
            watch: Watch::new(fault.kind),
            count: 0,
            action: if at_start { Action::Over } else { Action::Waiting },
            report,
        })
    }

    /// The report so far.
    pub fn report(&self) -> &FaultReport {
        &self.report
    }

    /// Whether the cameras repeat their images.
    pub fn freezes_cameras(&self) -> bool {
        matches!(self.action, Action::Frozen { .. })
    }

    /// Bias on the force that the wrist sensor reads, N, in the sensor's frame.
    pub fn bias(&self) -> Vector3<f64> {
        match &self.action {
            Action::Drift { force, direction, .. } => *force * direction,
            _ => Vector3::zeros(),
        }
    }
}
