//! Observations: what a policy sees, with the names of the fields that policies for DROID have.

use ramp_kit::Pose;
use ramp_robot::{Camera, ImageWidth, MOST_EXPOSURES, Observation, Robot, RobotError};
use rmpv::Value;

use crate::metadata::Metadata;
use crate::wire;

/// The widest the gripper opens, m.
pub(crate) const WIDEST: f64 = 0.08;

/// Knowledge that a policy gets beside the sensors of the robot.
#[derive(Clone, Debug)]
pub(crate) struct Told {
    /// The task, as a sentence.
    pub prompt: String,
    /// The episode, for servers that keep several apart.
    pub session: String,
    /// For a skill: where the part is, and its place, as far as the agent knows.
    pub poses: Option<[Pose; 2]>,
}

/// Takes the images that the policy sees and puts the observation together.
///
/// # Errors
/// The robot's, where there is no image.
pub(crate) fn observe(robot: &mut dyn Robot, metadata: &Metadata, told: &Told) -> Result<Value, RobotError> {
    let mut fields: Vec<(&str, Value)> = Vec::new();
    // RoboArena counts external cameras from 0. openpi's policies for DROID expect the second one.
    let external = if metadata.endpoints { "exterior_image_0_left" } else { "exterior_image_1_left" };
    let external = format!("observation/{external}");
    let now = robot.observe().time;
    if metadata.external {
        let image = picture(robot, metadata, Camera::BirdsEye, now)?;
        if metadata.ramp_fields {
            fields.extend(image.depth.map(|depth| ("ramp/exterior_depth", depth)));
        }
        fields.push((&external, image.colour));
    }
    if metadata.wrist {
        let image = picture(robot, metadata, Camera::Wrist, now)?;
        if metadata.ramp_fields {
            fields.extend(image.depth.map(|depth| ("ramp/wrist_depth", depth)));
        }
        fields.push(("observation/wrist_image_left", image.colour));
    }
    let seen = robot.observe();
    fields.extend(sensed(&seen));
    fields.push(("prompt", told.prompt.as_str().into()));
    if metadata.session {
        fields.push(("session_id", told.session.as_str().into()));
    }
    if metadata.endpoints {
        fields.push(("endpoint", "infer".into()));
    }
    if metadata.ramp_fields {
        fields.push(("ramp/time", seen.time.into()));
        fields.push(("ramp/wrench", wire::doubles(seen.wrench.as_slice())));
        fields.push(("ramp/tip_pose", wire::doubles(&seven(&seen.x_wt))));
        if let Some(touch) = &seen.touch {
            let forces = touch.fingers.map(|finger| <[f64; 3]>::from(finger.force));
            let centres = touch.fingers.map(|finger| finger.centre.unwrap_or_default());
            fields.push(("ramp/touch_force", wire::doubles(&forces.concat())));
            fields.push(("ramp/touch_centre", wire::doubles(&centres.concat())));
        }
        for (name, pose) in ["ramp/part_pose", "ramp/goal_pose"].into_iter().zip(told.poses.iter().flatten())
        {
            fields.push((name, wire::doubles(&seven(pose))));
        }
    }
    Ok(wire::map(fields))
}

/// The fields of arm and gripper.
fn sensed(seen: &Observation) -> [(&'static str, Value); 3] {
    let p = seen.x_wt.translation.vector;
    let (roll, pitch, yaw) = seen.x_wt.rotation.euler_angles();
    let closed = (1.0 - seen.width / WIDEST).clamp(0.0, 1.0);
    [
        ("observation/joint_position", wire::floats(&seen.positions)),
        ("observation/cartesian_position", wire::floats(&[p.x, p.y, p.z, roll, pitch, yaw])),
        ("observation/gripper_position", wire::floats(&[closed])),
    ]
}

/// Position and quaternion w, x, y, z.
fn seven(x: &Pose) -> [f64; 7] {
    let (p, q) = (x.translation.vector, x.rotation.quaternion());
    [p.x, p.y, p.z, q.w, q.i, q.j, q.k]
}

/// An image as a policy gets it.
struct Picture {
    colour: Value,
    /// On the track `depth`.
    depth: Option<Value>,
}

/// An image of the size that the policy wants: the whole field of view, between black bars. It is exposed
/// from robot time `now` (s) on.
fn picture(
    robot: &mut dyn Robot,
    metadata: &Metadata,
    camera: Camera,
    now: f64,
) -> Result<Picture, RobotError> {
    let model = robot.camera(camera);
    let width = metadata.image.map(|size| width_within(size, [model.height, model.width]));
    let mut image = robot.look_sized(camera, width)?;
    // Exposures from before the policy began may wait for someone to fetch them.
    for _ in 0..MOST_EXPOSURES {
        if image.time >= now {
            break;
        }
        image = robot.look_sized(camera, width)?;
    }
    let [rows, columns] = metadata.image.unwrap_or([image.height, image.width]);
    let size = [image.height, image.width];
    let depth = image
        .depth
        .as_ref()
        .map(|depth| wire::depth(columns, rows, &padded(depth.as_chunks::<1>().0, size, [rows, columns])));
    let colour = padded(image.pixels.as_chunks::<3>().0, size, [rows, columns]);
    Ok(Picture { colour: wire::image(columns, rows, colour), depth })
}

/// The largest width with which an image of a camera of `full` rows and columns fits.
fn width_within([rows, columns]: [usize; 2], full: [usize; 2]) -> ImageWidth {
    let width = columns.min(rows * full[1] / full[0]).max(ImageWidth::LEAST as usize);
    // Both sides of an image are within the limits of a width, so there is one.
    ImageWidth::new(width as u64).unwrap_or_else(ImageWidth::full)
}

/// Pixels of `N` values in the middle of black ones; both sizes are rows and columns.
fn padded<T: Copy + Default, const N: usize>(
    pixels: &[[T; N]],
    size: [usize; 2],
    [rows, columns]: [usize; 2],
) -> Vec<T> {
    let (height, width) = (size[0].min(rows), size[1].min(columns));
    let (top, left) = ((rows - height) / 2, (columns - width) / 2);
    let mut all = vec![T::default(); N * rows * columns];
    for (row, line) in pixels.chunks_exact(size[1]).take(height).enumerate() {
        all[N * ((top + row) * columns + left)..][..N * width].copy_from_slice(line[..width].as_flattened());
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_image_fits_whole_between_black_bars() {
        assert_eq!(width_within([224, 224], [800, 1280]).pixels(), 224);
        assert_eq!(width_within([180, 320], [800, 1280]).pixels(), 288);
        assert_eq!(width_within([16, 16], [800, 1280]).pixels(), 16);
        assert_eq!(width_within([1280, 1280], [800, 1280]).pixels(), 1280);
        let image = [[9; 3]; 8];
        let square = padded(&image, [2, 4], [4, 4]);
        assert_eq!(square, [vec![0; 12], vec![9; 24], vec![0; 12]].concat());
        let wide = padded(&image, [2, 4], [2, 6]);
        assert_eq!(wide[..3], [0; 3]);
        assert_eq!(wide[3..15], [9; 12]);
    }
}
