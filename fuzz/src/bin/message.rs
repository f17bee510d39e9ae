//! Messages of agents.
#![no_main]

use ramp_external_agent::protocol::{Request, parse};
use ramp_fuzz::{shows, target};

fn check(bytes: &[u8]) {
    let refused = match parse(bytes) {
        Ok(Request::Hello(hello)) => hello.check(),
        Ok(Request::Step(step)) => step.commands().map(|commands| {
            for (command, _) in commands {
                if let Err(error) = command.check_limits() {
                    shows(error);
                }
            }
        }),
        Ok(Request::Event(event)) => event.at(0.0).map(drop),
        Ok(Request::Plan(plan)) => plan.check(),
        Ok(_) => Ok(()),
        Err(error) => Err(error),
    };
    if let Err(error) = refused {
        shows(error);
    }
}

target!(
    [
        r#"{"hello": {"protocol": 1, "name": "fuzz", "version": "1.0"}}"#,
        r#"{"step": {"commands": [{"arm": {"joint_positions": [0, 0, 0, -1.5, 0, 1.5, 0]}, "gripper": {"width": 0.04, "force": 10}, "repeat": 20}]}}"#,
        r#"{"step": {"commands": [{"arm": {"pose": {"position": [0.4, 0, 0.3], "quat_wxyz": [0, 1, 0, 0]}}, "gripper": {"width": 0.04, "force": 10}}]}}"#,
        r#"{"step": {"commands": [{"arm": {"impedance": {"x_wt": {"position": [0.4, 0, 0.3], "quat_wxyz": [0, 1, 0, 0]}, "stiffness": [1, 1, 1, 1, 1, 1], "damping_ratio": 1, "feed_forward": [0, 0, 0, 0, 0, 0], "posture": [0, 0, 0, 0, 0, 0, 0]}}, "gripper": {"width": 0.04, "force": 10}}]}}"#,
        r#"{"observe": {}}"#,
        r#"{"look": {"camera": "birds-eye"}}"#,
        r#"{"plan": {"coarse": 3, "fine": 9, "planning": 0.1}}"#,
        r#"{"event": {"kind": "start", "what": "pick up b4"}}"#,
        r#"{"event": {"kind": "action_begun", "action": "pick_up", "item": {"beam": "b4"}, "grasp": {"link": "b4l1"}}}"#,
        r#"{"event": {"kind": "fault", "fault": "jammed", "part": "b4", "remaining": 0.003, "force": 25}}"#,
        r#"{"done": {}}"#,
    ]
    .map(|line| line.as_bytes().to_vec()),
    check
);
