//! An action language: sorts, statics, fluents and actions, and laws over them.
//!
//! A text goes in, and a checked [`Domain`] comes out, or an error with file, line and column. A
//! domain can be:
//!
//! - written as an answer set program that a person can read and clingo can solve
//!   ([`Domain::to_asp`]);
//! - executed for the objects and statics of one problem, state by state, with the effects of
//!   actions, the reasons against them, and the missing goals ([`Model`]);
//! - unrolled for one problem as a ground program, step by step, without the parts that the problem
//!   cannot reach; a solver of ground rules finds plans with it ([`Unrolled`]);
//! - written as PDDL with a problem, for planners that read PDDL, whose plans are read back
//!   ([`Pddl`]).
//!
//! This crate contains no solver, and nothing specific to assembly.
//!
//! ```
//! use ramp_action_language::{Domain, Model, Refusal, SourceFile, Term};
//!
//! let text = "
//!     sort room.                          % its objects come with the problem
//!     static door(room, room).
//!     inertial fluent at(room).
//!     action go(room).
//!     go(R) causes at(R).
//!     -at(R) if at(S), R != S.            % one place at a time
//!     impossible go(R) if at(S), -door(S, R).
//! ";
//! let domain = Domain::new(&SourceFile::new("rooms.al", text), None)?;
//!
//! // As an answer set program:
//! assert!(domain.to_asp().contains("holds(at(R),t) :- occurs(go(R),t)"));
//!
//! // Carried out for two rooms with a door between them, and a third one:
//! let [hall, kitchen, attic] = ["hall", "kitchen", "attic"].map(Term::from);
//! let mut facts: Vec<Term> = [&hall, &kitchen, &attic].map(|room| Term::new("room", [room.clone()])).into();
//! facts.push(Term::new("door", [hall.clone(), kitchen.clone()]));
//! let model = Model::new(&domain, &facts);
//! let start = model.initial(&[Term::new("at", [hall.clone()])], &[]).unwrap();
//! let after = model.after(&start, &Term::new("go", [kitchen.clone()])).unwrap();
//! assert!(model.holds(&after, &Term::new("at", [kitchen])));
//! assert!(!model.holds(&after, &Term::new("at", [hall])));
//! let refused = model.after(&start, &Term::new("go", [attic])).unwrap_err();
//! let Refusal::Impossible(reason) = refused else { panic!("{refused:?}") };
//! assert_eq!(reason.law, "impossible go(R) if at(S), -door(S, R)");
//! # Ok::<(), ramp_action_language::LanguageError>(())
//! ```
//!
//! A domain passes `lex` (tokens), `parse` (statements, `ast`) and `check` (names and sorts) to
//! become a [`Domain`]. `translate`, `interpreter`, `unroll`, `pddl` and `strips` are its
//! five uses. The
//! language is one of the AL_d family (M. Gelfond, D. Inclezan, *Some properties of system
//! descriptions of AL_d*, Journal of Applied Non-Classical Logics 23, 2013);
//! `docs/src/reference/action-language.md` describes every construct.

mod ast;
mod check;
mod domain;
mod interpreter;
mod lex;
mod parse;
mod pddl;
mod problem;
mod strips;
mod term;
mod translate;
mod unroll;

pub use domain::{Domain, FluentKind, Kind};
pub use interpreter::{Model, Reason, Refusal, State};
pub use pddl::{Pddl, PddlError};
pub use problem::{LanguageError, LanguageProblem};
pub use ramp_source::SourceFile;
pub use strips::Strips;
pub use term::Term;
pub use unroll::{GroundRule, Literal, Prospect, Unrolled};
