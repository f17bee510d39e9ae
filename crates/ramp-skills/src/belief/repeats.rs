//! Looks at a part from where a camera has seen it before: they repeat the errors of the first one.
//!
//! Lens, print and light err by where in the image a part is, and from where it is seen. So the first look
//! from a place tells something new, and another one little more.

use std::collections::BTreeMap;

use crate::Pose;
use crate::parameters::belief::EyesParameters;

/// Poses of parts in a camera that has seen them so.
#[derive(Clone, Debug, Default)]
pub struct Repeats {
    seen: BTreeMap<String, Vec<Pose>>,
}

impl Repeats {
    /// Factor on the covariance of a look at a part at `x_cp` in the camera, m. The first one from a place
    /// counts in full.
    pub fn factor(&mut self, part: &str, x_cp: &Pose, parameters: &EyesParameters) -> f64 {
        let seen = self.seen.entry(part.to_string()).or_default();
        let repeats = |before: &Pose| {
            let moved = before.inverse() * x_cp;
            moved.translation.vector.norm() < parameters.elsewhere
                && moved.rotation.angle().to_degrees() < parameters.elsewhere_turn
        };
        if seen.iter().any(repeats) {
            return parameters.common;
        }
        seen.push(*x_cp);
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::Parameters;

    /// Only another place or part tells as much as the first look.
    #[test]
    fn the_first_look_from_a_place_counts_in_full() {
        let parameters = Parameters::baseline().eyes.clone();
        let mut repeats = Repeats::default();
        let mut factor =
            |part: &str, x: f64| repeats.factor(part, &Pose::translation(x, 0.0, 0.2), &parameters);
        let (near, far) = (0.5 * parameters.elsewhere, 1.5 * parameters.elsewhere);
        assert_eq!(factor("b1", 0.0), 1.0);
        assert_eq!(factor("b1", near), parameters.common);
        assert_eq!(factor("b1", far), 1.0);
        assert_eq!(factor("b1", 0.0), parameters.common);
        assert_eq!(factor("b2", 0.0), 1.0);
    }
}
