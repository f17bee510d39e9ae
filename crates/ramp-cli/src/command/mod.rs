//! The subcommands, one file each.

pub mod agent;
pub mod bench;
pub mod check;
pub mod completions;
pub mod data;
pub mod episodes;
pub mod faults;
pub mod generate;
pub mod goals;
pub mod held_out;
pub mod kit;
pub mod leaderboard;
pub mod man;
pub mod own_skill;
pub mod plan;
pub mod replay;
pub mod report;
pub mod run;
pub mod score;
pub mod see;
pub mod seeds;
pub mod show;
pub mod skills;
pub mod trials;
pub mod twin;
pub mod world;
