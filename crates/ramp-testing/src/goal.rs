//! The files of a goal, read, and a twin of it.

use ramp_assembly::{Assembly, Task};
use ramp_robot::Track;
use ramp_robot::arm::ArmModel;
use ramp_twin::{Setup, Start, Twin, World};

use crate::data;

/// The files of one goal of the benchmark.
pub struct GoalFiles {
    /// The goal, with its kit.
    pub assembly: Assembly,
    /// The Panda.
    pub arm: ArmModel,
}

impl GoalFiles {
    /// Reads the kit, the arm and the goal of this name.
    #[must_use]
    pub fn new(goal: &str) -> GoalFiles {
        let kit = ramp_kit::read_kit(&data().join("kit.xml")).unwrap();
        let assembly = ramp_assembly::read_goal(&data().join(format!("goals/{goal}.xml")), &kit).unwrap();
        let arm = ArmModel::read(&data().join("arms/panda.json")).unwrap();
        GoalFiles { assembly, arm }
    }

    /// An episode in the world `ideal` from the start `sheet`, without a fault.
    #[must_use]
    pub fn setup(&self, track: Track, seed: u64) -> Setup<'_> {
        Setup {
            assembly: &self.assembly,
            arm: &self.arm,
            track,
            seed,
            start: Start::sheet(),
            world: World::ideal(),
            state: None,
            task: Task::Build,
            fault: None,
        }
    }

    /// A twin in the world `ideal`.
    #[must_use]
    pub fn twin(&self, track: Track, seed: u64) -> Twin {
        Twin::new(&self.setup(track, seed)).unwrap()
    }

    /// A twin in a world, on the track `state`.
    #[must_use]
    pub fn twin_in(&self, world: &World, seed: u64) -> Twin {
        Twin::new(&Setup { world, ..self.setup(Track::State, seed) }).unwrap()
    }
}
