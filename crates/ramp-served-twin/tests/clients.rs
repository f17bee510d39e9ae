//! Clients in Python: Franka's own, `pylibfranka`, and `panda-python` around libfranka 0.9.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

#[path = "it/served.rs"]
#[allow(dead_code, reason = "shared with the other tests, which use more of it")]
mod served;

use std::net::SocketAddr;
use std::process::{Command, ExitCode};

use nalgebra::{SMatrix, SVector};
use ramp_control::StateModel;
use ramp_franka_model as _;
use ramp_robot::Track;
use ramp_served_twin::{FciVersion, Pace};
use ramp_testing::trials::{check_unless, run};

use crate::served::{Served, goal_for, ideal};

/// The port at which Franka's libraries look for an arm.
const ARM_PORT: u16 = 1337;
/// How far numbers of two models may be apart, in their own units: rounding.
const ROUNDING: f64 = 1e-9;

/// Moves the arm, and prints what its model says where it ends.
const PANDA: &str = r#"
import json, sys
import numpy as np
import panda_py
from panda_py import libfranka
panda = panda_py.Panda(sys.argv[1])
goal = panda.q.copy()
goal[0] += 0.3
goal[3] += 0.2
moved = bool(panda.move_to_joint_position(goal))
state = panda.get_state()
model = panda.get_model()
print(json.dumps({
    "moved": moved,
    "off": float(np.abs(panda.q - goal).max()),
    "q": list(state.q),
    "gravity": list(model.gravity(state)),
    "jacobian": list(model.zero_jacobian(libfranka.Frame.kEndEffector, state)),
    "mass": list(model.mass(state)),
}))
"#;

/// Reads states, then turns a joint by torques for half a second.
const PYLIBFRANKA: &str = r#"
import json, sys
import pylibfranka
robot = pylibfranka.Robot(sys.argv[1], pylibfranka.RealtimeConfig.kIgnore)
first = robot.read_once()
second = robot.read_once()
control = robot.start_torque_control()
begin, turned, cycles = list(first.q), 0.0, 0
while True:
    state, duration = control.readOnce()
    cycles += 1
    turned = state.q[3] - begin[3]
    share = min(cycles / 300, 1.0)
    goal = list(begin)
    goal[3] += 0.05 * share * share * (3 - 2 * share)
    command = pylibfranka.Torques([
        stiffness * (goal[joint] - state.q[joint]) - damping * state.dq[joint]
        for joint, (stiffness, damping) in enumerate(zip(
            [600, 600, 600, 600, 250, 150, 50], [50, 50, 50, 50, 30, 25, 15]))
    ])
    if cycles == 500:
        command.motion_finished = True
        control.writeOnce(command)
        break
    control.writeOnce(command)
print(json.dumps({"turned": turned, "apart": round(1e3 * (second.time.to_sec() - first.time.to_sec()))}))
"#;

/// The reason why `python3` has no such module.
fn without(module: &str) -> Option<String> {
    let import = Command::new("python3").args(["-c", &format!("import {module}")]).output();
    let there = import.is_ok_and(|output| output.status.success());
    (!there).then(|| format!("python3 has no {module}"))
}

/// What a script prints that talks to the served twin.
fn answer(script: &str, served: &Served) -> serde_json::Value {
    let address = served.address.ip().to_string();
    let output = Command::new("python3").args(["-c", script, &address]).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let text = String::from_utf8_lossy(&output.stdout);
    serde_json::from_str(text.lines().last().unwrap()).unwrap()
}

fn numbers<const N: usize>(value: &serde_json::Value) -> [f64; N] {
    serde_json::from_value::<Vec<f64>>(value.clone()).unwrap().try_into().unwrap()
}

/// A served twin at the port of a real arm, which these clients cannot change: at an address of its own on
/// the loopback interface, so that checks can run side by side.
fn served(version: FciVersion) -> Served {
    let [low, high] = (std::process::id() as u16).to_le_bytes();
    let addresses = (2..=254).map(move |own| SocketAddr::from(([127, high, low, own], ARM_PORT)));
    Served::at(addresses, version, ideal(), Track::State, Pace::LockStep)
}

fn panda_python_moves_the_arm_with_a_downloaded_model() {
    let said = answer(PANDA, &served(FciVersion::V5));
    assert_eq!(said["moved"], true);
    let off = said["off"].as_f64().unwrap();
    assert!(off < 0.02, "{off} rad from the goal");
    let q = SVector::from(numbers::<7>(&said["q"]));
    let own = StateModel::new(&goal_for(FciVersion::V5, "easy-1").arm, SVector::zeros());
    let same = own.state(&q, &SVector::zeros());
    let jacobian = SMatrix::<f64, 6, 7>::from_column_slice(&numbers::<42>(&said["jacobian"]));
    let mass = SMatrix::<f64, 7, 7>::from_column_slice(&numbers::<49>(&said["mass"]));
    assert!((SVector::from(numbers::<7>(&said["gravity"])) - own.weight(&q)).amax() < ROUNDING);
    assert!((jacobian - same.jacobian).amax() < ROUNDING);
    assert!((mass - same.inertia).amax() < ROUNDING);
}

fn pylibfranka_reads_the_state_and_runs_a_torque_loop() {
    let said = answer(PYLIBFRANKA, &served(FciVersion::V10));
    assert_eq!(said["apart"], 1, "states of successive milliseconds");
    let turned = said["turned"].as_f64().unwrap();
    assert!((turned - 0.05).abs() < 0.005, "{turned} rad");
}

fn main() -> ExitCode {
    run(vec![
        check_unless(
            "panda_python_moves_the_arm_with_a_downloaded_model",
            || without("panda_py"),
            panda_python_moves_the_arm_with_a_downloaded_model,
        ),
        check_unless(
            "pylibfranka_reads_the_state_and_runs_a_torque_loop",
            || without("pylibfranka"),
            pylibfranka_reads_the_state_and_runs_a_torque_loop,
        ),
    ])
}
