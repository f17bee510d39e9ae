//! Beams that look alike without tags, and the names that they get by where they lie.
//!
//! Without tags nothing tells two beams of one shape apart, nor the ends of a beam that looks the same after
//! half a turn. Where such beams lie anywhere on the table, their places name them: [`named`] gives the names
//! of lookalikes in the order of the kit from the right of the arm to its left, and lets a beam whose ends
//! look alike point away from the arm. Whoever sees the table can do the same, as long as it is not
//! [`ambiguous`].

use std::f64::consts::PI;

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};

use crate::{Beam, JointType, Kit, Pose, Side};

/// Least distance along y of the middles of two lookalikes whose order can be seen, m: many times the error
/// of any pose on the table that is of use.
const APART: f64 = 10.0e-3;
/// Least x of the direction of a beam whose ends look alike, if it can be seen to point away from the arm.
const AHEAD: f64 = 0.05;

/// How a beam looks like another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Likeness {
    /// As it lies.
    Same,
    /// After half a turn about the vertical through its middle.
    Turned,
}

/// Whether a beam has the shape of another one, as it lies or after half a turn.
fn likeness(beam: &Beam, other: &Beam) -> Option<Likeness> {
    let flipped = |beam: &Beam| beam.start.map(|start| start.flipped);
    if flipped(beam) != flipped(other) {
        None
    } else if are_alike(&looks(beam), &looks(other)) {
        Some(Likeness::Same)
    } else {
        are_alike(&looks_turned(beam), &looks(other)).then_some(Likeness::Turned)
    }
}

/// Whether the two ends of a beam look alike.
pub fn has_like_ends(beam: &Beam) -> bool {
    are_alike(&looks(beam), &looks_turned(beam))
}

/// A joint as it looks: its type, its distance from the first hole, m, and the side to which it opens.
type Look = (JointType, f64, Option<Side>);

/// The joints of a beam along its x axis.
fn looks(beam: &Beam) -> Vec<Look> {
    beam.joints.iter().map(|joint| (joint.kind, joint.offset, joint.opens)).collect()
}

/// The same after half a turn about the vertical through its middle.
fn looks_turned(beam: &Beam) -> Vec<Look> {
    let opposite = |side: Side| if side == Side::Left { Side::Right } else { Side::Left };
    let turned = |(kind, offset, opens): Look| (kind, beam.span() - offset, opens.map(opposite));
    looks(beam).into_iter().rev().map(turned).collect()
}

fn are_alike(a: &[Look], b: &[Look]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() < 1.0e-6 && a.2 == b.2)
}

/// A pose of a beam after half a turn about the vertical through its middle.
fn turned(beam: &Beam, x_wb: &Pose) -> Pose {
    let over = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), PI);
    x_wb * Pose::from_parts(Translation3::new(beam.span(), 0.0, 0.0), over)
}

/// The y of the middle of a beam, m.
fn y_of(beam: &Beam, x_wb: &Pose) -> f64 {
    (x_wb * Point3::new(beam.span() / 2.0, 0.0, 0.0)).y
}

/// The names of the beams that look like this one without tags, itself among them, in the order of the kit.
///
/// ```
/// # let kit = ramp_kit::read_kit(std::path::Path::new("../../data/kit.xml"))?;
/// // Turned by half, `b5` looks like `b4`.
/// assert_eq!(ramp_kit::lookalike::of(&kit, "b5"), ["b4", "b5"]);
/// assert_eq!(ramp_kit::lookalike::of(&kit, "b9"), ["b9"]);
/// # Ok::<(), ramp_kit::KitError>(())
/// ```
pub fn of<'k>(kit: &'k Kit, name: &str) -> Vec<&'k str> {
    let Some(beam) = kit.beam(name) else { return Vec::new() };
    let like = kit.beams.iter().filter(|other| likeness(beam, other).is_some());
    like.map(|other| other.name.as_str()).collect()
}

/// Gives names to beams that lie at these poses in the world, as their places have it. A beam may come under
/// the name of any that looks the same; each pose that is returned is in the frame of the beam whose name it
/// gets. Names of which not as many lookalikes were given as there are names for them are left out.
pub fn named(kit: &Kit, names: &[&str], beams: &[(String, Pose)]) -> Vec<(String, Pose)> {
    let to_give: Vec<&Beam> = kit.beams.iter().filter(|beam| names.contains(&beam.name.as_str())).collect();
    let name = |beam: &&Beam| {
        let alike: Vec<&&Beam> = to_give.iter().filter(|other| likeness(other, beam).is_some()).collect();
        let as_beam = |(name, x_wb): &(String, Pose)| {
            let other = kit.beam(name)?;
            let turn = likeness(other, beam)? == Likeness::Turned;
            Some(if turn { turned(other, x_wb) } else { *x_wb })
        };
        let mut places: Vec<Pose> = beams.iter().filter_map(as_beam).collect();
        places.sort_by(|a, b| y_of(beam, a).total_cmp(&y_of(beam, b)));
        let place = alike.iter().position(|other| other.name == beam.name)?;
        let x_wb = *places.get(place).filter(|_| places.len() == alike.len())?;
        let back = has_like_ends(beam) && (x_wb.rotation * Vector3::x()).x < 0.0;
        Some((beam.name.clone(), if back { turned(beam, &x_wb) } else { x_wb }))
    };
    to_give.iter().filter_map(name).collect()
}

/// A beam whose name cannot be seen from these places: one that lies as far to the left as a lookalike, or
/// whose ends look alike and that points neither clearly away from the arm nor towards it.
pub fn ambiguous<'b>(kit: &Kit, beams: &'b [(String, Pose)]) -> Option<&'b str> {
    let given: Vec<(&Beam, &'b (String, Pose))> =
        beams.iter().filter_map(|it| Some((kit.beam(&it.0)?, it))).collect();
    let unclear = |(index, (beam, (_, x_wb))): (usize, &(&Beam, &(String, Pose)))| {
        let across = has_like_ends(beam) && (x_wb.rotation * Vector3::x()).x.abs() < AHEAD;
        let beside = |(other, (_, x_wo)): &(&Beam, &(String, Pose))| {
            likeness(beam, other).is_some() && (y_of(beam, x_wb) - y_of(other, x_wo)).abs() < APART
        };
        across || given[..index].iter().any(beside)
    };
    given.iter().enumerate().find(|it| unclear(*it)).map(|(_, (_, (name, _)))| name.as_str())
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use std::path::Path;

    use super::*;

    fn kit() -> Kit {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
        crate::read_kit(&data.join("kit.xml")).unwrap()
    }

    fn at(y: f64, yaw: f64) -> Pose {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
        Pose::from_parts(Translation3::new(0.4, y, 0.0), turn)
    }

    fn surface(beam: &Beam, x_wb: &Pose) -> Vec<[i64; 3]> {
        // The middle of each piece, and its extent along the axes of the beam.
        let pieces = crate::shape::beam_shapes(beam).into_iter().map(|shape| shape.bounds());
        let mut corners: Vec<[i64; 3]> = pieces
            .flat_map(|it| {
                let ([x, y, z], [dx, dy, dz]) = (it.centre(), it.half());
                [-1.0, 1.0].map(|side| x_wb * Point3::new(x + side * dx, y + side * dy, z + dz))
            })
            .map(|corner| corner.coords.map(|value| (value * 1.0e6).round() as i64).into())
            .collect();
        corners.sort_unstable();
        corners
    }

    /// A beam with another name looks the same: the names alone have changed.
    #[test]
    fn the_table_looks_the_same_after_the_names_are_given() {
        let kit = kit();
        let beams: Vec<(String, Pose)> = kit
            .beams
            .iter()
            .enumerate()
            .map(|(index, beam)| (beam.name.clone(), at(-0.1 * index as f64, 2.1 * index as f64)))
            .collect();
        let names: Vec<&str> = beams.iter().map(|(name, _)| name.as_str()).collect();
        let after = named(&kit, &names, &beams);
        assert_eq!(after.len(), beams.len());
        assert_ne!(after, beams);
        let all = |beams: &[(String, Pose)]| {
            let mut all: Vec<_> = beams.iter().map(|(name, x)| surface(kit.beam(name).unwrap(), x)).collect();
            all.sort();
            all
        };
        assert_eq!(all(&after), all(&beams));
        // Names that were given by places stay.
        let again = named(&kit, &names, &after);
        for ((name, x), (same, y)) in again.iter().zip(&after) {
            assert!(name == same && (x.inverse() * y).translation.vector.norm() < 1.0e-9);
        }
    }

    /// The names go from right to left, whichever beam lay where, and beams whose ends look alike point away
    /// from the arm.
    #[test]
    fn lookalikes_are_named_from_right_to_left() {
        let kit = kit();
        let beams =
            [("b1", 0.3, 3.0), ("b2", -0.3, 0.2), ("b3", 0.0, 0.0), ("b5", -0.2, 0.0), ("b4", 0.2, 0.0)];
        let beams: Vec<(String, Pose)> =
            beams.iter().map(|(name, y, yaw)| (name.to_string(), at(*y, *yaw))).collect();
        assert_eq!(ambiguous(&kit, &beams), None);
        let names: Vec<&str> = beams.iter().map(|(name, _)| name.as_str()).collect();
        let after = named(&kit, &names, &beams);
        let y = |name: &str| {
            let (_, x) = after.iter().find(|(it, _)| it == name).unwrap();
            y_of(kit.beam(name).unwrap(), x)
        };
        assert!(y("b1") < y("b2") && y("b2") < y("b3"));
        assert!((y("b4") + 0.2).abs() < 1.0e-9 && (y("b5") - 0.2).abs() < 1.0e-9);
        // Under another name that looks the same, the same comes out; too few get no name.
        let mut as_b4 = beams.clone();
        as_b4[3] = ("b4".to_string(), turned(kit.beam("b5").unwrap(), &beams[3].1));
        let again = named(&kit, &names, &as_b4);
        for ((name, x), (same, y)) in again.iter().zip(&after) {
            assert!(name == same && (x.inverse() * y).translation.vector.norm() < 1.0e-9);
        }
        assert_eq!(named(&kit, &names, &beams[1..]).len(), 2);
        for name in ["b1", "b2", "b3"] {
            let (_, x) = after.iter().find(|(it, _)| it == name).unwrap();
            assert!((x.rotation * Vector3::x()).x > 0.0);
        }
    }

    #[test]
    fn an_order_or_an_end_that_cannot_be_seen_is_ambiguous() {
        let kit = kit();
        let one = |name: &str, y, yaw| (name.to_string(), at(y, yaw));
        assert_eq!(ambiguous(&kit, &[one("b1", 0.1, 0.0), one("b2", 0.105, 0.0)]), Some("b2"));
        assert_eq!(ambiguous(&kit, &[one("b1", 0.1, 0.0), one("b9", 0.105, 0.0)]), None);
        assert_eq!(ambiguous(&kit, &[one("b1", 0.1, 1.57)]), Some("b1"));
        assert_eq!(ambiguous(&kit, &[one("b8", 0.1, 1.57)]), None);
    }
}
