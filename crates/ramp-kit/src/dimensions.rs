//! The dimensions of all parts, measured on the published release.
//!
//! Four of them determine every cross-section ([`Dimensions`]); the others are specific to the
//! benchmark.

/// Width of a joint across the beam, m: a male end and the necks of a female.
pub const BODY_WIDTH: f64 = 26.6e-3;
/// Height of a female's head, m; also the height of the top plate that carries a seated peg's head.
pub const FEMALE_HEIGHT: f64 = 33.2e-3;
/// Thickness of every printed wall and plate, m.
pub const WALL: f64 = 3.0e-3;
/// Gap on each side between a male and the female around it, m.
pub const CLEARANCE: f64 = 0.3e-3;
/// Edge of the square aluminium extrusion, m.
pub const EXTRUSION: f64 = 20.0e-3;
/// Radius of every peg hole, m.
pub const HOLE_RADIUS: f64 = 4.2e-3;
/// Radius of a peg's stem, m.
pub const STEM_RADIUS: f64 = 3.95e-3;
/// Length of a peg's stem, from the underside of the head to the tip, m.
pub const STEM_LENGTH: f64 = 33.2e-3;
/// Length of the cone at the end of the stem, m.
pub const STEM_CONE: f64 = 3.0e-3;
/// Radius of the flat end of that cone, m.
pub const STEM_TIP_RADIUS: f64 = 2.45e-3;
/// Edge of the square head of a peg, m.
pub const HEAD_WIDTH: f64 = 29.0e-3;
/// Height of the head of a peg, m.
pub const HEAD_HEIGHT: f64 = 24.0e-3;
/// Radius of the rounding of all edges of the head of a peg, m.
pub const HEAD_ROUNDING: f64 = 1.0e-3;
/// Length of a male end beyond its hole, m.
pub const MALE_TIP: f64 = 10.0e-3;
/// Chamfer on the four edges of a male's tip, m.
pub const MALE_CHAMFER: f64 = 1.5e-3;
/// Height of a beam's axis over the table when it rests on its females (or feet), m.
pub const AXIS_HEIGHT: f64 = 16.6e-3;
/// Height of the axis of a beam that rests on its male joints, m.
pub const AXIS_HEIGHT_LYING: f64 = 13.3e-3;
/// Depth at which the extrusion sits in its socket, m.
pub const SOCKET_DEPTH: f64 = 20.0e-3;
/// Density of printed PLA, kg/m³.
pub const PLA_DENSITY: f64 = 1240.0;
/// Mass of one metre of extrusion, kg/m: 184.1 mm² of aluminium.
pub const EXTRUSION_MASS: f64 = 0.497;

/// Length of the tag plate that follows a male end's socket section, m.
pub const TAG_PLATE: f64 = 27.05e-3;
/// Edge of the square recess for a tag's sticker, m.
pub const TAG_RECESS: f64 = 25.5e-3;
/// Depth of the countersink and of the whole screw hole in a socket's wall, and the radii at the
/// outer face and behind the 90° cone, m.
pub(crate) const SCREW: ScrewHole = ScrewHole { cone: 2.85e-3, outer: 5.6e-3, inner: 2.75e-3 };
/// The two feet of a male end: ranges across the axis and back from the hole, m.
pub(crate) const FEET: [[f64; 2]; 2] = [[6.3e-3, 9.8e-3], [-25.6e-3, -20.6e-3]];

/// The screw hole in the wall of a socket, m.
pub(crate) struct ScrewHole {
    /// Depth of the countersink.
    pub cone: f64,
    /// Radius at the outer face.
    pub outer: f64,
    /// Radius behind the cone.
    pub inner: f64,
}

/// The four dimensions that determine the cross-sections of all parts, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dimensions {
    /// Thickness of every wall and plate.
    pub wall: f64,
    /// Gap on each side between two mating parts.
    pub clearance: f64,
    /// Edge of the square extrusion.
    pub extrusion: f64,
    /// Diameter of every peg hole.
    pub peg_hole: f64,
}

impl Dimensions {
    /// The benchmark's dimensions. The twin and all motions assume them.
    pub const BENCHMARK: Dimensions =
        Dimensions { wall: WALL, clearance: CLEARANCE, extrusion: EXTRUSION, peg_hole: 2.0 * HOLE_RADIUS };

    /// Edge of the square socket around an extrusion, m.
    pub fn socket(&self) -> f64 {
        self.extrusion + 2.0 * self.clearance
    }

    /// Edge of the square section of a male, m.
    pub fn body(&self) -> f64 {
        self.socket() + 2.0 * self.wall
    }

    /// Height of the cavity of a female, m.
    pub fn cavity(&self) -> f64 {
        self.body() + 2.0 * self.clearance
    }

    /// Height of a female's head, which is the length of a peg's stem, m.
    pub fn female_height(&self) -> f64 {
        self.cavity() + 2.0 * self.wall
    }
}
