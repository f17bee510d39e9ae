//! The buffers of one camera, and the last picture in them.

use super::map::{bare, shadow_size};
use super::rigid::Rigid;
use super::table::Node;
use crate::lens::Lens;
use crate::looks::{Looks, Sticker};
use crate::texture::PLACES;
use ramp_robot::{CameraModel, Pose};
use std::sync::Arc;

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
    pub(super) body: u16,
}

/// Draws what one camera sees. Keeps its buffers from image to image.
pub struct Renderer {
    pub(super) looks: Arc<Looks>,
    pub(super) lens: Lens,
    /// One over the distance along the optical axis, 1/m; 0 where nothing is.
    pub(super) near: Vec<f32>,
    /// Content of each pixel: 0 nothing, a colour of the palette, or a tag.
    pub(super) shown: Vec<u32>,
    pub(super) palette: Vec<[u16; 3]>,
    /// The body of each colour of the palette.
    pub(super) owner: Vec<u16>,
    pub(super) tags: Vec<SeenTag>,
    /// Camera pose of the last picture.
    pub(super) x_wc: Pose,
    pub(super) screen: Vec<[f32; 3]>,
    /// Places on the table by rows of the image, and the camera's pose that they are seen from.
    pub(super) nodes: Vec<Node>,
    pub(super) nodes_from: Option<Pose>,
    pub(super) shadow: Vec<u8>,
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
            palette: Vec::new(),
            owner: Vec::new(),
            tags: Vec::new(),
            x_wc: Pose::identity(),
            screen: Vec::new(),
            nodes: Vec::new(),
            nodes_from: None,
            shadow: vec![0; cells[0] * cells[1]],
            sums: [0, 1].map(|_| vec![0; cells[0] * cells[1]]),
            soft: vec![0; cells[0] * cells[1]],
        }
    }

    /// Meshes and textures that it draws.
    pub fn looks(&self) -> &Looks {
        &self.looks
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
}
