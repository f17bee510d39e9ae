//! The station file: an arm at its table. `docs/src/reference/station-files.md` describes it.

use std::net::IpAddr;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;

use ramp_control::{ControllerSettings, JointVector};
use ramp_robot::DOF;
use ramp_source::{Fault, FormProblem, MAX_TITLE, Problem, SourceFile, is_text, shorten};
use serde::Deserialize;
use toml::Spanned;

use crate::cameras::{DeviceSettings, Format};
use crate::connection::{Connection, Pace};

/// An error in a station file, with its place.
pub type StationFault = Fault<StationProblem>;

/// Kinds of errors in a station file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StationProblem {
    /// The file cannot be read.
    #[error(transparent)]
    Form(#[from] FormProblem),
    /// The file is not TOML, or lacks something, or has what a station file has not.
    #[error("this is not a station file: {why}")]
    Toml {
        /// The parser's reason.
        why: String,
    },
    /// A value out of its range.
    #[error("found {name} = {found}, expected {expected}")]
    Value {
        /// Its name.
        name: &'static str,
        /// The value.
        found: String,
        /// The allowed values.
        expected: String,
    },
}

impl Problem for StationProblem {
    fn label(&self) -> String {
        match self {
            StationProblem::Form(problem) => problem.label(),
            StationProblem::Toml { .. } => "here".to_string(),
            StationProblem::Value { expected, .. } => format!("expected {expected}"),
        }
    }

    fn help(&self) -> Option<String> {
        match self {
            StationProblem::Form(problem) => problem.help(),
            _ => Some("examples/station-twin.toml has all that a station file holds".to_string()),
        }
    }
}

/// An arm at its table.
#[derive(Clone, Debug)]
pub struct Station {
    /// The robot, in words.
    pub robot: String,
    /// Who answers for runs there.
    pub scorer: String,
    /// Where it is.
    pub source: String,
    /// Name of the arm file.
    pub arm: String,
    /// The addresses.
    pub connection: Connection,
    /// What the controller knows of the arm.
    pub controller: ControllerSettings,
    /// The lowest corner of the box in which the tip may be, in the world, m.
    pub low: [f64; 3],
    /// Its highest corner, m.
    pub high: [f64; 3],
    /// The share of the arm's largest velocities that agents plan with, above 0 and up to 1.
    pub speed: f64,
    /// The calibration file of its cameras.
    pub calibration: Option<PathBuf>,
    /// Its cameras, wrist and bird's-eye, if no cell gives images.
    pub cameras: Option<[DeviceSettings; 2]>,
}

impl Station {
    /// Reads a station file.
    ///
    /// # Errors
    /// The first error in it, with its place.
    pub fn read(path: &Path) -> Result<Station, StationFault> {
        let mut station = Station::from_source(&SourceFile::read(path)?)?;
        // A calibration file is named as seen from the station file.
        let folder = path.parent().unwrap_or(Path::new(""));
        station.calibration = station.calibration.map(|file| folder.join(file));
        Ok(station)
    }

    /// Reads the text of a station file.
    ///
    /// # Errors
    /// As [`Station::read`].
    pub fn from_source(file: &SourceFile) -> Result<Station, StationFault> {
        let form: Form = toml::from_str(file.text()).map_err(|error| {
            let why = error.message().trim().replace('\n', ", ");
            Fault::new(StationProblem::Toml { why }, file.place(error.span().unwrap_or(0..0)))
        })?;
        form.check(file)
    }

    /// Whether the arm is on this machine: a served twin.
    pub fn is_loopback(&self) -> bool {
        let host =
            self.connection.arm.rsplit_once(':').map_or(self.connection.arm.as_str(), |(host, _)| host);
        host == "localhost" || host.parse::<IpAddr>().is_ok_and(|ip| ip.is_loopback())
    }
}

/// The file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Form {
    robot: Spanned<String>,
    scorer: Spanned<String>,
    source: Spanned<String>,
    arm: String,
    fci: FciForm,
    controller: ControllerForm,
    workspace: WorkspaceForm,
    calibration: Option<PathBuf>,
    cameras: Option<Spanned<CamerasForm>>,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
struct CamerasForm {
    wrist: CameraForm,
    birds_eye: CameraForm,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraForm {
    device: PathBuf,
    format: FormatForm,
    latency: Spanned<f64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
enum FormatForm {
    Mjpeg,
    Yuyv,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FciForm {
    address: Spanned<String>,
    gripper: Option<String>,
    cell: Option<String>,
    #[serde(default)]
    pace: PaceForm,
    reflex_force: Spanned<f64>,
    reflex_torque: Spanned<f64>,
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum PaceForm {
    #[default]
    RealTime,
    LockStep,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ControllerForm {
    armature: Spanned<[f64; DOF]>,
    friction: Spanned<[f64; DOF]>,
    compensation: Spanned<f64>,
    compensation_rate: Spanned<f64>,
    torque_rate: Spanned<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WorkspaceForm {
    low: Spanned<[f64; 3]>,
    high: Spanned<[f64; 3]>,
    speed: Spanned<f64>,
}

/// Refuses values of a file.
struct Check<'a>(&'a SourceFile);

impl Check<'_> {
    fn wrong(&self, name: &'static str, found: String, expected: String, span: Range<usize>) -> StationFault {
        Fault::new(StationProblem::Value { name, found, expected }, self.0.place(span))
    }

    fn text(&self, name: &'static str, value: &Spanned<String>) -> Result<String, StationFault> {
        let text = value.get_ref();
        if text.trim().is_empty() || !is_text(text, MAX_TITLE) {
            let expected = format!("1 to {MAX_TITLE} characters, none of them a control character");
            return Err(self.wrong(name, format!("\"{}\"", shorten(text)), expected, value.span()));
        }
        Ok(text.clone())
    }

    fn number(
        &self,
        name: &'static str,
        value: &Spanned<f64>,
        [low, high]: [f64; 2],
    ) -> Result<f64, StationFault> {
        self.all(name, value.span(), &[*value.get_ref()], [low, high])?;
        Ok(*value.get_ref())
    }

    fn all(
        &self,
        name: &'static str,
        span: Range<usize>,
        values: &[f64],
        [low, high]: [f64; 2],
    ) -> Result<(), StationFault> {
        match values.iter().find(|value| !(low..=high).contains(*value)) {
            Some(value) => Err(self.wrong(name, value.to_string(), format!("{low} to {high}"), span)),
            None => Ok(()),
        }
    }
}

impl CameraForm {
    fn check(self, check: &Check) -> Result<DeviceSettings, StationFault> {
        let latency = check.number("latency", &self.latency, [0.0, 1.0])?;
        let format = match self.format {
            FormatForm::Mjpeg => Format::Mjpeg,
            FormatForm::Yuyv => Format::Yuyv,
        };
        Ok(DeviceSettings { device: self.device, format, latency: Duration::from_secs_f64(latency) })
    }
}

/// The largest distance of a wall from the base, m.
const FAR: f64 = 2.0;

impl Form {
    fn check(self, file: &SourceFile) -> Result<Station, StationFault> {
        let Form { robot, scorer, source, arm, fci, controller, workspace, calibration, cameras } = self;
        let check = Check(file);
        let address = check.text("address", &fci.address)?;
        let gripper = match fci.gripper {
            Some(gripper) => gripper,
            None => match address.rsplit_once(':') {
                None => address.clone(),
                Some((host, port)) => {
                    let port = port.parse::<u16>().ok().and_then(|port| port.checked_add(1));
                    let port = port.ok_or_else(|| {
                        let expected = "HOST or HOST:PORT".to_string();
                        check.wrong(
                            "address",
                            format!("\"{}\"", shorten(&address)),
                            expected,
                            fci.address.span(),
                        )
                    })?;
                    format!("{host}:{port}")
                }
            },
        };
        let connection = Connection {
            gripper,
            arm: address,
            cell: fci.cell,
            pace: match fci.pace {
                PaceForm::RealTime => Pace::RealTime,
                PaceForm::LockStep => Pace::LockStep,
            },
            reflex_force: check.number("reflex_force", &fci.reflex_force, [1.0, 200.0])?,
            reflex_torque: check.number("reflex_torque", &fci.reflex_torque, [1.0, 200.0])?,
        };
        check.all("armature", controller.armature.span(), controller.armature.get_ref(), [0.0, 10.0])?;
        check.all("friction", controller.friction.span(), controller.friction.get_ref(), [0.0, 10.0])?;
        let settings = ControllerSettings {
            armature: JointVector::from(*controller.armature.get_ref()),
            friction: JointVector::from(*controller.friction.get_ref()),
            compensation: check.number("compensation", &controller.compensation, [0.0, 1.0])?,
            compensation_rate: check.number(
                "compensation_rate",
                &controller.compensation_rate,
                [0.0, 1000.0],
            )?,
            torque_rate: Some(check.number("torque_rate", &controller.torque_rate, [1.0, 1000.0])?),
        };
        let (low, high) = (*workspace.low.get_ref(), *workspace.high.get_ref());
        check.all("low", workspace.low.span(), &low, [-FAR, FAR])?;
        for axis in 0..3 {
            check.all("high", workspace.high.span(), &[high[axis]], [low[axis], FAR])?;
        }
        let speed = check.number("speed", &workspace.speed, [0.05, 1.0])?;
        let cameras = match cameras {
            None => None,
            Some(form) => {
                let span = form.span();
                let refused = |expected: &str| {
                    let found = "a table".to_string();
                    Err(check.wrong("cameras", found, expected.to_string(), span))
                };
                if connection.cell.is_some() {
                    return refused("none at a station whose cell gives images");
                }
                if calibration.is_none() {
                    return refused("`calibration`, the file of `ramp calibrate`, at the top beside them");
                }
                let CamerasForm { wrist, birds_eye } = form.into_inner();
                Some([wrist.check(&check)?, birds_eye.check(&check)?])
            }
        };
        Ok(Station {
            robot: check.text("robot", &robot)?,
            scorer: check.text("scorer", &scorer)?,
            source: check.text("source", &source)?,
            arm,
            connection,
            controller: settings,
            low,
            high,
            speed,
            calibration,
            cameras,
        })
    }
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use super::*;

    const EXAMPLE: &str = include_str!("../../../examples/station-twin.toml");

    fn read(text: &str) -> Result<Station, StationFault> {
        Station::from_source(&SourceFile::new("station.toml", text))
    }

    /// The example is a station on this machine, whose gripper is at the port after the arm's.
    #[test]
    fn the_example_is_the_served_twin() {
        let station = read(EXAMPLE).unwrap();
        assert!(station.is_loopback());
        assert_eq!(station.connection.gripper, "127.0.0.1:1338");
        assert_eq!(station.connection.pace, Pace::RealTime);
        assert_eq!(station.arm, "fr3");
    }

    /// An arm in the network is not on this machine, whatever its name begins with.
    #[test]
    fn an_arm_in_the_network_is_not_on_this_machine() {
        for address in ["172.16.0.2", "localhost.example.org:1337", "127.example.org"] {
            let station = read(&EXAMPLE.replace("127.0.0.1:1337", address)).unwrap();
            assert!(!station.is_loopback(), "{address}");
        }
    }

    /// A station without a cell has cameras with their calibration, beside the station file.
    #[test]
    fn cameras_come_with_their_calibration() {
        let cell = EXAMPLE.lines().find(|line| line.starts_with("cell")).unwrap();
        let devices = "\n[cameras.wrist]\ndevice = \"/dev/video0\"\nformat = \"mjpeg\"\nlatency = 0.05\n\
                       [cameras.birds-eye]\ndevice = \"/dev/video2\"\nformat = \"yuyv\"\nlatency = 0.06\n";
        let bare = EXAMPLE.replace(cell, "") + devices;
        let fault = read(&bare).unwrap_err().to_string();
        assert!(fault.contains("expected `calibration`"), "{fault}");
        let calibrated = format!("calibration = \"cell.toml\"\n{bare}");
        let fault =
            read(&format!("calibration = \"cell.toml\"\n{EXAMPLE}{devices}")).unwrap_err().to_string();
        assert!(fault.contains("a station whose cell gives images"), "{fault}");
        let fault = read(&calibrated.replace("0.06", "6.0")).unwrap_err().to_string();
        assert!(fault.contains("found latency = 6, expected 0 to 1"), "{fault}");
        assert!(read(&calibrated.replace("yuyv", "raw")).is_err());

        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("station.toml");
        std::fs::write(&file, &calibrated).unwrap();
        let station = Station::read(&file).unwrap();
        assert_eq!(station.calibration, Some(folder.path().join("cell.toml")));
        let [wrist, birds_eye] = station.cameras.unwrap();
        assert_eq!((wrist.format, birds_eye.format), (Format::Mjpeg, Format::Yuyv));
        assert_eq!(birds_eye.latency, Duration::from_millis(60));
    }

    /// What is wrong is told with its line.
    #[test]
    fn errors_have_their_line() {
        let speed = EXAMPLE.lines().position(|line| line.starts_with("speed")).unwrap() + 1;
        for (from, to, line, said) in [
            ("speed = 0.8", "speed = 3.0", speed, "found speed = 3, expected 0.05 to 1"),
            ("speed = 0.8", "sped = 0.8", speed, "unknown field `sped`"),
            ("speed = 0.8", "speed = nan", speed, "found speed = NaN"),
            ("127.0.0.1:1337", "127.0.0.1:99999", 10, "expected HOST or HOST:PORT"),
        ] {
            let fault = read(&EXAMPLE.replace(from, to)).unwrap_err();
            assert!(fault.to_string().contains(said), "{fault}");
            assert!(fault.location().starts_with(&format!("station.toml:{line}:")), "{fault:?}");
        }
        let fault = read(&EXAMPLE.replace("high = [0.85", "high = [-0.85")).unwrap_err();
        assert!(fault.to_string().contains("found high = -0.85"), "{fault}");
    }
}
