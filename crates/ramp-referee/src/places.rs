//! Whether a part is back in its place on the sheet: the geometry of one part at one moment.

use nalgebra::{Point3, Vector3};
use ramp_kit::{Beam, Kit, Pose};

/// Largest distance of a beam's middle from that of its outline, m. Chosen, with [`TURNED`]: the start
/// `moved` lays beams nearly as far off, and they are fetched from there.
pub const BESIDE: f64 = 10.0e-3;
/// Largest turn of a beam from its outline, rad: 6°.
pub const TURNED: f64 = 0.104_719_755_119_659_77;
/// Largest distance of a beam's end holes from their height on the table, m. Chosen: a beam that lies on
/// another part is higher.
pub const RAISED: f64 = 2.0e-3;
/// Largest distance along the table of a peg from a hole of a holder on its outline, m. Chosen: less than
/// half the distance of two holes.
pub const PEG_BESIDE: f64 = 15.0e-3;
/// Largest distance of a peg's head from the holder, m.
pub const PEG_RAISED: f64 = 1.0e-3;
/// Largest lean of a peg in a holder, rad. Chosen: in the hole of a holder it has room for less.
const LEANING: f64 = 0.1;

/// The places on the sheet where a part is back.
#[derive(Clone, Debug)]
pub(crate) enum Places {
    /// Of a beam of this span (m): the outlines of all beams of its shape, in the world.
    Beam { outlines: Vec<Pose>, span: f64 },
    /// Of a peg: every hole of every holder, in the world.
    Peg { holes: Vec<Pose> },
}

impl Places {
    /// Of a beam.
    pub(crate) fn of_beam(kit: &Kit, beam: &Beam) -> Places {
        let alike = kit.beams.iter().filter(|other| other.has_shape_of(beam));
        Places::Beam {
            outlines: alike.filter_map(|other| kit.x_wb_start(other)).collect(),
            span: beam.span(),
        }
    }

    /// Of a peg.
    pub(crate) fn of_peg(kit: &Kit) -> Places {
        Places::Peg { holes: kit.pegs.iter().filter_map(|peg| kit.x_wp_start(peg)).collect() }
    }

    /// Whether a part at this pose is in one of the places.
    pub(crate) fn holds(&self, x_wp: &Pose) -> bool {
        let axis = |x: &Pose, axis: Vector3<f64>| x.rotation * axis;
        match self {
            Places::Beam { outlines, span } => outlines.iter().any(|outline| {
                let off = |along: f64| {
                    let p = Point3::new(along, 0.0, 0.0);
                    x_wp * p - outline * p
                };
                let turned = axis(x_wp, Vector3::x()).angle(&axis(outline, Vector3::x()));
                off(span / 2.0).xy().norm() <= BESIDE
                    && turned <= TURNED
                    && [0.0, *span].iter().all(|end| off(*end).z.abs() <= RAISED)
                    && axis(x_wp, Vector3::z()).dot(&axis(outline, Vector3::z())) > 0.0
            }),
            Places::Peg { holes } => holes.iter().any(|hole| {
                let off = x_wp.translation.vector - hole.translation.vector;
                off.xy().norm() <= PEG_BESIDE
                    && off.z.abs() <= PEG_RAISED
                    && axis(x_wp, Vector3::z()).angle(&Vector3::z()) <= LEANING
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use std::path::Path;

    use nalgebra::{Translation3, UnitQuaternion};
    use ramp_assembly::Assembly;

    use super::*;

    fn assembly() -> Assembly {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
        let kit = ramp_kit::read_kit(&data.join("kit.xml")).unwrap();
        ramp_assembly::read_goal(&data.join("goals/easy-1.xml"), &kit).unwrap()
    }

    fn yaw(angle: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle)
    }

    #[test]
    fn a_beam_is_back_on_an_outline_of_its_shape_and_nowhere_else() {
        let assembly = assembly();
        let kit = &assembly.kit;
        let b1 = kit.beam("b1").unwrap();
        let places = Places::of_beam(kit, b1);
        let own = kit.x_wb_start(b1).unwrap();
        let moved = |x: f64, z: f64| Translation3::new(x, 0.0, z) * own;
        assert!(places.holds(&own) && places.holds(&moved(0.0099, 0.0019)));
        assert!(!places.holds(&moved(0.0101, 0.0)) && !places.holds(&moved(0.0, 0.0021)));
        let middle = Translation3::new(b1.span() / 2.0, 0.0, 0.0);
        let turned = |angle: f64| own * middle * yaw(angle) * middle.inverse();
        assert!(places.holds(&turned(0.1)) && !places.holds(&turned(0.11)));
        assert!(!places.holds(&turned(std::f64::consts::PI)), "its ends swapped");
        let over = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        assert!(!places.holds(&(own * over)), "upside down");
        let alike = kit.beams.iter().find(|other| other.name != "b1" && other.has_shape_of(b1)).unwrap();
        assert!(places.holds(&kit.x_wb_start(alike).unwrap()));
        let other = kit.beams.iter().find(|other| other.start.is_some() && !other.has_shape_of(b1)).unwrap();
        assert!(!places.holds(&kit.x_wb_start(other).unwrap()));
    }

    #[test]
    fn a_peg_is_back_in_any_hole_of_a_holder_and_not_beside_it() {
        let assembly = assembly();
        let kit = &assembly.kit;
        let places = Places::of_peg(kit);
        let hole = kit.x_wp_start(kit.peg("p5").unwrap()).unwrap();
        let moved = |x: f64, z: f64| Translation3::new(x, 0.0, z) * hole * yaw(1.0);
        assert!(places.holds(&hole) && places.holds(&moved(0.0149, 0.0009)));
        assert!(!places.holds(&moved(0.017, 0.0)), "between two holes");
        assert!(!places.holds(&moved(0.0, 0.03)), "on the holder");
        assert!(!places.holds(&moved(0.0, -hole.translation.z)), "on the table");
        let lean = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.6);
        assert!(!places.holds(&(hole * lean)), "leaning");
    }
}
