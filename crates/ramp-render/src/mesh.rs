//! Surfaces made of coloured triangles, metres, in the frame of their body.

use nalgebra::{Isometry3, Point3, Vector3};
use ramp_kit::shape::Cuboid;

/// A colour in linear light, red, green and blue, 0 to 1.
pub type Colour = [f32; 3];

/// A body's surface.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Corners, m.
    pub points: Vec<[f32; 3]>,
    /// Three corners each, anticlockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The colour of each triangle.
    pub colours: Vec<Colour>,
}

impl Mesh {
    /// Adds another surface, in one colour.
    pub fn add(
        &mut self,
        points: impl IntoIterator<Item = [f64; 3]>,
        triangles: impl IntoIterator<Item = [u32; 3]>,
        colour: Colour,
    ) {
        let first = self.points.len() as u32;
        self.points.extend(points.into_iter().map(|point| point.map(|value| value as f32)));
        for triangle in triangles {
            self.triangles.push(triangle.map(|corner| first + corner));
            self.colours.push(colour);
        }
    }

    /// Adds a solid of the kit, which comes in millimetres, moved by `x`.
    pub fn add_solid(&mut self, solid: &ramp_kit::solid::Solid, x: &Isometry3<f64>, colour: Colour) {
        let mesh = solid.mesh();
        let points: Vec<[f64; 3]> = mesh
            .points
            .iter()
            .map(|point| {
                let point = x * Point3::from(point.map(|value| value * 1e-3));
                [point.x, point.y, point.z]
            })
            .collect();
        self.add(points, mesh.triangles, colour);
    }

    /// Adds a box.
    pub fn add_box(&mut self, cuboid: &Cuboid, colour: Colour) {
        let corner = |index: usize| -> [f64; 3] {
            std::array::from_fn(
                |axis| if index >> axis & 1 == 0 { cuboid.min[axis] } else { cuboid.max[axis] },
            )
        };
        const QUADS: [[u32; 4]; 6] =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = QUADS.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        self.add((0..8).map(corner), triangles, colour);
    }

    /// Halves edges until none is longer than `longest` (m), so that a lens may bend them. Neighbours stay
    /// together: whether an edge is halved depends on the edge alone.
    pub fn refined(self, longest: f32) -> Mesh {
        let mut points = self.points;
        let mut todo: Vec<([u32; 3], Colour)> = self.triangles.into_iter().zip(self.colours).rev().collect();
        let mut middles = std::collections::HashMap::new();
        let mut mesh = Mesh::default();
        while let Some(([a, b, c], colour)) = todo.pop() {
            let length = |from: u32, to: u32| distance(&points[from as usize], &points[to as usize]);
            let edges = [(length(a, b), [a, b, c]), (length(b, c), [b, c, a]), (length(c, a), [c, a, b])];
            let longest_edge =
                edges.iter().fold(edges[0], |best, next| if next.0 > best.0 { *next } else { best });
            let (length, [from, to, other]) = longest_edge;
            if length <= longest {
                mesh.triangles.push([a, b, c]);
                mesh.colours.push(colour);
                continue;
            }
            let middle = *middles.entry((from.min(to), from.max(to))).or_insert_with(|| {
                let (p, q) = (points[from as usize], points[to as usize]);
                points.push(std::array::from_fn(|axis| 0.5 * (p[axis] + q[axis])));
                points.len() as u32 - 1
            });
            todo.push(([from, middle, other], colour));
            todo.push(([middle, to, other], colour));
        }
        mesh.points = points;
        mesh
    }

    /// A rough copy for shadows: corners that share a cell of a grid of `cell` (m) become one.
    pub fn coarse(&self, cell: f32) -> Mesh {
        let mut cells = std::collections::HashMap::new();
        let mut mesh = Mesh::default();
        let key = |point: &[f32; 3]| point.map(|value| (value / cell).round() as i32);
        let new: Vec<u32> = self
            .points
            .iter()
            .map(|point| {
                *cells.entry(key(point)).or_insert_with(|| {
                    mesh.points.push(*point);
                    mesh.points.len() as u32 - 1
                })
            })
            .collect();
        for (triangle, colour) in self.triangles.iter().zip(&self.colours) {
            let [a, b, c] = triangle.map(|corner| new[corner as usize]);
            if a != b && b != c && c != a {
                mesh.triangles.push([a, b, c]);
                mesh.colours.push(*colour);
            }
        }
        mesh
    }

    /// Centre and radius of a ball around it, m.
    pub fn ball(&self) -> ([f32; 3], f32) {
        let mut low = [f32::INFINITY; 3];
        let mut high = [f32::NEG_INFINITY; 3];
        for point in &self.points {
            for axis in 0..3 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        if self.points.is_empty() {
            return ([0.0; 3], 0.0);
        }
        let centre = std::array::from_fn(|axis| 0.5 * (low[axis] + high[axis]));
        let radius = self.points.iter().map(|point| distance(point, &centre)).fold(0.0, f32::max);
        (centre, radius)
    }

    /// The outward normal of each triangle.
    pub fn normals(&self) -> Vec<[f32; 3]> {
        let corner = |index: u32| Vector3::from(self.points[index as usize]);
        let normal = |&[a, b, c]: &[u32; 3]| {
            let cross = (corner(b) - corner(a)).cross(&(corner(c) - corner(a)));
            let length = cross.norm();
            if length > 0.0 { (cross / length).into() } else { [0.0, 0.0, 1.0] }
        };
        self.triangles.iter().map(normal).collect()
    }
}

fn distance(a: &[f32; 3], b: &[f32; 3]) -> f32 {
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2) + (a[2] - b[2]).powi(2)).sqrt()
}
