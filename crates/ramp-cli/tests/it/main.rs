//! The integration tests of `ramp-cli`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

mod agents;
mod alone;
mod bench;
mod built_in;
mod docs;
mod faults;
mod kit;
mod machine;
mod names;
mod own;
mod plan;
mod ramp;
mod reference;
mod replay;
mod report;
mod secret;
mod see;
mod skills;
mod world;
