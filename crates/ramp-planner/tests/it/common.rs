//! Common helpers of the tests of plans: the goals, and the replayer.

// Every test file uses a part of this.
#![allow(dead_code)]

use ramp_assembly::{Assembly, read_goal};
use ramp_kit::{Kit, read_kit};
use ramp_planner::{CoarseStep, Domains, Refused, Replayer, State};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

pub const EASY: [&str; 3] = ["easy-1", "easy-2", "easy-3"];
pub const HARDER: [&str; 6] = ["medium-1", "medium-2", "medium-3", "hard-1", "hard-2", "hard-3"];

pub fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data")
}

pub fn kit() -> &'static Kit {
    static KIT: LazyLock<Kit> = LazyLock::new(|| read_kit(&data().join("kit.xml")).unwrap());
    &KIT
}

pub fn domains() -> &'static Domains {
    static DOMAINS: LazyLock<Domains> = LazyLock::new(|| Domains::read(&data().join("domains")).unwrap());
    &DOMAINS
}

pub fn goal(name: &str) -> Assembly {
    read_goal(&data().join(format!("goals/{name}.xml")), kit()).unwrap()
}

pub fn replay(assembly: &Assembly, state: &State, steps: &[CoarseStep]) -> Result<(), Refused> {
    Replayer::new(assembly, domains(), state).unwrap().run(steps)
}
