//! The kit as data: beams with their joints and links, pegs, holders, and their start poses on the
//! sheet.

use crate::cuboid::Cuboid;
use crate::dimensions::{AXIS_HEIGHT, AXIS_HEIGHT_LYING, Dimensions};
use crate::joint::{JointType, Side};
use crate::pose::Pose;
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};

/// Everything on the table at the start of an episode.
#[derive(Clone, Debug)]
pub struct Kit {
    /// The beams, in the order of the file.
    pub beams: Vec<Beam>,
    /// The pegs, in the order of the file; three stand in each holder.
    pub pegs: Vec<Peg>,
    /// The peg holders.
    pub holders: Vec<Holder>,
    /// The printed sheet the parts start on.
    pub sheet: Sheet,
    /// Position of the assembly frame A in the world, m: the j1 hole of the clamped beam, at table level.
    pub base_xy: [f64; 2],
    /// The four dimensions of the printed parts.
    pub dimensions: Dimensions,
}

/// One beam: joints j1..jn along its axis, with a piece of extrusion (a link) between neighbours.
///
/// Its frame B has its origin at the j1 hole on the beam's axis, +x towards the last joint, +z up.
#[derive(Clone, Debug, PartialEq)]
pub struct Beam {
    /// For example `b4`.
    pub name: String,
    /// From j1 to jn.
    pub joints: Vec<Joint>,
    /// From l1 to l(n−1); link k joins joints k and k+1.
    pub links: Vec<Link>,
    /// Its start pose on the sheet; `None` for the beam that is clamped to the table.
    pub start: Option<StartPose>,
}

/// A printed joint of a beam.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// For example `b4j2`.
    pub name: String,
    /// Its type.
    pub kind: JointType,
    /// Distance of its hole from the j1 hole along the beam, m.
    pub offset: f64,
    /// The side an `in-f` or `in-f-end` opens to; `None` for every other type.
    pub opens: Option<Side>,
    /// The id of its AprilTag (family tag25h9), if it has one.
    pub tag: Option<u32>,
}

/// A piece of extrusion between two joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// For example `b4l1`.
    pub name: String,
    /// Distance between the socket floors at its two ends, m.
    pub length: f64,
    /// The range, in m from the j1 hole, in which the gripper may close from above.
    pub grasp: [f64; 2],
}

/// A peg, in slot −1, 0 or +1 of a holder.
#[derive(Clone, Debug, PartialEq)]
pub struct Peg {
    /// For example `p1`.
    pub name: String,
    /// The id of its AprilTag (family tag25h9).
    pub tag: u32,
    /// The holder it starts in.
    pub holder: String,
    /// −1, 0 or +1: its hole along x of the holder.
    pub slot: i32,
}

/// A peg holder with three holes.
#[derive(Clone, Debug, PartialEq)]
pub struct Holder {
    /// For example `h1`.
    pub name: String,
    /// Centre on the sheet, m, in the sheet's frame.
    pub centre: [f64; 2],
}

/// The A2 sheet. Its frame: origin at the top left corner, x right, y down; sheet x is world x,
/// sheet y is −world y.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Width (x) and height (y), m.
    pub size: [f64; 2],
    /// Position of the sheet's top left corner in the world, m.
    pub corner: [f64; 2],
    /// Centre of the sheet's own tag (id 0, its top towards the sheet's top), m.
    pub tag: [f64; 2],
    /// Length of that tag's black edge, m.
    pub tag_edge: f64,
}

impl Default for Sheet {
    /// The benchmark's: A2, in front of the robot to its left.
    fn default() -> Sheet {
        let (size, corner) = ([0.594, 0.420], [0.053, 0.600]);
        Sheet { size, corner, tag: [0.52458, 0.32045], tag_edge: 0.0755 }
    }
}

/// The start pose of a beam, by its j1 hole; all beams lie along +x of the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StartPose {
    /// Position of the j1 hole on the sheet, m.
    pub at: [f64; 2],
    /// Rotated by 180° about its own axis.
    pub flipped: bool,
}

impl Kit {
    /// The beam of that name.
    pub fn beam(&self, name: &str) -> Option<&Beam> {
        self.beams.iter().find(|beam| beam.name == name)
    }

    /// The peg of that name.
    pub fn peg(&self, name: &str) -> Option<&Peg> {
        self.pegs.iter().find(|peg| peg.name == name)
    }

    /// A point of the sheet in the world, at table level, m.
    pub fn sheet_to_world(&self, at: [f64; 2]) -> Point3<f64> {
        Point3::new(self.sheet.corner[0] + at[0], self.sheet.corner[1] - at[1], 0.0)
    }

    /// The assembly frame A in the world W: origin at table level under the clamped beam's j1 hole,
    /// X towards −y of the world, Y towards +x, Z up.
    pub fn x_wa(&self) -> Pose {
        Pose::from_parts(
            Translation3::new(self.base_xy[0], self.base_xy[1], 0.0),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -std::f64::consts::FRAC_PI_2),
        )
    }

    /// The nominal pose of a beam on the sheet, in the world; `None` for the clamped beam.
    pub fn x_wb_start(&self, beam: &Beam) -> Option<Pose> {
        let start = beam.start?;
        let at = self.sheet_to_world(start.at);
        let roll = if start.flipped { std::f64::consts::PI } else { 0.0 };
        Some(Pose::from_parts(
            Translation3::new(at.x, at.y, beam.axis_height_on_table()),
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), roll),
        ))
    }

    /// The nominal pose of a peg in its holder, in the world. A peg's frame P: origin at the centre
    /// of the head's underside, +z up, the stem towards −z.
    ///
    /// `None` when the kit has no such holder.
    pub fn x_wp_start(&self, peg: &Peg) -> Option<Pose> {
        let holder = self.holders.iter().find(|holder| holder.name == peg.holder)?;
        let centre = self.sheet_to_world(holder.centre);
        Some(Pose::translation(centre.x + f64::from(peg.slot) * Holder::PITCH, centre.y, Holder::HEIGHT))
    }
}

impl Holder {
    /// Distance between neighbouring holes, m.
    pub const PITCH: f64 = 34.0e-3;
    /// Height of the bar that carries the heads, m.
    pub const HEIGHT: f64 = 37.2e-3;
    /// Length (x) and width (y) of its base, m.
    pub const BASE: [f64; 2] = [103.0e-3, 40.0e-3];

    /// Its volume, in a frame at its centre on the table, z up, m: foot and bar.
    pub fn blocks() -> [Cuboid; 2] {
        let [x, y] = Holder::BASE.map(|edge| edge / 2.0);
        [
            Cuboid::new([-x, x], [-y, y], [0.0, 18.0e-3]),
            Cuboid::new([-x, x], [-12.5e-3, 12.5e-3], [0.0, Holder::HEIGHT]),
        ]
    }
}

impl Beam {
    /// Distance from the j1 hole to the hole of the last joint, m.
    pub fn span(&self) -> f64 {
        self.joints.last().map_or(0.0, |joint| joint.offset)
    }

    /// Whether it differs from another beam in its names, its tags and its place only.
    pub fn has_shape_of(&self, other: &Beam) -> bool {
        let joints = |beam: &Beam| -> Vec<_> {
            beam.joints
                .iter()
                .map(|joint| (joint.kind, joint.offset, joint.opens, joint.tag.is_some()))
                .collect()
        };
        let links = |beam: &Beam| -> Vec<f64> { beam.links.iter().map(|link| link.length).collect() };
        let flipped = |beam: &Beam| beam.start.map(|start| start.flipped);
        joints(self) == joints(other) && links(self) == links(other) && flipped(self) == flipped(other)
    }

    /// Whether it has the joints of another beam in the same places, whatever the sides to which these open.
    pub fn has_joints_of(&self, other: &Beam) -> bool {
        let joints = |beam: &Beam| beam.joints.iter().map(|it| (it.kind, it.offset)).collect::<Vec<_>>();
        joints(self) == joints(other)
    }

    /// The index of the joint of that name.
    pub fn joint_index(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }

    /// Mass, kg: printed joints in solid PLA and the extrusions.
    pub fn mass(&self) -> f64 {
        let printed: f64 = self.joints.iter().map(|joint| joint.kind.mass()).sum();
        let extruded: f64 =
            self.links.iter().map(|link| link.length * crate::dimensions::EXTRUSION_MASS).sum();
        printed + extruded
    }

    /// Whether females or feet hold it at its assembled height. An all-male beam lies lower.
    pub fn stands_at_assembled_height(&self) -> bool {
        self.joints.iter().any(|joint| !joint.kind.is_male() || joint.kind.form().feet)
    }

    /// Height of its axis when it lies on the table, m.
    pub fn axis_height_on_table(&self) -> f64 {
        if self.stands_at_assembled_height() { AXIS_HEIGHT } else { AXIS_HEIGHT_LYING }
    }

    /// The hole of joint `index` in the beam's frame, on the axis, m.
    pub fn p_b_hole(&self, index: usize) -> Point3<f64> {
        Point3::new(self.joints[index].offset, 0.0, 0.0)
    }

    /// Distance from j1 to the end that is further from joint `index`, m.
    pub fn far_end(&self, index: usize) -> f64 {
        if self.joints[index].offset > self.span() / 2.0 { 0.0 } else { self.span() }
    }
}
