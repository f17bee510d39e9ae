//! Whether a peg pins two holes: the geometry of one connection at one moment.

use nalgebra::{Point3, Vector3};
use ramp_kit::Pose;
use ramp_kit::joint::{BODY_WIDTH, FEMALE_HEIGHT, HOLE_RADIUS, STEM_LENGTH, WALL};

/// Largest distance of a counted peg's head from the female's top plate, m.
pub const SEATED: f64 = 0.5e-3;

/// Whether the peg at `x_peg` pins these two holes. Poses are in the world, holes in their beams'
/// frames.
///
/// ```
/// use nalgebra::Point3;
/// use ramp_kit::Pose;
/// let beam = Pose::translation(0.0, 0.0, 0.0166);
/// let hole = Point3::origin();
/// let seated = Pose::translation(0.0, 0.0, 0.0332);
/// assert!(ramp_referee::pins(&seated, &beam, &hole, &beam, &hole));
/// let not_flush = Pose::translation(0.0, 0.0, 0.0332 + 0.0006);
/// assert!(!ramp_referee::pins(&not_flush, &beam, &hole, &beam, &hole));
/// ```
pub fn pins(
    x_peg: &Pose,
    x_female: &Pose,
    p_b_female: &Point3<f64>,
    x_male: &Pose,
    p_b_male: &Point3<f64>,
) -> bool {
    let female = x_female * p_b_female;
    // Fast rejection: most pegs are far away.
    if (x_peg.translation.vector - female.coords).norm() > 0.05 {
        return false;
    }
    let up = upward(x_female);
    let plate = female + up * (FEMALE_HEIGHT / 2.0);
    let gap = (x_peg.translation.vector - plate.coords).dot(&up);
    if gap.abs() > SEATED {
        return false;
    }
    let male = x_male * p_b_male;
    let male_up = upward(x_male);
    // The female's hole goes through two plates, each with two openings; the male's has two openings.
    let (outer, inner) = (FEMALE_HEIGHT / 2.0, FEMALE_HEIGHT / 2.0 - WALL);
    [outer, inner, -inner, -outer].iter().all(|height| passes(x_peg, &(female + up * *height), &up))
        && [1.0, -1.0]
            .iter()
            .all(|side| passes(x_peg, &(male + male_up * (side * BODY_WIDTH / 2.0)), &male_up))
}

/// The axis of a beam's holes, pointing up: a flipped beam's z points down.
fn upward(x_wb: &Pose) -> Vector3<f64> {
    let z = x_wb.rotation * Vector3::z();
    if z.z < 0.0 { -z } else { z }
}

/// Whether the stem's axis passes through the round hole around `centre` in the plane with normal
/// `normal`.
fn passes(x_peg: &Pose, centre: &Point3<f64>, normal: &Vector3<f64>) -> bool {
    let down = x_peg.rotation * -Vector3::z();
    let slope = down.dot(normal);
    if slope.abs() < 1e-6 {
        return false;
    }
    let along = (centre.coords - x_peg.translation.vector).dot(normal) / slope;
    let through = x_peg.translation.vector + down * along;
    // Within the stem's length, with the head's tolerance.
    (-SEATED..=STEM_LENGTH + SEATED).contains(&along) && (through - centre.coords).norm() < HOLE_RADIUS
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Translation3, UnitQuaternion};

    fn female() -> Pose {
        Pose::translation(0.3, 0.1, 0.0166)
    }

    fn peg(x: f64, y: f64, gap: f64) -> Pose {
        Pose::translation(0.3 + x, 0.1 + y, 0.0332 + gap)
    }

    fn judge(peg: &Pose, male_shift: f64) -> bool {
        let male = Pose::translation(0.3 + male_shift, 0.1, 0.0166);
        pins(peg, &female(), &Point3::origin(), &male, &Point3::origin())
    }

    #[test]
    fn a_seated_peg_counts_and_one_too_high_or_too_low_does_not() {
        assert!(judge(&peg(0.0, 0.0, 0.0), 0.0));
        assert!(judge(&peg(0.0, 0.0, 0.00049), 0.0));
        assert!(!judge(&peg(0.0, 0.0, 0.00051), 0.0));
        assert!(!judge(&peg(0.0, 0.0, -0.00051), 0.0));
    }

    #[test]
    fn the_axis_must_pass_through_both_holes() {
        assert!(judge(&peg(0.0041, 0.0, 0.0), 0.0));
        assert!(!judge(&peg(0.0043, 0.0, 0.0), 0.0));
        // The male is missing.
        assert!(!judge(&peg(0.0, 0.0, 0.0), 0.0043));
        assert!(!judge(&peg(0.0, 0.0, 0.0), 0.05));
    }

    #[test]
    fn a_peg_on_its_head_or_its_side_does_not_count() {
        for angle in [1.6, std::f64::consts::PI] {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle);
            let lying = Pose::from_parts(Translation3::new(0.3, 0.1, 0.0332), turn);
            assert!(!judge(&lying, 0.0));
        }
    }

    #[test]
    fn a_flipped_female_is_judged_by_the_plate_that_is_on_top() {
        let roll = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        let flipped = Pose::from_parts(female().translation, roll);
        let here = Point3::origin();
        assert!(pins(&peg(0.0, 0.0, 0.0), &flipped, &here, &female(), &here));
    }
}
