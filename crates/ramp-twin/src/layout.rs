//! Start poses of all parts: those of the kit's sheet with a small random disturbance from the episode's
//! seed, so that no agent can replay a fixed motion.

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_assembly::Assembly;
use ramp_kit::Pose;
use ramp_robot::random::Stream;
use ramp_world::groups::Table;

/// Largest deviation of the start poses from the sheet's outlines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disturbance {
    /// Largest shift along each axis of the table, m.
    pub position: f64,
    /// Largest turn about the vertical, rad.
    pub angle: f64,
}

impl Default for Disturbance {
    /// 1 mm and 1°, uniform, as the benchmark prescribes.
    fn default() -> Self {
        Disturbance { position: 1.0e-3, angle: 1.0_f64.to_radians() }
    }
}

/// Start poses in the world.
#[derive(Clone, Debug)]
pub struct Layout {
    /// Each beam's frame; the clamped beam stands exactly at its place.
    pub beams: Vec<(String, Pose)>,
    /// Each holder's frame: centre of its base, at table level.
    pub holders: Vec<(String, Pose)>,
    /// Each peg's frame, standing in its holder.
    pub pegs: Vec<(String, Pose)>,
}

impl Layout {
    /// The start of the episode with this seed.
    pub fn new(assembly: &Assembly, disturbance: Disturbance, seed: u64) -> Layout {
        let mut stream = Stream::new(seed, "layout");
        let mut disturb = |x: &Pose, centre: Vector3<f64>| -> Pose {
            let shift = Translation3::new(
                stream.symmetric(disturbance.position),
                stream.symmetric(disturbance.position),
                0.0,
            );
            let turn =
                UnitQuaternion::from_axis_angle(&Vector3::z_axis(), stream.symmetric(disturbance.angle));
            let there = Translation3::from(centre);
            shift * there * turn * there.inverse() * x
        };
        let base = &assembly.beams[assembly.base];
        let kit = &assembly.kit;
        let beams = kit
            .beams
            .iter()
            .filter_map(|beam| {
                if beam.name == base.beam.name {
                    return Some((beam.name.clone(), kit.x_wa() * base.x_ab));
                }
                let x_wb = kit.x_wb_start(beam)?;
                let middle = x_wb * nalgebra::Point3::new(beam.span() / 2.0, 0.0, 0.0);
                Some((beam.name.clone(), disturb(&x_wb, middle.coords)))
            })
            .collect();
        let mut holders = Vec::new();
        let mut pegs = Vec::new();
        for holder in &kit.holders {
            let at = kit.sheet_to_world(holder.centre);
            let nominal = Pose::translation(at.x, at.y, 0.0);
            let x_wh = disturb(&nominal, at.coords);
            for peg in kit.pegs.iter().filter(|peg| peg.holder == holder.name) {
                if let Some(x_wp) = kit.x_wp_start(peg) {
                    pegs.push((peg.name.clone(), x_wh * nominal.inverse() * x_wp));
                }
            }
            holders.push((holder.name.clone(), x_wh));
        }
        Layout { beams, holders, pegs }
    }

    /// Moves all parts with a table that is too high and tilted.
    pub fn tilt(&mut self, table: &Table) {
        let x_table = x_table(table);
        if x_table == Pose::identity() {
            return;
        }
        for (_, x) in self.beams.iter_mut().chain(&mut self.holders).chain(&mut self.pegs) {
            *x = x_table * *x;
        }
    }
}

/// True pose of the table in its nominal frame.
pub(crate) fn x_table(table: &Table) -> Pose {
    let [x, y] = table.tilt;
    let lean = UnitQuaternion::from_scaled_axis(Vector3::new(x, y, 0.0));
    Pose::from_parts(Translation3::new(0.0, 0.0, table.height), lean)
}
