//! Images in the log of a run: PNG files, on a channel for each camera, and on another one for its depths.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use ramp_robot::{Camera, Image};
use serde_json::{Value, json};

const SCHEMA: &str = include_str!("../../../../data/schema/image.schema.json");

/// The channels: topic, name of the schema, and the schema itself.
pub(super) const CHANNELS: [(&str, &str, &str); 4] = [
    (topic(Camera::Wrist), "foxglove.CompressedImage", SCHEMA),
    (topic(Camera::BirdsEye), "foxglove.CompressedImage", SCHEMA),
    (depth_topic(Camera::Wrist), "foxglove.CompressedImage", SCHEMA),
    (depth_topic(Camera::BirdsEye), "foxglove.CompressedImage", SCHEMA),
];

/// The channel of a camera.
pub(super) const fn topic(camera: Camera) -> &'static str {
    match camera {
        Camera::Wrist => "/image/wrist",
        Camera::BirdsEye => "/image/birds-eye",
    }
}

/// The channel of a camera's depths.
pub(super) const fn depth_topic(camera: Camera) -> &'static str {
    match camera {
        Camera::Wrist => "/depth/wrist",
        Camera::BirdsEye => "/depth/birds-eye",
    }
}

/// The message of an image that was exposed at the time of `stamp`.
///
/// # Errors
/// When the image has not as many pixels as it says.
pub(super) fn message(image: &Image, stamp: &Value) -> Result<Value, png::EncodingError> {
    encoded(image, stamp, &image.pixels, (png::ColorType::Rgb, png::BitDepth::Eight))
}

/// The message of an image's depths: grey of 16 bits, in tenths of a millimetre.
///
/// # Errors
/// As [`message`].
pub(super) fn depth_message(
    image: &Image,
    depth: &[u16],
    stamp: &Value,
) -> Result<Value, png::EncodingError> {
    let bytes: Vec<u8> = depth.iter().flat_map(|depth| depth.to_be_bytes()).collect();
    encoded(image, stamp, &bytes, (png::ColorType::Grayscale, png::BitDepth::Sixteen))
}

fn encoded(
    image: &Image,
    stamp: &Value,
    pixels: &[u8],
    (colour, bits): (png::ColorType, png::BitDepth),
) -> Result<Value, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, image.width as u32, image.height as u32);
    encoder.set_color(colour);
    encoder.set_depth(bits);
    // The arm waits for its agent meanwhile.
    encoder.set_compression(png::Compression::Fastest);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(json!({
        "timestamp": stamp, "frame_id": image.camera.name(), "format": "png", "data": STANDARD.encode(&bytes),
    }))
}
