//! The robot that an agent drives.

use ramp_control::ControllerSettings;
use ramp_robot::arm::ArmModel;
use ramp_robot::{
    Camera, CameraModel, Command, Image, ImageWidth, Observation, PERIOD, PartReading, Robot, RobotError,
    Track,
};

use crate::cameras::LocalCameras;
use crate::cell::{Answer, Question};
use crate::cell_client::Cell;
use crate::connection::{Connection, Pace, Statistics};
use crate::error::FrankaError;
use crate::periods::Periods;
use crate::touch::{CellTouch, TouchSource};

/// A connected arm.
pub struct FrankaRobot {
    periods: Periods,
    cell: Option<Cell>,
    cameras: Option<LocalCameras>,
    /// Calibrated models, in the order of [`Camera::ALL`].
    models: Option<[CameraModel; 2]>,
    arm: ArmModel,
    track: Track,
    touch: Option<Box<dyn TouchSource>>,
    cell_touch: Option<CellTouch>,
    seen: Observation,
    failed: Option<RobotError>,
}

impl FrankaRobot {
    /// Connects to arm, gripper and cell, and begins to hold the arm where it is.
    ///
    /// # Errors
    /// When one of them does not answer, or the arm cannot move now.
    pub fn connect(
        connection: &Connection,
        arm: &ArmModel,
        settings: &ControllerSettings,
        track: Track,
    ) -> Result<FrankaRobot, FrankaError> {
        let mut cell = connection.cell.as_deref().map(Cell::connect).transpose()?;
        let periods = Periods::begin(connection, arm, settings)?;
        let seen = periods.observe()?;
        let cell_touch = cell.as_mut().map(|cell| CellTouch::of(cell, seen.time)).transpose()?.flatten();
        let mut robot = FrankaRobot {
            periods,
            cell,
            cameras: None,
            models: None,
            arm: arm.clone(),
            track,
            touch: None,
            cell_touch,
            seen,
            failed: None,
        };
        robot.observe_now()?;
        Ok(robot)
    }

    /// The same, with these models of its cameras, in the order of [`Camera::ALL`]. Without them they are the
    /// nominal ones.
    #[must_use]
    pub fn with_models(self, models: [CameraModel; 2]) -> FrankaRobot {
        FrankaRobot { models: Some(models), ..self }
    }

    /// The same, with the cameras of this computer, where no cell gives images.
    #[must_use]
    pub fn with_cameras(self, cameras: LocalCameras) -> FrankaRobot {
        let models = Camera::ALL.map(|camera| cameras.model(camera).clone());
        FrankaRobot { cameras: Some(cameras), models: Some(models), ..self }
    }

    /// The same, with tactile sensors in its fingers.
    ///
    /// # Errors
    /// When the arm has stopped.
    pub fn with_touch(mut self, source: Box<dyn TouchSource>) -> Result<FrankaRobot, FrankaError> {
        self.touch = Some(source);
        self.observe_now()?;
        Ok(self)
    }

    /// Takes what arm and fingers report now.
    fn observe_now(&mut self) -> Result<(), FrankaError> {
        let seen = self.periods.observe()?;
        self.seen = self.with_fingers(seen)?;
        Ok(())
    }

    /// An observation of the arm, with what the fingers feel now.
    fn with_fingers(&mut self, seen: Observation) -> Result<Observation, FrankaError> {
        let pace = self.periods.pace();
        let touch = match (&mut self.touch, self.cell_touch.as_mut().zip(self.cell.as_mut())) {
            (Some(source), _) => source.newest(),
            (None, Some((sensors, cell))) => Some(sensors.newest(cell, seen.time, pace)?),
            (None, None) => None,
        };
        Ok(Observation { touch, ..seen })
    }

    /// Numbers of the connection so far.
    pub fn statistics(&self) -> Statistics {
        self.periods.statistics()
    }

    fn cell(&mut self) -> Result<&mut Cell, FrankaError> {
        self.cell.as_mut().ok_or(FrankaError::NoCell)
    }

    fn check_running(&self) -> Result<(), RobotError> {
        self.failed.clone().map_or(Ok(()), Err)
    }

    /// Remembers what stopped the arm.
    fn kept<T>(&mut self, result: Result<T, RobotError>) -> Result<T, RobotError> {
        if let Err(error) = &result
            && error.is_final()
        {
            self.failed = Some(error.clone());
        }
        result
    }

    fn parts(&mut self) -> Result<Vec<PartReading>, FrankaError> {
        let cell = self.cell()?;
        match cell.ask(&Question::Parts)? {
            Answer::Parts { parts } => Ok(parts.into_iter().map(Into::into).collect()),
            other => Err(cell.unexpected(&other)),
        }
    }

    fn open_shutters(&mut self) -> Result<(), FrankaError> {
        if let Some(cameras) = &mut self.cameras {
            cameras.expose();
            return Ok(());
        }
        let cell = self.cell()?;
        match cell.ask(&Question::Expose)? {
            Answer::Done => Ok(()),
            other => Err(cell.unexpected(&other)),
        }
    }

    fn image(&mut self, camera: Camera, width: Option<ImageWidth>) -> Result<Image, FrankaError> {
        if let Some(cameras) = &mut self.cameras {
            let image = cameras.image(camera, width, &self.periods)?;
            self.observe_now()?;
            return Ok(image);
        }
        let width = width.map(|width| width.pixels() as u64);
        let cell = self.cell.as_mut().ok_or(FrankaError::NoCell)?;
        let wait = match cell.ask(&Question::Image { camera, width })? {
            Answer::Wait { periods } => periods,
            other => return Err(cell.unexpected(&other)),
        };
        if wait > 0 && self.periods.pace() == Pace::LockStep {
            self.periods.wait(wait)?;
        }
        let head = match cell.answer()? {
            Answer::Image(head) => head,
            other => return Err(cell.unexpected(&other)),
        };
        let pixels = cell.pixels(&head)?;
        let depth = if head.depth { Some(cell.depth(&head)?) } else { None };
        self.observe_now()?;
        let since = head.message as f64 - self.periods.first_message() as f64;
        Ok(Image {
            camera,
            time: since * PERIOD,
            x_wt: head.x_wt.into(),
            width: head.width,
            height: head.height,
            pixels,
            depth,
        })
    }
}

impl Robot for FrankaRobot {
    fn step(&mut self, command: &Command) -> Result<Observation, RobotError> {
        self.check_running()?;
        let seen = self.periods.step(command);
        let seen = self.kept(seen)?;
        let seen = self.with_fingers(seen).map_err(RobotError::from);
        self.seen = self.kept(seen)?;
        Ok(self.seen.clone())
    }

    fn observe(&self) -> Observation {
        self.seen.clone()
    }

    fn read_parts(&mut self) -> Result<Vec<PartReading>, RobotError> {
        self.check_running()?;
        if self.track.gives_images() {
            return Err(RobotError::NotOnTrack { track: self.track, what: "poses of parts" });
        }
        let parts = self.parts().map_err(RobotError::from);
        self.kept(parts)
    }

    fn expose(&mut self) -> Result<(), RobotError> {
        self.check_running()?;
        let done = self.open_shutters().map_err(RobotError::from);
        self.kept(done)
    }

    fn look_sized(&mut self, camera: Camera, width: Option<ImageWidth>) -> Result<Image, RobotError> {
        self.check_running()?;
        let image = self.image(camera, width).map_err(RobotError::from);
        self.kept(image)
    }

    fn camera(&self, camera: Camera) -> CameraModel {
        let models = self.models.iter().flatten().zip(Camera::ALL);
        let known = models.filter(|(_, other)| *other == camera).map(|(model, _)| model.clone()).next();
        known.unwrap_or_else(|| CameraModel::nominal(camera, self.arm.hand.tip))
    }
}
