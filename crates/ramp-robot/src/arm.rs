//! The arm as data: frames, limits, masses and shapes, read from `data/arms/*.json`.
//!
//! Shared by motion planning (kinematics, collisions, limits) and the twin (dynamics), so that both
//! have the same arm. All lengths m, angles rad, masses kg.

use ramp_source::{MAX_SENTENCE, plain};
use serde::Deserialize;
use serde::de::{Deserializer, Error};
use std::path::{Path, PathBuf};

/// Number of joints of the arm that robots, the twin and skills drive.
pub const DOF: usize = 7;

/// Distance from the last joint's frame of a Panda or a Research 3 to its flange along z, m. From the
/// documentation of Franka's URDF (`link8`).
pub const FLANGE: f64 = 0.107;

/// A serial arm of `N` revolute joints with a hand and two parallel fingers. Motions of any of them
/// can be planned; robots, the twin and skills take arms of [`DOF`] joints.
///
/// ```
/// # use std::path::Path;
/// # use ramp_robot::arm::ArmModel;
/// let file = Path::new("../../data/arms/ur5e.json");
/// let arm: ArmModel<6> = ArmModel::read(file)?;
/// assert_eq!(arm.name, "ur5e");
/// let refused = ArmModel::<7>::read(file).unwrap_err().to_string();
/// assert!(refused.contains("found 6, expected 7"));
/// # Ok::<(), ramp_robot::arm::ArmError>(())
/// ```
#[derive(Clone, Debug, Deserialize)]
pub struct ArmModel<const N: usize = DOF> {
    /// For example `panda`.
    pub name: String,
    /// Source of the numbers.
    pub source: String,
    /// The fixed base.
    pub base: BaseLink,
    /// From the base outwards; each rotates about its own z.
    #[serde(deserialize_with = "one_for_each_joint")]
    pub joints: [ArmJoint; N],
    /// The hand, fixed to the last link.
    pub hand: Hand,
    /// Limits of the commanded motion of the tip; `None`: not checked.
    #[serde(default)]
    pub cartesian: Option<CartesianLimits>,
    /// One finger; the other is the same, rotated by 180° about the hand's z.
    pub finger: Finger,
    /// Joint positions at the start of an episode, rad.
    #[serde(deserialize_with = "one_for_each_joint")]
    pub home: [f64; N],
    /// Preferred joint positions for work in front of the base, rad: the tip at y = 0, the hand
    /// pointing down with its x forward, the elbow up, every joint far from its limits. `home` when
    /// this is missing.
    #[serde(default, deserialize_with = "some_for_each_joint")]
    pub posture: Option<[f64; N]>,
}

/// A list of `N`.
fn one_for_each_joint<'de, D: Deserializer<'de>, T: Deserialize<'de>, const N: usize>(
    from: D,
) -> Result<[T; N], D::Error> {
    let list = Vec::deserialize(from)?;
    list.try_into().map_err(|list: Vec<T>| {
        D::Error::custom(format!(
            "a list with one element for each joint: found {}, expected {N}",
            list.len()
        ))
    })
}

fn some_for_each_joint<'de, D: Deserializer<'de>, const N: usize>(
    from: D,
) -> Result<Option<[f64; N]>, D::Error> {
    one_for_each_joint(from).map(Some)
}

/// Limits of the commanded motion of the tip: translation in m and s, then rotation in rad and s.
#[derive(Clone, Debug, Deserialize)]
pub struct CartesianLimits {
    /// m/s, rad/s.
    pub velocity: [f64; 2],
    /// m/s², rad/s².
    pub acceleration: [f64; 2],
    /// m/s³, rad/s³.
    pub jerk: [f64; 2],
}

/// The link that is bolted to the table.
#[derive(Clone, Debug, Deserialize)]
pub struct BaseLink {
    /// Its shape in the world.
    pub capsules: Vec<Capsule>,
}

/// A joint and the link it moves.
#[derive(Clone, Debug, Deserialize)]
pub struct ArmJoint {
    /// Origin in the frame of the joint before, m.
    pub position: [f64; 3],
    /// Orientation in the frame of the joint before, at angle zero.
    pub quat_wxyz: [f64; 4],
    /// Smallest and largest angle, rad.
    pub range: [f64; 2],
    /// Largest speed, rad/s.
    pub velocity: f64,
    /// Reduction of that speed near the ends of the range; `None`: the limit is constant.
    #[serde(default)]
    pub braking: Option<Braking>,
    /// Largest acceleration, rad/s².
    pub acceleration: f64,
    /// Largest jerk, rad/s³.
    pub jerk: f64,
    /// Largest torque, N·m.
    pub torque: f64,
    /// Largest change of torque, N·m/s.
    pub torque_rate: f64,
    /// The link.
    pub link: ArmLink,
}

/// Reduction of the velocity limit towards an end of the range, by Franka's formula for the
/// Research 3: at distance d (rad) from the end towards which the joint moves, the limit is √(2 ·
/// deceleration · d) − offset, and at least zero.
#[derive(Clone, Debug, Deserialize)]
pub struct Braking {
    /// rad/s².
    pub deceleration: f64,
    /// rad/s.
    pub offset: f64,
}

impl ArmJoint {
    /// The limits of velocity at angle `q` (rad), rad/s: towards smaller angles, not positive, and
    /// towards larger ones.
    ///
    /// ```
    /// # use std::path::Path;
    /// # use ramp_robot::arm::ArmModel;
    /// let arm: ArmModel = ArmModel::read(Path::new("../../data/arms/fr3.json"))?;
    /// let joint = &arm.joints[0];
    /// assert_eq!(joint.velocity_at(0.0), [-2.62, 2.62]);
    /// let [backwards, forwards] = joint.velocity_at(2.8);
    /// assert!(backwards == -2.62 && forwards < 0.45);
    /// # Ok::<(), ramp_robot::arm::ArmError>(())
    /// ```
    pub fn velocity_at(&self, q: f64) -> [f64; 2] {
        let towards = |distance: f64| match &self.braking {
            Some(braking) => {
                let brake = (2.0 * braking.deceleration * distance.max(0.0)).sqrt() - braking.offset;
                brake.max(0.0).min(self.velocity)
            }
            None => self.velocity,
        };
        let [low, high] = self.range;
        [-towards(q - low), towards(high - q)]
    }
}

/// A moving link, in its joint's frame.
#[derive(Clone, Debug, Deserialize)]
pub struct ArmLink {
    /// kg.
    pub mass: f64,
    /// Centre of mass, m.
    pub centre: [f64; 3],
    /// Inertia about the centre of mass, kg·m²: xx, yy, zz, xy, xz, yz.
    pub inertia: [f64; 6],
    /// Its shape.
    pub capsules: Vec<Capsule>,
}

/// A segment with a radius.
#[derive(Clone, Debug, Deserialize)]
pub struct Capsule {
    /// One end of the segment, m.
    pub from: [f64; 3],
    /// The other end, m.
    pub to: [f64; 3],
    /// m.
    pub radius: f64,
}

/// An axis-parallel box, m.
#[derive(Clone, Debug, Deserialize)]
pub struct ArmBox {
    /// The corner with the smallest coordinates.
    pub min: [f64; 3],
    /// The corner with the largest coordinates.
    pub max: [f64; 3],
}

/// The hand. Its frame H: z out of the hand, y along the closing direction of the fingers.
#[derive(Clone, Debug, Deserialize)]
pub struct Hand {
    /// Origin in the last joint's frame, m.
    pub position: [f64; 3],
    /// Orientation in the last joint's frame.
    pub quat_wxyz: [f64; 4],
    /// kg.
    pub mass: f64,
    /// Centre of mass, m.
    pub centre: [f64; 3],
    /// As [`ArmLink::inertia`].
    pub inertia: [f64; 6],
    /// Its shape: the body and the camera mounted on it.
    pub boxes: Vec<ArmBox>,
    /// Distance along z from H to the tip frame T, between the fingertips, m.
    pub tip: f64,
}

/// A finger that moves along +y of the hand; its joint position q ≥ 0 is its distance from closed.
/// The boxes are given at the height of the tip: x across, y from the finger's joint axis outwards,
/// z from T towards the hand.
#[derive(Clone, Debug, Deserialize)]
pub struct Finger {
    /// Distance along z from H to the finger's frame, m.
    pub origin: f64,
    /// Largest q, m.
    pub stroke: f64,
    /// kg.
    pub mass: f64,
    /// Centre of mass in the finger's frame, m.
    pub centre: [f64; 3],
    /// As [`ArmLink::inertia`].
    pub inertia: [f64; 6],
    /// The gripping surfaces: plate, rib and block.
    pub pads: Vec<ArmBox>,
    /// The rest of the finger.
    pub boxes: Vec<ArmBox>,
}

/// Error of reading an arm file.
#[derive(Debug, thiserror::Error)]
pub enum ArmError {
    /// The file is missing or not readable.
    #[error("cannot read {path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The content is not an arm.
    #[error("{path}:{line}:{column}: {message}")]
    Format {
        /// The file.
        path: PathBuf,
        /// From 1.
        line: usize,
        /// From 1.
        column: usize,
        /// The content found, and the content expected.
        message: String,
    },
}

impl<const N: usize> ArmModel<N> {
    /// Reads an arm file.
    ///
    /// # Errors
    /// When the file is missing, is not JSON of this form, does not have `N` joints, or holds
    /// contradictory limits.
    pub fn read(path: &Path) -> Result<ArmModel<N>, ArmError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| ArmError::Io { path: path.to_path_buf(), source })?;
        ArmModel::from_json(path, &text)
    }

    /// Reads the text of an arm file; `path` is its name in messages.
    ///
    /// # Errors
    /// As [`ArmModel::read`].
    pub fn from_json(path: &Path, text: &str) -> Result<ArmModel<N>, ArmError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let at = |line, column, message| ArmError::Format { path: path.to_path_buf(), line, column, message };
        let model: ArmModel<N> = serde_json::from_str(text)
            .map_err(|error| at(error.line(), error.column(), plain(&error.to_string(), MAX_SENTENCE)))?;
        for (index, joint) in model.joints.iter().enumerate() {
            let torques = [joint.torque, joint.torque_rate];
            let limits = [joint.velocity, joint.acceleration, joint.jerk, joint.link.mass];
            let checks = [
                (
                    joint.range[0] < joint.range[1]
                        && limits.iter().chain(&torques).all(|limit| *limit > 0.0),
                    "its range is empty or a limit is not positive",
                ),
                (
                    joint.braking.iter().all(|it| it.deceleration > 0.0 && it.offset >= 0.0),
                    "its deceleration in braking is not positive or its offset is negative",
                ),
            ];
            if let Some((_, problem)) = checks.iter().find(|(holds, _)| !holds) {
                return Err(at(1, 1, format!("joint {}: {problem}", index + 1)));
            }
        }
        if let Some(CartesianLimits { velocity, acceleration, jerk }) = &model.cartesian
            && ![velocity, acceleration, jerk].into_iter().flatten().all(|limit| *limit > 0.0)
        {
            return Err(at(1, 1, "cartesian: a limit is not positive".to_string()));
        }
        Ok(model)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(name: &str) -> ArmModel {
        ArmModel::read(&Path::new("../../data/arms").join(name)).unwrap()
    }

    /// At an end of the range the speed towards that end is zero and away from it full; never above
    /// the largest.
    #[test]
    fn velocity_falls_towards_the_ends_of_the_range() {
        for joint in &read("fr3.json").joints {
            let [low, high] = joint.range;
            assert_eq!(joint.velocity_at(low), [0.0, joint.velocity]);
            assert_eq!(joint.velocity_at(high), [-joint.velocity, 0.0]);
            assert_eq!(joint.velocity_at((low + high) / 2.0), [-joint.velocity, joint.velocity]);
            assert_eq!(joint.velocity_at(high + 1.0)[1], 0.0);
            let speeds =
                (0..=100).map(|step| joint.velocity_at(low + (high - low) * f64::from(step) / 100.0)[1]);
            assert!(speeds.is_sorted_by(|a, b| a >= b));
        }
        // √(2 · 6 · 0.1507) − 0.6599.
        assert!((read("fr3.json").joints[0].velocity_at(2.75)[1] - 0.68487).abs() < 1e-5);
    }

    #[test]
    fn without_braking_velocity_is_the_same_everywhere() {
        for joint in &read("panda.json").joints {
            assert_eq!(joint.velocity_at(joint.range[1]), [-joint.velocity, joint.velocity]);
        }
    }

    #[test]
    fn bad_braking_is_refused() {
        let text = std::fs::read_to_string("../../data/arms/fr3.json").unwrap();
        let refused = |from: &str, to: &str| {
            ArmModel::<7>::from_json(Path::new("arm.json"), &text.replace(from, to)).unwrap_err().to_string()
        };
        let sign =
            "arm.json:1:1: joint 2: its deceleration in braking is not positive or its offset is negative";
        assert_eq!(refused("\"deceleration\": 2.585", "\"deceleration\": 0"), sign);
        assert_eq!(refused("\"offset\": 0.2517", "\"offset\": -0.1"), sign);
        let missing = refused("    \"deceleration\": 2.585,\n", "");
        assert!(missing.contains("missing field `deceleration`"), "{missing}");
    }
}
