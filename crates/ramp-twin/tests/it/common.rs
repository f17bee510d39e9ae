//! A world to put a twin into: the kit, a goal and the arm, as they lie in `data`.

use std::path::Path;

use ramp_assembly::Assembly;
use ramp_kit::Kit;
use ramp_robot::Track;
use ramp_robot::arm::ArmModel;
use ramp_twin::{Disturbance, Setup, Twin};

pub struct World {
    pub kit: Kit,
    pub assembly: Assembly,
    pub arm: ArmModel,
}

impl World {
    pub fn new(goal: &str) -> World {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
        let kit = ramp_kit::read_kit(&data.join("kit.xml")).unwrap();
        let assembly = ramp_assembly::read_goal(&data.join(format!("goals/{goal}.xml")), &kit).unwrap();
        let arm = ArmModel::read(&data.join("arms/panda.json")).unwrap();
        World { kit, assembly, arm }
    }

    #[allow(dead_code)] // Each test binary compiles this file, and not all of them put a twin into another world.
    pub fn twin_in(&self, world: &ramp_twin::World, seed: u64) -> Twin {
        self.build(Track::State, seed, world)
    }

    #[allow(dead_code)]
    pub fn twin(&self, track: Track, seed: u64) -> Twin {
        self.build(track, seed, ramp_twin::World::ideal())
    }

    fn build(&self, track: Track, seed: u64, world: &ramp_twin::World) -> Twin {
        let (kit, assembly, arm) = (&self.kit, &self.assembly, &self.arm);
        let disturbance = Disturbance::default();
        Twin::new(&Setup { kit, assembly, arm, track, seed, disturbance, world, fault: None }).unwrap()
    }
}
