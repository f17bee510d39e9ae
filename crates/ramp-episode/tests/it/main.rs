//! The integration tests of `ramp-episode`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

mod cheats;
mod diagnosis;
mod easy_class;
mod events;
mod faults;
mod given;
mod hard_world;
mod logs;
mod logs_of_cheats;
mod medium_and_hard;
mod recovery;
mod scattered;
mod stops;
mod take_apart;
mod tape;
mod torques;
mod tracks;
