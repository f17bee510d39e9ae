//! The scene as MJCF: table, sheet, arm, beams, holders and pegs, all from the kit, the arm file and a
//! layout.
//!
//! Every flat of a part is a box, so the clearances of the parts are kept exactly. A peg hole is four boxes
//! and twelve turned boxes tangent to its circle (a 16-gon around it, at most 0.08 mm outside); the turned
//! ones are a little thinner than the plate, so that a seated head meets only the four. Parts meet the table
//! through one invisible box for each joint. For a comparison with other choices, see
//! docs/src/explanation/twin.md.

mod arm;
pub(crate) mod classes;
mod parts;
mod print;
mod shape;
mod table;
mod text;

pub use parts::PEG_MASS;

use self::arm::{actuators_and_sensors, arm_bodies};
use self::parts::{beam_body, holder_body, peg_body};
pub use self::print::Printed;
pub use self::shape::PartShape;
pub(crate) use self::table::{INTEGRATOR, LEAST_MASS, SLEEP, TABLE_SIDE};
use self::table::{header, table};
use crate::layout::Layout;
use ramp_kit::Kit;
use ramp_robot::arm::ArmModel;

/// Options of a scene that do not change its physics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneOptions {
    /// Whether the scene has the meshes that show the arm in MuJoCo's own pictures. They collide with nothing
    /// and have no mass; they cost 4 MB of memory and most of the time of the compiler.
    pub looks: bool,
    /// Memory that MuJoCo reserves for contacts and constraints, MiB. An engine that runs out of it reports
    /// an error. A whole goal uses 3 MiB in ordinary work and more when many parts are piled up.
    pub memory: u32,
}

impl Default for SceneOptions {
    /// With the arm's meshes, and 512 MiB.
    fn default() -> Self {
        SceneOptions { looks: true, memory: 512 }
    }
}

/// The MJCF text of a scene, whose parts are as they were `printed`. `base` names the beam that is clamped to
/// the table; parts that are rigid with it are fixed as well. Holders are fixed to the table, or with
/// `loose_holders` slide on it when they are pushed hard.
pub fn scene_xml(
    kit: &Kit,
    arm: &ArmModel,
    layout: &Layout,
    base: &str,
    loose_holders: bool,
    printed: &Printed,
    options: &SceneOptions,
) -> String {
    let mut xml = String::with_capacity(512 * 1024);
    let physics = printed.physics;
    // An arm without a name has no meshes.
    let look = if options.looks { arm.name.as_str() } else { "" };
    let stems = printed.stems(layout.pegs.iter().map(|(name, _)| name.as_str()));
    header(&mut xml, look, options.memory, physics, stems);
    table(&mut xml, kit, physics);
    arm_bodies(&mut xml, arm, look, physics);
    let mut meshes = String::new();
    for (name, x_wb) in &layout.beams {
        if let Some(beam) = kit.beam(name) {
            let mut part = printed.part(name);
            beam_body(&mut xml, beam, x_wb, name == base || layout.rigid.contains(name), &mut part);
            meshes.push_str(&part.meshes);
        }
    }
    for (name, x_wh) in &layout.holders {
        holder_body(&mut xml, name, x_wh, loose_holders);
    }
    for (name, x_wp) in &layout.pegs {
        peg_body(&mut xml, name, x_wp, layout.rigid.contains(name), &mut printed.part(name));
    }
    xml.push_str("</worldbody>\n");
    if !meshes.is_empty() {
        xml.push_str(&format!("<asset>\n{meshes}</asset>\n"));
    }
    actuators_and_sensors(&mut xml, arm);
    xml.push_str("</mujoco>\n");
    xml
}
