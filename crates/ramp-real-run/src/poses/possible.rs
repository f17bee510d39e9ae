//! Whether a measured pose is physically possible.
//!
//! The clamped beam has to be in its place whenever it is seen. Every other part lies or stands as it starts
//! when it is seen first, and is never in the table. A pose that breaks this is a mistake of units, of axes
//! or of the order of numbers, and no result is made from it.

use nalgebra::Vector3;
use ramp_kit::joint::BODY_WIDTH;
use ramp_kit::{Kit, Pose};

use super::cause::Measured;

/// Largest distance of the clamped beam from its nominal pose, m.
const CLAMPED: f64 = 10.0e-3;
/// Largest angle of the clamped beam from its nominal pose, rad: 20°. A single tag is less wrong than
/// that, and a mistaken axis or order turns the beam by 90° or more.
const TURNED: f64 = 20.0 / 180.0 * std::f64::consts::PI;
/// Largest depth of a measured point in the table, m; errors of measurement are smaller.
const IN_TABLE: f64 = 10.0e-3;
/// Smallest cosine between a part's upward axis at its first sight and the vertical: 60°.
const UPRIGHT: f64 = 0.5;

fn is_at(x_wp: &Pose, nominal: &Pose) -> bool {
    (x_wp.translation.vector - nominal.translation.vector).norm() <= CLAMPED
        && x_wp.rotation.angle_to(&nominal.rotation) <= TURNED
}

/// The questions about likely causes, or the general one.
fn ask(causes: Vec<String>, general: &str) -> String {
    if causes.is_empty() { general.to_string() } else { causes.join(" Or: ") }
}

/// Rejects a clamped beam that is not in its place. `x_wp` is its pose, from all tags so far.
pub(super) fn check_clamped(
    name: &str,
    measured: &Measured,
    x_wp: &Pose,
    nominal: &Pose,
    x_wa: &Pose,
) -> Result<(), String> {
    if is_at(x_wp, nominal) {
        return Ok(());
    }
    let off = (x_wp.translation.vector - nominal.translation.vector).norm();
    let angle = x_wp.rotation.angle_to(&nominal.rotation);
    let mut wrong = Vec::new();
    if off > CLAMPED {
        wrong.push(format!("{:.0} mm from its place", off * 1e3));
    }
    let up = |pose: &Pose| pose.rotation * Vector3::z();
    if up(x_wp).dot(&up(nominal)) < -UPRIGHT {
        wrong.push("upside down".to_string());
    } else if angle > TURNED {
        wrong.push(format!("turned by {:.0}° from its place", angle.to_degrees()));
    }
    let general = if off > CLAMPED {
        "are the poses in the frame of the robot's base? Are they in metres, and in which order are the numbers \
         of the quaternions?"
    } else {
        "in which order are the numbers of the quaternions (--quaternion), and are these the axes of the beam?"
    };
    let causes = measured.causes(x_wa, |pose| is_at(pose, nominal));
    Err(format!("{name}, which is clamped, is {}: {}", wrong.join(" and "), ask(causes, general)))
}

/// Rejects a part that is in the table, and one that does not lie or stand as it starts when it is `first`
/// seen. `goal` are the poses that the part may also have then.
pub(super) fn check_loose(
    kit: &Kit,
    name: &str,
    measured: &Measured,
    first: bool,
    goal: Option<&Pose>,
) -> Result<(), String> {
    let beam = kit.beams.iter().find(|beam| beam.name == name);
    // A beam's frame is on its axis, a peg's under its head, and a tag on a surface.
    let clearance = if beam.is_some() && measured.tag.is_none() { BODY_WIDTH / 2.0 } else { 0.0 };
    let depth = clearance - measured.at.z;
    if depth > IN_TABLE {
        return Err(format!(
            "{name} is {:.0} mm in the table: are the poses in the frame of the robot's base, whose z points up \
             and is 0 on the table?",
            depth * 1e3
        ));
    }
    if !first {
        return Ok(());
    }
    let starts: Vec<Vector3<f64>> = match beam {
        None => vec![Vector3::z()],
        Some(beam) => {
            let poses = kit.x_wb_start(beam).into_iter().chain(goal.copied());
            poses.map(|pose| pose.rotation * Vector3::z()).collect()
        }
    };
    let lies = |pose: &Pose| {
        let up = pose.rotation * Vector3::z();
        starts.is_empty() || starts.iter().any(|start| start.dot(&up) >= UPRIGHT)
    };
    let x_wp = measured.x_wp();
    let up = (x_wp.rotation * Vector3::z()).z;
    // A peg may have fallen on its side.
    if lies(&x_wp) || beam.is_none() && up > -UPRIGHT {
        return Ok(());
    }
    let how = match beam {
        None => "stands on its head",
        Some(_) if up.abs() < UPRIGHT => "stands on an edge or an end",
        Some(_) => "is upside down",
    };
    let mut causes = measured.causes(&kit.x_wa(), lies);
    // Units and places do not turn a part.
    causes.retain(|cause| cause.contains("--quaternion") || cause.contains("point"));
    let general =
        "in which order are the numbers of the quaternions (--quaternion), and where do the axes point?";
    Err(format!("{name} {how} when it is seen first: {}", ask(causes, general)))
}
