//! The clamp that holds the base beam, and what is rigid with it. It gives a little under a force.
//!
//! A beam on springs would connect all that stands on it: the engine would solve the whole frame at once, and
//! wake it for every touch. So the base beam is fixed for the engine, at a place that follows the forces of
//! the step before. The engine computes the places of fixed bodies once, and leaves them where they are put.
//! The way is short (0.1 mm under 25 N) and slow (some milliseconds), so the contacts follow.

use std::sync::Arc;

use mujoco_rs::prelude::*;
use nalgebra::Vector3;
use ramp_robot::PERIOD;

use crate::pieces::part_of;

/// Time in which the clamp follows a force, s. Chosen: as a beam of half a kilogram on 200 N/mm, half of the
/// critical damping.
const TIME: f64 = 3e-3;
/// The clamp is at most so fast, m/s. Chosen: a blow of hundreds of newtons would else move the beam so far
/// within a period that the parts on it push back harder still, without end. From this speed a frame of 1 kg
/// takes up 50 N.
const SPEED: f64 = 0.05;

/// The clamp of a scene.
#[derive(Clone)]
pub(crate) struct Clamp {
    /// The base beam and what is rigid with it, with all of their pieces; the base beam comes first.
    bodies: Vec<usize>,
    /// All of their geoms.
    geoms: Vec<usize>,
    /// Place of the beam without a force, m in the world.
    place: Vector3<f64>,
    /// m/N.
    give: f64,
}

impl Clamp {
    /// The clamp of a `frame` that gives by `give` (m/N) along each axis: the base beam, then the parts that
    /// are rigid with it. `None` for one that gives nothing.
    pub fn new(model: &MjModel, frame: &[usize], give: f64) -> Option<Clamp> {
        let base = *frame.first()?;
        let belongs = |other: &usize| frame.contains(&part_of(model, *other));
        let geom_body = |geom: &usize| model.geom_bodyid()[*geom].max(0) as usize;
        let mut bodies: Vec<usize> = (0..model.body_pos().len()).filter(belongs).collect();
        bodies.sort_by_key(|body| *body != base);
        Some(Clamp {
            bodies,
            geoms: (0..model.geom_bodyid().len()).filter(|geom| belongs(&geom_body(geom))).collect(),
            place: Vector3::from(model.body_pos()[base]),
            give,
        })
        .filter(|clamp| clamp.give > 0.0)
    }

    /// Moves the beam by the forces of the last step. Where nothing touches it, for example because all of
    /// the frame sleeps, it stays.
    pub fn step(&self, data: &mut MjData<Arc<MjModel>>) {
        // Pieces have forces of their own.
        let force = |body: &usize| {
            let [.., x, y, z] = data.cfrc_ext()[*body];
            Vector3::new(x, y, z)
        };
        let force: Vector3<f64> = self.bodies.iter().map(force).sum();
        let Some(base) = self.bodies.first().filter(|_| force != Vector3::zeros()) else { return };
        let off = Vector3::from(data.xpos()[*base]) - self.place;
        let change = ((force * self.give - off) * (PERIOD / TIME)).cap_magnitude(SPEED * PERIOD);
        let shift = |at: &mut [f64; 3]| *at = (Vector3::from(*at) + change).into();
        for body in &self.bodies {
            shift(&mut data.xpos_mut()[*body]);
            shift(&mut data.xipos_mut()[*body]);
        }
        self.geoms.iter().for_each(|geom| shift(&mut data.geom_xpos_mut()[*geom]));
    }
}
