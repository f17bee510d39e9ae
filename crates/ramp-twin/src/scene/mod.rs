//! The scene as MJCF: table, sheet, arm, beams, holders and pegs, all from the kit, the arm file and a layout.
//!
//! Every flat of a part is a box, so the clearances of the parts are kept exactly. A peg hole is four boxes and
//! twelve turned boxes tangent to its circle (a 16-gon around it, at most 0.08 mm outside); the turned ones are a
//! little thinner than the plate, so that a seated head meets only the four. Parts meet the table through one
//! invisible box for each joint. What these choices are worth, and which others failed, is in docs/src/explanation/twin.md.

mod arm;
mod parts;
mod print;
mod table;
mod text;

pub use parts::PEG_MASS;

use self::arm::{actuators_and_sensors, arm_bodies};
use self::parts::{beam_body, holder_body, peg_body};
pub use self::print::Printed;
use self::table::{header, table};
use crate::layout::Layout;
use ramp_kit::Kit;
use ramp_robot::arm::ArmModel;

/// The MJCF text of a scene, whose parts are as they were `printed`. `base` names the beam that is clamped to the table. Holders are fixed to it, or with
/// `loose_holders` slide on it when they are pushed hard.
pub fn scene_xml(
    kit: &Kit,
    arm: &ArmModel,
    layout: &Layout,
    base: &str,
    loose_holders: bool,
    printed: &Printed,
) -> String {
    let mut xml = String::with_capacity(512 * 1024);
    let physics = printed.physics;
    header(&mut xml, arm, &physics.parts, printed.stems(layout.pegs.iter().map(|(name, _)| name.as_str())));
    table(&mut xml, kit, physics);
    arm_bodies(&mut xml, arm, physics);
    for (name, x_wb) in &layout.beams {
        if let Some(beam) = kit.beam(name) {
            let clamp = (name == base).then_some(physics.table.clamp_give);
            beam_body(&mut xml, beam, x_wb, clamp, &mut printed.part(name));
        }
    }
    for (name, x_wh) in &layout.holders {
        holder_body(&mut xml, name, x_wh, loose_holders);
    }
    for (name, x_wp) in &layout.pegs {
        peg_body(&mut xml, name, x_wp, &mut printed.part(name));
    }
    xml.push_str("</worldbody>\n");
    actuators_and_sensors(&mut xml, arm);
    xml.push_str("</mujoco>\n");
    xml
}
