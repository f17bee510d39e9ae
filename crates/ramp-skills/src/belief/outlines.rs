//! The outlines of the sheet on which a part may lie at the start, its places in the frame, and the poses of
//! the holders by the pegs that were found in them.

use std::collections::BTreeMap;

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_assembly::Assembly;
use ramp_kit::joint::FEMALE_HEIGHT;
use ramp_kit::{Beam, Holder, Kit};
use ramp_world::Start;

use crate::Pose;
use crate::grasp::yaw_of;

/// Standard deviation of a uniform distribution over its half width.
const UNIFORM: f64 = 0.577_350_269_189_625_8;
/// Holes that are nearer to one another are those of one connection, m.
const HOLES_APART: f64 = 5.0e-3;

/// Deviation of a part from the outline on which it lies, 1 σ: its position along the table, m, and its turn
/// about the vertical, rad.
pub fn spread(start: &Start, lever: f64) -> [f64; 2] {
    let places = &start.places;
    [UNIFORM * (places.shift + places.turn * lever), UNIFORM * places.turn]
}

/// The poses on the outlines on which a beam may lie, its own first.
pub fn of_beam(kit: &Kit, beam: &Beam, start: &Start) -> Vec<Pose> {
    let others = kit
        .beams
        .iter()
        .filter(|other| start.trades() && other.name != beam.name && other.has_shape_of(beam));
    [beam].into_iter().chain(others).filter_map(|it| kit.x_wb_start(it)).collect()
}

/// The poses in the holders' slots in which a peg may stand, its own first.
pub fn of_peg(kit: &Kit, peg: &str, start: &Start) -> Vec<Pose> {
    let own = kit.peg(peg);
    let others = kit.pegs.iter().filter(|other| start.trades() && other.name != peg);
    own.into_iter().chain(others).filter_map(|it| kit.x_wp_start(it)).collect()
}

/// Poses of the holders by the pegs that were found in their slots. One without a peg stands on its outline.
pub fn holders(kit: &Kit, pegs: impl Iterator<Item = Pose>) -> Vec<(String, Pose)> {
    let pegs: Vec<Vector3<f64>> = pegs.map(|x| x.translation.vector).collect();
    kit.holders
        .iter()
        .map(|holder| {
            let at = kit.sheet_to_world(holder.centre);
            let slot = |slot: i32| Vector3::new(at.x + f64::from(slot) * Holder::PITCH, at.y, Holder::HEIGHT);
            let near = |slot: &Vector3<f64>| {
                let distance = |peg: &&Vector3<f64>| (*peg - slot).norm();
                let peg = pegs.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
                (distance(&peg) < Holder::PITCH / 2.0).then_some(*peg)
            };
            let found: Vec<(f64, Vector3<f64>)> = [-1, 0, 1]
                .into_iter()
                .filter_map(|it| Some((f64::from(it) * Holder::PITCH, near(&slot(it))?)))
                .collect();
            let yaw = match (found.first(), found.last()) {
                (Some((from, first)), Some((to, last))) if to > from => {
                    (last.y - first.y).atan2(last.x - first.x)
                }
                _ => 0.0,
            };
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
            let centres = found.iter().map(|(along, peg)| peg - turn * Vector3::new(*along, 0.0, 0.0));
            let centre = match found.len() {
                0 => at.coords,
                count => centres.sum::<Vector3<f64>>() / count as f64,
            };
            (holder.name.clone(), Pose::from_parts(Translation3::new(centre.x, centre.y, 0.0), turn))
        })
        .collect()
}

/// Poses of holders that stand anywhere, by the pegs that were found in them: each with its own pegs, in the
/// order of their slots. One without a peg that was found is left out.
pub fn holders_anywhere(kit: &Kit, found: impl Fn(&str) -> Option<Pose>) -> Vec<(String, Pose)> {
    let of_pegs = |holder: &Holder| {
        let own = kit.pegs.iter().filter(|peg| peg.holder == holder.name);
        let mut pegs: Vec<(f64, Pose)> =
            own.filter_map(|peg| Some((f64::from(peg.slot) * Holder::PITCH, found(&peg.name)?))).collect();
        pegs.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let ((from, first), (to, last)) = (*pegs.first()?, *pegs.last()?);
        let apart = last.translation.vector - first.translation.vector;
        let yaw = if to > from { apart.y.atan2(apart.x) } else { yaw_of(&first) };
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
        let centres =
            pegs.iter().map(|(along, x)| x.translation.vector - turn * Vector3::new(*along, 0.0, 0.0));
        let centre = centres.sum::<Vector3<f64>>() / pegs.len() as f64;
        Some(Pose::from_parts(Translation3::new(centre.x, centre.y, 0.0), turn))
    };
    kit.holders.iter().filter_map(|holder| Some((holder.name.clone(), of_pegs(holder)?))).collect()
}

/// The places of each part in the frame, in the world, its own first: a beam may stand in the place of
/// another one with the same joints, and any peg in any hole, those of connections first.
pub(super) fn in_frame(assembly: &Assembly) -> BTreeMap<String, Vec<Pose>> {
    let kit = &assembly.kit;
    let x_wa = kit.x_wa();
    let base = &assembly.beams[assembly.base].beam.name;
    let placed = || assembly.beams.iter().filter(|it| it.beam.name != *base);
    let of_beam = |beam: &Beam| {
        let own = placed().filter(|it| it.beam.name == beam.name);
        let others = placed().filter(|it| it.beam.name != beam.name && it.beam.has_joints_of(beam));
        own.chain(others).map(|it| x_wa * it.x_ab).collect::<Vec<Pose>>()
    };
    let connected = assembly.connections.iter().map(|it| assembly.p_a_hole(it.female));
    let all = assembly
        .beams
        .iter()
        .flat_map(|it| (0..it.beam.joints.len()).map(|joint| it.x_ab * it.beam.p_b_hole(joint)));
    let mut holes: Vec<Pose> = Vec::new();
    for hole in connected.chain(all).map(|hole| x_wa * hole) {
        let x = Pose::translation(hole.x, hole.y, hole.z + FEMALE_HEIGHT / 2.0);
        let is_it = |other: &Pose| (other.translation.vector - x.translation.vector).norm() < HOLES_APART;
        if !holes.iter().any(is_it) {
            holes.push(x);
        }
    }
    let beams = kit.beams.iter().map(|beam| (beam.name.clone(), of_beam(beam)));
    let pegs = kit.pegs.iter().map(|peg| (peg.name.clone(), holes.clone()));
    beams.chain(pegs).filter(|(_, places)| !places.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use std::path::Path;

    use super::*;

    fn kit() -> Kit {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
        ramp_kit::read_kit(&data.join("kit.xml")).unwrap()
    }

    #[test]
    fn parts_of_one_shape_may_lie_in_each_others_places() {
        let kit = kit();
        let count = |name: &str, start| of_beam(&kit, kit.beam(name).unwrap(), start).len();
        assert_eq!((count("b1", Start::moved()), count("b4", Start::moved())), (3, 1));
        assert_eq!(count("b1", Start::sheet()), 1);
        assert_eq!(of_peg(&kit, "p3", Start::moved()).len(), 15);
        assert_eq!(of_peg(&kit, "p3", Start::sheet()), [kit.x_wp_start(kit.peg("p3").unwrap()).unwrap()]);
    }

    /// A holder is where its pegs say, also when one of them has been taken out.
    #[test]
    fn holders_stand_where_their_pegs_are() {
        let kit = kit();
        let at = kit.sheet_to_world(kit.holders[1].centre);
        let x_wh = Pose::from_parts(
            Translation3::new(at.x + 0.004, at.y - 0.003, 0.0),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.07),
        );
        let peg = |slot: f64| x_wh * Pose::translation(slot * Holder::PITCH, 0.0, Holder::HEIGHT);
        for pegs in [vec![-1.0, 0.0, 1.0], vec![-1.0, 1.0], vec![0.0, 1.0]] {
            let found = holders(&kit, pegs.into_iter().map(peg));
            let (name, x) = &found[1];
            assert_eq!(name, "h2");
            assert!((x.translation.vector - x_wh.translation.vector).norm() < 1e-9);
            assert!(x.rotation.angle_to(&x_wh.rotation) < 1e-9);
            let at = kit.sheet_to_world(kit.holders[0].centre);
            assert_eq!(found[0].1, Pose::translation(at.x, at.y, 0.0));
        }
    }

    /// A holder that stands anywhere is where its own pegs say, however it is turned.
    #[test]
    fn holders_anywhere_stand_where_their_own_pegs_are() {
        let kit = kit();
        let x_wh = Pose::from_parts(
            Translation3::new(0.3, -0.5, 0.0),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 2.5),
        );
        let stands = |peg: &str| {
            let peg = kit.peg(peg).filter(|peg| peg.holder == "h4")?;
            Some(x_wh * Pose::translation(f64::from(peg.slot) * Holder::PITCH, 0.0, Holder::HEIGHT))
        };
        for pegs in [&["p10", "p11", "p12"][..], &["p12"], &["p10", "p11"]] {
            let found = holders_anywhere(&kit, |peg| stands(peg).filter(|_| pegs.contains(&peg)));
            let [(name, x)] = &found[..] else { panic!("{found:?}") };
            assert_eq!(name, "h4");
            assert!((x.translation.vector - x_wh.translation.vector).norm() < 1e-9);
            assert!(x.rotation.angle_to(&x_wh.rotation) < 1e-9);
        }
    }
}
