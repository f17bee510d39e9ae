//! Parts without tags that lie anywhere: found from above, and told apart from near.

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_kit::joint::HEAD_HEIGHT;
use ramp_kit::{Beam, Holder, Pose};
use ramp_robot::{Camera, CameraModel, Image};
use ramp_testing::table::{TIP, tip_above};
use ramp_vision::Lying;
use ramp_vision::untagged::{Believed, Scene, Strewn, strewn_covariance};

use crate::untagged::{Cell, WIDTH};

/// Lays a beam flat with its middle at a place, turned by `yaw`.
fn laid(beam: &Beam, flat: &Pose, [x, y]: [f64; 2], yaw: f64) -> Pose {
    let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw) * flat.rotation;
    let origin = Vector3::new(x, y, 0.0) - rotation * Vector3::new(beam.span() / 2.0, 0.0, 0.0);
    Pose::from_parts(Translation3::new(origin.x, origin.y, flat.translation.z), rotation)
}

impl Cell {
    fn flat(&self, part: &str) -> Pose {
        let kit = &self.table.kit;
        kit.x_wb_start(kit.beam(part).unwrap()).unwrap()
    }

    fn strewn(&self, part: &str) -> Strewn {
        let lying = Lying::at_start(&self.table.kit).into_iter().find(|lying| lying.part == part);
        Strewn { part: part.to_string(), flat: self.flat(part), lying }
    }

    /// Puts a beam somewhere; gives its pose.
    fn lay(&mut self, part: &str, at: [f64; 2], yaw: f64) -> Pose {
        let (kit, flat) = (self.table.kit.clone(), self.flat(part));
        let x_wb = laid(kit.beam(part).unwrap(), &flat, at, yaw);
        self.table.parts.iter_mut().find(|(name, _)| name == part).unwrap().1 = x_wb;
        x_wb
    }

    /// All parts but these, where they are.
    fn known(&self, but: &[&str]) -> Vec<Believed> {
        let others = self.table.parts.iter().filter(|(part, _)| !but.contains(&part.as_str()));
        let believed = |(part, x_wp): &(String, Pose)| Believed {
            part: part.clone(),
            x_wp: *x_wp,
            covariance: strewn_covariance(true),
            lying: None,
            held: false,
        };
        others.map(believed).collect()
    }

    fn seen_from_above(&self) -> Image {
        self.look(Camera::BirdsEye, Pose::translation(0.3, -0.55, 0.5), 1)
    }
}

/// Beams off the sheet, at any turn, are found where they are, one of each length, and none where there is
/// none.
#[test]
fn beams_that_lie_anywhere_are_found_from_above() {
    let mut cell = Cell::new();
    let strewn = [("b2", [0.47, -0.25], 0.6), ("b6", [0.66, -0.42], 0.6), ("b9", [0.68, 0.08], 1.4)];
    let truth = strewn.map(|(part, at, yaw)| (part, cell.lay(part, at, yaw)));
    let names = strewn.map(|(part, ..)| part);
    let image = cell.seen_from_above();
    let known = cell.known(&names);
    let scene = Scene { parts: &known, holders: &cell.holders, width: WIDTH };
    let model = CameraModel::nominal(Camera::BirdsEye, TIP);
    let wanted = names.map(|part| cell.strewn(part));
    let found = cell.finder.find_beams_anywhere(&image, &model, &scene, &wanted).unwrap();
    assert_eq!(found.len(), names.len(), "{found:?}");
    for (part, x_wb) in &truth {
        let span = cell.table.kit.beam(part).unwrap().span();
        let middle = |x: &Pose| x * Point3::new(span / 2.0, 0.0, 0.0);
        let (_, seen) = found.iter().find(|(name, _)| name == part).unwrap();
        let off = (middle(seen) - middle(x_wb)).xy().norm();
        let turn = (seen.rotation * Vector3::x()).cross(&(x_wb.rotation * Vector3::x())).norm();
        assert!(off < 3.0e-3 && turn < 0.02, "{part}: {off} m, {turn}");
    }
    // Known beams are not found again.
    let all = cell.known(&[]);
    let scene = Scene { parts: &all, ..scene };
    assert_eq!(cell.finder.find_beams_anywhere(&image, &model, &scene, &wanted).unwrap(), []);
}

/// The heads of the pegs of a holder nearly touch in the image, and those of one far from the middle do: they
/// are three in each case.
#[test]
fn heads_of_neighbours_are_told_apart_from_above() {
    for (at, yaw) in [([0.5, -0.1], 0.785), ([0.24, -0.4], 1.5), ([0.75, -0.45], -1.1)] {
        three_heads_are_found(at, yaw);
    }
}

fn three_heads_are_found([x, y]: [f64; 2], yaw: f64) {
    let mut cell = Cell::new();
    let x_wh = Pose::from_parts(
        Translation3::new(x, y, 0.0),
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw),
    );
    let pegs = ["p1", "p2", "p3"];
    for (index, peg) in pegs.iter().enumerate() {
        let along = (index as f64 - 1.0) * Holder::PITCH;
        let place = x_wh * Pose::translation(along, 0.0, Holder::HEIGHT);
        cell.table.parts.iter_mut().find(|(name, _)| name == peg).unwrap().1 = place;
    }
    let image = cell.seen_from_above();
    let known = cell.known(&pegs);
    let scene = Scene { parts: &known, holders: &cell.holders, width: WIDTH };
    let model = CameraModel::nominal(Camera::BirdsEye, TIP);
    let heads = cell.finder.find_heads_anywhere(&image, &model, &scene).unwrap();
    assert_eq!(heads.len(), 3, "{heads:?}");
    for peg in pegs {
        let head = cell.table.truth(peg) * Point3::new(0.0, 0.0, HEAD_HEIGHT / 2.0);
        assert!(heads.iter().any(|it| (it - head).xy().norm() < 4.0e-3), "{peg} at {head}: {heads:?}");
    }
}

/// Beams of one length look alike from above. From near and from the side the image tells which one it is,
/// and which end is which.
#[test]
fn a_beam_is_told_from_its_likes_from_near() {
    for (part, yaw) in [("b1", 0.4), ("b4", 0.4), ("b5", 0.4), ("b8", -0.3)] {
        let mut cell = Cell::new();
        let kit = cell.table.kit.clone();
        let at = [0.45, -0.1];
        cell.lay(part, at, yaw);
        let wanted: &[&str] = if part == "b8" { &["b8", "b9"] } else { &["b1", "b4"] };
        let shapes: Vec<Strewn> = wanted.iter().map(|part| cell.strewn(part)).collect();
        let mut beams = Vec::new();
        for shape in &shapes {
            let beam = kit.beam(&shape.part).unwrap();
            for turn in [0.0, std::f64::consts::PI] {
                beams.push((shape, laid(beam, &shape.flat, at, yaw + turn)));
            }
        }
        // Beside its middle or an end, from both sides.
        let reach = kit.beam(part).unwrap().span() / 2.0;
        let along = if part == "b8" { reach - 0.03 } else { 0.0 };
        let model = CameraModel::nominal(Camera::Wrist, TIP);
        let known = cell.known(&[part]);
        let mut off = vec![vec![0.0; beams.len()]; beams.len()];
        for across in [0.1, -0.1] {
            let (sine, cosine) = yaw.sin_cos();
            let eye = [at[0] + along * cosine + across * sine, at[1] + along * sine - across * cosine, 0.23];
            let image = cell.look(Camera::Wrist, tip_above(&model, eye, yaw, [0.0; 2]), 3);
            let scene = Scene { parts: &known, holders: &cell.holders, width: WIDTH };
            let compared = cell.finder.compare(&image, &model, &scene, &beams).unwrap().unwrap();
            off.iter_mut().flatten().zip(compared.off.iter().flatten()).for_each(|(sum, it)| *sum += it);
        }
        // The fifth beam looks like the fourth after half a turn; both ends of the first look alike.
        let best: &[usize] = match part {
            "b1" => &[0, 1],
            "b4" => &[2],
            "b5" => &[3],
            _ => &[0],
        };
        for other in (0..beams.len()).filter(|other| !best.contains(other)) {
            let (own, its) = (off[best[0]][other], off[other][best[0]]);
            assert!(own < 0.45 * (own + its), "{part} against {other}: {own} and {its}");
        }
    }
}

/// A beam with one end on the table and the other up in the air, as if it leaned on something, is found at
/// its tilt: from above, where heights hardly show, and from near.
#[test]
fn a_beam_that_leans_is_found() {
    let mut cell = Cell::new();
    let flat = cell.lay("b2", [0.47, -0.25], 0.6);
    // About its first end, which stays on the table.
    let across = flat.rotation * Vector3::y_axis();
    let lean = UnitQuaternion::from_axis_angle(&across, -8.0_f64.to_radians());
    let x_wb = Pose::from_parts(flat.translation, lean * flat.rotation);
    cell.table.parts.iter_mut().filter(|(part, _)| part == "b2").for_each(|(_, x)| *x = x_wb);
    let known = cell.known(&["b2"]);
    let scene = Scene { parts: &known, holders: &cell.holders, width: WIDTH };
    let near = tip_above(&CameraModel::nominal(Camera::Wrist, TIP), [0.47, -0.25, 0.45], 0.0, [0.0; 2]);
    let away = Pose::translation(0.3, -0.55, 0.5);
    for (camera, x_wt, most) in [(Camera::BirdsEye, away, 12.0e-3), (Camera::Wrist, near, 3.0e-3)] {
        let image = cell.look(camera, x_wt, 1);
        let model = CameraModel::nominal(camera, TIP);
        let found = cell.finder.find_leaning(&image, &model, &scene, &cell.strewn("b2"), &flat).unwrap();
        let seen = found.unwrap_or_else(|| panic!("{camera:?}: not found")).x_wp;
        let end = Point3::new(cell.table.kit.beam("b2").unwrap().span(), 0.0, 0.0);
        let off = [Point3::origin(), end].map(|end| (seen * end - x_wb * end).norm());
        assert!(off.iter().all(|off| *off < most), "{camera:?}: {off:?} m");
    }
}
