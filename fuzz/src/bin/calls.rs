//! The calls in a log.
#![no_main]

use ramp_fuzz::{shows, target};
use ramp_log::calls::{Decoder, Encoder, Entry};
use ramp_robot::{ArmCommand, Camera, Command, GripperCommand, Impedance, Pose};

fn check(bytes: &[u8]) {
    let (mut entries, mut encoder) = (Vec::new(), Encoder::default());
    for entry in Decoder::new(bytes) {
        match entry {
            Ok(entry) => entries.push(entry),
            Err(error) => shows(error),
        }
    }
    // Each entry takes a byte at least.
    assert!(entries.len() <= bytes.len());
    let steps = |entry: &Entry| if let Entry::Step(_, count) = entry { *count } else { 1 };
    if entries.iter().map(steps).sum::<u64>() > 10_000 {
        return;
    }
    // Calls that are read, written and read again are the same, command by command.
    for entry in &entries {
        match entry {
            Entry::Step(command, count) => (0..*count).for_each(|_| encoder.step(command)),
            Entry::ReadParts => encoder.read_parts(),
            Entry::Look(camera) => encoder.look(*camera),
            Entry::Expose => encoder.expose(),
            Entry::Answered(hash) => encoder.answered(*hash),
            Entry::Refused => encoder.refused(),
            Entry::State(hash) => encoder.state(*hash),
        }
    }
    let again: Vec<_> = Decoder::new(&encoder.take()).filter_map(Result::ok).collect();
    let all = |entries: &[Entry]| -> u64 { entries.iter().map(steps).sum() };
    assert_eq!(all(&again), all(&entries));
}

/// Every kind of entry.
fn seed() -> Vec<u8> {
    let mut encoder = Encoder::default();
    let impedance = Impedance {
        x_wt: Pose::translation(0.4, 0.0, 0.3),
        stiffness: [100.0; 6].into(),
        damping_ratio: 1.0,
        feed_forward: [0.0; 6].into(),
        posture: [0.1; 7],
    };
    let arms = [
        ArmCommand::JointPositions([0.1; 7]),
        ArmCommand::JointVelocities([0.2; 7]),
        ArmCommand::JointTorques([0.3; 7]),
        ArmCommand::CartesianPose(Pose::translation(0.4, 0.0, 0.3)),
        ArmCommand::CartesianImpedance(impedance),
    ];
    for arm in arms {
        let command = Command { arm, gripper: GripperCommand { width: 0.04, force: 10.0 } };
        (0..3).for_each(|_| encoder.step(&command));
    }
    encoder.read_parts();
    encoder.answered(7);
    encoder.look(Camera::Wrist);
    encoder.refused();
    encoder.look(Camera::BirdsEye);
    encoder.state(9);
    encoder.take()
}

target!([seed()], check);
