//! One image in BOP's form: its camera, and the pose, box and visible share of each part in it.

use ramp_robot::{CameraModel, Pose};
use serde_json::{Value, json};

use super::objects::Objects;

/// A part in an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// Its name.
    pub part: String,
    /// The number of its object.
    pub object: usize,
    /// Its pose in the optical frame.
    pub x_cp: Pose,
    /// Pixels of the image that it covers, hidden or not, row by row.
    pub whole: Vec<bool>,
    /// Pixels that show it.
    pub visible: Vec<bool>,
    /// Numbers of pixels: that it covers, beyond the border of the image too; those of the image with a
    /// depth; and those that show it.
    counts: [usize; 3],
    /// The box around it, beyond the border too: left, top, width and height, pixels.
    around: [i64; 4],
}

/// An image.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Its camera, without distortion.
    pub camera: CameraModel,
    /// The camera's pose in the world.
    pub x_wc: Pose,
    /// The parts of which some is in the image, hidden or not.
    pub instances: Vec<Instance>,
}

impl Instance {
    /// A part at `x_cp` that covers the pixels `whole`, of which `visible` show it; `depth` is that of the
    /// image. `None` where it covers none.
    pub fn new(
        objects: &Objects,
        (part, x_cp): (&str, Pose),
        camera: &CameraModel,
        (whole, visible): (Vec<bool>, Vec<bool>),
        depth: &[u16],
    ) -> Option<Instance> {
        let (object, shape) = objects.of(part)?;
        let count = |pixels: &[bool]| pixels.iter().filter(|it| **it).count();
        let inside = count(&whole);
        if inside == 0 {
            return None;
        }
        let with_depth = whole.iter().zip(depth).filter(|(covers, depth)| **covers && **depth > 0).count();
        let pixels: Vec<[f64; 2]> =
            shape.points.iter().filter_map(|point| camera.project(&(x_cp * point))).collect();
        let size = [camera.width as f64, camera.height as f64];
        let is_inside = |pixel: &[f64; 2]| (0..2).all(|axis| (0.0..size[axis]).contains(&pixel[axis]));
        // The pixels beyond the border are as many as the points beyond it say.
        let share = pixels.iter().filter(|pixel| is_inside(pixel)).count() as f64 / shape.points.len() as f64;
        let all = (inside as f64 / share.max(0.01)).round() as usize;
        let counts = [all.max(inside), with_depth, count(&visible)];
        let end = |axis: usize, better: fn(f64, f64) -> f64| {
            pixels.iter().map(|pixel| pixel[axis]).reduce(better).unwrap_or(0.0)
        };
        let low = [0, 1].map(|axis| end(axis, f64::min).floor() as i64);
        let high = [0, 1].map(|axis| end(axis, f64::max).ceil() as i64 - 1);
        let shows = visible.contains(&true);
        let around = if shows { [low[0], low[1], high[0] - low[0], high[1] - low[1]] } else { [-1; 4] };
        Some(Instance { part: part.to_string(), object, x_cp, whole, visible, counts, around })
    }

    /// The share of it that shows: of all pixels that it covers, beyond the border of the image too.
    pub fn share(&self) -> f64 {
        let [all, _, visible] = self.counts;
        visible as f64 / all as f64
    }
}

/// The nine numbers of a rotation, row by row, and the three of a translation, mm.
pub fn numbers(x: &Pose) -> ([f64; 9], [f64; 3]) {
    let turn = x.rotation.to_rotation_matrix();
    let rows = std::array::from_fn(|index| turn[(index / 3, index % 3)]);
    (rows, (x.translation.vector * 1e3).into())
}

/// Left and top pixel of a mask, and how far it is from there to the last ones, as BOP's toolkit counts
/// widths and heights; −1 where there is none.
fn around(mask: &[bool], width: usize) -> [i64; 4] {
    let (mut low, mut high) = ([i64::MAX; 2], [i64::MIN; 2]);
    for index in mask.iter().enumerate().filter(|(_, set)| **set).map(|(index, _)| index) {
        for (axis, at) in [index % width, index / width].into_iter().enumerate() {
            low[axis] = low[axis].min(at as i64);
            high[axis] = high[axis].max(at as i64);
        }
    }
    if low[0] > high[0] { [-1; 4] } else { [low[0], low[1], high[0] - low[0], high[1] - low[1]] }
}

impl Record {
    /// Its entry in `scene_camera.json`.
    pub fn camera_entry(&self) -> Value {
        let [fx, fy] = self.camera.focal;
        // There, the middle of the first pixel is at 0.
        let [cx, cy] = self.camera.centre.map(|centre| centre - 0.5);
        let (turn, shift) = numbers(&self.x_wc.inverse());
        json!({
            "cam_K": [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0],
            "depth_scale": ramp_robot::DEPTH_UNIT * 1e3,
            "cam_R_w2c": turn, "cam_t_w2c": shift,
        })
    }

    /// Its entry in `scene_gt.json`.
    pub fn truth_entry(&self) -> Value {
        let entry = |part: &Instance| {
            let (turn, shift) = numbers(&part.x_cp);
            json!({"obj_id": part.object, "cam_R_m2c": turn, "cam_t_m2c": shift})
        };
        self.instances.iter().map(entry).collect()
    }

    /// Its entry in `scene_gt_info.json`.
    pub fn info_entry(&self) -> Value {
        let width = self.camera.width;
        let entry = |part: &Instance| {
            let [all, with_depth, visible] = part.counts;
            json!({
                "bbox_obj": part.around,
                "bbox_visib": around(&part.visible, width),
                "px_count_all": all,
                "px_count_valid": with_depth,
                "px_count_visib": visible,
                "visib_fract": part.share(),
            })
        };
        self.instances.iter().map(entry).collect()
    }
}
