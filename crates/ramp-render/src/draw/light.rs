//! The lamp, and how much of its light comes back.

use crate::sensor::FULL;

/// Direction to the light, in the world: a lamp to the right of the robot, behind a viewer in front of it.
pub(super) const LIGHT: [f32; 3] = [0.30, -0.34, 0.89];
/// Light from everywhere, more of it from above, and light from the lamp.
const AMBIENT: f32 = 0.42;
const SKY: f32 = 0.13;
const LAMP: f32 = 0.55;

/// Brightness of a surface with this unit normal (world); 1 is white in full light.
pub(super) fn light_on(normal: &[f32; 3]) -> f32 {
    shade_on(normal) + lamp_on(normal)
}

/// The part of its brightness that is left in a shadow.
pub(super) fn shade_on(normal: &[f32; 3]) -> f32 {
    AMBIENT + SKY * normal[2]
}

/// The part of its brightness that comes from the lamp.
pub(super) fn lamp_on(normal: &[f32; 3]) -> f32 {
    let lamp = normal[0] * LIGHT[0] + normal[1] * LIGHT[1] + normal[2] * LIGHT[2];
    LAMP * lamp.max(0.0)
}

/// How narrow reflections are: the power of the cosine of the angle to a mirror's normal (Blinn and Phong).
const SHARP: i32 = 40;

/// The share of a reflection of the lamp that a viewer at `eye` (m, world) sees on a surface with this unit
/// normal at `place`.
pub(super) fn reflection(normal: &[f32; 3], eye: &[f32; 3], place: &[f32; 3]) -> f32 {
    let length = |v: [f32; 3]| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    let to_eye: [f32; 3] = std::array::from_fn(|axis| eye[axis] - place[axis]);
    let (far, lamp) = (length(to_eye), length(LIGHT));
    let half: [f32; 3] = std::array::from_fn(|axis| to_eye[axis] / far + LIGHT[axis] / lamp);
    let cosine = (0..3).map(|axis| normal[axis] * half[axis]).sum::<f32>() / length(half);
    cosine.max(0.0).powi(SHARP)
}

/// A brightness as the sensor counts it.
pub(super) fn linear(value: f32) -> u16 {
    (value * f32::from(FULL)).clamp(0.0, f32::from(FULL)) as u16
}

/// A colour of which the bytes are red, green and blue, lowest first, in light of which `lit` is 256 times
/// what a byte's one stands for.
#[inline]
pub(super) fn shine(colour: u32, lit: u32) -> [u16; 3] {
    [0, 8, 16].map(|shift| ((((colour >> shift & 255) * lit) >> 8) as u16).min(FULL))
}

/// A colour between that in full light and that in shadow, where the lamp gives `lit` of 256.
#[inline]
pub(super) fn mixed(full: [u16; 3], dark: [u16; 3], lit: u32) -> [u16; 3] {
    let mix = |full: u16, dark: u16| ((u32::from(full) * lit + u32::from(dark) * (256 - lit)) >> 8) as u16;
    std::array::from_fn(|channel| mix(full[channel], dark[channel]))
}

/// A colour of which shadows leave `left` of 256.
#[inline]
pub(super) fn dimmed(colour: [u16; 3], left: u32) -> [u16; 3] {
    colour.map(|value| ((u32::from(value) * left) >> 8) as u16)
}
