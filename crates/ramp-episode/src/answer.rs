//! Hashes of the answers that an agent received. The log keeps them, so that a replay can check that its
//! answers are the same.

use ramp_result::file::sha256_of;
use ramp_result::sha256;
use ramp_robot::{Image, PartReading, Pose};
use std::io::Read;

/// Of a reading of the parts.
pub(crate) fn of_readings(readings: &[PartReading]) -> u64 {
    let mut bytes = Vec::new();
    for reading in readings {
        // A name ends with a byte that no name holds.
        bytes.extend_from_slice(reading.part.as_bytes());
        bytes.push(0);
        put(&mut bytes, &pose(&reading.x_wp));
        put(&mut bytes, &reading.sigma);
    }
    of(&bytes)
}

/// Of an image, with the pose and the time that come with it.
pub(crate) fn of_image(image: &Image) -> u64 {
    let mut bytes = image.camera.name().as_bytes().to_vec();
    bytes.push(0);
    put(&mut bytes, &[image.time]);
    put(&mut bytes, &pose(&image.x_wt));
    let depth = image.depth_bytes();
    let all = bytes.as_slice().chain(&*image.pixels).chain(&*depth);
    // Reading from memory does not fail.
    sha256_of(all).map(|hash| first_bits(&hash)).unwrap_or_default()
}

fn pose(x: &Pose) -> [f64; 7] {
    let (p, q) = (x.translation.vector, x.rotation.quaternion());
    [p.x, p.y, p.z, q.w, q.i, q.j, q.k]
}

fn put(bytes: &mut Vec<u8>, numbers: &[f64]) {
    numbers.iter().for_each(|number| bytes.extend_from_slice(&number.to_bits().to_le_bytes()));
}

/// The first 64 bits of SHA-256.
fn of(bytes: &[u8]) -> u64 {
    first_bits(&sha256(bytes))
}

/// The first 64 bits of a hash in hexadecimal.
fn first_bits(hash: &str) -> u64 {
    hash.get(..16).and_then(|digits| u64::from_str_radix(digits, 16).ok()).unwrap_or_default()
}
