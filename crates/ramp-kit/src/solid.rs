//! The parts as solids: what is printed, and the bought parts for whoever wants them in a drawing program.
//!
//! Millimetres throughout this module, as in the files it fills. A joint's frame: origin on the axis of its peg
//! hole at the underside of its body, y along the beam (an end joint's extrusion comes from −y), z up; a joint
//! that is open to one side is open to −x at an end of a beam and to +x in its middle.

use std::f64::consts::PI;

use manifold_rust::cross_section::CrossSection;
use manifold_rust::linalg::{Vec2, Vec3};
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{Error, OpType};

use crate::beam::{Beam, Holder};
use crate::joint::{
    Dimensions, FEET, HEAD_HEIGHT, HEAD_WIDTH, JointForm, JointType, MALE_CHAMFER, MALE_TIP, SCREW,
    STEM_CONE, STEM_RADIUS, STEM_TIP_RADIUS, TAG_PLATE, TAG_RECESS,
};

/// Millimetres in a metre.
const MM: f64 = 1e3;
/// Corners of a polygon that stands for a circle: at most 0.01 mm inside a hole of the kit.
const CIRCLE: i32 = 64;
/// The smallest detail of a part, mm.
const SMALLEST: f64 = 1e-4;
/// By how much a cut reaches out of the face that it opens, so that no skin is left.
const PAST: f64 = 1.0;

/// The solid could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error, miette::Diagnostic)]
#[error("the solid of `{part}` cannot be made: {why}")]
#[diagnostic(help("look at the dimensions in the kit file"))]
pub struct SolidError {
    /// The part.
    pub part: String,
    /// What the modeller says.
    pub why: String,
}

/// A closed solid, mm.
#[derive(Clone)]
pub struct Solid(Manifold);

/// The surface of a solid: corners (mm) and triangles, whose corners go anticlockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The corners.
    pub points: Vec<[f64; 3]>,
    /// Indices of three corners each.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Its volume, mm³, from the divergence theorem: negative when it is inside out.
    pub fn volume(&self) -> f64 {
        let corner = |index: u32| nalgebra::Vector3::from(self.points[index as usize]);
        let six = |[a, b, c]: &[u32; 3]| corner(*a).dot(&corner(*b).cross(&corner(*c)));
        self.triangles.iter().map(six).sum::<f64>() / 6.0
    }

    /// Is every edge of every triangle also an edge of exactly one other, the other way round?
    pub fn is_closed(&self) -> bool {
        let mut edges: Vec<[u32; 2]> =
            self.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        edges.sort_unstable();
        let once = edges.windows(2).all(|pair| pair[0] != pair[1]);
        once && edges.iter().all(|&[a, b]| a != b && edges.binary_search(&[b, a]).is_ok())
    }

    /// The smallest and largest coordinates, mm.
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for point in &self.points {
            for axis in 0..3 {
                bounds[0][axis] = bounds[0][axis].min(point[axis]);
                bounds[1][axis] = bounds[1][axis].max(point[axis]);
            }
        }
        bounds
    }
}

impl Solid {
    /// An upright box from its ranges, mm.
    pub fn cuboid(x: [f64; 2], y: [f64; 2], z: [f64; 2]) -> Solid {
        let size = Vec3::new(x[1] - x[0], y[1] - y[0], z[1] - z[0]);
        Solid(Manifold::cube(size, false).translate(Vec3::new(x[0], y[0], z[0])))
    }

    /// A cylinder or cone around the vertical through (x, y), from the radius at `z[0]` to that at `z[1]`, mm.
    pub fn round(at: [f64; 2], radius: [f64; 2], z: [f64; 2]) -> Solid {
        let solid = Manifold::cylinder(z[1] - z[0], radius[0], radius[1], CIRCLE);
        Solid(solid.translate(Vec3::new(at[0], at[1], z[0])))
    }

    /// The smallest convex solid around points, mm.
    fn hull(points: &[[f64; 3]]) -> Solid {
        let points: Vec<Vec3> = points.iter().map(|p| Vec3::new(p[0], p[1], p[2])).collect();
        Solid(Manifold::hull(&points))
    }

    /// An outline with holes (the outline anticlockwise, holes clockwise), pulled up to `height`, mm.
    fn extrude(outlines: &[Vec<[f64; 2]>], height: f64) -> Solid {
        let polygons =
            outlines.iter().map(|line| line.iter().map(|p| Vec2::new(p[0], p[1])).collect()).collect();
        let section = CrossSection::new(polygons);
        Solid(Manifold::extrude(&section.to_polygons(), height, 0, 0.0, Vec2::new(1.0, 1.0)))
    }

    /// Moved, mm.
    pub fn translated(&self, by: [f64; 3]) -> Solid {
        Solid(self.0.translate(Vec3::new(by[0], by[1], by[2])))
    }

    /// Turned about x, then y, then z, degrees.
    pub fn rotated(&self, degrees: [f64; 3]) -> Solid {
        Solid(self.0.rotate(degrees[0], degrees[1], degrees[2]))
    }

    /// All of these as one.
    pub fn union(solids: &[Solid]) -> Solid {
        Solid::batch(solids, OpType::Add)
    }

    /// What is left of this when the others are cut off.
    pub fn minus(&self, cuts: &[Solid]) -> Solid {
        if cuts.is_empty() { self.clone() } else { Solid(self.0.difference(&Solid::union(cuts).0)) }
    }

    /// What this and another one have in common.
    pub fn common(&self, other: &Solid) -> Solid {
        Solid(self.0.intersection(&other.0))
    }

    fn batch(solids: &[Solid], operation: OpType) -> Solid {
        let all: Vec<Manifold> = solids.iter().map(|solid| solid.0.clone()).collect();
        Solid(Manifold::batch_boolean(&all, operation))
    }

    /// Volume, mm³.
    pub fn volume(&self) -> f64 {
        self.0.volume()
    }

    /// How many holes go through it, as through a ring.
    pub fn genus(&self) -> i32 {
        self.0.genus()
    }

    /// Its surface.
    pub fn mesh(&self) -> Mesh {
        let mesh = self.0.get_mesh_gl64(-1);
        let stride = (mesh.num_prop as usize).max(3);
        let points = mesh.vert_properties.chunks_exact(stride).map(|v| [v[0], v[1], v[2]]).collect();
        let index = |i: u64| u32::try_from(i).unwrap_or(u32::MAX);
        let triangles =
            mesh.tri_verts.chunks_exact(3).map(|t| [index(t[0]), index(t[1]), index(t[2])]).collect();
        Mesh { points, triangles }
    }

    /// Its outline seen from above: closed lines, mm, the outer ones anticlockwise.
    pub fn outline(&self) -> Vec<Vec<[f64; 2]>> {
        let polygons = self.0.project().simplify(1e-4).to_polygons();
        polygons.iter().map(|line| line.iter().map(|p| [p.x, p.y]).collect()).collect()
    }

    fn checked(self, part: &str) -> Result<Solid, SolidError> {
        // Corners that only rounding has parted become one, as they would in a file of single precision.
        let whole = Solid(self.0.simplify(SMALLEST));
        let why = match whole.0.status() {
            Error::NoError if whole.0.is_empty() => "nothing is left of it".to_string(),
            Error::NoError if whole.0.decompose().len() > 1 => "it falls into pieces".to_string(),
            Error::NoError => return Ok(whole),
            error => format!("{error:?}"),
        };
        Err(SolidError { part: part.to_string(), why })
    }
}

/// A joint, in the frame of this module.
///
/// ```
/// use ramp_kit::{Dimensions, JointType, solid};
/// let sleeve = solid::joint(JointType::ThruF, &Dimensions::BENCHMARK)?;
/// assert!((sleeve.volume() - 21720.4).abs() < 20.0);
/// # Ok::<(), solid::SolidError>(())
/// ```
///
/// # Errors
/// Dimensions that leave nothing, or pieces.
pub fn joint(kind: JointType, dimensions: &Dimensions) -> Result<Solid, SolidError> {
    let form = kind.form();
    let sizes = Sizes::new(dimensions);
    let solid = if form.male { male(kind, form, &sizes) } else { female(kind, form, &sizes) };
    solid.checked(kind.name())
}

/// What follows from the four numbers, mm.
struct Sizes {
    wall: f64,
    clearance: f64,
    /// Half of the body, of the socket and of a female's cavity; the height of a female.
    body: f64,
    socket: f64,
    cavity: f64,
    height: f64,
    hole: f64,
}

impl Sizes {
    fn new(d: &Dimensions) -> Sizes {
        Sizes {
            wall: d.wall * MM,
            clearance: d.clearance * MM,
            body: d.body() * MM / 2.0,
            socket: d.socket() * MM / 2.0,
            cavity: d.cavity() * MM / 2.0,
            height: d.female_height() * MM,
            hole: d.peg_hole * MM / 2.0,
        }
    }

    fn hole(&self, z: [f64; 2]) -> Solid {
        Solid::round([0.0; 2], [self.hole; 2], [z[0] - PAST, z[1] + PAST])
    }

    /// The countersunk hole in the wall of a socket at y, its axis at height z; `side` (±1) is the face it is in.
    fn screw(&self, side: f64, y: f64, z: f64) -> Solid {
        let (cone, outer, inner) = (SCREW.cone * MM, SCREW.outer * MM, SCREW.inner * MM);
        // Along +z first: the countersink from below, a little longer than its depth on the outside.
        let steeper = (outer - inner) / cone * PAST;
        let sink = Solid::round([0.0; 2], [outer + steeper, inner], [-PAST, cone]);
        let shank = Solid::round([0.0; 2], [inner; 2], [0.0, self.wall + PAST]);
        let turn = if side > 0.0 { -90.0 } else { 90.0 };
        Solid::union(&[sink, shank]).rotated([0.0, turn, 0.0]).translated([side * self.body, y, z])
    }

    /// The socket whose floor is at `from` and whose mouth is at `to`, and its screw hole.
    fn socket(&self, [from, to]: [f64; 2], side: f64, z: f64) -> [Solid; 2] {
        let out = (to - from).signum();
        let ends = [from.min(to + out * PAST), from.max(to + out * PAST)];
        let half = self.socket;
        [Solid::cuboid([-half, half], ends, [z - half, z + half]), self.screw(side, (from + to) / 2.0, z)]
    }
}

fn male(kind: JointType, form: &JointForm, s: &Sizes) -> Solid {
    let (sleeve, floor) = (kind.sleeve() * MM, form.socket_offset * MM);
    let (w, z) = (s.body, [0.0, 2.0 * s.body]);
    if !form.end {
        let body = Solid::cuboid([-w, w], [-sleeve, sleeve], z);
        let mut cuts = vec![s.hole(z)];
        for way in [1.0, -1.0] {
            cuts.extend(s.socket([way * floor, way * sleeve], 1.0, w));
        }
        return body.minus(&cuts);
    }
    let mut solids = Vec::new();
    for section in form.sections() {
        let [from, to] = section.along.map(|v| v * MM);
        let solid = if section.along[1] < MALE_TIP {
            let [right, left] = section.across.map(|v| v * MM);
            Solid::cuboid([-left, -right], [from, to], z)
        } else {
            let c = MALE_CHAMFER * MM;
            let ring = |y: f64, inset: f64| {
                [(-1.0, 0), (1.0, 0), (1.0, 1), (-1.0, 1)]
                    .map(|(x, top)| [x * (w - inset), y, if top == 0 { inset } else { z[1] - inset }])
            };
            Solid::hull(&[ring(from, 0.0), ring(to - c, 0.0), ring(to, c)].concat())
        };
        // Anticlockwise from above is to the left of +y too.
        solids.push(solid.rotated([0.0, 0.0, section.turn.to_degrees()]));
    }
    let plate = sleeve + TAG_PLATE * MM;
    solids.push(Solid::cuboid([-w, w], [-plate, -sleeve + 0.5], [z[1] - s.wall, z[1]]));
    if form.feet {
        let [across, along] = FEET.map(|range| range.map(|v| v * MM));
        for side in [-1.0, 1.0] {
            let mut x = across.map(|v| side * v);
            x.sort_by(f64::total_cmp);
            solids.push(Solid::cuboid(x, along, [-(s.height / 2.0 - w), 0.5]));
        }
    }
    let mut cuts = vec![s.hole(z)];
    cuts.extend(s.socket([-floor, -sleeve], -1.0, w));
    cuts.push(recess(kind, z[1], 0.5));
    Solid::union(&solids).minus(&cuts)
}

/// The recess for the tag in the face at height z, `depth` deep: upwards when it is negative.
fn recess(kind: JointType, z: f64, depth: f64) -> Solid {
    let at = -kind.tag_offset().unwrap_or_default() * MM;
    let half = TAG_RECESS * MM / 2.0;
    let ends = if depth > 0.0 { [z - depth, z + PAST] } else { [z - PAST, z - depth] };
    Solid::cuboid([-half, half], [at - half, at + half], ends)
}

fn female(kind: JointType, form: &JointForm, s: &Sizes) -> Solid {
    let (sleeve, floor) = (kind.sleeve() * MM, form.socket_offset * MM);
    let (w, middle) = (s.body, s.height / 2.0);
    let cavity = form.cavity * MM;
    let head = cavity + s.wall;
    // An end is open where the beam stops, and to −x; a middle to +x.
    let (open, ends) = if form.end { (-1.0, [-head, cavity]) } else { (1.0, [-head, head]) };
    let neck = if form.end { [-sleeve, 0.0] } else { [-sleeve, sleeve] };
    let solids = [
        Solid::cuboid([-w, w], ends, [0.0, s.height]),
        Solid::cuboid([-w, w], neck, [middle - w, middle + w]),
    ];
    let closed = if form.one_sided { w - s.wall } else { w + PAST };
    let x = if open > 0.0 { [-closed, w + PAST] } else { [-w - PAST, closed] };
    let y = if form.end { [-cavity, cavity + PAST] } else { [-cavity, cavity] };
    let mut cuts = vec![Solid::cuboid(x, y, [middle - s.cavity, middle + s.cavity]), s.hole([0.0, s.height])];
    if form.end {
        cuts.extend(s.socket([-floor, -sleeve], -1.0, middle));
        cuts.push(recess(kind, middle + w, s.clearance));
        cuts.push(recess(kind, middle - w, -s.clearance));
    } else {
        for way in [1.0, -1.0] {
            cuts.extend(s.socket([way * floor, way * sleeve], 1.0, middle));
        }
    }
    Solid::union(&solids).minus(&cuts)
}

/// A part of a beam at its place.
#[derive(Clone)]
pub struct Piece {
    /// The name of the joint or link.
    pub name: String,
    /// The part, mm, in the beam's frame: origin on the axis at the first hole, x along the beam, z up.
    pub solid: Solid,
    /// Is it a length of extrusion?
    pub link: bool,
}

/// The parts of a beam in their order along it, each moved by `apart` (mm) from the one before.
///
/// # Errors
/// As [`joint`].
pub fn beam(beam: &Beam, dimensions: &Dimensions, apart: f64) -> Result<Vec<Piece>, SolidError> {
    let mut pieces = Vec::new();
    for (index, part) in beam.joints.iter().enumerate() {
        let form = part.kind.form();
        let sizes = Sizes::new(dimensions);
        let axis = if form.male { sizes.body } else { sizes.height / 2.0 };
        let solid = joint(part.kind, dimensions)?.translated([0.0, 0.0, -axis]);
        // An end looks out of its beam; a middle is turned so that it opens to its side. A female end that opens
        // to the other side is turned about the beam, which it does not show.
        let open = part.opens.map_or(1.0, |side| -side.sign());
        let (turn, over) = match (form.end, index == 0) {
            (true, true) => (90.0, open < 0.0),
            (true, false) => (-90.0, open > 0.0),
            (false, _) => (-90.0 * open, false),
        };
        let solid = solid.rotated([0.0, 0.0, turn]);
        let solid = if over && form.one_sided { solid.rotated([180.0, 0.0, 0.0]) } else { solid };
        let shift = 2.0 * apart * index as f64;
        let solid = solid.translated([part.offset * MM + shift, 0.0, 0.0]);
        pieces.push(Piece { name: part.name.clone(), solid, link: false });
        let Some(link) = beam.links.get(index) else { continue };
        let from = (part.offset + form.socket_offset) * MM + shift + apart;
        let solid = extrusion(link.length * MM)?.rotated([0.0, 90.0, 0.0]).translated([from, 0.0, 0.0]);
        pieces.push(Piece { name: link.name.clone(), solid, link: true });
    }
    Ok(pieces)
}

/// A length of extrusion along z, mm: a 20 × 20 profile with four slots.
///
/// # Errors
/// No length.
pub fn extrusion(length: f64) -> Result<Solid, SolidError> {
    Solid::extrude(&profile(), length).checked("extrusion")
}

/// The section of the extrusion: its outline and its bore, mm.
pub fn profile() -> Vec<Vec<[f64; 2]>> {
    /// Half the edge, the corners' radius, half the slot's mouth, thickness of its lips, half its width behind
    /// them, depth there before it narrows, half the web.
    const HALF: f64 = 10.0;
    const CORNER: f64 = 2.0;
    const MOUTH: f64 = 2.5;
    const LIP: f64 = 1.8;
    const UNDERCUT: f64 = 5.75;
    const STRAIGHT: f64 = 1.11;
    const WEB: f64 = 3.65;
    const BORE: f64 = 2.15;
    // One quarter: the corner at (+, +) and the slot that follows it on the +y side, anticlockwise.
    let floor = UNDERCUT - (HALF - LIP - STRAIGHT - WEB);
    let mut quarter: Vec<[f64; 2]> = arc([HALF - CORNER; 2], CORNER, 0.0, PI / 2.0, 8);
    quarter.extend([
        [MOUTH, HALF],
        [MOUTH, HALF - LIP],
        [UNDERCUT, HALF - LIP],
        [UNDERCUT, HALF - LIP - STRAIGHT],
        [floor, WEB],
        [-floor, WEB],
        [-UNDERCUT, HALF - LIP - STRAIGHT],
        [-UNDERCUT, HALF - LIP],
        [-MOUTH, HALF - LIP],
        [-MOUTH, HALF],
    ]);
    let turned = |turns: i32| {
        quarter.iter().map(move |&[x, y]| match turns {
            0 => [x, y],
            1 => [-y, x],
            2 => [-x, -y],
            _ => [y, -x],
        })
    };
    let outline = (0..4).flat_map(turned).collect();
    let mut bore = arc([0.0; 2], BORE, 0.0, 2.0 * PI, CIRCLE);
    bore.pop();
    bore.reverse();
    vec![outline, bore]
}

/// Points on a circle, from one angle (rad) to another.
fn arc(centre: [f64; 2], radius: f64, from: f64, to: f64, steps: i32) -> Vec<[f64; 2]> {
    let at = |step: i32| {
        let angle = from + (to - from) * f64::from(step) / f64::from(steps);
        [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()]
    };
    (0..=steps).map(at).collect()
}

/// Points on a sphere, the poles and the equator's quarters among them.
fn ball(centre: [f64; 3], radius: f64) -> Vec<[f64; 3]> {
    let mut points = Vec::new();
    for ring in 0..=8 {
        let (height, around) = (PI * f64::from(ring) / 8.0).sin_cos();
        for step in 0..16 {
            let (sin, cos) = (2.0 * PI * f64::from(step) / 16.0).sin_cos();
            points.push([
                centre[0] + radius * height * cos,
                centre[1] + radius * height * sin,
                centre[2] + radius * around,
            ]);
        }
    }
    points
}

/// A peg; z = 0 is the underside of its head, the stem points down.
///
/// # Errors
/// None for the benchmark's dimensions.
pub fn peg(dimensions: &Dimensions) -> Result<Solid, SolidError> {
    /// Radius of the head's edges; the groove around the tag's pad: its inside, its width and depth.
    const ROUND: f64 = 1.0;
    const PAD: f64 = 25.5;
    const GROOVE: [f64; 2] = [0.6, 0.2];
    let (half, top) = (HEAD_WIDTH * MM / 2.0 - ROUND, HEAD_HEIGHT * MM - ROUND);
    let mut corners = Vec::new();
    for x in [-half, half] {
        for y in [-half, half] {
            for z in [ROUND, top] {
                corners.extend(ball([x, y, z], ROUND));
            }
        }
    }
    let head = Solid::hull(&corners);
    let (top, [width, depth]) = (HEAD_HEIGHT * MM, GROOVE);
    let square = |half: f64| Solid::cuboid([-half, half], [-half, half], [top - depth, top + PAST]);
    let groove = square(PAD / 2.0 + width).minus(&[square(PAD / 2.0)]);
    // As long as a female is high, whatever its walls are.
    let (length, cone) = (dimensions.female_height() * MM, STEM_CONE * MM);
    let (radius, tip) = (STEM_RADIUS * MM, STEM_TIP_RADIUS * MM);
    let stem = Solid::round([0.0; 2], [radius; 2], [cone - length, 2.0]);
    let end = Solid::round([0.0; 2], [tip, radius], [-length, cone - length]);
    Solid::union(&[head.minus(&[groove]), stem, end]).checked("peg")
}

/// A holder for three pegs; the origin is the centre of its base.
///
/// # Errors
/// None for the benchmark's dimensions.
pub fn holder(dimensions: &Dimensions) -> Result<Solid, SolidError> {
    /// Half the depth of a rib at some heights; the last is inside the bar.
    const RIB: [[f64; 2]; 6] =
        [[0.0, 20.0], [3.85, 17.7], [9.9, 14.98], [17.2, 12.4], [28.2, 10.45], [36.2, 10.0]];
    const RIBS: [[f64; 2]; 4] = [[-51.5, -45.5], [-20.0, -14.0], [14.0, 20.0], [45.5, 51.5]];
    const ROUND: f64 = 1.0;
    /// Half the width of the ridge that the tips stand in, the heights of its top and of the pockets' floor, and
    /// the height from which the floor between the ribs narrows into it.
    const RIDGE: f64 = 11.86;
    const TOP: f64 = 6.0;
    const FLOOR: f64 = 4.0;
    const SLAB: f64 = 3.85;
    /// Height of the bar over the ribs' last step; the countersink at its top.
    const BAR: f64 = 4.0;
    const SINK: [f64; 2] = [5.6, 1.4];
    let height = Holder::HEIGHT * MM;
    let length = Holder::BASE[0] * MM / 2.0;
    let mut solids = Vec::new();
    for [from, to] in RIBS {
        for pair in RIB.windows(2) {
            let mut points = Vec::new();
            for &[z, half] in pair {
                for (x, out_x) in [(from, -1.0), (to, 1.0)] {
                    for out_y in [-1.0, 1.0] {
                        let centre = [x - out_x * ROUND, out_y * (half - ROUND)];
                        let corner = arc([0.0; 2], ROUND, 0.0, PI / 2.0, 6);
                        points.extend(
                            corner.iter().map(|c| [centre[0] + out_x * c[0], centre[1] + out_y * c[1], z]),
                        );
                    }
                }
            }
            solids.push(Solid::hull(&points));
        }
    }
    // The bar, its upper edges round.
    let half = RIB[5][1];
    let mut points = Vec::new();
    for x in [-1.0, 1.0] {
        for y in [-1.0, 1.0] {
            points.push([x * length, y * half, height - BAR]);
            points.extend(ball([x * (length - ROUND), y * (half - ROUND), height - ROUND], ROUND));
        }
    }
    solids.push(Solid::hull(&points));
    let inner = length - 1.0;
    let slab =
        |z: f64, half: f64| [[-inner, -half, z], [inner, -half, z], [inner, half, z], [-inner, half, z]];
    solids.push(Solid::hull(&[slab(0.0, RIB[0][1]), slab(SLAB, RIB[1][1])].concat()));
    solids.push(Solid::cuboid([-inner, inner], [-RIDGE, RIDGE], [SLAB - 1.0, TOP]));
    let mut cuts = Vec::new();
    let radius = dimensions.peg_hole * MM / 2.0;
    for slot in [-1.0, 0.0, 1.0] {
        let at = [slot * Holder::PITCH * MM, 0.0];
        cuts.push(Solid::round(at, [radius; 2], [height - BAR - PAST, height + PAST]));
        let slope = (SINK[0] - radius) / SINK[1] * PAST;
        cuts.push(Solid::round(at, [radius, SINK[0] + slope], [height - SINK[1], height + PAST]));
        cuts.push(Solid::round(at, [radius; 2], [FLOOR, TOP + PAST]));
    }
    Solid::union(&solids).minus(&cuts).checked("holder")
}

/// A fingertip: x across the finger, y the way it closes, z up to the hand; the origin is the point between the
/// tips that the hand is steered by.
///
/// # Errors
/// None.
pub fn fingertip() -> Result<Solid, SolidError> {
    /// The plate, the rib that enters the slot of an extrusion, and the block that holds a peg's head.
    const HALF: f64 = 10.0;
    const PLATE: [f64; 2] = [-19.0, 21.0];
    const THICK: f64 = 10.0;
    const RIB: [f64; 2] = [-18.5, -15.5];
    const RIB_REACH: f64 = 14.0;
    const BLOCK: [f64; 2] = [-6.2, 6.8];
    const BLOCK_REACH: f64 = 19.0;
    /// The screw: its height, its radius, the nut across flats and how deep it sits, the boss around it.
    const SCREW_Z: f64 = 10.0;
    const SCREW_R: f64 = 2.1;
    const NUT: f64 = 5.66;
    const NUT_DEPTH: f64 = 3.2;
    const BOSS: [f64; 2] = [2.95, 1.5];
    let prism = |section: &[[f64; 2]]| {
        // Drawn as (y, z), pulled along x.
        let points: Vec<[f64; 3]> =
            section.iter().flat_map(|&[y, z]| [[-HALF, y, z], [HALF, y, z]]).collect();
        Solid::hull(&points)
    };
    // The plate's front edges are broken by 1.5, its lower ones by 0.5.
    let outline = [
        [-HALF, 0.0],
        [HALF, 0.0],
        [HALF, THICK - 1.5],
        [HALF - 1.5, THICK],
        [1.5 - HALF, THICK],
        [-HALF, THICK - 1.5],
    ];
    let shrunk = outline.map(|[x, y]| [x - x.signum() * 0.5, y.clamp(0.5, THICK - 0.5)]);
    let ring = |outline: &[[f64; 2]], z: f64| outline.iter().map(|&[x, y]| [x, y, z]).collect::<Vec<_>>();
    let plate = Solid::hull(
        &[ring(&shrunk, PLATE[0]), ring(&outline, PLATE[0] + 0.5), ring(&outline, PLATE[1])].concat(),
    );
    let nose = (RIB[1] - RIB[0]) / 2.0;
    let rib = prism(&[
        [THICK - 3.0, RIB[0]],
        [RIB_REACH - nose, RIB[0]],
        [RIB_REACH, RIB[0] + nose],
        [RIB_REACH - nose, RIB[1]],
        [THICK - 3.0, RIB[1]],
    ]);
    let block = prism(&[
        [THICK - 3.0, BLOCK[0]],
        [BLOCK_REACH - 1.2, BLOCK[0]],
        [BLOCK_REACH, BLOCK[0] + 1.2],
        [BLOCK_REACH, BLOCK[1] - 1.2],
        [BLOCK_REACH - 1.2, BLOCK[1]],
        [THICK - 3.0, BLOCK[1]],
    ]);
    // Drawn along z and laid back, so that z becomes y.
    let lay = |solid: Solid| solid.rotated([-90.0, 0.0, 0.0]).translated([0.0, 0.0, SCREW_Z]);
    let boss = lay(Solid::round([0.0; 2], [BOSS[0]; 2], [-BOSS[1], 0.5]));
    let bolt = lay(Solid::round([0.0; 2], [SCREW_R; 2], [-BOSS[1] - PAST, THICK + PAST]));
    let corner = NUT / 3f64.sqrt();
    let hexagon: Vec<[f64; 2]> =
        (0..6).map(|k| (PI / 3.0 * f64::from(k)).sin_cos()).map(|(s, c)| [corner * c, corner * s]).collect();
    let nut = Solid::extrude(&[hexagon], NUT_DEPTH + PAST).translated([0.0, 0.0, THICK - NUT_DEPTH]);
    Solid::union(&[plate, rib, block, boss]).minus(&[bolt, lay(nut)]).checked("fingertip")
}

/// The clamp that holds the fixed beam on the table: a trough for its extrusion, y along the beam, z = 0 on the
/// table, four holes down into the table and two for screws into the extrusion's slots.
///
/// # Errors
/// Dimensions that leave no wall beside the extrusion.
pub fn clamp(dimensions: &Dimensions) -> Result<Solid, SolidError> {
    const LENGTH: f64 = 80.0;
    const WIDTH: f64 = 30.0;
    const HEIGHT: f64 = 26.85;
    /// Height of the feet, and thickness of the walls beside the extrusion.
    const FOOT: f64 = 6.0;
    const SIDE: f64 = 9.0;
    const TABLE_SCREW: f64 = 2.75;
    const SLOT_SCREW: f64 = 2.6;
    let socket = dimensions.socket() * MM / 2.0;
    let axis = dimensions.female_height() * MM / 2.0;
    let (x, y) = (LENGTH / 2.0, WIDTH / 2.0);
    let wall = socket + SIDE;
    let foot = Solid::cuboid([-x, x], [-y, y], [0.0, FOOT]);
    let trough = Solid::cuboid([-wall, wall], [-y, y], [0.0, HEIGHT]);
    let mut cuts =
        vec![Solid::cuboid([-socket, socket], [-y - PAST, y + PAST], [axis - socket, HEIGHT + PAST])];
    for side in [-1.0, 1.0] {
        for along in [-1.0, 1.0] {
            let at = [side * (wall + x) / 2.0, along * 8.5];
            cuts.push(Solid::round(at, [TABLE_SCREW; 2], [-PAST, FOOT + PAST]));
        }
    }
    let screw = Solid::round([0.0; 2], [SLOT_SCREW; 2], [-x, x]).rotated([0.0, 90.0, 0.0]);
    cuts.push(screw.translated([0.0, 0.0, axis]));
    Solid::union(&[foot, trough]).minus(&cuts).checked("clamp")
}
