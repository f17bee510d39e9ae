//! The subcommands, one file each.

pub mod check;
pub mod goals;
pub mod plan;
pub mod run;
pub mod show;
pub mod twin;
