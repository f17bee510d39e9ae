//! The twin's cameras: time passes while they expose, the same seed gives the same bits, and they are not quite where
//! the agent is told.

#![allow(clippy::unwrap_used)] // A test that cannot go on may stop.

mod common;

use common::World;
use ramp_robot::camera::Mount;
use ramp_robot::{Camera, Robot, RobotError, Track};

#[test]
fn an_image_takes_time_and_is_the_same_for_a_seed() {
    let world = World::new("easy-1");
    let (mut one, mut two) = (world.twin(Track::Tags, 4), world.twin(Track::Tags, 4));
    let tip = one.observe().x_wt;
    let before = one.time();
    // Both cameras are exposed together; the same one again takes its time.
    for (camera, moments) in [(Camera::Wrist, 1.0), (Camera::BirdsEye, 1.0), (Camera::BirdsEye, 2.0)] {
        let image = one.look(camera).unwrap();
        let there = before + 0.042 * moments;
        assert!((image.time - there + 0.038).abs() < 1e-9, "{}", image.time - before);
        assert!((one.time() - there).abs() < 1e-9, "{}", one.time() - before);
        assert!(image == two.look(camera).unwrap());
    }
    // The arm stayed where it was, and the physics is the same too.
    assert!((one.observe().x_wt.translation.vector - tip.translation.vector).norm() < 1e-3);
    assert_eq!(one.state_hash(), two.state_hash());
    // Two images of one camera differ by their noise.
    assert_ne!(one.look(Camera::Wrist).unwrap().pixels, two.look(Camera::BirdsEye).unwrap().pixels);
}

#[test]
fn cameras_are_a_little_away_from_where_the_agent_is_told() {
    let world = World::new("easy-1");
    let mut seen = Vec::new();
    for seed in 1..40 {
        let twin = world.twin(Track::State, seed);
        for camera in Camera::ALL {
            let place = |mount: Mount| match mount {
                Mount::Tip(x) | Mount::World(x) => x,
            };
            let error = place(twin.camera(camera).mount).inverse() * place(twin.true_camera(camera).mount);
            let shift = error.translation.vector;
            let turn = error.rotation.scaled_axis();
            seen.extend((0..3).map(|axis| [shift[axis] * 1e3, turn[axis].to_degrees()]));
        }
    }
    // Standard deviations of 0.5 mm and 0.2° along each axis.
    let spread =
        |index: usize| (seen.iter().map(|v| v[index] * v[index]).sum::<f64>() / seen.len() as f64).sqrt();
    assert!((0.42..0.58).contains(&spread(0)), "{} mm", spread(0));
    assert!((0.17..0.23).contains(&spread(1)), "{} degrees", spread(1));
}

#[test]
fn the_noisy_track_has_no_images_and_goes_on() {
    let world = World::new("easy-1");
    let mut twin = world.twin(Track::Noisy, 1);
    assert!(matches!(twin.look(Camera::Wrist), Err(RobotError::NotOnTrack { track: Track::Noisy, .. })));
    assert!(twin.read_parts().is_ok());
    let mut twin = world.twin(Track::Tags, 1);
    assert!(matches!(twin.read_parts(), Err(RobotError::NotOnTrack { track: Track::Tags, .. })));
    assert!(twin.look(Camera::BirdsEye).is_ok());
}
