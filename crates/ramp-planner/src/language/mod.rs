//! The action language of `data/domains/*.al`: sorts, statics, fluents and actions, and laws over them.
//!
//! A domain goes through four steps, one module each: `lex` cuts the text into words, `parse` makes statements of
//! them, `check` finds the sort of every variable and refuses what means nothing, and [`Domain`] is the outcome.
//! From there it goes two ways: `translate` writes it as a program for clingo that a person can read, and `ground`
//! carries it out directly, state by state, for the replayer, the diagnosis and the explanations. What the planner
//! solves is the same program for one problem, unrolled step by step without what that problem cannot reach
//! (`ground::unroll`); a test holds the two against each other.
//!
//! The language is one of the AL_d family (M. Gelfond, D. Inclezan, *Some properties of system descriptions of
//! AL_d*, Journal of Applied Non-Classical Logics 23, 2013); `docs/src/reference/action-language.md` describes every construct.

pub(crate) mod ast;
pub(crate) mod check;
pub(crate) mod ground;
mod lex;
mod parse;
mod problem;
mod translate;

pub use check::Domain;
pub(crate) use check::{FluentKind, Kind};
pub use problem::{LanguageError, LanguageProblem};
