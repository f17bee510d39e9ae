//! Arm files, as logs carry them.
#![no_main]

use std::path::Path;

use ramp_fuzz::{data_of, shows, target};
use ramp_robot::arm::ArmModel;

fn check(bytes: &[u8]) {
    if let Err(error) = ArmModel::<7>::from_json(Path::new("arm.json"), &String::from_utf8_lossy(bytes)) {
        shows(error);
    }
}

target!(data_of("arms", "json"), check);
