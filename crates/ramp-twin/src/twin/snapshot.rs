//! Snapshots of a twin, exact to the last bit.
//!
//! MuJoCo's own `mjSTATE_*` leave out which bodies sleep, so that a scene set from them ends micrometres
//! elsewhere. A snapshot is a clone of all of MuJoCo's data and of the twin's state.

use std::sync::Arc;

use mujoco_rs::prelude::*;

use super::{Twin, Workspace};
use crate::scene::Scene;
use crate::state::State;

/// Everything of a twin that changes.
#[derive(Clone)]
pub struct Snapshot {
    scene: Arc<Scene>,
    data: MjData<Arc<MjModel>>,
    state: State,
}

/// Error of [`Twin::restore`].
#[derive(Debug, thiserror::Error)]
pub enum RestoreError {
    /// The snapshot belongs to another scene: another goal, seed, world or layout.
    #[error("the snapshot was taken of another twin")]
    OtherTwin,
}

impl Snapshot {
    /// Robot time at which it was taken, s.
    pub fn time(&self) -> f64 {
        self.state.observation.time
    }
}

impl Twin {
    /// Copies everything that changes. Takes some microseconds, and the memory of MuJoCo's data that is in
    /// use.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot { scene: Arc::clone(&self.scene), data: self.data.clone(), state: self.state.clone() }
    }

    /// Returns to a snapshot of this twin, or of one that [`Twin::duplicate`] made of it. All later steps,
    /// readings and images are the same to the last bit as they were after the snapshot.
    ///
    /// # Errors
    /// [`RestoreError::OtherTwin`]; the twin is then unchanged.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), RestoreError> {
        if !Arc::ptr_eq(&snapshot.scene, &self.scene) {
            return Err(RestoreError::OtherTwin);
        }
        snapshot.data.copy_to(&mut self.data).map_err(|_| RestoreError::OtherTwin)?;
        self.state.clone_from(&snapshot.state);
        Ok(())
    }

    /// A second twin in the same state, which shares the scene.
    pub fn duplicate(&self) -> Twin {
        Twin {
            scene: Arc::clone(&self.scene),
            data: self.data.clone(),
            state: self.state.clone(),
            workspace: Workspace::new(&self.scene),
        }
    }
}
