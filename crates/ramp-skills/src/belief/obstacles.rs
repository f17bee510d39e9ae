//! Parts as boxes, for the check of collisions.

use ramp_kit::shape::{Cuboid, Shape, beam_shapes, peg_head};
use ramp_kit::{Beam, Holder, Kit, joint};
use ramp_motion::Obstacle;

use crate::Pose;

/// The boxes of a beam whose pose is `x_wb`, in the same frame.
pub fn beam_boxes(beam: &Beam, x_wb: &Pose) -> Vec<Obstacle> {
    let cuboids = beam_shapes(beam).into_iter().map(cuboid_of);
    cuboids.map(|cuboid| obstacle(&beam.name, x_wb, &cuboid)).collect()
}

/// The boxes of a peg whose pose is `x_wp`, in the same frame.
pub fn peg_boxes(peg: &str, x_wp: &Pose) -> [Obstacle; 2] {
    [obstacle(peg, x_wp, &peg_head()), obstacle(peg, x_wp, &peg_stem())]
}

/// The boxes of the holders, with their names and poses in the world.
pub fn holder_boxes(holders: &[(String, Pose)]) -> Vec<Obstacle> {
    let boxes = |(name, x): &(String, Pose)| Holder::blocks().map(|block| obstacle(name, x, &block));
    holders.iter().flat_map(boxes).collect()
}

/// The boxes of a part that the hand holds, in the tip's frame, given its pose there.
pub fn held_boxes(kit: &Kit, part: &str, x_tp: &Pose) -> Vec<Obstacle> {
    match kit.beam(part) {
        Some(beam) => beam_boxes(beam, x_tp),
        None => peg_boxes(part, x_tp).to_vec(),
    }
}

/// The stem of a peg as a box in the peg's frame.
fn peg_stem() -> Cuboid {
    let r = joint::STEM_RADIUS;
    Cuboid::new([-r, r], [-r, r], [-joint::STEM_LENGTH, 0.0])
}

fn cuboid_of(shape: Shape) -> Cuboid {
    match shape {
        Shape::Solid(cuboid) | Shape::Plate { cuboid, .. } | Shape::Foot(cuboid) => cuboid,
        Shape::Nose { x0, x1 } => {
            let w = joint::BODY_WIDTH / 2.0;
            Cuboid::new([x0, x1], [-w, w], [-w, w])
        }
        turned @ Shape::Turned { .. } => turned.bounds(),
    }
}

fn obstacle(name: &str, x_wp: &Pose, cuboid: &Cuboid) -> Obstacle {
    let [x, y, z] = cuboid.centre();
    Obstacle { name: name.to_string(), x: x_wp * nalgebra::Translation3::new(x, y, z), half: cuboid.half() }
}
