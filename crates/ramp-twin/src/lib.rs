//! The digital twin (section III-E of the paper): kit, goal and seed become a [`Twin`], a robot to drive and
//! the truth for the referee.
//!
//! Data passes one way: [`layout`] disturbs the start poses from the seed; [`mjcf`] writes the MJCF; MuJoCo
//! compiles it into a `Scene`, which never changes; `State` is what changes, and [`twin`] steps it once each
//! millisecond, with the arm's controller from [`ramp_control`]. After the start only contact moves and holds
//! a part, and in an episode with a [`fault`] the force of that fault.

mod broad_phase;
pub mod cameras;
mod clamp;
pub mod drawing;
mod drive;
mod engine;
mod export;
mod extent;
pub mod fault;
mod given;
mod joint_friction;
pub mod layout;
mod line;
mod looks;
pub mod mjcf;
mod period;
mod pieces;
pub mod profile;
mod rest;
mod scene;
mod sensors;
pub mod setup;
mod shutters;
mod slow_gripper;
mod state;
mod touch;
pub mod twin;
#[cfg(feature = "view")]
pub mod view;
mod witness;

pub use drawing::{Drawing, Drawn, Renderers};
pub use export::ForMujoco;
pub use fault::{Fault, FaultError, FaultKind, FaultReport};
pub use given::{GivenState, StateFault, StateProblem};
pub use layout::Layout;
pub use mjcf::SceneOptions;
pub use ramp_world::{Start, World};
pub use setup::{Setup, TwinError};
pub use state::{Stop, controller_settings};
pub use twin::Twin;
pub use twin::served::JointReport;
pub use twin::snapshot::{RestoreError, Snapshot};
pub use witness::Moment;
