//! A live window on the twin. It has a state of its own and copies the twin's positions into it, so that
//! nothing done in the window can reach the physics.

use mujoco_rs::prelude::*;
use mujoco_rs::viewer::MjViewer;

use crate::setup::{Setup, TwinError};
use crate::twin::Twin;

/// Robot time between two pictures, s.
const INTERVAL: f64 = 0.02;

/// A window that shows a twin of the same setup.
pub struct Window {
    viewer: MjViewer,
    data: MjData<Box<MjModel>>,
    last: f64,
}

impl Window {
    /// Opens a window.
    ///
    /// # Errors
    /// When the scene does not compile, or there is no display.
    pub fn open(setup: &Setup) -> Result<Window, TwinError> {
        let twin = Twin::new(setup)?;
        let model =
            MjModel::from_xml_string(twin.scene()).map_err(|error| TwinError::Scene(error.to_string()))?;
        let viewer =
            MjViewer::launch_passive(&model, 0).map_err(|error| TwinError::Window(error.to_string()))?;
        Ok(Window { viewer, data: MjData::new(Box::new(model)), last: f64::NEG_INFINITY })
    }

    /// Shows where everything is now. A window that was closed stays closed.
    pub fn show(&mut self, twin: &Twin) {
        if !self.viewer.running() || twin.time() - self.last < INTERVAL {
            return;
        }
        self.last = twin.time();
        self.data.qpos_mut().copy_from_slice(twin.qpos());
        self.data.forward_kinematics();
        self.viewer.sync_data(&mut self.data);
        // A frame that cannot be drawn does not stop the episode.
        let _ = self.viewer.render();
    }
}
