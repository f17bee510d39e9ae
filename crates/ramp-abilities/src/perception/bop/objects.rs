//! The objects of a data set: one for each shape, since parts of one shape cannot be told apart.

use std::fmt::Write;

use nalgebra::{Point3, Rotation3, Vector3};
use ramp_render::mesh::Mesh;
use ramp_render::{Looks, looks::Surface};
use ramp_robot::Pose;
use serde_json::{Value, json};

/// Corners of two surfaces that are nearer than this are the same, m: more than drawing from near leaves out.
const SAME: f32 = 0.8e-3;
/// Longest edge of a mesh for comparing poses, m.
const FINE: f32 = 0.006;
/// Number of points with which poses are compared.
const POINTS: usize = 500;

/// One shape.
#[derive(Clone, Debug)]
pub struct Object {
    /// The parts that have it.
    pub parts: Vec<String>,
    /// Points all over its surface, m, in the frame of a part.
    pub points: Vec<Point3<f64>>,
    /// Turns and shifts that leave it as it is, beside none at all.
    pub symmetries: Vec<Pose>,
    /// Its largest extent, m.
    pub diameter: f64,
    mesh: Mesh,
}

/// All of them. The number of an object is one more than its index.
#[derive(Clone, Debug)]
pub struct Objects {
    /// By number.
    pub all: Vec<Object>,
}

impl Objects {
    /// Of these parts.
    pub fn new(looks: &Looks, parts: &[String]) -> Objects {
        let mut all: Vec<Object> = Vec::new();
        for part in parts {
            let Some(body) = looks.body(part).and_then(|index| looks.bodies().get(index)) else { continue };
            let [Surface { mesh, .. }, _] = &body.surfaces;
            match all.iter_mut().find(|object| object.mesh.points == mesh.points) {
                Some(object) => object.parts.push(part.clone()),
                None => all.push(Object::new(part, mesh)),
            }
        }
        Objects { all }
    }

    /// The object of a part, with its number.
    pub fn of(&self, part: &str) -> Option<(usize, &Object)> {
        let index = self.all.iter().position(|object| object.parts.iter().any(|name| name == part))?;
        Some((index + 1, &self.all[index]))
    }

    /// The file `models_info.json`: extents, diameters and symmetries.
    pub fn info(&self) -> Value {
        let object = |(index, object): (usize, &Object)| {
            let [low, high] = object.bounds();
            let mut info = json!({
                "diameter": object.diameter * 1e3,
                "min_x": low[0] * 1e3, "min_y": low[1] * 1e3, "min_z": low[2] * 1e3,
                "size_x": (high[0] - low[0]) * 1e3,
                "size_y": (high[1] - low[1]) * 1e3,
                "size_z": (high[2] - low[2]) * 1e3,
                "parts": object.parts,
            });
            if !object.symmetries.is_empty() {
                let symmetries: Vec<_> = object.symmetries.iter().map(matrix).collect();
                info["symmetries_discrete"] = json!(symmetries);
            }
            ((index + 1).to_string(), info)
        };
        Value::Object(self.all.iter().enumerate().map(object).collect())
    }
}

/// The sixteen numbers of a pose, row by row, mm.
fn matrix(x: &Pose) -> Vec<f64> {
    let mut matrix = x.to_homogeneous();
    matrix.fixed_view_mut::<3, 1>(0, 3).scale_mut(1e3);
    matrix.transpose().iter().copied().collect()
}

impl Object {
    fn new(part: &str, mesh: &Mesh) -> Object {
        let fine = mesh.clone().refined(FINE);
        let stride = (fine.points.len() / POINTS).max(1);
        let points: Vec<Point3<f64>> =
            fine.points.iter().step_by(stride).map(|point| Point3::from(point.map(f64::from))).collect();
        let corners = || mesh.points.iter().map(|point| Point3::from(*point));
        let diameter = corners()
            .flat_map(|a| corners().map(move |b| nalgebra::distance_squared(&a, &b)))
            .fold(0.0, f32::max);
        let mut object = Object {
            parts: vec![part.to_string()],
            points,
            symmetries: Vec::new(),
            diameter: f64::from(diameter.sqrt()),
            mesh: mesh.clone(),
        };
        object.symmetries = object.find_symmetries();
        object
    }

    /// The lowest and highest of each coordinate, m.
    fn bounds(&self) -> [[f64; 3]; 2] {
        let corners = || self.mesh.points.iter().map(|point| Point3::from(point.map(f64::from)));
        let low = corners().fold(Point3::from([f64::INFINITY; 3]), |low, p| low.inf(&p));
        let high = corners().fold(Point3::from([f64::NEG_INFINITY; 3]), |high, p| high.sup(&p));
        [low.into(), high.into()]
    }

    /// Those turns by quarters about its middle after which each corner lies on another one.
    fn find_symmetries(&self) -> Vec<Pose> {
        let [low, high] = self.bounds().map(Point3::from);
        let middle = nalgebra::center(&low, &high).coords;
        let corners: Vec<Point3<f32>> = self.mesh.points.iter().map(|point| Point3::from(*point)).collect();
        let mut found: Vec<Pose> = Vec::new();
        let quarter = |axis, count: i32| {
            Rotation3::from_axis_angle(&axis, f64::from(count) * std::f64::consts::FRAC_PI_2)
        };
        for (a, b, c) in (0..64).map(|index| (index / 16, index / 4 % 4, index % 4)) {
            let turn =
                quarter(Vector3::x_axis(), a) * quarter(Vector3::y_axis(), b) * quarter(Vector3::z_axis(), c);
            let x = Pose::from_parts((middle - turn * middle).into(), turn.into());
            let known = |other: &Pose| other.rotation.angle_to(&x.rotation) < 0.1;
            if turn.angle() < 0.1 || found.iter().any(known) {
                continue;
            }
            let moved = x.cast::<f32>();
            let lies = |corner: &Point3<f32>| {
                let there = moved * corner;
                corners.iter().any(|other| nalgebra::distance(other, &there) < SAME)
            };
            if corners.iter().all(lies) {
                found.push(x);
            }
        }
        found
    }

    /// The mesh as a PLY file, mm, with the colour of each corner. A `fine` one has corners all over its
    /// faces, for comparing poses.
    pub fn ply(&self, fine: bool) -> String {
        let mesh = if fine { self.mesh.clone().refined(FINE) } else { self.mesh.clone() };
        let mut colours = vec![[0u8; 3]; mesh.points.len()];
        let grey = |light: f32| (light.powf(1.0 / 2.2) * 255.0).round() as u8;
        for (triangle, colour) in mesh.triangles.iter().zip(&mesh.colours) {
            triangle.iter().for_each(|corner| colours[*corner as usize] = colour.map(grey));
        }
        let mut text = String::from("ply\nformat ascii 1.0\n");
        let _ = writeln!(text, "element vertex {}", mesh.points.len());
        for name in ["x", "y", "z"] {
            let _ = writeln!(text, "property float {name}");
        }
        for name in ["red", "green", "blue"] {
            let _ = writeln!(text, "property uchar {name}");
        }
        let _ = writeln!(text, "element face {}", mesh.triangles.len());
        text.push_str("property list uchar int vertex_indices\nend_header\n");
        for (point, [r, g, b]) in mesh.points.iter().zip(&colours) {
            let [x, y, z] = point.map(|value| value * 1e3);
            let _ = writeln!(text, "{x:.4} {y:.4} {z:.4} {r} {g} {b}");
        }
        for [a, b, c] in &mesh.triangles {
            let _ = writeln!(text, "3 {a} {b} {c}");
        }
        text
    }
}
