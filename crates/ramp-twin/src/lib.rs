//! The digital twin (section III-E of the paper): kit, goal and seed become a [`Twin`], a robot to drive and the
//! truth for the referee.
//!
//! Data passes one way: [`layout`] disturbs the start poses from the seed; [`scene`] writes the MJCF; MuJoCo
//! compiles it; [`twin`] steps it, with the arm's inner loop from [`ramp_control`] once each millisecond. After the
//! start nothing writes to a part: contact alone moves and holds it, and in an episode with a [`fault`] the force
//! of that fault.

mod broad_phase;
pub mod cameras;
mod command;
mod drive;
mod engine;
pub mod fault;
mod joint_friction;
pub mod layout;
mod line;
mod looks;
pub mod scene;
pub mod setup;
mod slow_gripper;
pub mod twin;
#[cfg(feature = "view")]
pub mod view;

pub use fault::{Fault, FaultError, FaultKind, FaultReport};
pub use layout::{Disturbance, Layout};
pub use ramp_world::World;
pub use scene::SceneOptions;
pub use setup::{Setup, TwinError};
pub use twin::Twin;
pub use twin::snapshot::{RestoreError, Snapshot};
