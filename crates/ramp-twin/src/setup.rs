//! What an episode in the twin is made from.

use ramp_assembly::Assembly;
use ramp_render::LooksError;
use ramp_robot::Track;
use ramp_robot::arm::ArmModel;
use ramp_world::World;

use crate::fault::Fault;
use crate::layout::Disturbance;

/// What an episode in the twin is made from.
#[derive(Clone, Debug)]
pub struct Setup<'a> {
    /// The goal, with its kit.
    pub assembly: &'a Assembly,
    /// The arm.
    pub arm: &'a ArmModel,
    /// What the agent may see.
    pub track: Track,
    /// All randomness flows from here.
    pub seed: u64,
    /// How far the start differs from the sheet's outlines.
    pub disturbance: Disturbance,
    /// What the physics are drawn from.
    pub world: &'a World,
    /// What goes wrong on purpose.
    pub fault: Option<Fault>,
}

/// Why a twin could not be made.
#[derive(Debug, thiserror::Error)]
pub enum TwinError {
    /// MuJoCo refused the scene.
    #[error("MuJoCo cannot compile the scene: {0}")]
    Scene(String),
    /// There is no window to be had.
    #[error("cannot open a window: {0}")]
    Window(String),
    /// The cameras have nothing to show.
    #[error(transparent)]
    Looks(#[from] LooksError),
    /// The scene lacks something the twin needs: the kit or the arm file is not what it should be.
    #[error("the scene has no {0}")]
    Missing(String),
}
