//! What can be in an image, as triangles: the parts and holders of a kit, the hand and its fingers.
//!
//! The shapes are those of the kit's CAD and of the arm file. The colours are those of the materials in even
//! light from above: where the lamps are is not known.

use std::collections::BTreeMap;

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_kit::Kit;
use ramp_kit::solid::{self, Mesh, Solid, SolidError};
use ramp_robot::Pose;
use ramp_robot::arm::{ArmBox, ArmModel};

/// Linear light, red, green and blue; 1 is white in full light.
pub type Colour = [f32; 3];

/// Black and orange plastic, raw aluminium, grey plastic, the fingers' rubber and their metal, as a camera
/// sees them in even light.
const JOINT: Colour = [0.035, 0.037, 0.042];
const PEG: Colour = [0.50, 0.13, 0.02];
const ALUMINIUM: Colour = [0.52, 0.54, 0.57];
const HOLDER: Colour = [0.16, 0.17, 0.18];
const FINGERTIP: Colour = [0.03, 0.03, 0.033];
const TOOL: Colour = [0.22, 0.23, 0.25];
/// Details of a part that no camera of the cell shows, mm.
const DETAIL: f64 = 0.05;
/// Points of the extrusion's rounded corners that lie closer than this are left out, mm.
const CLOSE: f64 = 1.2;
/// Normals that differ by less look the same.
const SAME: f32 = 1.0e-3;
/// Length of an extrusion that is hidden in the joints at its ends, m.
const HIDDEN: f64 = 3.0e-3;

/// A surface in the frame of its body, m.
#[derive(Clone, Debug, Default)]
pub struct Surface {
    /// Corners.
    pub points: Vec<[f32; 3]>,
    /// Three corners each, anticlockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Of each triangle, the index of its patch.
    pub patch_of: Vec<u32>,
    /// What looks the same everywhere: outward normal and colour.
    pub patches: Vec<([f32; 3], Colour)>,
    /// Centre and radius of a ball around it.
    pub ball: ([f32; 3], f32),
}

impl Surface {
    fn add(&mut self, mesh: &Mesh, x: &Pose, colour: Colour) {
        let first = self.points.len() as u32;
        let points: Vec<Point3<f64>> =
            mesh.points.iter().map(|p| x * Point3::from(p.map(|value| value * 1.0e-3))).collect();
        self.points.extend(points.iter().map(|p| [p.x as f32, p.y as f32, p.z as f32]));
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|corner| points[corner as usize]);
            let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) else { continue };
            self.triangles.push(triangle.map(|corner| first + corner));
            let normal = Vector3::new(normal.x as f32, normal.y as f32, normal.z as f32);
            let same = |(other, its): &([f32; 3], Colour)| {
                *its == colour && (Vector3::from(*other) - normal).amax() < SAME
            };
            let patch = self.patches.iter().position(same).unwrap_or_else(|| {
                self.patches.push((normal.into(), colour));
                self.patches.len() - 1
            });
            self.patch_of.push(patch as u32);
        }
    }

    fn add_box(&mut self, piece: &ArmBox, x: &Pose, colour: Colour) {
        let [low, high] = [piece.min, piece.max].map(|corner| corner.map(|value| value * 1.0e3));
        let solid = Solid::cuboid([low[0], high[0]], [low[1], high[1]], [low[2], high[2]]);
        self.add(&solid.mesh(), x, colour);
    }

    /// With the ball around all corners.
    fn closed(mut self) -> Surface {
        let corners = || self.points.iter().map(|p| Point3::from(*p));
        let low = corners().fold(Point3::from([f32::INFINITY; 3]), |low, p| low.inf(&p));
        let high = corners().fold(Point3::from([f32::NEG_INFINITY; 3]), |high, p| high.sup(&p));
        let centre = nalgebra::center(&low, &high);
        let radius = corners().map(|p| (p - centre).norm()).fold(0.0, f32::max);
        self.ball = (centre.into(), radius);
        self
    }
}

/// The surfaces of all bodies, by name: parts and holders by their names in the kit, `hand`, `finger1` and
/// `finger2` in the frames of the arm file.
///
/// # Errors
/// Dimensions of which no solid can be made.
pub fn surfaces(kit: &Kit, arm: &ArmModel) -> Result<BTreeMap<String, Surface>, SolidError> {
    let still = Pose::identity();
    let mut all = BTreeMap::new();
    for beam in &kit.beams {
        let mut surface = Surface::default();
        for piece in solid::beam(beam, &kit.dimensions, 0.0)?.iter().filter(|piece| !piece.link) {
            surface.add(&piece.solid.simplified(DETAIL).mesh(), &still, JOINT);
        }
        for pair in beam.joints.windows(2) {
            let from = pair[0].offset + pair[0].kind.sleeve() - HIDDEN;
            let to = pair[1].offset - pair[1].kind.sleeve() + HIDDEN;
            surface.add(&extrusion(from, to), &still, ALUMINIUM);
        }
        all.insert(beam.name.clone(), surface.closed());
    }
    let one = |solid: &Solid, colour: Colour| {
        let mut surface = Surface::default();
        surface.add(&solid.simplified(DETAIL).mesh(), &still, colour);
        surface.closed()
    };
    let peg = one(&solid::peg(&kit.dimensions)?, PEG);
    all.extend(kit.pegs.iter().map(|part| (part.name.clone(), peg.clone())));
    let holder = one(&solid::holder(&kit.dimensions)?, HOLDER);
    all.extend(kit.holders.iter().map(|part| (part.name.clone(), holder.clone())));
    let mut hand = Surface::default();
    // The boxes after the first are the camera's own housing.
    for piece in arm.hand.boxes.iter().take(1) {
        hand.add_box(piece, &still, TOOL);
    }
    all.insert("hand".to_string(), hand.closed());
    let finger = finger(arm)?;
    all.insert("finger1".to_string(), finger.clone());
    all.insert("finger2".to_string(), finger);
    Ok(all)
}

/// A finger in its own frame. Boxes and fingertip are given from the tip, with z towards the hand.
fn finger(arm: &ArmModel) -> Result<Surface, SolidError> {
    let tip = arm.hand.tip - arm.finger.origin;
    let outer = arm.finger.pads.first().map_or(0.0, |pad| pad.max[1]);
    let over = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    let mut surface = Surface::default();
    let x_ft = Pose::from_parts(Translation3::new(0.0, outer, tip), over);
    surface.add(&solid::fingertip()?.simplified(DETAIL).mesh(), &x_ft, FINGERTIP);
    for piece in &arm.finger.boxes {
        let ([x0, y0, z0], [x1, y1, z1]) = (piece.min, piece.max);
        let piece = ArmBox { min: [x0, y0, tip - z1], max: [x1, y1, tip - z0] };
        surface.add_box(&piece, &Pose::identity(), TOOL);
    }
    Ok(surface.closed())
}

/// The sides of an extrusion from x = `from` to x = `to`, m, as a mesh in mm.
fn extrusion(from: f64, to: f64) -> Mesh {
    let mut section: Vec<[f64; 2]> = Vec::new();
    for point in solid::profile().into_iter().next().unwrap_or_default() {
        if section.last().is_none_or(|last| (point[0] - last[0]).hypot(point[1] - last[1]) > CLOSE) {
            section.push(point);
        }
    }
    let count = section.len() as u32;
    let at = |x: f64| section.iter().map(move |[y, z]| [x * 1.0e3, *y, *z]);
    let points = at(from).chain(at(to)).collect();
    let sides = (0..count).map(|here| (here, (here + 1) % count));
    let triangles = sides.flat_map(|(a, b)| [[a, b, b + count], [a, b + count, a + count]]).collect();
    Mesh { points, triangles }
}
