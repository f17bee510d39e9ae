//! What is asked of the generator, and what it gives.

use crate::assembly::{Assembly, Class};
use crate::check::MAX_BEAMS;

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request {
    /// How many beams, the clamped one included.
    pub beams: usize,
    /// Every seed gives another goal, and always the same one.
    pub seed: u64,
    /// Of this class only.
    pub class: Option<Class>,
}

/// A generated goal.
#[derive(Clone, Debug)]
pub struct Generated {
    /// Its name, for example `hard-6-beams-17`.
    pub name: String,
    /// The text of its file.
    pub goal: String,
    /// The text of the kit file it is for, where the given kit had too few beams.
    pub kit: Option<String>,
    /// The goal, read back and checked.
    pub assembly: Assembly,
}

/// Why no goal could be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, miette::Diagnostic)]
#[non_exhaustive]
pub enum GenerateError {
    /// A number of beams that makes no goal.
    #[error("a goal has 2 to {} beams, and {found} were asked for", MAX_BEAMS)]
    Beams {
        /// How many were asked for.
        found: usize,
    },
    /// No clamped beam to begin with.
    #[error("the kit has no clamped beam (one without a start) to build a goal on")]
    NoBase,
    /// Nothing was found.
    #[error("found no {}goal of {beams} beams with the seed {seed}", class.map_or(String::new(), |class| format!("{} ", class.name())))]
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
