//! Images while they are drawn. A [`Drawing`] holds all that an image takes, so that any thread can draw it;
//! the twin takes back the sensor with [`Twin::drawn`](crate::Twin::drawn).

use std::sync::Arc;

use ramp_render::{Looks, Renderer, Scene, Sensor, StereoSensor};
use ramp_robot::{Camera, CameraModel, Image, ImageWidth, Pose};

/// Number of a camera in arrays.
pub(crate) fn index(camera: Camera) -> usize {
    usize::from(camera == Camera::BirdsEye)
}

/// Sensor and last image of a camera.
#[derive(Clone)]
pub(crate) struct Eye {
    pub sensor: Sensor,
    /// On the track `depth`.
    pub stereo: Option<StereoSensor>,
    /// The last image. Without pixels before the first, and in an episode in which no camera freezes.
    pub last: Pixels,
}

/// An image without its time and place.
#[derive(Clone, Default)]
pub(crate) struct Pixels {
    width: usize,
    height: usize,
    /// Red, green and blue of each pixel, row by row from the top left.
    rgb: Vec<u8>,
    /// See [`Image::depth`].
    depth: Option<Vec<u16>>,
}

impl Pixels {
    /// With another number of pixels: each is the nearest of this image.
    fn with_size(&self, width: usize, height: usize) -> Pixels {
        if (self.width, self.height) == (width, height) {
            return self.clone();
        }
        let nearest = |pixel: usize, count: usize, own: usize| (2 * pixel + 1) * own / (2 * count);
        let mut rgb = Vec::with_capacity(3 * width * height);
        let mut depth = self.depth.as_ref().map(|_| Vec::with_capacity(width * height));
        for row in (0..height).map(|row| nearest(row, height, self.height)) {
            for column in (0..width).map(|column| nearest(column, width, self.width)) {
                let from = row * self.width + column;
                rgb.extend_from_slice(&self.rgb[3 * from..][..3]);
                if let (Some(depth), Some(own)) = (&mut depth, &self.depth) {
                    depth.push(own[from]);
                }
            }
        }
        Pixels { width, height, rgb, depth }
    }
}

/// Renderers of one camera, made when they are first needed: of its own width, and of the last other one.
#[derive(Default)]
struct CameraRenderers {
    own: Option<Renderer>,
    other: Option<(ImageWidth, Renderer)>,
}

impl CameraRenderers {
    /// The renderer for images of this width.
    fn get(&mut self, looks: Arc<Looks>, model: &CameraModel, width: Option<ImageWidth>) -> &mut Renderer {
        let Some(width) = width else {
            return self.own.get_or_insert_with(|| Renderer::new(looks, model));
        };
        if self.other.as_ref().is_some_and(|(last, _)| *last != width) {
            self.other = None;
        }
        &mut self.other.get_or_insert_with(|| (width, Renderer::new(looks, &model.with_width(width)))).1
    }
}

/// Renderers of both cameras of one twin. They carry nothing from one image to the next.
#[derive(Default)]
pub struct Renderers([CameraRenderers; 2]);

/// An image to be drawn.
pub struct Drawing {
    pub(crate) camera: Camera,
    /// Of the camera's own width without it.
    pub(crate) width: Option<ImageWidth>,
    /// See [`Drawing::time`].
    pub(crate) time: f64,
    /// The tip in the world at that time.
    pub(crate) x_wt: Pose,
    /// Whether the camera repeats its last image, if it has taken one.
    pub(crate) frozen: bool,
    /// Whether the camera may freeze later.
    pub(crate) remembers: bool,
    /// All bodies, and the camera in the world, at each moment that the image shows together.
    pub(crate) seen: Vec<(Scene, Pose)>,
    pub(crate) looks: Arc<Looks>,
    pub(crate) model: CameraModel,
    pub(crate) eye: Eye,
}

/// An image that has been drawn, with its sensor.
pub struct Drawn {
    pub(crate) image: Image,
    pub(crate) eye: Eye,
}

impl Drawing {
    /// Robot time in the middle of the exposure, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Draws the image, with the renderers of the same twin.
    pub fn draw(self, renderers: &mut Renderers) -> Drawn {
        let Drawing { camera, width, time, x_wt, frozen, remembers, seen, looks, model, mut eye } = self;
        let size = width.map_or_else(|| model.clone(), |width| model.with_width(width));
        let pixels = if frozen && !eye.last.rgb.is_empty() {
            eye.last.with_size(size.width, size.height)
        } else {
            let renderer = renderers.0[index(camera)].get(looks, &model, width);
            let rgb = match &seen[..] {
                [(scene, x_wc)] => renderer.render(scene, x_wc, &mut eye.sensor),
                moving => renderer.render_moving(moving, &mut eye.sensor),
            };
            let depth = eye.stereo.as_mut().map(|stereo| stereo.measure(renderer));
            let pixels = Pixels { width: size.width, height: size.height, rgb, depth };
            if remembers {
                eye.last.clone_from(&pixels);
            }
            pixels
        };
        let Pixels { width, height, rgb, depth } = pixels;
        Drawn { image: Image { camera, time, x_wt, width, height, pixels: rgb, depth }, eye }
    }
}

impl Drawn {
    /// The image.
    pub fn image(&self) -> &Image {
        &self.image
    }
}
