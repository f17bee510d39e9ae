//! Images in the log of a run: PNG files, on a channel for each camera.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use ramp_robot::{Camera, Image};
use serde_json::{Value, json};

const SCHEMA: &str = include_str!("../../../../data/schema/image.schema.json");

/// The channels: topic, name of the schema, and the schema itself.
pub(super) const CHANNELS: [(&str, &str, &str); 2] = [
    (topic(Camera::Wrist), "foxglove.CompressedImage", SCHEMA),
    (topic(Camera::BirdsEye), "foxglove.CompressedImage", SCHEMA),
];

/// The channel of a camera.
pub(super) const fn topic(camera: Camera) -> &'static str {
    match camera {
        Camera::Wrist => "/image/wrist",
        Camera::BirdsEye => "/image/birds-eye",
    }
}

/// The message of an image that was exposed at the time of `stamp`.
///
/// # Errors
/// When the image has not as many pixels as it says.
pub(super) fn message(image: &Image, stamp: &Value) -> Result<Value, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, image.width as u32, image.height as u32);
    encoder.set_color(png::ColorType::Rgb);
    // The arm waits for its agent meanwhile.
    encoder.set_compression(png::Compression::Fastest);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&image.pixels)?;
    writer.finish()?;
    Ok(json!({
        "timestamp": stamp, "frame_id": image.camera.name(), "format": "png", "data": STANDARD.encode(&bytes),
    }))
}
