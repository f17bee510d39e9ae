//! The metadata that a server sends when a connection begins: what its policy sees, and the meaning of its
//! actions.
//!
//! A server of RoboArena's kind names its action space. A plain openpi server does not: what it then gets is
//! what a policy for DROID expects.

use ramp_kit::source::{is_name, shorten, to_name};
use ramp_result::sha256;
use ramp_robot::{ImageWidth, is_reserved};
use rmpv::Value;

use crate::wire;

/// The largest metadata, bytes.
pub(crate) const LARGEST: usize = 1 << 16;
/// Image size of policies for DROID, rows and columns.
const DROID_IMAGE: [usize; 2] = [224, 224];
/// Rate of actions on the DROID platform, Hz.
const DROID_RATE: f64 = 15.0;
/// Actions of a chunk that openpi's example for DROID carries out before it asks again.
const DROID_HORIZON: u64 = 8;
/// Rates of actions that are possible, Hz.
const RATES: [f64; 2] = [1.0, 100.0];
/// The most actions of a chunk that are carried out.
const MOST_ACTIONS: u64 = 1000;
/// The longest time limit, s: longer than any episode.
const LONGEST_LIMIT: f64 = 1e4;
/// Largest length of the policy's own name within the agent's name, characters.
const LONGEST_NAME: usize = 24;
/// Hexadecimal digits of the hash within the agent's name.
const DIGITS: usize = 8;

/// Meaning of the numbers of an action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActionSpace {
    /// Positions of the seven joints, rad.
    JointPosition,
    /// Velocities of the seven joints in DROID's unit.
    JointVelocity,
    /// Velocity of the tip along and about the axes of the world, in DROID's units.
    CartesianVelocity,
}

impl ActionSpace {
    const ALL: [ActionSpace; 3] =
        [ActionSpace::JointPosition, ActionSpace::JointVelocity, ActionSpace::CartesianVelocity];

    /// The name in metadata.
    pub fn name(self) -> &'static str {
        match self {
            ActionSpace::JointPosition => "joint_position",
            ActionSpace::JointVelocity => "joint_velocity",
            ActionSpace::CartesianVelocity => "cartesian_velocity",
        }
    }

    /// Numbers of an action without the gripper's.
    pub fn numbers(self) -> usize {
        match self {
            ActionSpace::JointPosition | ActionSpace::JointVelocity => ramp_robot::DOF,
            ActionSpace::CartesianVelocity => 6,
        }
    }
}

/// A policy, as its server describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct Metadata {
    /// The name in results: the policy's own, and the first digits of the hash of its metadata.
    pub name: String,
    /// The version in results.
    pub version: String,
    /// SHA-256 of the message with the metadata, in hex.
    pub sha256: String,
    /// Meaning of the numbers of an action.
    pub action_space: ActionSpace,
    /// Rows and columns of the images; `None`: as they come out of the cameras.
    pub image: Option<[usize; 2]>,
    /// It sees the wrist camera.
    pub wrist: bool,
    /// It sees the bird's-eye camera.
    pub external: bool,
    /// Each observation names its episode.
    pub session: bool,
    /// The server is of RoboArena's kind: observations name an endpoint, and a reset is one.
    pub endpoints: bool,
    /// Actions in a second, Hz.
    pub rate: f64,
    /// Actions of a chunk that are carried out before the next observation.
    pub horizon: usize,
    /// Robot time after which the policy is stopped, s.
    pub time_limit: Option<f64>,
    /// It gets the fields that begin with `ramp/`.
    pub ramp_fields: bool,
}

impl Metadata {
    /// The metadata in a message.
    ///
    /// # Errors
    /// The mistake, for a person, with the name of its field.
    pub fn read(bytes: &[u8]) -> Result<Metadata, String> {
        if bytes.len() > LARGEST {
            return Err(format!("its metadata have {} bytes, and {LARGEST} is the most", bytes.len()));
        }
        let value = wire::from_bytes(bytes).map_err(|error| format!("its metadata {error}"))?;
        if !value.is_map() {
            return Err("its metadata are no map".to_string());
        }
        let fields = Fields(&value);
        let (sha256, own) = (sha256(bytes), fields.text("name")?.unwrap_or("policy"));
        let short: String = to_name(own).chars().take(LONGEST_NAME).collect();
        let name = format!("{short}.{}", &sha256[..DIGITS]);
        if !is_name(&name) || is_reserved(&name) {
            return Err(format!("its `name` is `{}`, which no policy can have", shorten(own)));
        }
        let endpoints = fields.get("action_space").is_some();
        let external = fields.whole("n_external_cameras", 0, 2)?.unwrap_or(1);
        if external > 1 {
            return Err("`n_external_cameras` is 2, and the cell has one, the bird's-eye camera".to_string());
        }
        if fields.flag("needs_stereo_camera")?.unwrap_or(false) {
            return Err("`needs_stereo_camera` is true, and the cameras are not stereo".to_string());
        }
        let image = match fields.get("image_resolution") {
            None => Some(DROID_IMAGE),
            Some(Value::Nil) => None,
            Some(value) => Some(image_size(value)?),
        };
        Ok(Metadata {
            name,
            version: fields.text("version")?.map_or_else(|| "unknown".to_string(), to_name),
            sha256,
            action_space: action_space(&fields)?,
            image,
            wrist: fields.flag("needs_wrist_camera")?.unwrap_or(true),
            external: external == 1,
            session: fields.flag("needs_session_id")?.unwrap_or(false),
            endpoints,
            rate: fields.number("control_hz", RATES)?.unwrap_or(DROID_RATE),
            horizon: fields.whole("open_loop_horizon", 1, MOST_ACTIONS)?.unwrap_or(DROID_HORIZON) as usize,
            time_limit: fields.number("time_limit", [0.1, LONGEST_LIMIT])?,
            ramp_fields: fields.flag("needs_ramp_fields")?.unwrap_or(false),
        })
    }
}

fn action_space(fields: &Fields) -> Result<ActionSpace, String> {
    let Some(name) = fields.text("action_space")? else { return Ok(ActionSpace::JointVelocity) };
    ActionSpace::ALL.into_iter().find(|it| it.name() == name).ok_or_else(|| {
        let known: Vec<&str> = ActionSpace::ALL.iter().map(|it| it.name()).collect();
        format!("`action_space` is `{}`; there are {}", shorten(name), known.join(", "))
    })
}

/// Rows and columns of images, each as many pixels as an image can have.
fn image_size(value: &Value) -> Result<[usize; 2], String> {
    let sides = wire::to_array(value).map_err(|error| format!("`image_resolution` {error}"))?;
    let (least, most) = (ImageWidth::LEAST as f64, ImageWidth::MOST as f64);
    match sides.numbers[..] {
        [rows, columns]
            if [rows, columns].iter().all(|it| (least..=most).contains(it) && it.fract() == 0.0) =>
        {
            Ok([rows as usize, columns as usize])
        }
        _ => Err(format!(
            "`image_resolution` is not two whole numbers from {least} to {most}, rows and columns"
        )),
    }
}

/// The fields of a map.
struct Fields<'v>(&'v Value);

impl<'v> Fields<'v> {
    fn get(&self, key: &str) -> Option<&'v Value> {
        wire::get(self.0, key)
    }

    /// A field that may be missing or nil.
    fn read<T>(
        &self,
        key: &str,
        what: &str,
        read: impl Fn(&'v Value) -> Option<T>,
    ) -> Result<Option<T>, String> {
        match self.get(key) {
            None | Some(Value::Nil) => Ok(None),
            Some(value) => read(value).map(Some).ok_or_else(|| format!("`{key}` is not {what}")),
        }
    }

    fn text(&self, key: &str) -> Result<Option<&'v str>, String> {
        self.read(key, "a text", wire::text)
    }

    fn flag(&self, key: &str) -> Result<Option<bool>, String> {
        self.read(key, "true or false", Value::as_bool)
    }

    fn whole(&self, key: &str, least: u64, most: u64) -> Result<Option<u64>, String> {
        let what = format!("a whole number from {least} to {most}");
        self.read(key, &what, |value| value.as_u64().filter(|it| (least..=most).contains(it)))
    }

    fn number(&self, key: &str, [least, most]: [f64; 2]) -> Result<Option<f64>, String> {
        let what = format!("a number from {least} to {most}");
        self.read(key, &what, |value| value.as_f64().filter(|it| (least..=most).contains(it)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::map;

    fn read(entries: &[(&str, Value)]) -> Result<Metadata, String> {
        Metadata::read(&wire::to_bytes(&map(entries.iter().cloned())))
    }

    #[test]
    fn a_plain_openpi_server_gets_what_a_policy_for_droid_expects() {
        let plain = read(&[]).unwrap();
        assert_eq!(plain.action_space, ActionSpace::JointVelocity);
        assert_eq!((plain.image, plain.rate, plain.horizon), (Some([224, 224]), 15.0, 8));
        assert!(plain.wrist && plain.external && !plain.endpoints && !plain.session && !plain.ramp_fields);
        assert!(plain.name.starts_with("policy.") && plain.version == "unknown", "{}", plain.name);
        let other = read(&[("name", "pi 0".into()), ("version", "2".into())]).unwrap();
        assert!(other.name.starts_with("pi0.") && other.version == "2", "{}", other.name);
        assert_ne!(plain.sha256, other.sha256);
    }

    #[test]
    fn a_roboarena_server_says_what_it_sees_and_does() {
        let sides = Value::from(vec![Value::from(180), 320.into()]);
        let it = read(&[
            ("action_space", "joint_position".into()),
            ("image_resolution", sides),
            ("needs_wrist_camera", false.into()),
            ("n_external_cameras", 0.into()),
            ("needs_session_id", true.into()),
        ]);
        let it = it.unwrap();
        assert_eq!((it.action_space, it.image), (ActionSpace::JointPosition, Some([180, 320])));
        assert!(it.endpoints && it.session && !it.wrist && !it.external);
        assert_eq!(read(&[("image_resolution", Value::Nil)]).unwrap().image, None);
    }

    #[test]
    fn each_mistake_names_its_field() {
        let pair = |one: f64, two: f64| Value::from(vec![Value::from(one), two.into()]);
        for (key, value, why) in [
            (
                "action_space",
                Value::from("cartesian_position"),
                "`action_space` is `cartesian_position`; there are",
            ),
            ("image_resolution", pair(8.0, 224.0), "`image_resolution` is not two whole numbers from 16"),
            ("image_resolution", pair(f64::NAN, 224.0), "`image_resolution`"),
            ("image_resolution", 224.into(), "`image_resolution`"),
            ("n_external_cameras", 2.into(), "`n_external_cameras` is 2"),
            ("needs_stereo_camera", true.into(), "`needs_stereo_camera`"),
            ("needs_wrist_camera", 1.into(), "`needs_wrist_camera` is not true or false"),
            ("control_hz", f64::INFINITY.into(), "`control_hz` is not a number from 1 to 100"),
            ("open_loop_horizon", 0.into(), "`open_loop_horizon`"),
            ("time_limit", (-1.0).into(), "`time_limit`"),
            ("name", 7.into(), "`name` is not a text"),
            ("name", "baseline+mine".into(), "which no policy can have"),
        ] {
            let error = read(&[(key, value.clone())]).unwrap_err();
            assert!(error.contains(why), "{key}={value}: {error}");
        }
        assert!(Metadata::read(&wire::to_bytes(&7.into())).unwrap_err().contains("no map"));
        assert!(Metadata::read(&vec![0; LARGEST + 1]).unwrap_err().contains("is the most"));
    }
}
