//! Observations: what an agent on its track knows, as a row of numbers with names.

use nalgebra::Vector6;
use ramp_kit::Pose;
use ramp_robot::{DOF, Observation};

/// A piece of the row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Its name.
    pub name: &'static str,
    /// Its shape.
    pub shape: Vec<usize>,
    /// Its first index in the row.
    pub offset: usize,
    /// Its meaning, with unit and frame.
    pub about: &'static str,
}

impl Field {
    /// Its numbers in the row.
    pub fn len(&self) -> usize {
        self.shape.iter().product()
    }

    /// Whether it has none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The row of an environment whose fingers have tactile sensors (`touch`), whose task has a part and a place
/// for it (`skill`), and that tells the poses of so many parts.
pub fn fields(touch: bool, skill: bool, parts: usize) -> Vec<Field> {
    let mut fields: Vec<Field> = Vec::new();
    let mut add = |name, shape: Vec<usize>, about| {
        let offset = fields.last().map_or(0, |last: &Field| last.offset + last.len());
        fields.push(Field { name, shape, offset, about });
    };
    add("positions", vec![DOF], "joint positions, rad");
    add("velocities", vec![DOF], "joint velocities, rad/s");
    add("torques", vec![DOF], "joint torques on top of gravity compensation, N·m");
    add("tip", vec![7], "pose of the tip in the world: x, y, z in m, quaternion w, x, y, z");
    add("width", vec![1], "distance between the fingers, m");
    add(
        "wrench",
        vec![6],
        "wrench of the hand on the world at the wrist since the start of the episode, axes of the world: N, N·m",
    );
    add(
        "lead",
        vec![6],
        "target of the impedance from the tip, axes of the world: m, rotation vector in rad",
    );
    if touch {
        add(
            "touch_force",
            vec![2, 3],
            "force of each finger on the object that it touches, axes of the tip, N",
        );
        add(
            "touch_centre",
            vec![2, 2],
            "x and z of each finger's centre of pressure from the tip, m; 0 where it presses too lightly",
        );
    }
    if skill {
        add("part", vec![7], "believed pose of the part of the task in the world, as `tip`");
        add(
            "error",
            vec![6],
            "from the part to its believed place, axes of the world: m, rotation vector in rad",
        );
    }
    if parts > 0 {
        add(
            "parts",
            vec![parts, 7],
            "poses of the parts in the world, each as `tip`, in the order of `part_names`",
        );
    }
    add("time", vec![1], "share of the episode's time that is left");
    fields
}

/// Writes a row from its beginning on.
pub(crate) struct Row<'o> {
    out: &'o mut [f32],
    at: usize,
}

impl<'o> Row<'o> {
    pub fn new(out: &'o mut [f32]) -> Row<'o> {
        Row { out, at: 0 }
    }

    pub fn put(&mut self, numbers: &[f64]) {
        for number in numbers {
            if let Some(slot) = self.out.get_mut(self.at) {
                *slot = *number as f32;
            }
            self.at += 1;
        }
    }

    pub fn pose(&mut self, x: &Pose) {
        let (p, q) = (x.translation.vector, x.rotation.quaternion());
        self.put(&[p.x, p.y, p.z, q.w, q.i, q.j, q.k]);
    }

    pub fn sensed(&mut self, seen: &Observation, tare: &Vector6<f64>, lead: &Vector6<f64>) {
        self.put(&seen.positions);
        self.put(&seen.velocities);
        self.put(&seen.torques);
        self.pose(&seen.x_wt);
        self.put(&[seen.width]);
        self.put((seen.wrench - tare).as_slice());
        self.put(lead.as_slice());
        if let Some(touch) = &seen.touch {
            touch.fingers.iter().for_each(|finger| self.put(finger.force.as_slice()));
            touch.fingers.iter().for_each(|finger| self.put(&finger.centre.unwrap_or_default()));
        }
    }
}

/// From one pose to another: shift and rotation vector, axes of the world, m and rad.
pub(crate) fn error(from: &Pose, to: &Pose) -> Vector6<f64> {
    let shift = to.translation.vector - from.translation.vector;
    let turn = (to.rotation * from.rotation.inverse()).scaled_axis();
    Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
}
