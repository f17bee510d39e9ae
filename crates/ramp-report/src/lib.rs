//! Output for readers: statistics, tables, plots, a page, a leaderboard.
//!
//! Data passes one way: a [`ramp_result::collection`] becomes a [`Report`] of lines and comparisons
//! ([`sums`]). [`page`] writes it as one HTML file with plots ([`plot`], [`curves`]), [`table`] as
//! CSV, [`paper`] as LaTeX. [`curve`] draws a single episode. [`leaderboard`] makes a site of the
//! results of many agents, and [`held_out`] commits an organiser to secret goals. [`sweep`] plots
//! results against a quantity of the world. This crate links no physics engine.

mod alone;
mod columns;
pub mod curve;
pub mod curves;
mod format;
pub mod held_out;
pub mod leaderboard;
pub mod page;
pub mod paper;
pub mod plot;
pub mod report;
mod shell;
pub mod sums;
pub mod sweep;
pub mod table;

pub use report::{Named, Report};
