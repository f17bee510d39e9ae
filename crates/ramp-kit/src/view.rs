//! Line drawings of solids: the visible edges.

use crate::solid::Mesh;
use nalgebra::{Vector2, Vector3};
use std::collections::HashMap;

/// A viewing direction: parallel projection, one millimetre of the part becomes `scale` on paper.
pub(crate) struct View {
    /// Right and up on the paper, in the frame of the parts.
    right: Vector3<f64>,
    up: Vector3<f64>,
    /// Towards the viewer.
    eye: Vector3<f64>,
    pub scale: f64,
}

/// Visible lines on paper, mm, y down, relative to the view's origin.
pub(crate) type Lines = Vec<[Vector2<f64>; 2]>;

/// Cosine limit: faces that meet at a smaller angle, such as facets of a circle, have no edge.
const SMOOTH: f64 = 0.94;
/// Size of a cell of the depth map on paper, mm.
const CELL: f64 = 0.15;
/// Largest distance behind the depth map at which an edge counts as on the surface, mm of the part.
const BEHIND: f64 = 0.6;

impl View {
    /// From the left front and above: x of the part goes to the right and a little down.
    pub fn oblique(scale: f64) -> View {
        let eye = Vector3::new(-0.26, -0.78, 0.58).normalize();
        let right = Vector3::z().cross(&eye).normalize();
        View { right, up: eye.cross(&right), eye, scale }
    }

    /// A point on paper, mm.
    pub fn at(&self, p: &Vector3<f64>) -> Vector2<f64> {
        Vector2::new(p.dot(&self.right), -p.dot(&self.up)) * self.scale
    }

    /// The smallest and the largest coordinates of meshes on paper, mm.
    pub fn bounds(&self, meshes: &[Mesh]) -> [Vector2<f64>; 2] {
        let points = meshes.iter().flat_map(|mesh| &mesh.points).map(|p| self.at(&Vector3::from(*p)));
        let none = [Vector2::repeat(f64::INFINITY), Vector2::repeat(f64::NEG_INFINITY)];
        points.fold(none, |[low, high], p| [low.inf(&p), high.sup(&p)])
    }

    /// The visible edges of meshes.
    pub fn lines(&self, meshes: &[Mesh]) -> Lines {
        let mut map = DepthMap::new(self.bounds(meshes));
        for mesh in meshes {
            for triangle in &mesh.triangles {
                map.cover(triangle.map(|index| {
                    let p = Vector3::from(mesh.points[index as usize]);
                    (self.at(&p), p.dot(&self.eye))
                }));
            }
        }
        let mut lines = Vec::new();
        for mesh in meshes {
            for [a, b] in self.edges(mesh) {
                self.visible(&map, &a, &b, &mut lines);
            }
        }
        lines
    }

    /// The edges of a mesh to draw where they are visible: creases, and silhouettes of rounded
    /// surfaces.
    fn edges(&self, mesh: &Mesh) -> Vec<[Vector3<f64>; 2]> {
        let mut normals: HashMap<[u32; 2], Vec<Vector3<f64>>> = HashMap::new();
        let mut order = Vec::new();
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|index| Vector3::from(mesh.points[index as usize]));
            let Some(normal) = (b - a).cross(&(c - a)).try_normalize(1e-9) else { continue };
            for corner in 0..3 {
                let (from, to) = (triangle[corner], triangle[(corner + 1) % 3]);
                let edge = [from.min(to), from.max(to)];
                let sides = normals.entry(edge).or_default();
                if sides.is_empty() {
                    order.push(edge);
                }
                sides.push(normal);
            }
        }
        let drawn = |edge: &[u32; 2]| match normals[edge].as_slice() {
            [a, b] => {
                let bend = a.dot(b);
                let outline = (a.dot(&self.eye) > 0.0) != (b.dot(&self.eye) > 0.0) && bend < 0.999_99;
                bend < SMOOTH || outline
            }
            _ => true,
        };
        let points = |edge: [u32; 2]| edge.map(|index| Vector3::from(mesh.points[index as usize]));
        order.into_iter().filter(drawn).map(points).collect()
    }

    fn visible(&self, map: &DepthMap, a: &Vector3<f64>, b: &Vector3<f64>, lines: &mut Lines) {
        let (pa, pb) = (self.at(a), self.at(b));
        let steps = ((pb - pa).norm() / (CELL * 1.5)).ceil().max(1.0);
        let mut from = None;
        let mut step = 0.0;
        while step <= steps {
            let share = step / steps;
            let p = a + (b - a) * share;
            let seen = p.dot(&self.eye) > map.depth(&self.at(&p)) - BEHIND;
            match (seen, from) {
                (true, None) => from = Some(share),
                (false, Some(begin)) => {
                    lines.push([pa + (pb - pa) * begin, pa + (pb - pa) * (step - 1.0) / steps]);
                    from = None;
                }
                _ => {}
            }
            step += 1.0;
        }
        if let Some(begin) = from {
            lines.push([pa + (pb - pa) * begin, pb]);
        }
        // A point is not a line.
        lines.retain(|[a, b]| (b - a).norm_squared() > 1e-6);
    }
}

/// The distance of the nearest surface in every cell of the paper.
struct DepthMap {
    origin: Vector2<f64>,
    columns: usize,
    rows: usize,
    depth: Vec<f64>,
}

impl DepthMap {
    fn new([low, high]: [Vector2<f64>; 2]) -> DepthMap {
        let cells = |length: f64| (length / CELL).clamp(0.0, 8000.0).ceil() as usize + 2;
        let (columns, rows) = (cells(high.x - low.x), cells(high.y - low.y));
        DepthMap { origin: low, columns, rows, depth: vec![f64::NEG_INFINITY; columns * rows] }
    }

    /// A cell's centre, in cells.
    fn cell(&self, p: &Vector2<f64>) -> Vector2<f64> {
        (p - self.origin) / CELL
    }

    /// The farthest of the nearest surfaces around a point. Beside a rounded silhouette lies the
    /// background, and its own surface falls away steeply.
    fn depth(&self, p: &Vector2<f64>) -> f64 {
        let cell = self.cell(p);
        let mut farthest = f64::INFINITY;
        for row in [cell.y - 1.0, cell.y, cell.y + 1.0] {
            for column in [cell.x - 1.0, cell.x, cell.x + 1.0] {
                let (column, row) = (column.round().max(0.0) as usize, row.round().max(0.0) as usize);
                let index = row.min(self.rows - 1) * self.columns + column.min(self.columns - 1);
                farthest = farthest.min(self.depth[index]);
            }
        }
        farthest
    }

    /// Adds a triangle: its corners on paper, and their depths.
    fn cover(&mut self, corners: [(Vector2<f64>, f64); 3]) {
        let [(a, da), (b, db), (c, dc)] = corners.map(|(p, depth)| (self.cell(&p), depth));
        let area = (b - a).perp(&(c - a));
        if area.abs() < 1e-9 {
            return;
        }
        let range = |low: f64, high: f64, count: usize| {
            let last = count as f64 - 1.0;
            (low.ceil().clamp(0.0, last) as usize, high.floor().clamp(0.0, last) as usize)
        };
        let (x0, x1) = range(a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x), self.columns);
        let (y0, y1) = range(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y), self.rows);
        for row in y0..=y1 {
            for column in x0..=x1 {
                let p = Vector2::new(column as f64, row as f64);
                let (u, v) = ((c - b).perp(&(p - b)) / area, (a - c).perp(&(p - c)) / area);
                let w = 1.0 - u - v;
                if u >= -1e-9 && v >= -1e-9 && w >= -1e-9 {
                    let nearest = &mut self.depth[row * self.columns + column];
                    *nearest = nearest.max(u * da + v * db + w * dc);
                }
            }
        }
    }
}
