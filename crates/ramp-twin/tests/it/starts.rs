//! Starts: where the parts lie, drawn from the seed.

use std::collections::BTreeSet;

use nalgebra::{Point3, Vector3};
use ramp_assembly::Assembly;
use ramp_kit::{Kit, Pose};
use ramp_robot::Track;
use ramp_testing::GoalFiles;
use ramp_twin::{Layout, Setup, Start, Twin};

/// Shift (m) and turn (rad) of a beam from an outline.
fn from_outline(kit: &Kit, beam: &str, outline: &str, x_wb: &Pose) -> [f64; 2] {
    let middle = Point3::new(kit.beam(beam).unwrap().span() / 2.0, 0.0, 0.0);
    let there = kit.x_wb_start(kit.beam(outline).unwrap()).unwrap();
    let off = (x_wb * middle) - (there * middle);
    [off.x.abs().max(off.y.abs()), x_wb.rotation.angle_to(&there.rotation)]
}

/// The slot in which a peg stands, as the name of the peg that has it on the sheet.
fn slot<'k>(kit: &'k Kit, x_wp: &Pose) -> &'k str {
    let off = |peg: &&ramp_kit::Peg| {
        (kit.x_wp_start(peg).unwrap().translation.vector - x_wp.translation.vector).norm()
    };
    let nearest = kit.pegs.iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
    assert!(off(&nearest) < 0.017);
    &nearest.name
}

fn beam<'l>(layout: &'l Layout, name: &str) -> &'l Pose {
    &layout.beams.iter().find(|(other, _)| other == name).unwrap().1
}

/// The same seed gives the same places, another one others; the clamped beam has its own.
#[test]
fn parts_stay_on_their_own_outlines_of_the_sheet() {
    let files = GoalFiles::new("easy-1");
    let kit = &files.assembly.kit;
    for seed in 1..=20 {
        let layout = Layout::new(&files.assembly, Start::sheet(), seed);
        let [again, other] = [seed, seed + 1].map(|seed| Layout::new(&files.assembly, Start::sheet(), seed));
        assert_eq!(layout.beams, again.beams);
        assert_ne!(layout.beams, other.beams);
        let clamped = beam(&layout, "b7").translation.vector;
        assert!((clamped - Vector3::new(0.31, 0.0268, 0.0166)).norm() < 1e-9, "{clamped}");
        for (name, x_wb) in layout.beams.iter().filter(|(name, _)| name != "b7") {
            let [shift, turn] = from_outline(kit, name, name, x_wb);
            assert!(shift <= 1.0e-3 && turn <= 1.0_f64.to_radians(), "{name}: {shift} m, {turn} rad");
        }
        for (name, x_wp) in &layout.pegs {
            assert_eq!(slot(kit, x_wp), name);
        }
    }
}

/// Every part lies within the limits of the start at one outline of its shape, no two at the same; all of the
/// spread is used; beams of one shape and pegs trade places.
#[test]
fn parts_are_moved_and_trade_places() {
    let files = GoalFiles::new("easy-1");
    let kit = &files.assembly.kit;
    let places = &Start::moved().places;
    let (mut farthest, mut most) = (0.0_f64, 0.0_f64);
    let (mut outlines_of_b1, mut slots_of_p1) = (BTreeSet::new(), BTreeSet::new());
    for seed in 1..=60 {
        let layout = Layout::new(&files.assembly, Start::moved(), seed);
        let mut taken = BTreeSet::new();
        for (name, x_wb) in layout.beams.iter().filter(|(name, _)| name != "b7") {
            let shape: &[&str] =
                if ["b1", "b2", "b3"].contains(&name.as_str()) { &["b1", "b2", "b3"] } else { &[name] };
            let shape: Vec<&str> = shape.to_vec();
            let fits = |outline: &&&str| from_outline(kit, name, outline, x_wb)[0] < 0.02;
            let outline = *shape.iter().find(fits).unwrap();
            let [shift, turn] = from_outline(kit, name, outline, x_wb);
            assert!(shift <= places.shift && turn <= places.turn, "{name}: {shift} m, {turn} rad");
            (farthest, most) = (farthest.max(shift), most.max(turn));
            assert!(taken.insert(outline), "two beams on the outline of {outline}");
            if name == "b1" {
                outlines_of_b1.insert(outline.to_string());
            }
        }
        let mut slots: Vec<&str> = layout.pegs.iter().map(|(_, x_wp)| slot(kit, x_wp)).collect();
        slots_of_p1.insert(slots[0].to_string());
        slots.sort_unstable();
        slots.dedup();
        assert_eq!(slots.len(), kit.pegs.len());
        assert!(layout.pegs.iter().map(|(name, _)| name).eq(kit.pegs.iter().map(|peg| &peg.name)));
    }
    assert!(farthest > 0.95 * places.shift && most > 0.95 * places.turn, "{farthest} m, {most} rad");
    assert_eq!(outlines_of_b1.len(), 3);
    assert!(slots_of_p1.len() > 10, "{slots_of_p1:?}");
}

/// The hand can grip each link of every beam that it can grip on the outlines: with seed 4, b6 once lay
/// beside one link of b1, and a holder beside the other, so that no plan could build easy-1.
#[test]
fn the_fingers_have_room_beside_every_link() {
    let files = GoalFiles::new("easy-1");
    let kit = &files.assembly.kit;
    // Corners of both fingers of the open hand beside the point at `s`, in the beam's frame.
    let fingers = |s: f64| {
        [-1.0, 1.0]
            .map(|side| [-0.01, 0.01].map(|x| [0.018, 0.028].map(|y| Point3::new(s + x, side * y, 0.0))))
    };
    for seed in 1..=100 {
        let layout = Layout::new(&files.assembly, Start::moved(), seed);
        let covered = |p: &Point3<f64>, but: &str| {
            let in_beam = layout.beams.iter().filter(|(name, _)| name != but).any(|(name, x_wb)| {
                let p_b = x_wb.inverse_transform_point(p);
                (-0.02..kit.beam(name).unwrap().span() + 0.02).contains(&p_b.x) && p_b.y.abs() < 0.011
            });
            in_beam
                || layout.holders.iter().any(|(_, x_wh)| {
                    let p_h = x_wh.inverse_transform_point(p);
                    p_h.x.abs() < ramp_kit::Holder::BASE[0] / 2.0
                        && p_h.y.abs() < ramp_kit::Holder::BASE[1] / 2.0
                })
        };
        for (name, x_wb) in layout.beams.iter().filter(|(name, _)| name != "b7") {
            for link in &kit.beam(name).unwrap().links {
                let [from, to] = link.grasp;
                let free = (0..=20).any(|step| {
                    let s = from + (to - from) * f64::from(step) / 20.0;
                    fingers(s).iter().flatten().flatten().all(|p| !covered(&(x_wb * p), name))
                });
                assert!(free, "seed {seed}: {name} cannot be gripped at {}", link.name);
            }
        }
    }
}

/// The places that the seeds draw are free: nothing moves in the first half second.
#[test]
fn moved_parts_lie_still() {
    let files = GoalFiles::new("hard-1");
    for seed in 1..=3 {
        let setup = Setup { start: Start::moved(), ..files.setup(Track::State, seed) };
        let mut twin = Twin::new(&setup).unwrap();
        let before = twin.truth().x_wp;
        twin.settle(500).unwrap();
        for ((name, x), x_before) in twin.part_names().zip(twin.truth().x_wp).zip(before) {
            let moved = (x.translation.vector - x_before.translation.vector).norm();
            assert!(moved < 0.5e-3, "seed {seed}: {name} has moved by {moved} m");
        }
        assert!(twin.deepest_penetration() < 0.3e-3, "{}", twin.deepest_penetration());
    }
}

/// A kit whose outlines lie too close for its start keeps the parts on them.
#[test]
fn a_crowded_sheet_keeps_its_parts() {
    let files = GoalFiles::new("easy-1");
    let mut kit = (*files.assembly.kit).clone();
    let at = kit.beam("b4").unwrap().start.unwrap().at;
    let crowded = kit.beams.iter_mut().find(|beam| beam.name == "b5").unwrap();
    crowded.start.as_mut().unwrap().at = [at[0], at[1] - 0.034];
    let assembly = Assembly { kit: kit.into(), ..files.assembly.clone() };
    let layout = Layout::new(&assembly, Start::moved(), 1);
    let [b4, b5] = ["b4", "b5"].map(|name| beam(&layout, name).translation.vector);
    assert!((b4 - b5).dot(&Vector3::y()).abs() > 0.03, "{b4} {b5}");
}

/// Where no tag tells them apart, each part is called by the outline on which it lies.
#[test]
fn without_tags_parts_do_not_trade_places() {
    let files = GoalFiles::new("easy-1");
    let kit = &files.assembly.kit;
    for seed in 1..=20 {
        let layout = Layout::on_track(&files.assembly, Start::moved(), Track::Colour, seed);
        for (name, x_wb) in layout.beams.iter().filter(|(name, _)| name != "b7") {
            assert!(from_outline(kit, name, name, x_wb)[0] < 0.02, "{name}");
        }
        for (name, x_wp) in &layout.pegs {
            let outline = kit.x_wp_start(kit.peg(name).unwrap()).unwrap();
            assert!((x_wp.translation.vector - outline.translation.vector).norm() < 0.02, "{name}");
        }
    }
}
