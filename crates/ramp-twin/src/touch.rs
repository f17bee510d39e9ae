//! Tactile sensors in the pads of the fingers: from the forces at the contacts of a finger's pads to what its
//! sensor reports.

use std::ops::Range;
use std::sync::Arc;

use mujoco_rs::prelude::*;
use mujoco_rs::wrappers::mj_model::MjtObjBase;
use nalgebra::{Matrix3, Vector3};
use ramp_robot::random::Stream;
use ramp_robot::{FingerTouch, PERIOD, Touch};
use ramp_world::Physics;

use crate::engine::rotation_from_rows;
use crate::setup::TwinError;

type Data = MjData<Arc<MjModel>>;

/// The pads in the model, and the tip at which their forces are reported.
pub(crate) struct Pads {
    /// The geoms of each finger's pads.
    geoms: [Range<usize>; 2],
    /// Site of the tip T.
    tip_site: usize,
}

impl Pads {
    /// The first `count` geoms of each finger.
    ///
    /// # Errors
    /// [`TwinError::Missing`] when a finger or the tip is not in the model.
    pub fn new(model: &MjModel, count: usize) -> Result<Pads, TwinError> {
        let find = |kind, name: &str| {
            model.name_to_id(kind, name).ok_or_else(|| TwinError::Missing(name.to_string()))
        };
        let geoms = |name: &str| {
            let body = find(MjtObjBase::mjOBJ_BODY, name)?;
            let from = usize::try_from(model.body_geomadr()[body]).unwrap_or(0);
            Ok::<_, TwinError>(from..from + count)
        };
        let geoms = [geoms("finger1")?, geoms("finger2")?];
        Ok(Pads { geoms, tip_site: find(MjtObjBase::mjOBJ_SITE, "tip")? })
    }

    /// Of each finger: the force of its pads on what they touch, N, and the sum of places times pressing
    /// force, N·m; both in axes of T, places from its origin.
    fn loads(&self, data: &Data) -> [(Vector3<f64>, Vector3<f64>); 2] {
        let of_tip = rotation_from_rows(&data.site_xmat()[self.tip_site]).inverse();
        let p_tip = Vector3::from(data.site_xpos()[self.tip_site]);
        let mut loads = [(Vector3::zeros(), Vector3::zeros()); 2];
        for (number, contact) in data.contact().iter().enumerate() {
            let finger_of = |geom: i32| {
                let geom = usize::try_from(geom).ok()?;
                self.geoms.iter().position(|geoms| geoms.contains(&geom))
            };
            for (side, geom) in contact.geom.into_iter().enumerate() {
                let Some(finger) = finger_of(geom) else { continue };
                let [normal, first, second, ..] = data.contact_force(number);
                // The rows of the contact's frame are its axes. The force is that of the first geom on the
                // second one.
                let axes = Matrix3::from_row_slice(&contact.frame);
                let on_second = axes.transpose() * Vector3::new(normal, first, second);
                let force = of_tip * if side == 0 { on_second } else { -on_second };
                let place = of_tip * (Vector3::from(contact.pos) - p_tip);
                loads[finger].0 += force;
                loads[finger].1 += place * pressing(finger, &force);
            }
        }
        loads
    }
}

/// The part of a finger's force with which it closes, N.
fn pressing(finger: usize, force: &Vector3<f64>) -> f64 {
    // The first finger closes along −y.
    if finger == 0 { -force.y } else { force.y }
}

/// The sensors of both fingers, as an episode goes on.
#[derive(Clone)]
pub(crate) struct TouchSensors {
    noise: Stream,
    /// Drift of each finger's force, N.
    drift: [Vector3<f64>; 2],
    reading: Touch,
}

impl TouchSensors {
    /// Sensors of the episode with this seed, which touch nothing yet.
    pub fn new(physics: &Physics, seed: u64) -> TouchSensors {
        let mut noise = Stream::new(seed, "touch");
        let drift = [0, 1].map(|_| normals(&mut noise, physics.touch.force_drift));
        let reading = Touch { fingers: drift.map(|force| FingerTouch { force, centre: None }) };
        TouchSensors { noise, drift, reading }
    }

    /// The last reading.
    pub fn reading(&self) -> Touch {
        self.reading
    }

    /// Reads the sensors after the period with this number, if a reading is due.
    pub fn step(&mut self, pads: &Pads, physics: &Physics, data: &Data, period: u64) {
        let touch = &physics.touch;
        let every = (touch.interval / PERIOD).round().max(1.0);
        if !period.is_multiple_of(every as u64) {
            return;
        }
        // An Ornstein-Uhlenbeck process: it returns to zero with its time constant, and keeps its deviation.
        let kept = (-every * PERIOD / touch.drift_time).exp();
        let renewed = touch.force_drift * (1.0 - kept * kept).sqrt();
        let loads = pads.loads(data);
        for (finger, (force, moments)) in loads.into_iter().enumerate() {
            // As many numbers are drawn in each reading, whatever the finger touches.
            self.drift[finger] = self.drift[finger] * kept + normals(&mut self.noise, renewed);
            let noise = normals(&mut self.noise, touch.force_noise);
            let shift = normals(&mut self.noise, touch.centre_noise);
            let pressed = pressing(finger, &force);
            let centre = moments / pressed + shift;
            let centre = (pressed > touch.centre_force).then_some([centre.x, centre.z]);
            let force = force + self.drift[finger] + noise;
            let force = force.map(|along| along.clamp(-touch.range, touch.range));
            self.reading.fingers[finger] = FingerTouch { force, centre };
        }
    }
}

/// Three numbers with this standard deviation.
fn normals(noise: &mut Stream, sigma: f64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| noise.normal(sigma))
}
