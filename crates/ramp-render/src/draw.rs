//! From poses and a camera to pixels: a depth buffer says which triangle each pixel shows, then every pixel is
//! coloured once.

use std::sync::Arc;

use nalgebra::Vector3;
use ramp_robot::{CameraModel, Pose};

use crate::lens::Lens;
use crate::looks::{Looks, Sticker};
use crate::mesh::Mesh;
use crate::sensor::{FULL, Sensor};
use crate::texture::{Level, PLACES, TAG_LIGHT};

/// Nothing nearer than this is drawn, m.
const NEAR: f32 = 0.01;
/// By how much nearer than it is a tag counts when it is asked what hides what, m: more than the details that meshes
/// leave out.
const STICKER_LIFT: f32 = 1.0e-3;
/// Where the light comes from, in the world: a lamp to the right of the robot, behind whoever looks at it.
const LIGHT: [f32; 3] = [0.30, -0.34, 0.89];
/// Light from everywhere, more of it from above, and light from the lamp.
const AMBIENT: f32 = 0.42;
const SKY: f32 = 0.13;
const LAMP: f32 = 0.55;
/// The table's top (x and y ranges in the world, m), its colour, and that of the floor around it.
const TABLE: [[f32; 2]; 2] = [[-0.4, 1.6], [-0.6, 0.6]];
const TABLE_COLOUR: [f32; 3] = [0.33, 0.31, 0.28];
const FLOOR_COLOUR: [f32; 3] = [0.13, 0.13, 0.13];
/// What is seen where nothing is.
const WALL_COLOUR: [f32; 3] = [0.55, 0.57, 0.60];
/// Cells of the shadow map per metre, and how much of the light a shadow leaves.
const SHADOW_SCALE: f32 = 200.0;
const SHADOW_LEFT: f32 = 0.55;
/// Shadows are cast up to so far beyond what a camera sees of the table, m: more than their edges are wide.
const SHADOW_EDGE: f32 = 0.1;
/// Cells over which a shadow's edge is spread.
const WIDE: u16 = 5;
/// What is at a place: something to be looked at closely, nothing but table, nothing but paper, the floor beside the table,
/// or, where one does not look down at all, the wall.
const DETAIL: u8 = 0;
const TABLE_TOP: u8 = 1;
const PAPER: u8 = 2;
const FLOOR: u8 = 3;
const WALL: u8 = 4;
/// Pixels along a row between two whose places on the table are worked out, from near and from far, and how far apart those
/// may be, m: twice what is known to be bare around a cell, and less than the width of any shadow.
const STRIDES: [usize; 2] = [16, 8];
const BARE: f32 = 20.0e-3;
/// A body of which a pixel covers more than this is drawn with less detail, m.
const FAR_PIXEL: f32 = 0.8e-3;
/// Marks a pixel that shows a tag.
const TAG: u32 = 1 << 31;
/// A body's number in the segmentation for the table, the floor and the wall.
pub const NOTHING: u16 = u16::MAX;

/// Where all bodies are.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Index of each body that is there ([`Looks::body`]) and its pose in the world.
    pub bodies: Vec<(usize, Pose)>,
}

/// A tag that is in view: how its plane is seen.
struct SeenTag {
    sticker: Sticker,
    /// From the direction (x/z, y/z, 1) of a pixel to the tag's plane: rows of a homography onto (x w, y w, w).
    rows: [[f32; 3]; 3],
    /// How bright a pixel is of which that many [`PLACES`] are white.
    light: [u16; PLACES + 1],
    body: u16,
}

/// Draws what one camera sees. Keeps its buffers from image to image.
pub struct Renderer {
    looks: Arc<Looks>,
    lens: Lens,
    /// One over the distance along the optical axis, 1/m; 0 where nothing is.
    near: Vec<f32>,
    /// What is shown: 0 nothing, a colour of the palette, or a tag.
    shown: Vec<u32>,
    palette: Vec<[u16; 3]>,
    /// The body of each colour of the palette.
    owner: Vec<u16>,
    tags: Vec<SeenTag>,
    /// Where the last picture was taken from.
    x_wc: Pose,
    screen: Vec<[f32; 3]>,
    shadow: Vec<u8>,
    /// Sums while shadows' edges are made soft.
    sums: [Vec<u16>; 2],
    /// For each cell of the map what is there: [`TABLE_TOP`], [`PAPER`] or [`DETAIL`].
    bare: Vec<u8>,
    /// For each cell of the map the shadow on it, on its right neighbour, and on the two below, a byte each.
    soft: Vec<u32>,
}

/// A turn and a shift in single precision.
#[derive(Clone, Copy)]
struct Rigid {
    turn: [[f32; 3]; 3],
    shift: [f32; 3],
}

impl Rigid {
    fn new(x: &Pose) -> Rigid {
        let m = x.rotation.to_rotation_matrix();
        Rigid {
            turn: std::array::from_fn(|row| std::array::from_fn(|column| m[(row, column)] as f32)),
            shift: std::array::from_fn(|axis| x.translation.vector[axis] as f32),
        }
    }

    #[inline]
    fn turned(&self, v: &[f32; 3]) -> [f32; 3] {
        std::array::from_fn(|row| {
            self.turn[row][0] * v[0] + self.turn[row][1] * v[1] + self.turn[row][2] * v[2]
        })
    }

    #[inline]
    fn moved(&self, p: &[f32; 3]) -> [f32; 3] {
        let turned = self.turned(p);
        std::array::from_fn(|axis| turned[axis] + self.shift[axis])
    }
}

fn light_on(normal: &[f32; 3]) -> f32 {
    let lamp = normal[0] * LIGHT[0] + normal[1] * LIGHT[1] + normal[2] * LIGHT[2];
    AMBIENT + SKY * normal[2] + LAMP * lamp.max(0.0)
}

fn linear(value: f32) -> u16 {
    (value * f32::from(FULL)).clamp(0.0, f32::from(FULL)) as u16
}

impl Renderer {
    /// A renderer for a camera.
    pub fn new(looks: Arc<Looks>, model: &CameraModel) -> Renderer {
        let count = model.width * model.height;
        let cells = shadow_size();
        Renderer {
            bare: bare(&looks),
            looks,
            lens: Lens::new(model),
            near: vec![0.0; count],
            shown: vec![0; count],
            palette: Vec::new(),
            owner: Vec::new(),
            tags: Vec::new(),
            x_wc: Pose::identity(),
            screen: Vec::new(),
            shadow: vec![0; cells[0] * cells[1]],
            sums: [0, 1].map(|_| vec![0; cells[0] * cells[1]]),
            soft: vec![0; cells[0] * cells[1]],
        }
    }

    /// What it draws.
    pub fn looks(&self) -> &Looks {
        &self.looks
    }

    /// Takes a picture: red, green and blue of each pixel, gamma 2.2. `x_wc` is the pose of the optical frame in the
    /// world.
    pub fn render(&mut self, scene: &Scene, x_wc: &Pose, sensor: &mut Sensor) -> Vec<u8> {
        self.near.fill(0.0);
        self.shown.fill(0);
        self.palette.clear();
        self.owner.clear();
        self.tags.clear();
        self.x_wc = *x_wc;
        // Colour 0 is nothing.
        self.palette.push([0; 3]);
        self.owner.push(NOTHING);
        let looks = Arc::clone(&self.looks);
        let x_cw = x_wc.inverse();
        for (index, x_wb) in &scene.bodies {
            self.body(&looks, *index, x_wb, &(x_cw * x_wb));
        }
        self.tag(&looks.sheet_tag, &Pose::identity(), &x_cw, NOTHING);
        self.cast_shadows(&looks, scene, &Rigid::new(&x_cw));
        self.expose(&looks, x_wc, sensor)
    }

    /// Distance along the optical axis in each pixel of the last picture, m; infinite where nothing is.
    pub fn depth(&self) -> Vec<f32> {
        let camera = Rigid::new(&self.x_wc);
        let width = self.lens.model.width;
        let table = |index: usize| {
            let [dx, dy] = self.lens.row(index / width).map(|row| row[index % width]);
            let fall = camera.turn[2][0] * dx + camera.turn[2][1] * dy + camera.turn[2][2];
            if fall < 0.0 { -camera.shift[2] / fall } else { f32::INFINITY }
        };
        let depth = |(index, near): (usize, &f32)| if *near > 0.0 { 1.0 / near } else { table(index) };
        self.near.iter().enumerate().map(depth).collect()
    }

    /// Which body each pixel of the last picture shows ([`Looks::bodies`]), or [`NOTHING`].
    pub fn segmentation(&self) -> Vec<u16> {
        let owner = |shown: &u32| {
            if shown & TAG != 0 {
                self.tags[(shown & !TAG) as usize].body
            } else {
                self.owner[*shown as usize]
            }
        };
        self.shown.iter().map(owner).collect()
    }

    fn body(&mut self, looks: &Looks, index: usize, x_wb: &Pose, x_cb: &Pose) {
        let Some(body) = looks.bodies().get(index) else { return };
        let (camera, world) = (Rigid::new(x_cb), Rigid::new(x_wb));
        if !self.in_view(&camera, body.ball) {
            return;
        }
        // What a pixel covers on it decides how much detail is drawn.
        let distance = camera.moved(&body.ball.0)[2] - body.ball.1;
        let far = distance > FAR_PIXEL * self.lens.model.focal[0] as f32;
        let surface = &body.surfaces[usize::from(far)];
        self.project(&camera, &surface.mesh);
        let mesh = &surface.mesh;
        for ((triangle, normal), colour) in mesh.triangles.iter().zip(&surface.normals).zip(&mesh.colours) {
            let corners = triangle.map(|corner| self.screen[corner as usize]);
            let next = self.palette.len() as u32;
            if self.triangle(&corners, next) {
                let light = light_on(&world.turned(normal));
                let [r, g, b] = colour.map(|share| linear(share * light));
                self.palette.push([r, g, b]);
                self.owner.push(index as u16);
            }
        }
        for sticker in &body.tags {
            self.tag(sticker, x_wb, x_cb, index as u16);
        }
    }

    /// Could a ball be in the image?
    fn in_view(&self, camera: &Rigid, (centre, radius): ([f32; 3], f32)) -> bool {
        let [x, y, z] = camera.moved(&centre);
        if z + radius < NEAR {
            return false;
        }
        // The half angles of the image's sides, a little wider.
        let model = &self.lens.model;
        let side = |value: f32, pixels: usize, focal: f64| {
            let slope = 0.58 * pixels as f32 / focal as f32;
            value.abs() - radius * (1.0 + slope * slope).sqrt() < slope * z.max(0.0)
        };
        side(x, model.width, model.focal[0]) && side(y, model.height, model.focal[1])
    }

    /// Puts the corners of a mesh on the screen: pixels and one over the distance, or −1 behind the camera.
    fn project(&mut self, camera: &Rigid, mesh: &Mesh) {
        self.screen.clear();
        for point in &mesh.points {
            let p = camera.moved(point);
            if p[2] < NEAR {
                self.screen.push([0.0, 0.0, -1.0]);
            } else {
                let [x, y] = self.lens.project(p);
                self.screen.push([x, y, 1.0 / p[2]]);
            }
        }
    }

    /// Draws a triangle that is seen from outside; says whether it may be in the image.
    #[inline]
    fn triangle(&mut self, corners: &[[f32; 3]; 3], shown: u32) -> bool {
        let [a, b, c] = corners;
        if a[2] < 0.0 || b[2] < 0.0 || c[2] < 0.0 {
            return false;
        }
        // y points down, so what is anticlockwise from outside is clockwise here: a negative area.
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        if area >= -1e-6 {
            return false;
        }
        let (width, height) = (self.lens.model.width, self.lens.model.height);
        let low = |axis: usize| a[axis].min(b[axis]).min(c[axis]);
        let high = |axis: usize| a[axis].max(b[axis]).max(c[axis]);
        // Pixels whose middles are inside.
        let first = (-floor(0.5 - low(1))).max(0);
        let last = floor(high(1) - 0.5).min(height as i32 - 1);
        let left = (-floor(0.5 - low(0))).max(0);
        let right = floor(high(0) - 0.5).min(width as i32 - 1);
        if first > last || left > right {
            return false;
        }
        let one = 1.0 / area;
        let slope = |axis: usize| {
            let (b, c) = ((b[2] - a[2]) * one, (c[2] - a[2]) * one);
            if axis == 0 {
                b * (corners[2][1] - a[1]) - c * (corners[1][1] - a[1])
            } else {
                c * (corners[1][0] - a[0]) - b * (corners[2][0] - a[0])
            }
        };
        let (dx, dy) = (slope(0), slope(1));
        // Anticlockwise on the screen: going up the inside lies to the left of an edge, going down to its right.
        let (mut rights, mut lefts) =
            ([Edge::new(f32::INFINITY, 0.0); 2], [Edge::new(f32::NEG_INFINITY, 0.0); 2]);
        let (mut right_count, mut left_count) = (0, 0);
        let top = first as f32 + 0.5;
        for [p, q] in [[a, b], [b, c], [c, a]] {
            let rise = q[1] - p[1];
            let slope = ((q[0] - p[0]) / rise).clamp(-STEEP, STEEP);
            let edge = || Edge::new(p[0] - 0.5 + slope * (top - p[1]), slope);
            if rise < -1e-6 && right_count < 2 {
                rights[right_count] = edge();
                right_count += 1;
            } else if rise > 1e-6 && left_count < 2 {
                lefts[left_count] = edge();
                left_count += 1;
            }
        }
        let (left, right) = (i64::from(left), i64::from(right));
        for y in first as usize..=last as usize {
            let middle = y as f32 + 0.5;
            let [[a_right, b_right], [a_left, b_left]] =
                [&mut rights, &mut lefts].map(|edges| edges.each_mut().map(Edge::next));
            let to = right.min(a_right.min(b_right) >> Edge::BITS);
            let from = left.max((a_left.max(b_left) + Edge::ALMOST) >> Edge::BITS);
            if from > to {
                continue;
            }
            let (from, to) = (from as usize, to as usize + 1);
            let start = a[2] + dx * (from as f32 + 0.5 - a[0]) + dy * (middle - a[1]);
            let near = &mut self.near[y * width + from..y * width + to];
            let pixels = &mut self.shown[y * width + from..y * width + to];
            // Without a branch: several pixels go at once, and which ones are hidden cannot be guessed.
            for ((near, pixel), step) in near.iter_mut().zip(pixels).zip(0i32..) {
                let value = start + dx * step as f32;
                let mask = u32::from(value > *near).wrapping_neg();
                *near = f32::from_bits(value.to_bits() & mask | near.to_bits() & !mask);
                *pixel = shown & mask | *pixel & !mask;
            }
        }
        true
    }

    /// Draws a tag of a body.
    fn tag(&mut self, sticker: &Sticker, x_wb: &Pose, x_cb: &Pose, body: u16) {
        const PARTS: usize = 4;
        let x_cg = x_cb * sticker.place.x_pg;
        let p_g_camera = x_cg.inverse().translation.vector;
        if p_g_camera.z <= 0.0 {
            return;
        }
        let camera = Rigid::new(&x_cg);
        if !self.in_view(&camera, ([0.0; 3], 0.8 * sticker.size)) {
            return;
        }
        let number = TAG | self.tags.len() as u32;
        let corner = |row: usize, column: usize| {
            let at = |index: usize| sticker.size * (index as f32 / PARTS as f32 - 0.5);
            camera.moved(&[at(column), at(row), 0.0])
        };
        for row in 0..PARTS {
            for column in 0..PARTS {
                let quad = [
                    corner(row, column),
                    corner(row, column + 1),
                    corner(row + 1, column + 1),
                    corner(row + 1, column),
                ];
                if quad.iter().any(|p| p[2] < NEAR) {
                    continue;
                }
                let [a, b, c, d] = quad.map(|p| {
                    let [x, y] = self.lens.project(p);
                    [x, y, 1.0 / (p[2] - STICKER_LIFT)]
                });
                self.triangle(&[a, b, c], number);
                self.triangle(&[a, c, d], number);
            }
        }
        // A direction d of C meets the plane z = 0 of G where o + t R d has z = 0, o being the camera in G.
        let turn = x_cg.rotation.inverse().to_rotation_matrix();
        let o = p_g_camera;
        let row = |axis: usize| -> [f32; 3] {
            std::array::from_fn(|column| (o[axis] * turn[(2, column)] - o.z * turn[(axis, column)]) as f32)
        };
        let last = std::array::from_fn(|column| turn[(2, column)] as f32);
        let normal = (x_wb * sticker.place.x_pg).rotation * Vector3::z();
        let light = light_on(&[normal.x as f32, normal.y as f32, normal.z as f32]);
        let [white, black] = TAG_LIGHT.map(|share| share * light);
        let share = |count: usize| count as f32 / PLACES as f32;
        self.tags.push(SeenTag {
            sticker: sticker.clone(),
            rows: [row(0), row(1), last],
            light: std::array::from_fn(|count| linear(black + (white - black) * share(count))),
            body,
        });
    }

    /// Marks on a map of the table what the lamp does not reach, where `camera` (the world's pose in it) may see it.
    fn cast_shadows(&mut self, looks: &Looks, scene: &Scene, camera: &Rigid) {
        let [columns, rows] = shadow_size();
        self.shadow.fill(0);
        for (index, x_wb) in &scene.bodies {
            let Some(body) = looks.bodies().get(*index) else { continue };
            let world = Rigid::new(x_wb);
            let (centre, radius) = body.ball;
            let [x, y, z] = world.moved(&centre);
            let down = z / LIGHT[2];
            let middle = [x - LIGHT[0] * down, y - LIGHT[1] * down, 0.0];
            if !self.in_view(camera, (middle, radius / LIGHT[2] + SHADOW_EDGE)) {
                continue;
            }
            self.screen.clear();
            for point in &body.shadow.points {
                let [x, y, z] = world.moved(point);
                let down = z.max(0.0) / LIGHT[2];
                self.screen.push([
                    (x - LIGHT[0] * down - TABLE[0][0]) * SHADOW_SCALE,
                    (y - LIGHT[1] * down - TABLE[1][0]) * SHADOW_SCALE,
                    0.0,
                ]);
            }
            for triangle in &body.shadow.triangles {
                let corners = triangle.map(|corner| self.screen[corner as usize]);
                fill(&mut self.shadow, columns, rows, &corners);
            }
        }
        // Soft edges: the lamp is not a point. Then, wider, where there is any shadow at all.
        let [sums, marks] = &mut self.sums;
        for (sum, shadow) in sums.iter_mut().zip(&self.shadow) {
            *sum = u16::from(*shadow);
        }
        spread(sums, marks, columns);
        for (mark, sum) in marks.iter_mut().zip(&*sums) {
            *mark = sum / (WIDE * WIDE);
        }
        // The last cells, which have no neighbours, are never in shadow: see [`spread`].
        let inner = marks.len() - columns - 1;
        let [a, b, c, d] = [0, 1, columns, columns + 1].map(|step| &marks[step..][..inner]);
        for ((((soft, a), b), c), d) in self.soft.iter_mut().zip(a).zip(b).zip(c).zip(d) {
            *soft = u32::from(*a) | u32::from(*b) << 8 | u32::from(*c) << 16 | u32::from(*d) << 24;
        }
    }

    /// Colours every pixel, blurs as the lens does, and lets the sensor count the light.
    fn expose(&mut self, looks: &Looks, x_wc: &Pose, sensor: &mut Sensor) -> Vec<u8> {
        let (width, height) = (self.lens.model.width, self.lens.model.height);
        sensor.begin();
        let mut image = Vec::with_capacity(width * height * 3);
        // A row of linear light with its first and last pixel repeated, and the last three rows, blurred.
        let mut light = vec![0u16; 3 * (width + 2)];
        let mut rows = vec![vec![0u16; 3 * width]; 3];
        let mut mixed = vec![0u16; 3 * width];
        let table = Table::new(looks, x_wc, &self.lens.model);
        let mut nodes = vec![[0.0; 2]; width.div_ceil(table.stride) + 1];
        for y in 0..=height {
            if y < height {
                self.colour_row(looks, &table, y, &mut nodes, &mut light[3..3 * (width + 1)]);
                light.copy_within(3..6, 0);
                light.copy_within(3 * width..3 * (width + 1), 3 * (width + 1));
                blur(&mut rows[y % 3], &light, &light[3..], &light[6..]);
            }
            if y == 0 {
                continue;
            }
            let above = &rows[y.saturating_sub(2) % 3];
            let here = &rows[(y - 1) % 3];
            let below = &rows[y.min(height - 1) % 3];
            blur(&mut mixed, above, here, below);
            sensor.expose(&mixed, &mut image);
        }
        image
    }

    fn colour_row(
        &self,
        looks: &Looks,
        table: &Table<'_>,
        y: usize,
        nodes: &mut [[f32; 2]],
        light: &mut [u16],
    ) {
        let width = self.lens.model.width;
        let [dx, dy] = self.lens.row(y);
        for (index, node) in nodes.iter_mut().enumerate() {
            let x = (index * table.stride).min(width - 1);
            *node = table.place(dx[x], dy[x]);
        }
        let shown = &self.shown[y * width..][..width];
        let mut x = 0;
        while x < width {
            // A run of pixels that show one thing.
            let what = shown[x];
            let end = x + run(&shown[x..]);
            if what == 0 {
                let mut from = x;
                while from < end {
                    let to = end.min((from / table.stride + 1) * table.stride);
                    let light = &mut light[3 * from..3 * to];
                    table.stretch(looks, (&self.bare, &self.soft), [dx, dy], nodes, from, light);
                    from = to;
                }
            } else if what & TAG == 0 {
                let colour = self.palette[what as usize];
                light[3 * x..3 * end].chunks_exact_mut(3).for_each(|light| light.copy_from_slice(&colour));
            } else {
                let tag = &self.tags[(what & !TAG) as usize];
                let mut steps = [[0.0; 2]; 2];
                for (light, at) in light[3 * x..3 * end].chunks_exact_mut(3).zip(x..end) {
                    if (at - x).is_multiple_of(STRETCH) {
                        steps = self.lens.step(at, y);
                    }
                    light.fill(tag_pixel(tag, steps, [dx[at], dy[at]]));
                }
            }
            x = end;
        }
    }
}

/// How many show the same as the first: several at once as long as that is so.
#[inline]
fn run(shown: &[u32]) -> usize {
    const MANY: usize = 8;
    let what = shown.first().copied().unwrap_or_default();
    let same = |many: &[u32; MANY]| many.iter().fold(0, |others, next| others | next ^ what) == 0;
    let whole = MANY * shown.as_chunks().0.iter().take_while(|many| same(many)).count();
    whole + shown[whole..].iter().take_while(|next| **next == what).count()
}

/// Pixels along a row for which the way to the next direction is taken to be the same.
const STRETCH: usize = 16;

/// How bright a pixel is that looks at a tag along a direction; `steps` lead to the next pixels' directions.
#[inline]
fn tag_pixel(tag: &SeenTag, steps: [[f32; 2]; 2], [dx, dy]: [f32; 2]) -> u16 {
    let [[xx, xy, xz], [yx, yy, yz], [wx, wy, wz]] = tag.rows;
    let one = 1.0 / (wx * dx + wy * dy + wz);
    let at = [(xx * dx + xy * dy + xz) * one, (yx * dx + yy * dy + yz) * one];
    // How far the next pixels are on the tag.
    let [right, below] = steps.map(|[sx, sy]| {
        let fall = wx * sx + wy * sy;
        [(xx * sx + xy * sy - at[0] * fall) * one, (yx * sx + yy * sy - at[1] * fall) * one]
    });
    tag.light[tag.sticker.cells.white(at[0], at[1], right, below)]
}

/// More pixels from row to row than an edge needs to cross any image between two rows.
const STEEP: f32 = 4e6;

/// Where the edge of a triangle crosses the middles of rows, in pixels from the middle of the first: whole numbers of
/// small parts of pixels, so that a row costs an addition.
#[derive(Clone, Copy)]
struct Edge {
    at: i64,
    step: i64,
}

impl Edge {
    /// So many bits are the parts of a pixel.
    const BITS: u32 = 24;
    /// A little less than a pixel.
    const ALMOST: i64 = (1 << Self::BITS) - 1;
    /// Further outside than any image, and far from the end of the numbers.
    const OUTSIDE: f32 = 1e10;

    #[inline]
    fn new(at: f32, step: f32) -> Edge {
        let fixed = |value: f32| {
            // Two comparisons without a thought for what is no number.
            let value = if value < Self::OUTSIDE { value } else { Self::OUTSIDE };
            let value = if value > -Self::OUTSIDE { value } else { -Self::OUTSIDE };
            (value * (1i64 << Self::BITS) as f32) as i64
        };
        Edge { at: fixed(at), step: fixed(step) }
    }

    /// Where it is in this row; goes on to the next.
    #[inline]
    fn next(&mut self) -> i64 {
        let at = self.at;
        self.at += self.step;
        at
    }
}

/// The largest whole number that is not larger, for numbers of pixels: without a call to the mathematics library.
#[inline]
fn floor(value: f32) -> i32 {
    const SHIFT: i32 = 4096;
    // Two comparisons without a thought for what is no number: that becomes the limit.
    let value = if value < 4000.0 { value } else { 4000.0 };
    let value = if value > -4000.0 { value } else { -4000.0 };
    (value + SHIFT as f32) as i32 - SHIFT
}

/// Columns and rows of the shadow map.
fn shadow_size() -> [usize; 2] {
    TABLE.map(|[from, to]| ((to - from) * SHADOW_SCALE).ceil() as usize)
}

/// Marks the cells of a triangle, whichever way round it goes.
fn fill(map: &mut [u8], columns: usize, rows: usize, corners: &[[f32; 3]; 3]) {
    let low = corners.iter().fold(f32::INFINITY, |low, p| low.min(p[1]));
    let high = corners.iter().fold(f32::NEG_INFINITY, |high, p| high.max(p[1]));
    let first = (low - 0.5).ceil().max(0.0);
    let last = (high - 0.5).floor().min(rows as f32 - 1.0);
    if first > last {
        return;
    }
    for y in first as usize..=last as usize {
        let middle = y as f32 + 0.5;
        let (mut from, mut to) = (f32::INFINITY, f32::NEG_INFINITY);
        for edge in 0..3 {
            let (p, q) = (corners[edge], corners[(edge + 1) % 3]);
            if (p[1] <= middle) != (q[1] <= middle) {
                let x = p[0] + (q[0] - p[0]) * (middle - p[1]) / (q[1] - p[1]);
                from = from.min(x);
                to = to.max(x);
            }
        }
        let from = (from - 0.5).ceil().max(0.0);
        let to = (to - 0.5).floor().min(columns as f32 - 1.0);
        if from <= to {
            map[y * columns + from as usize..=y * columns + to as usize].fill(255);
        }
    }
}

/// The lens's blur across three neighbours, a standard deviation of 0.6 pixels.
fn blur(mixed: &mut [u16], before: &[u16], here: &[u16], after: &[u16]) {
    for (((mixed, before), here), after) in mixed.iter_mut().zip(before).zip(here).zip(after) {
        // Twelve bits times sixteen just fit.
        *mixed = (3 * before + 10 * here + 3 * after) >> 4;
    }
}

/// How the table is seen.
struct Table<'a> {
    turn: [[f32; 3]; 3],
    eye: [f32; 3],
    /// One of [`STRIDES`].
    stride: usize,
    /// The sheet's picture, about as fine as the image.
    sheet: Level<'a>,
    /// The sheet's colours by their numbers where no shadow falls.
    ink: [[u16; 3]; 256],
    /// Colours without shadows by what is there, [`TABLE_TOP`] to [`WALL`].
    plain: [[u16; 3]; WALL as usize + 1],
}

/// A colour of which the bytes are red, green and blue, lowest first, in light of which `lit` is 256 times what a
/// byte's one stands for.
#[inline]
fn shine(colour: u32, lit: u32) -> [u16; 3] {
    [0, 8, 16].map(|shift| ((((colour >> shift & 255) * lit) >> 8) as u16).min(FULL))
}

/// The place of what does not look down at the table at all.
const ABOVE: f32 = 1e9;

impl<'a> Table<'a> {
    fn new(looks: &'a Looks, x_wc: &Pose, model: &CameraModel) -> Table<'a> {
        let rigid = Rigid::new(x_wc);
        // What a pixel covers where the optical axis meets the table, or straight below.
        let down = -rigid.turn[2][2];
        let distance = if down > 0.3 { rigid.shift[2] / down } else { rigid.shift[2] };
        let pixel = distance.max(0.01) / model.focal[0] as f32;
        // A little room for what is further away than the middle.
        let [near, far] = STRIDES;
        let stride = if 1.5 * pixel * (near as f32) < BARE { near } else { far };
        let sheet = looks.sheet.on(looks.sheet.level(pixel));
        let lit = light_on(&[0.0, 0.0, 1.0]);
        let colour = |colour: [f32; 3], light: f32| colour.map(|share| linear(share * light));
        let of_255 = (lit * f32::from(FULL) / 255.0 * 256.0) as u32;
        let ink = std::array::from_fn(|number| shine(sheet.colour(number as u8), of_255));
        let mut plain = [[0; 3]; WALL as usize + 1];
        plain[usize::from(TABLE_TOP)] = colour(TABLE_COLOUR, lit);
        plain[usize::from(PAPER)] = shine(looks.sheet.paper(), of_255);
        plain[usize::from(FLOOR)] = colour(FLOOR_COLOUR, 0.8 * lit);
        plain[usize::from(WALL)] = colour(WALL_COLOUR, 1.0);
        Table { turn: rigid.turn, eye: rigid.shift, stride, sheet, ink, plain }
    }

    /// Where a pixel looks on the table, m in the world.
    #[inline]
    fn place(&self, dx: f32, dy: f32) -> [f32; 2] {
        let [tx, ty, tz] = self.turn;
        let fall = tz[0] * dx + tz[1] * dy + tz[2];
        let t = -self.eye[2] / fall;
        let (x, y) = (tx[0] * dx + tx[1] * dy + tx[2], ty[0] * dx + ty[1] * dy + ty[2]);
        let down = fall <= -1e-3;
        [(self.eye[0], x), (self.eye[1], y)].map(|(eye, way)| if down { eye + t * way } else { ABOVE })
    }

    /// Colours the pixels from `x` on, which all show the table. `nodes` are the places of each `stride`th pixel of the row
    /// and of its last: between two that are close to each other, places and shadows go straight.
    fn stretch(
        &self,
        looks: &Looks,
        (bare, soft): (&[u8], &[u32]),
        [dx, dy]: [&[f32]; 2],
        nodes: &[[f32; 2]],
        x: usize,
        light: &mut [u16],
    ) {
        let (index, skip) = (x / self.stride, x % self.stride);
        let (from, to) = (nodes[index], nodes[index + 1]);
        let pixels = light.chunks_exact_mut(3);
        let close = (to[0] - from[0]).abs().max((to[1] - from[1]).abs()) < BARE;
        let (what, other) = (kind(bare, from), kind(bare, to));
        let plain = what == other && what != DETAIL;
        if close && (plain || on_sheet(looks, from) && on_sheet(looks, to)) {
            let share = 1.0 / (dx.len() - 1 - index * self.stride).clamp(1, self.stride) as f32;
            let [left, last] = if what < FLOOR { [from, to].map(|at| shade_at(soft, at)) } else { [256; 2] };
            // In 65536th parts.
            let fade = ((last as f32 - left as f32) * 65536.0 * share) as i32;
            let begin = ((left as i32) << 16) + skip as i32 * fade;
            let lefts = (0..).map(|step| ((begin + step * fade) >> 16) as u32);
            if plain && fade == 0 {
                let colour = dimmed(self.plain[usize::from(what)], left);
                pixels.for_each(|light| light.copy_from_slice(&colour));
            } else if plain {
                let colour = self.plain[usize::from(what)];
                pixels.zip(lefts).for_each(|(light, left)| light.copy_from_slice(&dimmed(colour, left)));
            } else {
                let step = [(to[0] - from[0]) * share, (from[1] - to[1]) * share];
                let skip = skip as f32;
                let at = [
                    from[0] - looks.sheet_corner[0] + skip * step[0],
                    looks.sheet_corner[1] - from[1] + skip * step[1],
                ];
                for ((light, number), left) in pixels.zip(self.sheet.along(at, step)).zip(lefts) {
                    light.copy_from_slice(&self.faded(number, left));
                }
            }
            return;
        }
        for ((light, dx), dy) in pixels.zip(&dx[x..]).zip(&dy[x..]) {
            light.copy_from_slice(&self.colour(looks, (bare, soft), self.place(*dx, *dy)));
        }
    }

    /// The colour of that number on the sheet, of which shadows leave `left` of 256.
    #[inline]
    fn faded(&self, number: u8, left: u32) -> [u16; 3] {
        dimmed(self.ink[usize::from(number)], left)
    }

    fn colour(&self, looks: &Looks, (bare, soft): (&[u8], &[u32]), at: [f32; 2]) -> [u16; 3] {
        let what = kind(bare, at);
        if what >= FLOOR {
            return self.plain[usize::from(what)];
        }
        let left = shade_at(soft, at);
        if on_sheet(looks, at) {
            let number = self.sheet.at(at[0] - looks.sheet_corner[0], looks.sheet_corner[1] - at[1]);
            return self.faded(number, left);
        }
        dimmed(self.plain[usize::from(TABLE_TOP)], left)
    }
}

/// A colour of which shadows leave `left` of 256.
#[inline]
fn dimmed(colour: [u16; 3], left: u32) -> [u16; 3] {
    colour.map(|value| ((u32::from(value) * left) >> 8) as u16)
}

#[inline]
fn on_sheet(looks: &Looks, [x, y]: [f32; 2]) -> bool {
    let (u, v) = (x - looks.sheet_corner[0], looks.sheet_corner[1] - y);
    u > 0.0 && v > 0.0 && u < looks.sheet_size[0] && v < looks.sheet_size[1]
}

/// What is at a place or near it.
#[inline]
fn kind(bare: &[u8], [x, y]: [f32; 2]) -> u8 {
    let (column, row) = ((x - TABLE[0][0]) * SHADOW_SCALE, (y - TABLE[1][0]) * SHADOW_SCALE);
    let [columns, rows] = shadow_size();
    if column >= 0.0 && row >= 0.0 && column < columns as f32 && row < rows as f32 {
        bare[row as usize * columns + column as usize]
    } else if x == ABOVE {
        WALL
    } else {
        FLOOR
    }
}

/// How much light reaches a place on the table, of 256.
#[inline]
fn shade_at(soft: &[u32], [x, y]: [f32; 2]) -> u32 {
    shade(soft, (x - TABLE[0][0]) * SHADOW_SCALE, (y - TABLE[1][0]) * SHADOW_SCALE)
}

/// Adds up, for each cell, those around it: [`WIDE`] along both directions.
fn spread(sums: &mut [u16], marks: &mut [u16], columns: usize) {
    // Along rows, then along columns; what runs over an edge is not missed on a table this much larger.
    for (step, across) in [(1, true), (columns, false)] {
        let (from, to): (&mut [u16], &mut [u16]) = if across { (sums, marks) } else { (marks, sums) };
        to.fill(0);
        let reach = 2 * step;
        let inner = from.len() - 2 * reach;
        let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|index| &from[index * step..][..inner]);
        for (((((to, a), b), c), d), e) in to[reach..].iter_mut().zip(a).zip(b).zip(c).zip(d).zip(e) {
            *to = a + b + c + d + e;
        }
    }
}

/// What each cell of the map shows where no shadow falls, seen from anywhere near it.
fn bare(looks: &Looks) -> Vec<u8> {
    let [columns, rows] = shadow_size();
    let kind = |column: i64, row: i64| {
        if !(0..columns as i64).contains(&column) || !(0..rows as i64).contains(&row) {
            return DETAIL;
        }
        let x = TABLE[0][0] + (column as f32 + 0.5) / SHADOW_SCALE;
        let y = TABLE[1][0] + (row as f32 + 0.5) / SHADOW_SCALE;
        let (u, v) = (x - looks.sheet_corner[0], looks.sheet_corner[1] - y);
        let [width, height] = looks.sheet_size;
        if !(u > 0.0 && v > 0.0 && u < width && v < height) {
            TABLE_TOP
        } else if looks.sheet.is_blank([u, v], 1.0 / SHADOW_SCALE) {
            PAPER
        } else {
            DETAIL
        }
    };
    let kinds: Vec<u8> =
        (0..rows as i64).flat_map(|row| (0..columns as i64).map(move |column| kind(column, row))).collect();
    // The same for two cells all around: more than a stretch of pixels reaches.
    let same = |index: usize| {
        let (row, column) = (index / columns, index % columns);
        let inside = (2..rows - 2).contains(&row) && (2..columns - 2).contains(&column);
        let around = |row: usize| &kinds[row * columns + column - 2..row * columns + column + 3];
        inside && (row - 2..row + 3).all(|row| around(row).iter().all(|kind| *kind == kinds[index]))
    };
    (0..kinds.len()).map(|index| if same(index) { kinds[index] } else { DETAIL }).collect()
}

/// How much light reaches a place on the shadow map, of 256.
#[inline]
fn shade(shadow: &[u32], column: f32, row: f32) -> u32 {
    const LOST: u32 = ((1.0 - SHADOW_LEFT) * 256.0) as u32;
    let [columns, _] = shadow_size();
    let (u, v) = ((column * 256.0) as i32 - 128, (row * 256.0) as i32 - 128);
    let from = (v >> 8).max(0) as usize * columns + (u >> 8).max(0) as usize;
    let four = shadow.get(from).copied().unwrap_or_default();
    // Most places are quite lit.
    if four == 0 {
        return 256;
    }
    let byte = |shift: u32| four >> shift & 255;
    let (fu, fv) = ((u & 255) as u32, (v & 255) as u32);
    let mix = |a: u32, b: u32| a * (256 - fu) + b * fu;
    let dark = (mix(byte(0), byte(8)) * (256 - fv) + mix(byte(16), byte(24)) * fv) >> 16;
    256 - ((dark * LOST) >> 8)
}
