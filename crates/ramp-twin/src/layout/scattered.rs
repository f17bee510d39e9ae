//! Places anywhere on the table: of beams and holders with their pegs, or of beams on one another and lying
//! pegs.

use std::collections::BTreeMap;

use nalgebra::{Point2, Point3, Translation3, UnitQuaternion, Vector3};
use ramp_assembly::Assembly;
use ramp_kit::joint::{HEAD_HEIGHT, HEAD_WIDTH, STEM_LENGTH};
use ramp_kit::shape::Cuboid;
use ramp_kit::{Footprint, Pose, lookalike};
use ramp_robot::random::Stream;
use ramp_world::start::Scatter;

use super::body::Body;

/// Number of places that are drawn for a part before the draw starts over.
const TRIES: usize = 1000;
/// Number of times that a draw starts over before the start counts as impossible.
const DRAWS: usize = 300;
/// Room below a beam that lies on others, over the highest of them, m: it falls this far.
const FALL: f64 = 2.0e-3;

/// A part that is to be placed.
struct Item {
    /// At a pose that only serves as its turn about its own axes and its height.
    body: Body,
    kind: Kind,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Clamped,
    Beam,
    /// A beam that may lie over beams and pegs.
    Upper,
    Holder,
    Peg,
}

/// The poses of beams, holders and lying pegs in the episode with this seed, in the world, by name. Without
/// tags, beams that look alike are named by their places; a draw in which those are ambiguous starts over.
///
/// # Errors
/// The name of a part for which no place was found.
pub fn draw(
    assembly: &Assembly,
    clearance: f64,
    scatter: &Scatter,
    tags: bool,
    seed: u64,
) -> Result<BTreeMap<String, Pose>, String> {
    let mut stream = Stream::new(seed, "layout");
    let mut failed = String::new();
    for _ in 0..DRAWS {
        let items = match place(items(assembly, scatter), clearance, scatter, &mut stream) {
            Ok(items) => items,
            Err(part) => {
                failed = part;
                continue;
            }
        };
        let beams = beams(&items);
        let mut poses = poses(items);
        if tags {
            return Ok(poses);
        }
        match lookalike::ambiguous(&assembly.kit, &beams) {
            Some(beam) => failed = beam.to_string(),
            None => {
                let names: Vec<&str> = beams.iter().map(|(name, _)| name.as_str()).collect();
                poses.extend(lookalike::named(&assembly.kit, &names, &beams));
                return Ok(poses);
            }
        }
    }
    Err(failed)
}

/// Poses of the beams that are not clamped, by name.
fn beams(items: &[Item]) -> Vec<(String, Pose)> {
    let free = items.iter().filter(|item| matches!(item.kind, Kind::Beam | Kind::Upper));
    free.map(|item| (item.body.name.clone(), item.body.x)).collect()
}

/// All parts to be placed, in the order of the draw.
fn items(assembly: &Assembly, scatter: &Scatter) -> Vec<Item> {
    let kit = &assembly.kit;
    let base = &assembly.beams[assembly.base];
    let jumbled = scatter.jumble >= 0.5;
    let highest = kit.beams.iter().map(|beam| 2.0 * beam.axis_height_on_table()).fold(0.0, f64::max);
    let mut items = vec![Item { body: Body::beam(&base.beam, kit.x_wa() * base.x_ab), kind: Kind::Clamped }];
    items.extend(kit.holders.iter().map(|holder| {
        let body = Body::holder(holder, Pose::identity());
        Item { body, kind: Kind::Holder }
    }));
    let beams = kit.beams.iter().filter(|beam| beam.name != base.beam.name && beam.start.is_some());
    for (index, beam) in beams.enumerate() {
        let upper = jumbled && index % 2 == 1;
        let roll = if beam.start.is_some_and(|start| start.flipped) { std::f64::consts::PI } else { 0.0 };
        let height = beam.axis_height_on_table() + if upper { highest + FALL } else { 0.0 };
        let x = Pose::from_parts(
            Translation3::new(0.0, 0.0, height),
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), roll),
        );
        let kind = if upper { Kind::Upper } else { Kind::Beam };
        items.push(Item { body: Body::beam(beam, x), kind });
    }
    if jumbled {
        let half = HEAD_WIDTH / 2.0;
        let box_ = Cuboid::new([-STEM_LENGTH, HEAD_HEIGHT], [-half, half], [-half, half]);
        items.extend(kit.pegs.iter().map(|peg| {
            let middle = Point3::from(box_.centre());
            let x = Pose::translation(0.0, 0.0, half);
            Item { body: Body::new(&peg.name, x, middle, vec![box_]), kind: Kind::Peg }
        }));
    }
    items
}

/// Places all parts, each clear of those before it.
///
/// # Errors
/// The name of the first part for which a thousand draws found no place.
fn place(
    items: Vec<Item>,
    clearance: f64,
    scatter: &Scatter,
    stream: &mut Stream,
) -> Result<Vec<Item>, String> {
    let mut placed: Vec<Item> = Vec::new();
    for mut item in items {
        let flat = item.body.x;
        let found = item.kind == Kind::Clamped
            || (0..TRIES).any(|_| {
                item.body.x = anywhere(&item.body, &flat, scatter, stream);
                within(&item, scatter)
                    && placed.iter().all(|other| is_clear(&item, other, clearance, scatter))
                    && (scatter.jumble >= 0.5 || leaves_room(&item, &placed))
            });
        if !found {
            return Err(item.body.name);
        }
        placed.push(item);
    }
    Ok(placed)
}

/// A place for a body with its middle anywhere in the region.
fn anywhere(body: &Body, flat: &Pose, scatter: &Scatter, stream: &mut Stream) -> Pose {
    let mut between = |from: f64, to: f64| from + (to - from) * stream.uniform();
    let x = between(scatter.area_x.from, scatter.area_x.to);
    let y = between(scatter.area_y.from, scatter.area_y.to);
    let turn = between(-std::f64::consts::PI, std::f64::consts::PI);
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
    let middle = (flat * body.middle).xy();
    Translation3::new(x, y, 0.0) * turn * Translation3::new(-middle.x, -middle.y, 0.0) * flat
}

/// Whether all of a part lies in the area, its middle in the ring, and a holder not where the frame is to
/// stand.
fn within(item: &Item, scatter: &Scatter) -> bool {
    let body = &item.body;
    let middle = (body.x * body.middle).xy();
    let inside = |p: &Point2<f64>| scatter.area_x.holds(p.x) && scatter.area_y.holds(p.y);
    let [x, y] = [scatter.frame_x, scatter.frame_y].map(|range| [range.from, range.to]);
    let frame = Footprint::of_ranges(x, y);
    scatter.ring.holds(middle.coords.norm())
        && body.footprints().all(|footprint| footprint.corners().iter().all(inside))
        && (item.kind != Kind::Holder || body.footprints().all(|footprint| footprint.is_clear(&frame, 0.0)))
}

/// Whether a part is far enough from another one.
fn is_clear(item: &Item, other: &Item, clearance: f64, scatter: &Scatter) -> bool {
    let clearance = match (item.kind, other.kind) {
        (Kind::Upper, Kind::Beam) | (Kind::Beam, Kind::Upper) => return true,
        (_, Kind::Clamped) => scatter.clamped.max(clearance),
        _ => clearance,
    };
    item.body.is_clear(&item.body.x, &other.body, clearance)
}

/// Whether the hand can grip each link of a part and of all others that it could grip without this part.
fn leaves_room(item: &Item, placed: &[Item]) -> bool {
    let before: Vec<&Body> = placed.iter().map(|other| &other.body).collect();
    if item.body.grippable(&before) != item.body.grippable(&[]) {
        return false;
    }
    placed.iter().enumerate().filter(|(_, other)| other.kind == Kind::Beam).all(|(index, beam)| {
        let others = before.iter().enumerate().filter(|(other, _)| *other != index);
        let around: Vec<&Body> = others.map(|(_, body)| *body).chain([&item.body]).collect();
        beam.body.grippable(&around) == beam.body.grippable(&[])
    })
}

/// The pose of each part by name. The stem of a lying peg points along −x of its place.
fn poses(items: Vec<Item>) -> BTreeMap<String, Pose> {
    let lying = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f64::consts::FRAC_PI_2);
    let pose = |item: Item| {
        let x = if item.kind == Kind::Peg { item.body.x * lying } else { item.body.x };
        (item.body.name, x)
    };
    items.into_iter().map(pose).collect()
}
