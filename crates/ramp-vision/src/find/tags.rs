//! Tags as points of the part that they stick on.

use crate::detect::Detection;
use nalgebra::{Point3, Vector3};
use ramp_kit::tags::TagPlace;

/// Mean length of the edges of tags in the image, pixels.
pub(super) fn mean_size(tags: &[(&TagPlace, &Detection)]) -> f64 {
    tags.iter().map(|(_, detection)| detection.size()).sum::<f64>() / tags.len() as f64
}

/// The middle of tags on their part, m.
pub(super) fn middle_of(tags: &[(&TagPlace, &Detection)]) -> Vector3<f64> {
    tags.iter().map(|(place, _)| place.x_pg.translation.vector).sum::<Vector3<f64>>() / tags.len() as f64
}

/// The corners of a tag's black square on its part, in the order of [`Detection::corners`].
pub fn corner_points(place: &TagPlace) -> [Point3<f64>; 4] {
    let half = place.edge / 2.0;
    [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]]
        .map(|[x, y]| place.x_pg * Point3::new(half * x, half * y, 0.0))
}
