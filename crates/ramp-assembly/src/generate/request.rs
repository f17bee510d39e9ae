//! Request and result of the generator.

use crate::assembly::{Assembly, Class};
use crate::check::MAX_BEAMS;

/// A request for a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request {
    /// Number of beams, the clamped one included.
    pub beams: usize,
    /// Each seed gives another goal, reproducibly.
    pub seed: u64,
    /// Only goals of this class.
    pub class: Option<Class>,
}

/// A generated goal.
#[derive(Clone, Debug)]
pub struct Generated {
    /// Its name, for example `hard-6-beams-17`.
    pub name: String,
    /// The text of its file.
    pub goal: String,
    /// The text of its kit file, when the given kit had too few beams.
    pub kit: Option<String>,
    /// The goal, read back and checked.
    pub assembly: Assembly,
}

/// Reasons why no goal was generated.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, miette::Diagnostic)]
#[non_exhaustive]
pub enum GenerateError {
    /// An impossible number of beams.
    #[error("a goal has 2 to {} beams, but {found} were requested", MAX_BEAMS)]
    Beams {
        /// The requested number.
        found: usize,
    },
    /// The kit has no clamped beam.
    #[error("the kit has no clamped beam (one without a start) to build a goal on")]
    NoBase,
    /// A single goal of a set of the open class.
    #[error("a set of the open class is drawn as a whole")]
    Open,
    /// No goal of the open class was found.
    #[error("found no goal of {beams} beams for the {size} part of a set")]
    #[diagnostic(help("the kit has too few parts for a set of the open class"))]
    NoOpenGoal {
        /// The number of beams.
        beams: usize,
        /// The size.
        size: &'static str,
    },
    /// The search found no goal.
    #[error("found no {}goal of {beams} beams with the seed {seed}", class.map_or(String::new(), |class| format!("{class} ")))]
    #[diagnostic(help(
        "try another seed, class or number of beams; the published kit gives easy goals of 2 to 5 beams, medium ones of 3 to 7 and hard ones of 4 to 8, and frames of 10 beams and more come with a kit of their own"
    ))]
    NotFound {
        /// The number of beams.
        beams: usize,
        /// The seed.
        seed: u64,
        /// The class.
        class: Option<Class>,
    },
}
