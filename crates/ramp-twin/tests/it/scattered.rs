//! Starts in which parts lie anywhere on the table.

use std::f64::consts::PI;

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_kit::shape::{Shape, beam_shapes};
use ramp_kit::source::SourceFile;
use ramp_kit::{Beam, Footprint, Holder, Kit, Pose, tags};
use ramp_motion::{Joints, PathPlanner};
use ramp_robot::camera::{CameraModel, Mount};
use ramp_robot::{Camera, Track};

use ramp_testing::GoalFiles;
use ramp_twin::{Layout, Setup, Start, Twin, TwinError};

const GOALS: [&str; 9] =
    ["easy-1", "easy-2", "easy-3", "medium-1", "medium-2", "medium-3", "hard-1", "hard-2", "hard-3"];
/// Seeds that each goal draws.
const SEEDS: std::ops::RangeInclusive<u64> = 1..=12;

fn footprints(beam: &Beam, x_wb: &Pose) -> Vec<Footprint> {
    beam_shapes(beam).iter().map(Shape::bounds).map(|bounds| Footprint::new(x_wb, &bounds)).collect()
}

/// Every part on the table by name, as rectangles.
fn parts(kit: &Kit, layout: &Layout) -> Vec<(String, Vec<Footprint>)> {
    let beams = layout.beams.iter().map(|(name, x)| (name.clone(), footprints(kit.beam(name).unwrap(), x)));
    let holders = layout.holders.iter().map(|(name, x)| {
        (name.clone(), Holder::blocks().iter().map(|block| Footprint::new(x, block)).collect())
    });
    beams.chain(holders).collect()
}

fn middle(kit: &Kit, name: &str, x: &Pose) -> Point3<f64> {
    x * Point3::new(kit.beam(name).map_or(0.0, |beam| beam.span() / 2.0), 0.0, 0.0)
}

/// The poses of the open hand that grips a part at its middle, in both senses.
fn grasps(p: Point3<f64>, height: f64, yaw: f64) -> [Pose; 2] {
    [0.0, PI].map(|sense| {
        let down = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw + sense)
            * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
        Pose::from_parts(Translation3::new(p.x, p.y, height), down)
    })
}

fn yaw_of(x: &Pose) -> f64 {
    let along = x.rotation * Vector3::x();
    along.y.atan2(along.x)
}

/// For every goal and seed: no two parts are nearer than the clearance, holders leave the place of the frame
/// free, the arm reaches each part at its middle and over it, and the bird's-eye camera has each tag that is
/// turned up in its picture.
#[test]
fn scattered_parts_are_clear_reachable_and_visible() {
    let start = Start::scattered();
    let scatter = start.scatter.as_ref().unwrap();
    let mut under_the_frame = 0;
    for goal in GOALS {
        let files = GoalFiles::new(goal);
        let kit = &files.assembly.kit;
        let planner = PathPlanner::new(&files.arm);
        let q = Joints::from(files.arm.home);
        let camera = CameraModel::nominal(Camera::BirdsEye, files.arm.hand.tip);
        let Mount::World(x_wc) = camera.mount else { panic!("the bird's-eye camera hangs in the room") };
        for seed in SEEDS {
            let layout = Layout::new(&files.assembly, start, seed);
            assert_eq!(layout.unplaced, None);
            assert_eq!((layout.beams.len(), layout.pegs.len()), (kit.beams.len(), kit.pegs.len()));
            let parts = parts(kit, &layout);
            let base = &files.assembly.beams[files.assembly.base].beam.name;
            for (index, (name, own)) in parts.iter().enumerate() {
                for (other, theirs) in &parts[index + 1..] {
                    let least = if name == base || other == base { 0.03 } else { start.places.clearance };
                    let clear = own.iter().all(|own| theirs.iter().all(|it| own.is_clear(it, least)));
                    assert!(clear, "{goal}, seed {seed}: {name} and {other}");
                }
            }
            let frame = Footprint::of_ranges(
                [scatter.frame_x.from, scatter.frame_x.to],
                [scatter.frame_y.from, scatter.frame_y.to],
            );
            for (name, x) in layout.beams.iter().chain(&layout.holders).filter(|(name, _)| name != base) {
                let p = middle(kit, name, x);
                assert!(scatter.ring.holds(p.xy().coords.norm()), "{goal}, seed {seed}: {name} at {p}");
                let (_, own) = parts.iter().find(|(other, _)| other == name).unwrap();
                let free = own.iter().all(|own| own.is_clear(&frame, 0.0));
                let is_beam = kit.beam(name).is_some();
                assert!(is_beam || free, "{goal}, seed {seed}: {name} stands in the frame's place");
                under_the_frame += usize::from(is_beam && !free);
                for height in [p.z + 0.017, 0.06, 0.15] {
                    let reached = grasps(p, height, yaw_of(x)).iter().any(|x_wt| {
                        planner.solve(x_wt, &q).is_ok_and(|q| planner.kinematics.range_margin(&q) > 0.1)
                    });
                    assert!(reached, "{goal}, seed {seed}: no grasp of {name} at {p}, tip at {height} m");
                }
            }
            for place in tags::places(kit) {
                let all = layout.beams.iter().chain(&layout.pegs);
                let Some((name, x)) = all.into_iter().find(|(name, _)| *name == place.part) else { continue };
                let x_wg = x * place.x_pg;
                assert!((x_wg.rotation * Vector3::z()).z > 0.9, "{goal}, seed {seed}: {name}'s tag is below");
                let pixel =
                    camera.project(&(x_wc.inverse() * Point3::from(x_wg.translation.vector))).unwrap();
                let inside = (20.0..1260.0).contains(&pixel[0]) && (20.0..780.0).contains(&pixel[1]);
                assert!(inside, "{goal}, seed {seed}: the tag of {name} at {pixel:?}");
            }
        }
    }
    let episodes = GOALS.len() * SEEDS.count();
    assert!(
        under_the_frame > episodes,
        "{under_the_frame} beams in {episodes} episodes leave nothing to clear"
    );
}

/// The same seed draws the same places, another one others; nothing moves while the arm waits.
#[test]
fn scattered_parts_lie_still() {
    let files = GoalFiles::new("hard-1");
    for seed in 1..=3 {
        let [one, again, other] =
            [seed, seed, seed + 1].map(|seed| Layout::new(&files.assembly, Start::scattered(), seed));
        assert_eq!((&one.beams, &one.pegs), (&again.beams, &again.pegs));
        assert_ne!(one.beams, other.beams);
        let setup = Setup { start: Start::scattered(), ..files.setup(Track::State, seed) };
        let mut twin = Twin::new(&setup).unwrap();
        let before = twin.truth().x_wp;
        twin.settle(500).unwrap();
        for ((name, x), x_before) in twin.part_names().zip(twin.truth().x_wp).zip(before) {
            let moved = (x.translation.vector - x_before.translation.vector).norm();
            assert!(moved < 0.5e-3, "seed {seed}: {name} has moved by {moved} m");
        }
    }
}

/// Of a jumble, beams lie on one another, and pegs lie: nothing goes through the table or another part.
#[test]
fn a_jumble_comes_to_rest() {
    let files = GoalFiles::new("easy-1");
    let kit = &files.assembly.kit;
    let (mut upright, mut raised) = (0, 0);
    for seed in 1..=4 {
        let setup = Setup { start: Start::jumbled(), ..files.setup(Track::State, seed) };
        let mut twin = Twin::new(&setup).unwrap();
        twin.settle(1500).unwrap();
        assert!(twin.deepest_penetration() < 2.0e-3, "seed {seed}: {} m", twin.deepest_penetration());
        for (name, x) in twin.part_names().zip(twin.truth().x_wp) {
            let up = (x.rotation * Vector3::z()).z;
            assert!(
                x.translation.z > 0.0 && x.translation.vector.xy().norm() < 1.2,
                "seed {seed}: {name} at {x}"
            );
            let Some(beam) = kit.beam(name).filter(|beam| beam.start.is_some()) else {
                upright += usize::from(kit.peg(name).is_some() && up > 0.5);
                continue;
            };
            raised += usize::from(x.translation.z > beam.axis_height_on_table() + 5.0e-3);
        }
    }
    assert_eq!(upright, 0);
    assert!(raised > 2, "{raised} beams lie on others");
}

/// A start whose region is too small for its parts is refused, and no part is put where another one is.
#[test]
fn a_start_without_room_is_refused() {
    let files = GoalFiles::new("easy-1");
    let text = Start::scattered().text.replace("value = [0.36, 0.64]", "value = [0.36, 0.37]");
    let text =
        text.replace("name = \"scattered\"", "name = \"narrow\"").replace("[-0.62, 0.62]", "[0.2, 0.62]");
    let start = Start::from_source(&SourceFile::new("narrow.toml", &text)).unwrap();
    let setup = Setup { start: &start, ..files.setup(Track::State, 1) };
    let Err(error) = Twin::new(&setup) else { panic!("there is no room for eight beams") };
    assert!(matches!(error, TwinError::NoPlace { .. }), "{error}");
    assert!(error.to_string().starts_with("start narrow: no place for "), "{error}");
}

/// Without tags, who sees the table can tell the names: those of beams that look alike go from right to left,
/// and one whose ends look alike points away from the arm.
#[test]
fn without_tags_names_are_given_by_places() {
    for goal in ["easy-1", "hard-1"] {
        let files = GoalFiles::new(goal);
        let kit = &files.assembly.kit;
        for start in [Start::scattered(), Start::jumbled()] {
            for seed in 1..=10 {
                let layout = Layout::on_track(&files.assembly, start, Track::Colour, seed);
                assert_eq!(layout.unplaced, None);
                let y = |name: &str| {
                    let (_, x) = layout.beams.iter().find(|(it, _)| it == name)?;
                    Some((x * Point3::new(kit.beam(name)?.span() / 2.0, 0.0, 0.0)).y)
                };
                let base = &files.assembly.beams[files.assembly.base].beam.name;
                for names in [&["b1", "b2", "b3"][..], &["b4", "b5"]] {
                    let free = names.iter().filter(|name| *name != base);
                    let ys: Vec<f64> = free.filter_map(|name| y(name)).collect();
                    assert!(
                        ys.windows(2).all(|pair| pair[0] + 9.0e-3 < pair[1]),
                        "{goal}, seed {seed}: {ys:?}"
                    );
                }
                for (name, x) in layout.beams.iter().filter(|(name, _)| name != base) {
                    let ahead = (x.rotation * Vector3::x()).x > 0.0;
                    let like = ["b1", "b2", "b3", "b6", "b9"].contains(&name.as_str());
                    assert!(ahead || !like, "{goal}, seed {seed}: {name}");
                }
            }
        }
    }
}
