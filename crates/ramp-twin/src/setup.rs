//! Input of an episode in the twin.

use ramp_assembly::{Assembly, Task};
use ramp_render::LooksError;
use ramp_robot::Track;
use ramp_robot::arm::ArmModel;
use ramp_world::{Start, World};

use crate::fault::Fault;
use crate::given::GivenState;

/// Input of an episode in the twin.
#[derive(Clone, Debug)]
pub struct Setup<'a> {
    /// The goal, with its kit.
    pub assembly: &'a Assembly,
    /// The arm.
    pub arm: &'a ArmModel,
    /// The track: the data that the agent may see.
    pub track: Track,
    /// Seed of all random numbers.
    pub seed: u64,
    /// The start from which the places of the parts are drawn.
    pub start: &'a Start,
    /// The state in which the frame begins; `None`: nothing is built.
    pub state: Option<&'a GivenState>,
    /// The task. A frame that is to be taken apart begins as
    /// [`GivenState::built`] has it.
    pub task: Task,
    /// The world from which the physics are drawn.
    pub world: &'a World,
    /// The injected fault.
    pub fault: Option<Fault>,
}

/// Why a twin could not be made.
#[derive(Debug, thiserror::Error)]
pub enum TwinError {
    /// MuJoCo refused the scene.
    #[error("MuJoCo cannot compile the scene: {0}")]
    Scene(String),
    /// A window cannot be opened.
    #[error("cannot open a window: {0}")]
    Window(String),
    /// Meshes and textures for images cannot be loaded.
    #[error(transparent)]
    Looks(#[from] LooksError),
    /// The start has no place for a part.
    #[error("start {start}: no place for {part} is clear of all other parts, within its area and its ring")]
    NoPlace {
        /// The start.
        start: String,
        /// The part.
        part: String,
    },
    /// The scene lacks a body or site that the twin needs: the kit or the arm file is wrong.
    #[error("the scene has no {0}")]
    Missing(String),
}
