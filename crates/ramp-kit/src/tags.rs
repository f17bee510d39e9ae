//! The AprilTags of the family tag25h9, by which cameras find the parts: their patterns and their
//! places on the parts.

use nalgebra::{Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

use crate::beam::Kit;
use crate::dimensions::HEAD_HEIGHT;
use crate::joint::JointType;
use crate::pose::Pose;

/// Cells along an edge of a tag, its white ring included.
pub const CELLS: usize = 9;
/// Cells along the black edge, the size of a tag as detectors define it.
pub const BLACK_CELLS: usize = 7;
/// Length of the black edge of a part's tag, m.
pub const BLACK_EDGE: f64 = 19.0e-3;
/// Edge of the sticker that it is printed on, m.
pub const STICKER: f64 = 25.0e-3;
/// Number of tags: ids 0 to 34.
pub const COUNT: u32 = 35;

/// The code words of the family, as its authors publish them: 25 bits each, the first one highest.
const CODES: [u32; COUNT as usize] = [
    0x156f1f4, 0x1f28cd5, 0x16ce32c, 0x1ea379c, 0x1390f89, 0x034fad0, 0x07dcdb5, 0x119ba95, 0x1ae9daa,
    0x0df02aa, 0x082fc15, 0x0465123, 0x0ceee98, 0x1f17260, 0x14429cd, 0x17248a8, 0x16ad452, 0x09670ad,
    0x16f65b2, 0x0b8322b, 0x05d715b, 0x1a1c7e7, 0x0d7890d, 0x1813522, 0x1c9c611, 0x099e4a4, 0x0855234,
    0x17b81c0, 0x0c294bb, 0x089fae3, 0x044df5f, 0x1360159, 0x0ec31e8, 0x1bcc0f6, 0x0a64f8d,
];

/// The cells of a tag, row by row from the top, `true` where it is black; `None` for an id that the
/// family does not have.
///
/// ```
/// let cells = ramp_kit::tags::cells(7).unwrap();
/// assert!(cells[0].iter().all(|black| !black) && cells[1][1..8].iter().all(|black| *black));
/// assert!(ramp_kit::tags::cells(35).is_none());
/// ```
pub fn cells(id: u32) -> Option<[[bool; CELLS]; CELLS]> {
    let code = *CODES.get(id as usize)?;
    let mut cells = [[false; CELLS]; CELLS];
    for row in &mut cells[1..=BLACK_CELLS] {
        row[1..=BLACK_CELLS].fill(true);
    }
    let mut bits = (0..25).rev().map(|bit| code >> bit & 1 == 1);
    // Six cells of a quadrant, four times around the middle, then the middle itself.
    let quarter: [[usize; 2]; 6] = [[1, 1], [2, 1], [3, 1], [4, 1], [2, 2], [3, 2]];
    for turn in 0..4 {
        for cell in quarter {
            let [x, y] = (0..turn).fold(cell, |[x, y], _| [6 - y, x]);
            cells[y + 1][x + 1] = !bits.next().unwrap_or_default();
        }
    }
    cells[4][4] = !bits.next().unwrap_or_default();
    Some(cells)
}

/// A tag in place on a part.
#[derive(Clone, Debug, PartialEq)]
pub struct TagPlace {
    /// Its id.
    pub id: u32,
    /// The beam or peg that carries it.
    pub part: String,
    /// Pose of the tag's frame G on the part: origin in the middle of the tag, x to its right, y to
    /// its top, z out of its face.
    pub x_pg: Pose,
    /// Length of its black edge, m.
    pub edge: f64,
}

/// A frame at `at` with y and z in these directions.
fn facing(at: Vector3<f64>, y: Vector3<f64>, z: Vector3<f64>) -> Pose {
    let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[y.cross(&z), y, z]));
    Pose::from_parts(Translation3::from(at), UnitQuaternion::from_rotation_matrix(&rotation))
}

/// The tags as the assembly guide places them: on the ends of beams with their tops outwards, on
/// the upper face of the beam as it lies on the sheet, and on the heads of pegs with their tops
/// towards +y.
pub fn places(kit: &Kit) -> Vec<TagPlace> {
    let mut places = Vec::new();
    for beam in &kit.beams {
        let flipped = beam.start.is_some_and(|start| start.flipped);
        for (index, joint) in beam.joints.iter().enumerate() {
            let Some((id, inwards, height)) = joint_tag(joint.tag, joint.kind) else { continue };
            let outward = if index == 0 { -1.0 } else { 1.0 };
            // The plate of a male end is on one face only.
            let up = if flipped && !joint.kind.is_male() { -1.0 } else { 1.0 };
            let at = Vector3::new(joint.offset - outward * inwards, 0.0, up * height);
            let x_pg = facing(at, Vector3::x() * outward, Vector3::z() * up);
            places.push(TagPlace { id, part: beam.name.clone(), x_pg, edge: BLACK_EDGE });
        }
    }
    for peg in &kit.pegs {
        let x_pg = facing(Vector3::z() * HEAD_HEIGHT, Vector3::y(), Vector3::z());
        places.push(TagPlace { id: peg.tag, part: peg.name.clone(), x_pg, edge: BLACK_EDGE });
    }
    places
}

fn joint_tag(id: Option<u32>, kind: JointType) -> Option<(u32, f64, f64)> {
    Some((id?, kind.tag_offset()?, kind.tag_height()?))
}

/// The id of the sheet's own tag.
pub const SHEET_ID: u32 = 0;

/// The pose of the sheet's own tag in the world, as [`TagPlace::x_pg`]: its top towards the sheet's top.
pub fn x_wg_sheet(kit: &Kit) -> Pose {
    facing(kit.sheet_to_world(kit.sheet.tag).coords, Vector3::y(), Vector3::z())
}
