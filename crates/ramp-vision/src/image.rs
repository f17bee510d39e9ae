//! Checks an image, and turns it into linear light.

use ramp_robot::{Camera, CameraModel, Image};

/// An image that nothing can be seen in.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SightError {
    /// It has not the size that the camera is said to have.
    #[error(
        "the image of the camera `{}` is {width} × {height} pixels with {bytes} bytes, not {} × {}",
        camera.name(), expected[0], expected[1]
    )]
    Size {
        /// Which camera.
        camera: Camera,
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Bytes of pixels.
        bytes: usize,
        /// The size in the camera model.
        expected: [usize; 2],
    },
    /// Hardly any light.
    #[error("the image of the camera `{}` is black: 99 % of its pixels are darker than {level} of 255", camera.name())]
    Black {
        /// Which camera.
        camera: Camera,
        /// Grey level.
        level: u8,
    },
    /// Too much light.
    #[error("the image of the camera `{}` is saturated: {share:.0} % of its pixels are white", camera.name())]
    Saturated {
        /// Which camera.
        camera: Camera,
        /// Percent.
        share: f64,
    },
    /// The detector would not start.
    #[error("cannot start the tag detector: {0}")]
    Detector(String),
}

/// Grey levels below which an image counts as black: read-out noise alone stays under it.
const BLACK: usize = 24;
/// Largest share of the pixels that may be as bright as can be.
const SATURATED: f64 = 0.4;

/// Linear light, one byte a pixel.
#[derive(Clone, Debug)]
pub struct Grey {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Light, 0 to 255, row by row.
    pub pixels: Vec<u8>,
}

impl Grey {
    /// The light that made an image.
    ///
    /// # Errors
    /// An image of the wrong size, or black or saturated.
    pub fn new(image: &Image, camera: &CameraModel) -> Result<Grey, SightError> {
        let (width, height) = (image.width, image.height);
        let expected = [camera.width, camera.height];
        if [width, height] != expected || image.pixels.len() != width * height * 3 {
            let bytes = image.pixels.len();
            return Err(SightError::Size { camera: image.camera, width, height, bytes, expected });
        }
        // Gamma 2.2, as images have it; scaled so that four of them make 255 · 64.
        let linear: [u16; 256] =
            std::array::from_fn(|value| ((value as f64 / 255.0).powf(2.2) * 255.0 * 16.0).round() as u16);
        let pixels: Vec<u8> = image
            .pixels
            .chunks_exact(3)
            .map(|pixel| {
                let [r, g, b] = [pixel[0], pixel[1], pixel[2]].map(|value| linear[usize::from(value)]);
                ((r + 2 * g + b + 32) >> 6) as u8
            })
            .collect();
        check_light(image, SATURATED)?;
        Ok(Grey { width, height, pixels })
    }

    /// Light between the four pixels around a place; `None` outside.
    #[inline]
    pub fn at(&self, [x, y]: [f64; 2]) -> Option<f64> {
        let (x, y) = (x - 0.5, y - 0.5);
        if !(x >= 0.0 && y >= 0.0 && x < (self.width - 1) as f64 && y < (self.height - 1) as f64) {
            return None;
        }
        let (column, row) = (x as usize, y as usize);
        let (u, v) = (x - column as f64, y - row as f64);
        let from = row * self.width + column;
        let light = |index: usize| f64::from(self.pixels[index]);
        let upper = light(from) * (1.0 - u) + light(from + 1) * u;
        let lower = light(from + self.width) * (1.0 - u) + light(from + self.width + 1) * u;
        Some(upper * (1.0 - v) + lower * v)
    }
}

/// Refuses an image without light, and one of which more than this share is as bright as can be.
pub(crate) fn check_light(image: &Image, saturated: f64) -> Result<(), SightError> {
    // Every seventh pixel's green.
    let mut counts = [0u32; 256];
    for green in image.pixels.iter().skip(1).step_by(21) {
        counts[usize::from(*green)] += 1;
    }
    let all: u32 = counts.iter().sum();
    let dark: u32 = counts[..BLACK].iter().sum();
    if f64::from(dark) >= 0.99 * f64::from(all) {
        return Err(SightError::Black { camera: image.camera, level: BLACK as u8 });
    }
    let share = f64::from(counts[254] + counts[255]) / f64::from(all);
    if share > saturated {
        return Err(SightError::Saturated { camera: image.camera, share: 100.0 * share });
    }
    Ok(())
}
