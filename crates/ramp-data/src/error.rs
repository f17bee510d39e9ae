//! Errors of reading the data.

use ramp_assembly::{GoalError, UnknownGoal};
use ramp_kit::KitError;
use ramp_planner::DomainError;
use ramp_robot::arm::ArmError;
use ramp_source::ReadError;
use ramp_world::WorldFault;

/// A file of the data that cannot be read, or a name that is not known.
///
/// `{}` prints one sentence, `{:#}` the same after `file:line:column`, and [`miette`] the line itself with a
/// caret.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[non_exhaustive]
pub enum DataError {
    /// A folder without a kit.
    #[error("there is no kit.xml in {folder}")]
    #[diagnostic(help(
        "`ramp data export DIR` writes the built-in kit, goals, domains and arms to a folder"
    ))]
    NoKit {
        /// The folder.
        folder: String,
    },
    /// A folder that cannot be read.
    #[error("the folder {folder} cannot be read: {source}")]
    Folder {
        /// The folder.
        folder: String,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The kit.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Kit(#[from] KitError),
    /// A goal.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Goal(#[from] GoalError),
    /// A goal's name.
    #[error(transparent)]
    #[diagnostic(transparent)]
    UnknownGoal(#[from] UnknownGoal),
    /// A set of the open class that the data does not have.
    #[error("there is no set {name} in {place}")]
    UnknownSet {
        /// The name.
        name: String,
        /// The place of the goals.
        place: String,
        /// The sets that there are.
        #[help]
        help: String,
    },
    /// The planning rules.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Domains(#[from] DomainError),
    /// The arm.
    #[error(transparent)]
    Arm(#[from] ArmError),
    /// An arm's name.
    #[error("there is no arm `{name}`")]
    #[diagnostic(help("the arms are {names}"))]
    UnknownArm {
        /// The name.
        name: String,
        /// The names of all arms.
        names: String,
    },
    /// A world file or a start file.
    #[error(transparent)]
    #[diagnostic(transparent)]
    World(#[from] WorldFault),
    /// A start's name.
    #[error("there is no start `{name}`")]
    UnknownStart {
        /// The name.
        name: String,
        /// The most similar name, or the names of all starts.
        #[help]
        help: String,
    },
    /// A world's name.
    #[error("there is no world `{name}`")]
    UnknownWorld {
        /// The name.
        name: String,
        /// The most similar name, or the names of all worlds.
        #[help]
        help: String,
    },
    /// A file that is no readable text.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Read(#[from] ReadError),
}
