//! The twin's cameras: time passes while they expose, the same seed gives the same bits, and their true poses
//! differ a little from those reported to the agent.

use ramp_robot::camera::Mount;
use ramp_robot::{
    ArmCommand, Camera, Command, GripperCommand, Image, ImageWidth, MOST_EXPOSURES, Robot, RobotError, Track,
};
use ramp_testing::GoalFiles;
use ramp_twin::Twin;

const GRIPPER: GripperCommand = GripperCommand { width: 0.04, force: 10.0 };

#[test]
fn an_image_takes_time_and_is_the_same_for_a_seed() {
    let world = GoalFiles::new("easy-1");
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

/// A small image shows the same field of view, takes the same robot time, and changes nothing in the physics.
#[test]
fn a_small_image_shows_what_the_full_one_shows() {
    const FACTOR: usize = 8;
    let world = GoalFiles::new("easy-1");
    let (mut one, mut two) = (world.twin(Track::Tags, 4), world.twin(Track::Tags, 4));
    let width = ImageWidth::new(1280 / FACTOR as u64);
    for camera in Camera::ALL {
        let (full, small) = (one.look(camera).unwrap(), two.look_sized(camera, width).unwrap());
        assert_eq!((small.width, small.height), (160, 100));
        assert_eq!((small.time, small.pixels.len()), (full.time, 3 * 160 * 100));
        let mean = |row: usize, column: usize, colour: usize| {
            let block = (0..FACTOR * FACTOR).map(|it| {
                let (row, column) = (FACTOR * row + it / FACTOR, FACTOR * column + it % FACTOR);
                f64::from(full.pixels[3 * (row * full.width + column) + colour])
            });
            block.sum::<f64>() / (FACTOR * FACTOR) as f64
        };
        let off: f64 = small
            .pixels
            .iter()
            .enumerate()
            .map(|(index, own)| {
                let (pixel, colour) = (index / 3, index % 3);
                (f64::from(*own) - mean(pixel / 160, pixel % 160, colour)).abs()
            })
            .sum();
        // One sample in place of the mean of 64: edges and the sensor's noise differ.
        assert!(off / (small.pixels.len() as f64) < 8.0, "{camera:?}: {}", off / small.pixels.len() as f64);
    }
    assert_eq!(one.state_hash(), two.state_hash());
    assert_eq!(two.look(Camera::Wrist).unwrap().width, 1280, "the next one is full again");
}

/// Shutters that are opened at once follow each other at the interval of the cameras, while the arm moves.
/// The oldest image comes first, without a wait if it is there. Eight are kept: another one takes the place
/// of the oldest that is there, and is not begun if none is.
#[test]
fn exposures_go_on_while_the_arm_moves() {
    let world = GoalFiles::new("easy-1");
    let mut twin = world.twin(Track::Tags, 4);
    let wait = |twin: &mut Twin, periods: usize| {
        let hold = Command { arm: ArmCommand::JointPositions(world.arm.home), gripper: GRIPPER };
        for _ in 0..periods {
            twin.step(&hold).unwrap();
        }
    };
    let before = twin.time();
    (0..3).for_each(|_| twin.expose().unwrap());
    assert_eq!(twin.time(), before);
    wait(&mut twin, 120);
    for number in 0..3 {
        for camera in Camera::ALL {
            let image = twin.look(camera).unwrap();
            assert!((image.time - before - 0.004 - 0.033 * f64::from(number)).abs() < 1e-9);
            assert!((twin.time() - before - 0.120).abs() < 1e-9);
        }
    }
    // None waits any more: one of now.
    assert!(twin.look(Camera::Wrist).unwrap().time > before + 0.120);
    // One that is not there yet is waited for.
    twin.expose().unwrap();
    wait(&mut twin, 10);
    let now = twin.time();
    let image = twin.look(Camera::BirdsEye).unwrap();
    assert!((image.time - now + 0.006).abs() < 1e-9 && (twin.time() - image.time - 0.038).abs() < 1e-9);
    assert_eq!(twin.look(Camera::Wrist).unwrap().time, image.time);
    let now = twin.time();
    (0..=MOST_EXPOSURES).for_each(|_| twin.expose().unwrap());
    wait(&mut twin, 400);
    // The ninth was not begun, and one more takes the place of the first.
    twin.expose().unwrap();
    let mut last = now + 0.004;
    for _ in 1..MOST_EXPOSURES {
        let image = twin.look(Camera::Wrist).unwrap();
        assert!((image.time - last - 0.033).abs() < 1e-9);
        last = image.time;
    }
    assert!((twin.look(Camera::Wrist).unwrap().time - now - 0.404).abs() < 1e-9);
    let mut noisy = world.twin(Track::Noisy, 4);
    assert_eq!(noisy.expose(), Err(RobotError::NotOnTrack { track: Track::Noisy, what: "images" }));
}

/// An image of a hand that moves carries where the tip was in the middle, and is blurred; one from the same
/// place of a hand at rest is sharp.
#[test]
fn a_moving_hand_blurs_its_image() {
    let world = GoalFiles::new("easy-1");
    // Pixels in a thousand that differ from their right neighbour as only a sharp edge does: far more than by
    // noise.
    let sharpness = |image: &Image| -> f64 {
        let rows = image.pixels.chunks_exact(3 * image.width);
        let edges =
            |row: &[u8]| row.windows(4).step_by(3).filter(|pair| pair[0].abs_diff(pair[3]) > 60).count();
        1e3 * rows.map(edges).sum::<usize>() as f64 / (image.width * image.height) as f64
    };
    let seen = |speed: f64| {
        let mut twin = world.twin(Track::Tags, 4);
        let mut tips = Vec::new();
        for period in 0..300 {
            let share = (f64::from(period) / 200.0).min(1.0);
            let mut velocities = [0.0; 7];
            velocities[0] = speed * share;
            if period == 250 {
                twin.expose().unwrap();
            }
            let command = Command { arm: ArmCommand::JointVelocities(velocities), gripper: GRIPPER };
            tips.push(twin.step(&command).unwrap().x_wt);
        }
        let image = twin.look(Camera::Wrist).unwrap();
        // Four periods after the shutter opened.
        assert!((image.x_wt.translation.vector - tips[253].translation.vector).norm() < 1e-12);
        sharpness(&image)
    };
    let (still, moving) = (seen(0.0), seen(0.6));
    assert!(moving < 0.5 * still, "{moving} and {still} in a thousand");
}

#[test]
fn cameras_are_a_little_away_from_where_the_agent_is_told() {
    let world = GoalFiles::new("easy-1");
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
    let world = GoalFiles::new("easy-1");
    let mut twin = world.twin(Track::Noisy, 1);
    assert!(matches!(twin.look(Camera::Wrist), Err(RobotError::NotOnTrack { track: Track::Noisy, .. })));
    assert!(twin.read_parts().is_ok());
    let mut twin = world.twin(Track::Tags, 1);
    assert!(matches!(twin.read_parts(), Err(RobotError::NotOnTrack { track: Track::Tags, .. })));
    assert!(twin.look(Camera::BirdsEye).is_ok());
}
