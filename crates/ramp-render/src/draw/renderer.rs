//! The buffers of one camera, and the last picture in them.

use super::map::{TABLE, bare, shadow_size};
use super::occluder::Occluders;
use super::rigid::Rigid;
use super::table::Node;
use crate::lens::Lens;
use crate::looks::{Looks, Sticker};
use crate::texture::PLACES;
use ramp_robot::{CameraModel, Pose};
use std::sync::Arc;

/// Height of the table above the floor, m: chosen, that of a usual table.
const TABLE_HEIGHT: f32 = 0.75;
/// Marks a pixel that shows a tag.
pub(super) const TAG: u32 = 1 << 31;
/// A body's number in the segmentation for the table, the floor and the wall.
pub const NOTHING: u16 = u16::MAX;

/// A tag that is in view: how its plane is seen.
pub(super) struct SeenTag {
    pub(super) sticker: Sticker,
    /// From the direction (x/z, y/z, 1) of a pixel to the tag's plane: rows of a homography onto (x w, y w,
    /// w).
    pub(super) rows: [[f32; 3]; 3],
    /// Brightness of a pixel of which that many [`PLACES`] are white.
    pub(super) light: [u16; PLACES + 1],
    /// The same in shadow, if an edge of a shadow may cross it.
    pub(super) dark: Option<[u16; PLACES + 1]>,
    pub(super) body: u16,
}

/// A triangle of a body that may be in view.
pub(super) struct Face {
    /// Red, green and blue in the lamp's light.
    pub(super) colour: [u16; 3],
    /// The same in shadow, if an edge of a shadow may cross it.
    pub(super) dark: Option<[u16; 3]>,
    pub(super) body: u16,
    pub(super) metal: bool,
}

/// Draws what one camera sees. Keeps its buffers from image to image.
pub struct Renderer {
    pub(super) looks: Arc<Looks>,
    pub(super) lens: Lens,
    /// One over the distance along the optical axis, 1/m; 0 where nothing is.
    pub(super) near: Vec<f32>,
    /// Content of each pixel: 0 nothing, a face, or a tag.
    pub(super) shown: Vec<u32>,
    pub(super) faces: Vec<Face>,
    pub(super) tags: Vec<SeenTag>,
    /// Camera pose of the last picture.
    pub(super) x_wc: Pose,
    pub(super) screen: Vec<[f32; 3]>,
    /// Places on the table by rows of the image, and the camera's pose that they are seen from.
    pub(super) nodes: Vec<Node>,
    pub(super) nodes_from: Option<Pose>,
    /// The highest occluder of the lamp above each cell of the map.
    pub(super) occluders: Occluders,
    /// Light of the lamp, of 256, at the corners of the body that is being drawn, once it is known.
    pub(super) corner_light: Vec<Option<u32>>,
    /// Sums while shadows' edges are made soft.
    pub(super) sums: [Vec<u16>; 2],
    /// Content of each cell of the map: [`TABLE_TOP`], [`PAPER`] or [`DETAIL`].
    pub(super) bare: Vec<u8>,
    /// For each cell of the map the shadow on it, on its right neighbour, and on the two below, a byte each.
    pub(super) soft: Vec<u32>,
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
            faces: Vec::new(),
            tags: Vec::new(),
            x_wc: Pose::identity(),
            screen: Vec::new(),
            nodes: Vec::new(),
            nodes_from: None,
            occluders: Occluders::new(),
            corner_light: Vec::new(),
            sums: [0, 1].map(|_| vec![0; cells[0] * cells[1]]),
            soft: vec![0; cells[0] * cells[1]],
        }
    }

    /// Draws with other meshes and textures from now on, those of another episode.
    pub fn dress(&mut self, looks: Arc<Looks>) {
        if !Arc::ptr_eq(&looks.sheet, &self.looks.sheet) {
            self.bare = bare(&looks);
            self.nodes_from = None;
        }
        self.looks = looks;
    }

    /// Meshes and textures that it draws.
    pub fn looks(&self) -> &Looks {
        &self.looks
    }

    /// Distance along the optical axis in each pixel of the last picture, m; infinite where nothing is.
    pub fn depth(&self) -> Vec<f32> {
        self.nearness().into_iter().map(|near| if near > 0.0 { 1.0 / near } else { f32::INFINITY }).collect()
    }

    /// One over that distance, 1/m; 0 where nothing is.
    pub(crate) fn nearness(&self) -> Vec<f32> {
        let camera = Rigid::new(&self.x_wc);
        let [x, y, z] = camera.shift;
        let ground = |dx: f32, dy: f32| {
            let [u, v, fall] = [0, 1, 2]
                .map(|row| camera.turn[row][0] * dx + camera.turn[row][1] * dy + camera.turn[row][2]);
            let far = -z / fall;
            let within = |place: f32, [from, to]: [f32; 2]| (place >= from) & (place <= to);
            let on_table = within(x + far * u, TABLE[0]) & within(y + far * v, TABLE[1]);
            let height = if on_table { z } else { z + TABLE_HEIGHT };
            if fall < 0.0 { -fall / height } else { 0.0 }
        };
        let mut nearness = self.near.clone();
        let width = self.lens.model.width;
        for (y, row) in nearness.chunks_exact_mut(width).enumerate() {
            let [xs, ys] = self.lens.row(y);
            for ((near, dx), dy) in row.iter_mut().zip(xs).zip(ys) {
                let ground = ground(*dx, *dy);
                *near = if *near > 0.0 { *near } else { ground };
            }
        }
        nearness
    }

    /// Pixels in a row, and rows.
    pub(crate) fn size(&self) -> [usize; 2] {
        [self.lens.model.width, self.lens.model.height]
    }

    /// The focal length along a row, pixels.
    pub(crate) fn focal(&self) -> f64 {
        self.lens.model.focal[0]
    }

    /// Whether a pixel of the last picture shows metal.
    pub(crate) fn shows_metal(&self, pixel: usize) -> bool {
        let shown = self.shown[pixel];
        shown & TAG == 0 && self.faces[shown as usize].metal
    }

    /// Which body each pixel of the last picture shows ([`Looks::bodies`]), or [`NOTHING`].
    pub fn segmentation(&self) -> Vec<u16> {
        let owner = |shown: &u32| {
            if shown & TAG != 0 {
                self.tags[(shown & !TAG) as usize].body
            } else {
                self.faces[*shown as usize].body
            }
        };
        self.shown.iter().map(owner).collect()
    }
}
