//! Readings of parts on each track: their noise and their duration are as specified.

use nalgebra::Vector6;
use ramp_robot::{Camera, PartReading, Robot, RobotError, Track};
use ramp_testing::GoalFiles;
use ramp_twin::Twin;
use ramp_twin::twin::{READING_DROPPED, READING_NOISE, READING_STEPS};

/// Shift (m) and rotation vector (rad) of a reading against the truth of that moment.
fn error(twin: &Twin, reading: &PartReading) -> Vector6<f64> {
    let index = twin.part_names().position(|name| name == reading.part).unwrap();
    let x_wp = twin.truth().x_wp[index];
    let shift = reading.x_wp.translation.vector - x_wp.translation.vector;
    let turn = (reading.x_wp.rotation * x_wp.rotation.inverse()).scaled_axis();
    Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
}

#[test]
fn noisy_readings_have_the_noise_that_they_say() {
    let world = GoalFiles::new("easy-3");
    let mut twin = world.twin(Track::Noisy, 3);
    let parts = twin.part_names().count();
    let rounds = 400;
    let mut errors: Vec<Vector6<f64>> = Vec::new();
    for _ in 0..rounds {
        let before = twin.time();
        let readings = twin.read_parts().unwrap();
        assert!(
            (twin.time() - before - f64::from(READING_STEPS) * 1e-3).abs() < 1e-9,
            "a reading is not free"
        );
        for reading in &readings {
            assert_eq!(reading.sigma, READING_NOISE);
            errors.push(error(&twin, reading));
        }
    }
    let asked = (rounds * parts) as f64;
    let count = errors.len() as f64;
    // Four standard deviations of each statistic.
    let dropped = 1.0 - count / asked;
    let slack = 4.0 * (READING_DROPPED * (1.0 - READING_DROPPED) / asked).sqrt();
    assert!((dropped - READING_DROPPED).abs() < slack, "{dropped:.4} are missing");
    for axis in 0..6 {
        let sigma = READING_NOISE[axis / 3];
        let mean = errors.iter().map(|error| error[axis]).sum::<f64>() / count;
        let square = errors.iter().map(|error| error[axis].powi(2)).sum::<f64>() / count;
        assert!(mean.abs() < 4.0 * sigma / count.sqrt(), "axis {axis}: mean {mean:.2e}");
        assert!(
            (square.sqrt() / sigma - 1.0).abs() < 4.0 / (2.0 * count).sqrt(),
            "axis {axis}: {square:.3e}"
        );
        // Readings of different axes, and successive readings, are uncorrelated.
        let slack = 4.0 * sigma / count.sqrt();
        for other in 0..axis {
            let product = errors.iter().map(|error| error[axis] * error[other]).sum::<f64>() / count;
            assert!(product.abs() < slack * READING_NOISE[other / 3], "axes {axis} and {other}");
        }
        let next = errors.iter().zip(&errors[parts..]).map(|(a, b)| a[axis] * b[axis]).sum::<f64>() / count;
        assert!(next.abs() < slack * sigma, "axis {axis} from one reading to the next");
    }
}

#[test]
fn readings_repeat_for_a_seed_and_for_no_other() {
    let world = GoalFiles::new("easy-3");
    let read = |seed| {
        let mut twin = world.twin(Track::Noisy, seed);
        let readings: Vec<_> = (0..3).flat_map(|_| twin.read_parts().unwrap()).collect();
        (readings, twin.state_hash())
    };
    assert_eq!(read(5), read(5));
    assert_ne!(read(5).0, read(6).0);
}

#[test]
fn a_track_gives_what_it_says_and_nothing_else() {
    let world = GoalFiles::new("easy-3");
    // Exact, and at no cost.
    let mut state = world.twin(Track::State, 1);
    for reading in state.read_parts().unwrap() {
        assert!(error(&state, &reading).amax() < 1e-12, "{}", reading.part);
        assert_eq!(reading.sigma, [0.0; 2]);
    }
    assert_eq!(state.time(), 0.0);
    let refused = |track, what| RobotError::NotOnTrack { track, what };
    let mut noisy = world.twin(Track::Noisy, 1);
    for camera in Camera::ALL {
        assert_eq!(noisy.look(camera).err(), Some(refused(Track::Noisy, "images")));
    }
    let mut tags = world.twin(Track::Tags, 1);
    assert_eq!(tags.read_parts(), Err(refused(Track::Tags, "poses of parts")));
    // The request takes no robot time.
    assert!(noisy.read_parts().is_ok() && tags.observe().time == 0.0);
}
