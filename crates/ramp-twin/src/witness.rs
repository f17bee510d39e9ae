//! What the referee has to see of each call: the true poses at equal intervals of robot time, also while a
//! reading, an image or a recovery takes its time, and parts that are in each other in any period.

use std::sync::Arc;

use mujoco_rs::prelude::*;
use ramp_assembly::{Penetration, Truth};
use ramp_robot::PERIOD;

use crate::scene::Scene;

/// Depth from which a penetration is recorded, m. Chosen: above what contacts give in ordinary work, so that
/// there is nothing to record.
pub(crate) const LEAST: f64 = 0.5e-3;

/// The true world at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// The poses.
    pub truth: Truth,
    /// Beams and pegs that were more than 0.5 mm in each other since the moment before, each pair with its
    /// largest depth.
    pub penetrations: Vec<Penetration>,
}

/// Records moments.
#[derive(Clone, Default)]
pub(crate) struct Witness {
    /// Number of periods from one moment to the next; `None`: nothing is recorded.
    pub every: Option<u64>,
    /// The moments that nobody has read yet.
    pub moments: Vec<Moment>,
    /// Penetrations since the last moment.
    pub penetrations: Vec<Penetration>,
}

/// Adds penetrations to those that are known: each pair once, with its largest depth.
pub(crate) fn merge(known: &mut Vec<Penetration>, found: impl Iterator<Item = Penetration>) {
    for penetration in found {
        match known.iter_mut().find(|it| it.parts == penetration.parts) {
            Some(it) => it.depth = it.depth.max(penetration.depth),
            None => known.push(penetration),
        }
    }
}

/// Records the last one of `steps` periods.
pub(crate) fn record(scene: &Scene, data: &MjData<Arc<MjModel>>, witness: &mut Witness, steps: u64) {
    let Some(every) = witness.every else { return };
    merge(&mut witness.penetrations, scene.penetrations(data, LEAST));
    if steps.is_multiple_of(every) {
        let moment = now(scene, data, witness, steps);
        witness.moments.push(moment);
    }
}

/// The moment after `steps` periods; it ends the interval of the penetrations.
pub(crate) fn now(scene: &Scene, data: &MjData<Arc<MjModel>>, witness: &mut Witness, steps: u64) -> Moment {
    Moment {
        truth: scene.truth(data, steps as f64 * PERIOD),
        penetrations: std::mem::take(&mut witness.penetrations),
    }
}
