//! What the tests of whole episodes share.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};

use ramp_assembly::Assembly;
use ramp_eval::result::Software;
use ramp_eval::{EpisodeResult, run_episode};
use ramp_kit::Kit;
use ramp_planner::Domains;
use ramp_robot::Track;
use ramp_robot::arm::ArmModel;
use ramp_skills::Baseline;
use ramp_twin::{Disturbance, Setup};

/// The files of one goal.
pub struct World {
    pub kit: Kit,
    pub assembly: Assembly,
    pub arm: ArmModel,
    pub domains: Domains,
}

pub fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data")
}

impl World {
    pub fn new(goal: &str) -> World {
        let kit = ramp_kit::read_kit(&data().join("kit.xml")).unwrap();
        let assembly = ramp_assembly::read_goal(&data().join(format!("goals/{goal}.xml")), &kit).unwrap();
        let arm = ArmModel::read(&data().join("arms/panda.json")).unwrap();
        let domains = Domains::read(&data().join("domains")).unwrap();
        World { kit, assembly, arm, domains }
    }

    #[allow(dead_code)]
    pub fn setup(&self, seed: u64) -> Setup<'_> {
        self.setup_on(Track::State, seed)
    }

    pub fn setup_on(&self, track: Track, seed: u64) -> Setup<'_> {
        Setup {
            kit: &self.kit,
            assembly: &self.assembly,
            arm: &self.arm,
            track,
            seed,
            disturbance: Disturbance::default(),
        }
    }

    #[allow(dead_code)]
    pub fn run(&self, seed: u64) -> EpisodeResult {
        self.run_on(Track::State, seed)
    }

    #[allow(dead_code)]
    pub fn run_on(&self, track: Track, seed: u64) -> EpisodeResult {
        let mut agent = Baseline::new(&self.kit, &self.assembly, &self.arm, &self.domains, seed);
        let software = Software { version: "test".into(), commit: "test".into() };
        run_episode(&self.setup_on(track, seed), &mut agent, &software, 1, &mut |_, _| {}).unwrap()
    }
}
