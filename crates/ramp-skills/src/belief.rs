//! Where the agent believes the parts to be: what the robot let it read last.

use std::collections::BTreeMap;

use nalgebra::Point3;
use ramp_assembly::{Assembly, Connection, JointRef};
use ramp_kit::Kit;
use ramp_kit::shape::{Cuboid, Shape, beam_shapes, peg_head};
use ramp_kit::{Holder, joint};
use ramp_motion::Obstacle;
use ramp_robot::RobotError;

use crate::Pose;
use crate::fault::{Fault, SkillError};
use crate::hand::Hand;

/// Part poses in the world, by name.
#[derive(Clone, Debug, Default)]
pub struct Belief {
    x_wp: BTreeMap<String, Pose>,
}

impl Belief {
    /// Reads the parts anew; what is not seen keeps its last pose.
    ///
    /// # Errors
    /// The robot's.
    pub fn update(&mut self, hand: &mut Hand) -> Result<(), RobotError> {
        for reading in hand.look()? {
            self.x_wp.insert(reading.part, reading.x_wp);
        }
        Ok(())
    }

    /// Where a part is.
    ///
    /// # Errors
    /// [`Fault::Unseen`].
    pub fn pose(&self, part: &str) -> Result<Pose, SkillError> {
        self.x_wp.get(part).copied().ok_or_else(|| Fault::Unseen { part: part.to_string() }.into())
    }

    /// Where the hole of a joint is: on the beam's axis, in the world.
    ///
    /// # Errors
    /// [`Fault::Unseen`].
    pub fn hole(&self, assembly: &Assembly, joint: JointRef) -> Result<Point3<f64>, SkillError> {
        let beam = &assembly.beams[joint.beam].beam;
        Ok(self.pose(&beam.name)? * beam.p_b_hole(joint.joint))
    }

    /// Horizontal distance between the two holes of a connection, m.
    ///
    /// # Errors
    /// [`Fault::Unseen`].
    pub fn offset(&self, assembly: &Assembly, connection: &Connection) -> Result<f64, SkillError> {
        let female = self.hole(assembly, connection.female)?;
        let male = self.hole(assembly, connection.male)?;
        Ok((female.xy() - male.xy()).norm())
    }

    /// Everything that stands around, as boxes in the world, without the parts named in `without`.
    pub fn obstacles(&self, kit: &Kit, without: &[&str]) -> Vec<Obstacle> {
        let mut obstacles = Vec::new();
        let left_out = |name: &str| without.contains(&name);
        for beam in kit.beams.iter().filter(|beam| !left_out(&beam.name)) {
            if let Some(x_wb) = self.x_wp.get(&beam.name) {
                let cuboids = beam_shapes(beam).into_iter().map(cuboid_of);
                obstacles.extend(cuboids.map(|cuboid| obstacle(&beam.name, x_wb, &cuboid)));
            }
        }
        for peg in kit.pegs.iter().filter(|peg| !left_out(&peg.name)) {
            if let Some(x_wp) = self.x_wp.get(&peg.name) {
                obstacles.push(obstacle(&peg.name, x_wp, &peg_head()));
                obstacles.push(obstacle(&peg.name, x_wp, &peg_stem()));
            }
        }
        for holder in &kit.holders {
            let at = kit.sheet_to_world(holder.centre);
            let x = Pose::translation(at.x, at.y, 0.0);
            let [length, width] = Holder::BASE;
            let foot = Cuboid::new([-length / 2.0, length / 2.0], [-width / 2.0, width / 2.0], [0.0, 0.018]);
            let bar = Cuboid::new([-length / 2.0, length / 2.0], [-0.0125, 0.0125], [0.0, Holder::HEIGHT]);
            obstacles.push(obstacle(&holder.name, &x, &foot));
            obstacles.push(obstacle(&holder.name, &x, &bar));
        }
        obstacles
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

/// The boxes of a part that the hand holds, in the tip's frame, given its pose there.
pub fn held_boxes(kit: &Kit, part: &str, x_tp: &Pose) -> Vec<Obstacle> {
    if let Some(beam) = kit.beam(part) {
        beam_shapes(beam).into_iter().map(|shape| obstacle(part, x_tp, &cuboid_of(shape))).collect()
    } else {
        vec![obstacle(part, x_tp, &peg_head()), obstacle(part, x_tp, &peg_stem())]
    }
}
