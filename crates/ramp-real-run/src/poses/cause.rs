//! Likely causes of poses and times that cannot be: units, order of the numbers, axes and frames.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_kit::Pose;
use ramp_kit::tags::TagPlace;

use super::order::QuaternionOrder;

/// Factors from units of length that are mistaken for metres.
const LENGTHS: [(f64, &str); 2] = [(1e-3, "millimetres"), (1e-2, "centimetres")];
/// Factors from units of time that are mistaken for seconds.
const TIMES: [(f64, &str); 3] = [(1e-3, "milliseconds"), (1e-6, "microseconds"), (1e-9, "nanoseconds")];

/// A pose as the log has it.
#[derive(Clone, Copy)]
pub(super) struct Measured<'a> {
    /// Position, m.
    pub at: Vector3<f64>,
    /// The fields w, x, y, z of its rotation, of unit length.
    pub wxyz: [f64; 4],
    /// The order in which the fields are read.
    pub order: QuaternionOrder,
    /// The tag that was measured; `None` if the part itself was.
    pub tag: Option<&'a TagPlace>,
}

impl Measured<'_> {
    /// The pose of what was measured, in the world.
    fn seen(&self, order: QuaternionOrder, scale: f64) -> Pose {
        let turn = UnitQuaternion::from_quaternion(order.quaternion(self.wxyz));
        Pose::from_parts(Translation3::from(self.at * scale), turn)
    }

    /// The pose of the part, given that of what was measured.
    fn part(&self, seen: &Pose) -> Pose {
        self.tag.map_or(*seen, |tag| seen * tag.x_pg.inverse())
    }

    /// The pose of the part in the world.
    pub fn x_wp(&self) -> Pose {
        self.part(&self.seen(self.order, 1.0))
    }

    /// Mistakes without which the part would be where `is_right` accepts it, as questions. `x_wa` is the pose
    /// of the assembly frame.
    pub fn causes(&self, x_wa: &Pose, is_right: impl Fn(&Pose) -> bool) -> Vec<String> {
        let mut causes = Vec::new();
        let mut ask = |seen: Pose, cause: String| {
            if is_right(&self.part(&seen)) && !causes.contains(&cause) {
                causes.push(cause);
            }
        };
        let seen = self.seen(self.order, 1.0);
        for order in QuaternionOrder::ALL.into_iter().filter(|order| *order != self.order) {
            let name = order.name();
            ask(
                self.seen(order, 1.0),
                format!("are the numbers of the quaternions in another order (try --quaternion {name})?"),
            );
        }
        for (scale, unit) in LENGTHS {
            ask(self.seen(self.order, scale), format!("are the positions in {unit} (expected metres)?"));
        }
        ask(
            x_wa * seen,
            "are the poses in the frame of the assembly (expected the robot's base)?".to_string(),
        );
        ask(seen.inverse(), "are these poses of the world in the parts' frames?".to_string());
        ask(
            Pose::from_parts(seen.translation, seen.rotation.inverse()),
            "are these rotations from the world to the part?".to_string(),
        );
        for turn in axis_turns() {
            let down = (turn * Vector3::z()).z < -0.5;
            let points = if down { "does z of their frame point down" } else { "has their frame other axes" };
            ask(turn * seen, format!("{points} (expected x forward from the robot's base, z up)?"));
        }
        if self.tag.is_some() {
            for turn in axis_turns() {
                let inwards = (turn * Vector3::z()).z < -0.5;
                let points =
                    if inwards { "does z of the tags point inwards" } else { "have the tags other axes" };
                ask(
                    seen * turn,
                    format!("{points} (expected x to a tag's right, y to its top, z out of it)?"),
                );
            }
        }
        causes
    }
}

/// All turns that map axes to axes, but none at all.
fn axis_turns() -> Vec<UnitQuaternion<f64>> {
    let quarter = |axis, times: i32| UnitQuaternion::from_axis_angle(&axis, FRAC_PI_2 * f64::from(times));
    // The image of z, then a turn about it.
    let z_images = [
        quarter(Vector3::x_axis(), 0),
        quarter(Vector3::x_axis(), 2),
        quarter(Vector3::x_axis(), 1),
        quarter(Vector3::x_axis(), 3),
        quarter(Vector3::y_axis(), 1),
        quarter(Vector3::y_axis(), 3),
    ];
    let all =
        z_images.iter().flat_map(|image| (0..4).map(move |times| image * quarter(Vector3::z_axis(), times)));
    all.skip(1).collect()
}

/// The unit that a time in seconds is probably in, as a question after a message; `is_right` accepts
/// the time. Empty if none is.
pub(crate) fn time_unit(seconds: f64, is_right: impl Fn(f64) -> bool) -> String {
    match TIMES.iter().find(|(scale, _)| is_right(seconds * scale)) {
        Some((_, unit)) => format!(": is it in {unit} (expected seconds)?"),
        None => String::new(),
    }
}

/// The same for a position that is farther than `far` from the origin.
pub(super) fn length_unit(at: [f64; 3], far: f64) -> &'static str {
    let smallest = LENGTHS[0].0;
    let is_near = at.iter().all(|value| (value * smallest).abs() <= far);
    if is_near { ": are the positions in millimetres or centimetres?" } else { "" }
}
