//! Closed solids and their surfaces: made of boxes, cylinders and outlines, joined and cut.

use manifold_rust::cross_section::CrossSection;
use manifold_rust::linalg::{Vec2, Vec3};
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{Error, OpType};
use std::f64::consts::PI;

/// Number of corners of a polygon that approximates a circle: at most 0.01 mm inside a hole of the
/// kit.
pub(super) const CIRCLE: i32 = 64;

/// Smallest detail of a part, mm.
const SMALLEST: f64 = 1e-4;

/// Overshoot of a cut beyond the face that it opens, mm, so that no skin remains.
pub(super) const PAST: f64 = 1.0;

/// Millimetres in a metre.
pub(super) const MM: f64 = 1e3;

/// The solid could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error, miette::Diagnostic)]
#[error("the solid of `{part}` cannot be made: {why}")]
#[diagnostic(help("look at the dimensions in the kit file"))]
pub struct SolidError {
    /// The part.
    pub part: String,
    /// The modeller's reason.
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
    /// Its volume, mm³, from the divergence theorem: negative when the surface is inside out.
    pub fn volume(&self) -> f64 {
        let corner = |index: u32| nalgebra::Vector3::from(self.points[index as usize]);
        let six = |[a, b, c]: &[u32; 3]| corner(*a).dot(&corner(*b).cross(&corner(*c)));
        self.triangles.iter().map(six).sum::<f64>() / 6.0
    }

    /// Whether every edge of every triangle is also an edge of exactly one other, in the opposite
    /// direction.
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

    /// A cylinder or cone around the vertical through (x, y), from the radius at `z[0]` to that at
    /// `z[1]`, mm.
    pub fn round(at: [f64; 2], radius: [f64; 2], z: [f64; 2]) -> Solid {
        let solid = Manifold::cylinder(z[1] - z[0], radius[0], radius[1], CIRCLE);
        Solid(solid.translate(Vec3::new(at[0], at[1], z[0])))
    }

    /// The smallest convex solid around points, mm.
    pub(super) fn hull(points: &[[f64; 3]]) -> Solid {
        let points: Vec<Vec3> = points.iter().map(|p| Vec3::new(p[0], p[1], p[2])).collect();
        Solid(Manifold::hull(&points))
    }

    /// An outline with holes (the outline anticlockwise, holes clockwise), pulled up to `height`, mm.
    pub(super) fn extrude(outlines: &[Vec<[f64; 2]>], height: f64) -> Solid {
        let polygons =
            outlines.iter().map(|line| line.iter().map(|p| Vec2::new(p[0], p[1])).collect()).collect();
        let section = CrossSection::new(polygons);
        Solid(Manifold::extrude(&section.to_polygons(), height, 0, 0.0, Vec2::new(1.0, 1.0)))
    }

    /// Translated, mm.
    pub fn translated(&self, by: [f64; 3]) -> Solid {
        Solid(self.0.translate(Vec3::new(by[0], by[1], by[2])))
    }

    /// Rotated about x, then y, then z, degrees.
    pub fn rotated(&self, degrees: [f64; 3]) -> Solid {
        Solid(self.0.rotate(degrees[0], degrees[1], degrees[2]))
    }

    /// The union of these.
    pub fn union(solids: &[Solid]) -> Solid {
        Solid::batch(solids, OpType::Add)
    }

    /// This solid minus the others.
    pub fn minus(&self, cuts: &[Solid]) -> Solid {
        if cuts.is_empty() { self.clone() } else { Solid(self.0.difference(&Solid::union(cuts).0)) }
    }

    /// The intersection with another one.
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

    /// Number of through holes, as in a torus.
    pub fn genus(&self) -> i32 {
        self.0.genus()
    }

    /// The same without details that are smaller than `detail`, mm.
    #[must_use]
    pub fn simplified(&self, detail: f64) -> Solid {
        Solid(self.0.simplify(detail))
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

    /// The solid of a part, if it is one piece.
    pub(super) fn checked(self, part: &str) -> Result<Solid, SolidError> {
        // Corners separated only by rounding are merged, as they would be in a file of single
        // precision.
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

/// Points on a circle, from one angle (rad) to another.
pub(super) fn arc(centre: [f64; 2], radius: f64, from: f64, to: f64, steps: i32) -> Vec<[f64; 2]> {
    let at = |step: i32| {
        let angle = from + (to - from) * f64::from(step) / f64::from(steps);
        [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()]
    };
    (0..=steps).map(at).collect()
}

/// Points on a sphere, the poles and the equator's quarters among them.
pub(super) fn ball(centre: [f64; 3], radius: f64) -> Vec<[f64; 3]> {
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
