//! Images as PNG files.

use std::path::Path;

use miette::{IntoDiagnostic, Report};
use ramp_robot::Image;

use crate::output::write_file;

/// Writes pixels of an image as a PNG file.
///
/// # Errors
/// The system's.
pub fn write_png(path: &Path, image: &Image, pixels: &[u8]) -> Result<(), Report> {
    write_pixels(path, image, pixels, png::ColorType::Rgb, png::BitDepth::Eight)
}

/// Writes pixels of any type, as many as in an image.
///
/// # Errors
/// The system's.
pub fn write_pixels(
    path: &Path,
    image: &Image,
    pixels: &[u8],
    colour: png::ColorType,
    bits: png::BitDepth,
) -> Result<(), Report> {
    let mut bytes = Vec::new();
    let (width, height) = (image.width as u32, image.height as u32);
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(colour);
    encoder.set_depth(bits);
    let mut writer = encoder.write_header().into_diagnostic()?;
    writer.write_image_data(pixels).into_diagnostic()?;
    writer.finish().into_diagnostic()?;
    write_file(path, bytes)
}
