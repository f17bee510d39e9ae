//! The seven printed joint types and the few numbers they are all made from.
//!
//! Measured on the published release of the benchmark; the table stands in the documentation of the parts.

/// Width of a joint across the beam, m: a male end and the necks of a female.
pub const BODY_WIDTH: f64 = 26.6e-3;
/// Height of a female's head, m; also the height of the top plate that a seated peg's head rests on.
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
/// How far a male end reaches past its hole, m.
pub const MALE_TIP: f64 = 10.0e-3;
/// Chamfer on the four edges of a male's tip, m.
pub const MALE_CHAMFER: f64 = 1.5e-3;
/// Height of a beam's axis over the table when its females (or feet) stand on it, m.
pub const AXIS_HEIGHT: f64 = 16.6e-3;
/// Height of the axis of a beam that lies on its male joints, m.
pub const AXIS_HEIGHT_LYING: f64 = 13.3e-3;
/// Depth at which the extrusion sits in its socket, m.
pub const SOCKET_DEPTH: f64 = 20.0e-3;
/// Density of printed PLA, kg/m³.
pub const PLA_DENSITY: f64 = 1240.0;
/// Mass of one metre of extrusion, kg/m: 184.1 mm² of aluminium.
pub const EXTRUSION_MASS: f64 = 0.497;

/// The side of a beam, seen from above with j1 behind you and the last joint ahead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// +y of the beam.
    Left,
    /// −y of the beam.
    Right,
}

impl Side {
    /// +1 for left, −1 for right: the sign of y in the beam's frame.
    pub fn sign(self) -> f64 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
        }
    }
}

/// A type of joint, by the name the published files use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum JointType {
    /// `in-m-end`: a male end; its beam lies flat on the table.
    InMEnd,
    /// `in-m-end-feet`: a male end on two feet, which hold it at the height of a female's floor.
    InMEndFeet,
    /// `thru-m`: a male in the middle of a beam; the beam passes through a female.
    ThruM,
    /// `in-f-end`: a female end, open to one side and at the beam's end.
    InFEnd,
    /// `in-f`: a female in the middle of a beam, open to one side, with a stop wall.
    InF,
    /// `thru-f`: a female in the middle of a beam, open to both sides.
    ThruF,
    /// `angle-f`: a long female in the middle of a beam, open to both sides, entered at up to 40.7°.
    AngleF,
}

impl JointType {
    /// All seven, in the order of the bill of parts.
    pub const ALL: [JointType; 7] = [
        JointType::InMEnd,
        JointType::InMEndFeet,
        JointType::ThruM,
        JointType::InFEnd,
        JointType::InF,
        JointType::ThruF,
        JointType::AngleF,
    ];

    /// The name in kit files.
    pub fn name(self) -> &'static str {
        match self {
            JointType::InMEnd => "in-m-end",
            JointType::InMEndFeet => "in-m-end-feet",
            JointType::ThruM => "thru-m",
            JointType::InFEnd => "in-f-end",
            JointType::InF => "in-f",
            JointType::ThruF => "thru-f",
            JointType::AngleF => "angle-f",
        }
    }

    /// The type of that name.
    pub fn from_name(name: &str) -> Option<JointType> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Does it enter another joint?
    pub fn is_male(self) -> bool {
        matches!(self, JointType::InMEnd | JointType::InMEndFeet | JointType::ThruM)
    }

    /// Does it stand at an end of its beam?
    pub fn is_end(self) -> bool {
        matches!(self, JointType::InMEnd | JointType::InMEndFeet | JointType::InFEnd)
    }

    /// Has it an opening to one side only, so that the kit must say which?
    pub fn has_opening(self) -> bool {
        matches!(self, JointType::InF | JointType::InFEnd)
    }

    /// Distance along the beam from the peg hole to the floor of the extrusion's socket, m.
    pub fn socket_offset(self) -> f64 {
        match self {
            JointType::InMEnd | JointType::InMEndFeet => 8.6e-3,
            JointType::ThruM | JointType::InF | JointType::ThruF => 17.6e-3,
            JointType::InFEnd => 23.2e-3,
            JointType::AngleF => 33.0e-3,
        }
    }

    /// Distance along the beam from the peg hole to where the joint's outside ends and the extrusion is bare, m.
    pub fn sleeve(self) -> f64 {
        match self {
            JointType::InMEnd | JointType::InMEndFeet => 28.6e-3,
            JointType::ThruM | JointType::InF | JointType::ThruF => 37.6e-3,
            JointType::InFEnd => 43.2e-3,
            JointType::AngleF => 53.0e-3,
        }
    }

    /// Distance along the beam from the peg hole to where the gripper has room from above, m: past the tag plate
    /// of a male end, otherwise the sleeve.
    pub fn top_cover(self) -> f64 {
        match self {
            JointType::InMEnd | JointType::InMEndFeet => 55.65e-3,
            other => other.sleeve(),
        }
    }

    /// Mass of the printed part, kg: its volume in solid PLA.
    pub fn mass(self) -> f64 {
        let volume_mm3 = match self {
            JointType::InMEnd => 18906.3,
            JointType::InMEndFeet => 19021.8,
            JointType::ThruM => 34677.6,
            JointType::InFEnd => 18656.5,
            JointType::InF => 23939.9,
            JointType::ThruF => 21720.4,
            JointType::AngleF => 26636.1,
        };
        volume_mm3 * 1e-9 * PLA_DENSITY
    }
}
