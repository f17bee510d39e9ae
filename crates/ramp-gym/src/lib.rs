//! Environments for learning: the benchmark's goals and its twelve skills as things to reset, to act in and
//! to be judged by. No Python is needed for them.
//!
//! Data passes one way. A [`Benchmark`] holds the files and plans each goal once. [`tasks`] takes the plans
//! of its goals apart into skills. A [`Scenario`] says what is to be done, on which track and in which world.
//! [`cast`] cuts the scene to what a task needs, [`ready`] lets the baseline do what comes before a skill,
//! and [`start`] keeps what came of it. An [`Env`] copies such a start, turns the numbers of a policy into
//! commands ([`action`]), lets the judges of `ramp trials` and the referee look, and rewards ([`reward`]). A
//! [`Batch`] is many of them on several threads. [`own`] puts a skill of one's own into the baseline.

pub mod action;
pub mod batch;
pub mod benchmark;
pub mod cast;
pub mod env;
pub mod known;
pub mod observe;
pub mod onlooker;
pub mod outline;
pub mod own;
pub mod pictures;
pub mod ready;
pub mod reward;
pub mod samples;
pub mod scenario;
pub mod start;
pub mod tasks;

pub use action::{ActionKind, Cartesian, Driver, Joint};
pub use batch::Batch;
pub use benchmark::{Benchmark, BenchmarkError};
pub use env::{Env, EnvError, Options, Step};
pub use onlooker::Onlooker;
pub use pictures::View;
pub use reward::{RewardTerms, Weights};
pub use samples::{Pictures, Sample, Sampler};
pub use scenario::{Begin, Frame, Mission, SKILLS, Scenario, ScenarioError};
