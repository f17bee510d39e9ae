//! The calibration file: what was estimated of a cell and was good enough.
//!
//! `docs/src/reference/calibration.md` describes the format.

use std::fmt::Write;
use std::path::Path;

use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use ramp_robot::camera::Mount;
use ramp_robot::{Camera, CameraModel, DOF, Pose};
use ramp_source::{MAX_FILE, nearest, plain, read_text, shorten};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::error::CalibrationError;

/// Version of the format.
pub const FORMAT: &str = "ramp-calibration-1";
/// Largest number of pixels along an edge.
const LARGEST_EDGE: f64 = 8192.0;
/// Largest number: of a focal length in pixels.
const LARGEST: f64 = 1e6;

/// A lens.
#[derive(Clone, Debug, PartialEq)]
pub struct LensEntry {
    /// Pixels in a row, and rows.
    pub size: [usize; 2],
    /// Focal lengths along x and y, pixels.
    pub focal: [f64; 2],
    /// Principal point, pixels.
    pub centre: [f64; 2],
    /// k1, k2, p1, p2, k3.
    pub distortion: [f64; 5],
}

/// A plane in the robot's base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableEntry {
    /// Upward normal, of length 1.
    pub normal: [f64; 3],
    /// Height at the origin, m.
    pub height: f64,
}

/// The joints' friction.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionEntry {
    /// The arm's name.
    pub arm: String,
    /// Dry friction, N·m.
    pub coulomb: [f64; DOF],
    /// Viscous friction, N·m·s/rad.
    pub viscous: [f64; DOF],
    /// Torque that is left in both directions alike, N·m.
    pub offset: [f64; DOF],
}

/// The content of a calibration file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Calibration {
    /// Lens of the wrist camera.
    pub wrist: Option<LensEntry>,
    /// Lens of the overhead camera.
    pub birds_eye: Option<LensEntry>,
    /// Pose of the wrist camera's optical frame in the tip frame.
    pub x_tc: Option<Pose>,
    /// Pose of the overhead camera's optical frame in the robot's base frame.
    pub x_wc: Option<Pose>,
    /// The table.
    pub table: Option<TableEntry>,
    /// The joints' friction.
    pub friction: Option<FrictionEntry>,
}

impl Calibration {
    /// Reads a calibration file; one that is not there is empty.
    ///
    /// # Errors
    /// The first error in the file.
    pub fn read_or_empty(path: &Path) -> Result<Calibration, CalibrationError> {
        if path.exists() { Calibration::read(path) } else { Ok(Calibration::default()) }
    }

    /// Reads a calibration file.
    ///
    /// # Errors
    /// The first error in the file.
    pub fn read(path: &Path) -> Result<Calibration, CalibrationError> {
        let text = read_text(path, MAX_FILE)?;
        let reader = Reader { file: plain(&path.display().to_string(), usize::MAX), text: &text };
        reader.read()
    }

    /// The lens of a camera.
    pub fn lens(&self, camera: Camera) -> Option<&LensEntry> {
        match camera {
            Camera::Wrist => self.wrist.as_ref(),
            Camera::BirdsEye => self.birds_eye.as_ref(),
        }
    }

    /// Replaces the lens of a camera.
    pub fn set_lens(&mut self, camera: Camera, model: &CameraModel) {
        let entry = LensEntry {
            size: [model.width, model.height],
            focal: model.focal,
            centre: model.centre,
            distortion: model.distortion,
        };
        match camera {
            Camera::Wrist => self.wrist = Some(entry),
            Camera::BirdsEye => self.birds_eye = Some(entry),
        }
    }

    /// The lens of a camera as a model whose mounting has no meaning.
    pub fn lens_model(&self, camera: Camera) -> Option<CameraModel> {
        let lens = self.lens(camera)?;
        Some(CameraModel {
            width: lens.size[0],
            height: lens.size[1],
            focal: lens.focal,
            centre: lens.centre,
            distortion: lens.distortion,
            mount: Mount::World(Pose::identity()),
        })
    }

    /// A camera of which both lens and pose are known.
    pub fn camera(&self, camera: Camera) -> Option<CameraModel> {
        let mount = match camera {
            Camera::Wrist => Mount::Tip(self.x_tc?),
            Camera::BirdsEye => Mount::World(self.x_wc?),
        };
        Some(CameraModel { mount, ..self.lens_model(camera)? })
    }

    /// The file's text. Numbers read back are those that were written, to the last bit.
    pub fn to_toml(&self) -> String {
        let mut text = String::from(
            "# Calibration of a cell, by `ramp calibrate`. Metres, radians, pixels, N·m; quaternions as w, x, y, z.\n",
        );
        // Writing to a string does not fail.
        let _ = writeln!(text, "format = \"{FORMAT}\"");
        for camera in Camera::ALL {
            let Some(LensEntry { size, focal, centre, distortion }) = self.lens(camera) else { continue };
            let _ = writeln!(text, "\n[lens.{}]\nsize = {size:?}\nfocal = {focal:?}", camera.name());
            let _ = writeln!(text, "centre = {centre:?}\n# k1, k2, p1, p2, k3\ndistortion = {distortion:?}");
        }
        let poses = [
            ("hand-eye", "# Pose of the wrist camera's optical frame in the tip frame", &self.x_tc),
            (
                "birds-eye",
                "# Pose of the overhead camera's optical frame in the robot's base frame",
                &self.x_wc,
            ),
        ];
        for (section, about, pose) in poses {
            let Some(pose) = pose else { continue };
            let position: [f64; 3] = pose.translation.vector.into();
            let q = pose.rotation.quaternion();
            let quaternion = [q.w, q.i, q.j, q.k];
            let _ = writeln!(
                text,
                "\n{about}\n[{section}]\nposition = {position:?}\nquaternion = {quaternion:?}"
            );
        }
        if let Some(TableEntry { normal, height }) = &self.table {
            let about =
                "# The table's plane in the robot's base frame: upward normal, and height at the origin";
            let _ = writeln!(text, "\n{about}\n[table]\nnormal = {normal:?}\nheight = {height:?}");
        }
        if let Some(FrictionEntry { arm, coulomb, viscous, offset }) = &self.friction {
            let about = "# Friction between commanded torque and motion, of each joint from the base on";
            let _ = writeln!(text, "\n{about}\n[friction]\narm = \"{arm}\"\ncoulomb = {coulomb:?}");
            let _ = writeln!(text, "viscous = {viscous:?}\noffset = {offset:?}");
        }
        text
    }
}

type Entry<'t, 'a> = &'t Spanned<DeValue<'a>>;

/// Reads one file.
struct Reader<'a> {
    file: String,
    text: &'a str,
}

impl Reader<'_> {
    fn read(&self) -> Result<Calibration, CalibrationError> {
        let table = DeTable::parse(self.text).map_err(|error| {
            let at = error.span().map_or(0, |span| span.start);
            self.wrong(at, shorten(error.message()), "valid TOML")
        })?;
        let table = table.get_ref();
        let known = ["format", "lens", "hand-eye", "birds-eye", "table", "friction"];
        self.check(table, "a calibration file", &known)?;
        let format = self.need(table, 0, "format")?;
        if !matches!(format.get_ref(), DeValue::String(text) if text == FORMAT) {
            return Err(self.value(format, &format!("format = \"{FORMAT}\"")));
        }
        let mut found = Calibration::default();
        if let Some(lenses) = table.get("lens") {
            let lenses = self.table(lenses)?;
            self.check(lenses, "lens", &Camera::ALL.map(Camera::name))?;
            let lens = |name: &str| lenses.get(name).map(|lens| self.lens(lens)).transpose();
            (found.wrist, found.birds_eye) = (lens("wrist")?, lens("birds-eye")?);
        }
        let pose = |name: &str| table.get(name).map(|pose| self.pose(name, pose)).transpose();
        (found.x_tc, found.x_wc) = (pose("hand-eye")?, pose("birds-eye")?);
        if let Some(entry) = table.get("table") {
            let inner = self.table(entry)?;
            self.check(inner, "table", &["normal", "height"])?;
            let normal = self.numbers::<3>(inner, entry, "normal", [-1.0, 1.0])?;
            self.check_length(inner, "normal", &normal)?;
            let [height] = self.numbers(inner, entry, "height", [-10.0, 10.0])?;
            found.table = Some(TableEntry { normal, height });
        }
        if let Some(entry) = table.get("friction") {
            found.friction = Some(self.friction(entry)?);
        }
        Ok(found)
    }

    fn lens(&self, entry: Entry<'_, '_>) -> Result<LensEntry, CalibrationError> {
        let table = self.table(entry)?;
        self.check(table, "lens", &["size", "focal", "centre", "distortion"])?;
        let size = self.numbers::<2>(table, entry, "size", [1.0, LARGEST_EDGE])?;
        Ok(LensEntry {
            size: size.map(|edge| edge as usize),
            focal: self.numbers(table, entry, "focal", [1.0, LARGEST])?,
            centre: self.numbers(table, entry, "centre", [-LARGEST, LARGEST])?,
            distortion: self.numbers(table, entry, "distortion", [-100.0, 100.0])?,
        })
    }

    fn pose(&self, name: &str, entry: Entry<'_, '_>) -> Result<Pose, CalibrationError> {
        let table = self.table(entry)?;
        self.check(table, name, &["position", "quaternion"])?;
        let [x, y, z] = self.numbers(table, entry, "position", [-10.0, 10.0])?;
        let quaternion = self.numbers::<4>(table, entry, "quaternion", [-1.0, 1.0])?;
        self.check_length(table, "quaternion", &quaternion)?;
        let [w, i, j, k] = quaternion;
        // As it was written: normalised again, it would change in its last bits.
        let rotation = UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k));
        Ok(Pose::from_parts(Translation3::new(x, y, z), rotation))
    }

    fn friction(&self, entry: Entry<'_, '_>) -> Result<FrictionEntry, CalibrationError> {
        let table = self.table(entry)?;
        self.check(table, "friction", &["arm", "coulomb", "viscous", "offset"])?;
        let arm = self.need(table, entry.span().start, "arm")?;
        let name = match arm.get_ref() {
            DeValue::String(name) if ramp_source::is_name(name) => name.to_string(),
            _ => return Err(self.value(arm, "the name of an arm")),
        };
        let torques = |name: &str| self.numbers(table, entry, name, [-1000.0, 1000.0]);
        Ok(FrictionEntry {
            arm: name,
            coulomb: torques("coulomb")?,
            viscous: torques("viscous")?,
            offset: torques("offset")?,
        })
    }

    fn table<'t, 'a>(&self, entry: Entry<'t, 'a>) -> Result<&'t DeTable<'a>, CalibrationError> {
        match entry.get_ref() {
            DeValue::Table(table) => Ok(table),
            _ => Err(self.value(entry, "a table")),
        }
    }

    /// Checks that a table holds nothing unknown.
    fn check(&self, table: &DeTable<'_>, place: &str, known: &[&str]) -> Result<(), CalibrationError> {
        match table.iter().find(|(key, _)| !known.contains(&key.get_ref().as_ref())) {
            None => Ok(()),
            Some((key, _)) => {
                let near = nearest(key.get_ref(), known.iter().copied());
                let near = near.map_or_else(|| known.join(", "), |near| format!("`{near}`"));
                let found = format!("`{}` in {place}", shorten(key.get_ref()));
                Err(self.wrong(key.span().start, found, &near))
            }
        }
    }

    fn need<'t, 'a>(
        &self,
        table: &'t DeTable<'a>,
        at: usize,
        name: &str,
    ) -> Result<Entry<'t, 'a>, CalibrationError> {
        table.get(name).ok_or_else(|| self.wrong(at, format!("no `{name}`"), "it"))
    }

    /// A list of numbers; a list of one is a number.
    fn numbers<const N: usize>(
        &self,
        table: &DeTable<'_>,
        section: Entry<'_, '_>,
        name: &str,
        [least, most]: [f64; 2],
    ) -> Result<[f64; N], CalibrationError> {
        let entry = self.need(table, section.span().start, name)?;
        let numbers: Option<Vec<f64>> = match entry.get_ref() {
            DeValue::Array(values) => values.iter().map(|value| number(value.get_ref())).collect(),
            value => number(value).map(|value| vec![value]),
        };
        let numbers = numbers.filter(|all| all.iter().all(|it| (least..=most).contains(it)));
        numbers.and_then(|all| <[f64; N]>::try_from(all).ok()).ok_or_else(|| {
            let what = if N == 1 { "a number".to_string() } else { format!("{N} numbers") };
            self.value(entry, &format!("{what} from {least} to {most} as `{name}`"))
        })
    }

    /// Checks that a list is a vector of length 1.
    fn check_length(&self, table: &DeTable<'_>, name: &str, list: &[f64]) -> Result<(), CalibrationError> {
        let length = list.iter().map(|value| value * value).sum::<f64>().sqrt();
        if (length - 1.0).abs() < 1e-6 {
            return Ok(());
        }
        let at = table.get(name).map_or(0, |entry| entry.span().start);
        Err(self.wrong(at, format!("`{name}` of length {length:.4}"), "length 1"))
    }

    fn value(&self, entry: Entry<'_, '_>, expected: &str) -> CalibrationError {
        let found = self.text.get(entry.span()).unwrap_or_default();
        self.wrong(entry.span().start, format!("`{}`", shorten(found)), expected)
    }

    fn wrong(&self, at: usize, found: String, expected: &str) -> CalibrationError {
        let before = self.text.get(..at).unwrap_or_default();
        let line = before.matches('\n').count() + 1;
        CalibrationError::Entry { file: self.file.clone(), line, found, expected: expected.to_string() }
    }
}

/// A number; `None` for anything else.
fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
        DeValue::Float(float) => float.as_str().parse().ok(),
        _ => None,
    }
}
