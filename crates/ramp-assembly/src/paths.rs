//! Insertion paths: the directions from which each beam can be inserted, and the beams that block
//! it there.
//!
//! This is the only place that decides which beams block which. The checker finds a first order
//! with it, the generator proves that its goals can be built, and the planner passes it to its
//! rules.

use crate::block::LEAST_DISTANCE;
use crate::placed::{Connection, PlacedBeam};
use crate::sweep::{Meeting, Solid, clear_distance};
use nalgebra::{Point3, Unit, Vector3};
use ramp_kit::Link;
use ramp_kit::shape::beam_shapes;

/// Distance of a grasp from both ends of a link, m: half a fingertip and 1 mm.
pub const FINGER: f64 = 11.0e-3;
/// Smallest remaining length of the link for the choice of a grasp, m.
const ROOM: f64 = 5.0e-3;
/// The insertion path from above.
pub const DOWN: &str = "down";

/// A straight insertion path to a beam's goal pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    /// For people and for the rules.
    pub name: &'static str,
    /// The direction of the motion, in the assembly frame.
    pub direction: Unit<Vector3<f64>>,
}

/// Collision between a beam being withdrawn and a placed one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Obstacle {
    /// The overlaps along the path.
    pub meeting: Meeting,
    /// Whether no link with room for a hand remains behind the placed beam.
    pub handless: bool,
}

impl Obstacle {
    /// Whether it blocks the path on its own.
    pub fn blocks(&self) -> bool {
        self.handless || self.meeting.blocks()
    }
}

/// The insertion paths of all beams of an assembly.
#[derive(Clone, Debug)]
pub struct Paths {
    solids: Vec<Solid>,
    ways: Vec<Vec<Way>>,
    /// By beam and path: the nearby beams, by index, and their collisions.
    near: Vec<Vec<Vec<(usize, Obstacle)>>>,
}

impl Paths {
    /// The paths of placed beams. The clamped beam `base` has none.
    pub fn new(beams: &[PlacedBeam], base: usize, connections: &[Connection]) -> Paths {
        let solid = |placed: &PlacedBeam| Solid::new(&beam_shapes(&placed.beam), &placed.x_ab);
        let solids: Vec<Solid> = beams.iter().map(solid).collect();
        let ways: Vec<Vec<Way>> = beams.iter().map(ways).collect();
        let near = (0..beams.len())
            .map(|beam| {
                let of_way = |way: &Way| {
                    let back = -way.direction.into_inner();
                    let others = (0..beams.len()).filter(|&other| other != beam && beam != base);
                    let near = others.filter(|&other| solids[beam].may_meet(&solids[other], &back));
                    near.map(|other| {
                        let meeting = solids[beam].meeting(&solids[other], &back);
                        let begins = meeting.covers.first();
                        let handless = begins.is_some_and(|it| it[0] <= 0.0 && it[1] > LEAST_DISTANCE)
                            && handless(beams, connections, [beam, other], way);
                        (other, Obstacle { meeting, handless })
                    })
                    .collect()
                };
                ways[beam].iter().map(of_way).collect()
            })
            .collect();
        Paths { solids, ways, near }
    }

    /// The beams in their goal poses, by index.
    pub fn solids(&self) -> &[Solid] {
        &self.solids
    }

    /// The paths to a beam's goal pose, the usual ones first, the one from above last.
    pub fn ways(&self, beam: usize) -> &[Way] {
        &self.ways[beam]
    }

    /// The beams near a path of a beam, by index, and their collisions.
    pub fn near(&self, beam: usize, way: usize) -> &[(usize, Obstacle)] {
        &self.near[beam][way]
    }

    /// The collision of a beam with another on a path; `None` when they are not near each other.
    pub fn obstacle(&self, beam: usize, way: usize, other: usize) -> Option<&Obstacle> {
        let near = &self.near[beam][way];
        near.binary_search_by_key(&other, |(other, _)| *other).ok().map(|index| &near[index].1)
    }

    /// The beams that each block a path of a beam on their own.
    pub fn blocked(&self, beam: usize, way: usize) -> impl Iterator<Item = usize> + '_ {
        self.near[beam][way].iter().filter(|(_, obstacle)| obstacle.blocks()).map(|(other, _)| *other)
    }

    /// Pairs of beams that block a path only together: one makes the path longer, and the other one
    /// is further out.
    pub fn blocked_together(&self, beam: usize, way: usize) -> Vec<[usize; 2]> {
        let near = self.near[beam][way].iter().filter(|(_, obstacle)| !obstacle.blocks());
        let alone: Vec<(usize, &Meeting)> = near.map(|(other, it)| (*other, &it.meeting)).collect();
        let longer = alone.iter().filter(|(_, it)| clear_distance([*it].into_iter()) != Some(LEAST_DISTANCE));
        let mut pairs: Vec<[usize; 2]> = longer
            .flat_map(|&(first, longer)| {
                let others = alone.iter().filter(move |(second, it)| *second != first && !it.hits.is_empty());
                let shut = others.filter(move |(_, it)| clear_distance([longer, *it].into_iter()).is_none());
                shut.map(move |&(second, _)| [first.min(second), first.max(second)])
            })
            .collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    /// Length of the straight motion that brings a beam to its goal pose past the placed ones, m;
    /// `None` when this path is blocked.
    pub fn distance(&self, beam: usize, way: usize, stands: impl Fn(usize) -> bool) -> Option<f64> {
        let near = self.near[beam][way].iter().filter(|(other, _)| stands(*other)).map(|(_, it)| it);
        if near.clone().any(|obstacle| obstacle.handless) {
            return None;
        }
        clear_distance(near.map(|obstacle| &obstacle.meeting))
    }
}

/// Whether a link is long enough for a hand.
pub fn usable(link: &Link) -> bool {
    link.grasp[1] - link.grasp[0] - 2.0 * FINGER >= ROOM
}

/// Grasp position on a link, from j1, m.
pub fn middle(link: &Link) -> f64 {
    0.5 * (link.grasp[0] + link.grasp[1])
}

/// Whether every link of a beam must pass through a joint of the other one on this path.
fn handless(beams: &[PlacedBeam], connections: &[Connection], [beam, other]: [usize; 2], way: &Way) -> bool {
    let placed = &beams[beam];
    let holes: Vec<Point3<f64>> = connections
        .iter()
        .filter(|connection| connection.male.beam == beam && connection.female.beam == other)
        .map(|connection| placed.x_ab * placed.beam.p_b_hole(connection.male.joint))
        .collect();
    let behind = |link: &Link| {
        let p = placed.x_ab * Point3::new(middle(link), 0.0, 0.0);
        usable(link) && holes.iter().all(|hole| (p - hole).dot(&way.direction) < 0.0)
    };
    !holes.is_empty() && !placed.beam.links.iter().any(behind)
}

/// The candidate directions: an oblique beam along its own axis first, any other towards the
/// clamped beam.
fn ways(placed: &PlacedBeam) -> Vec<Way> {
    let axis = placed.x_ab.rotation * Vector3::x();
    let along = Vector3::new(axis.x, axis.y, 0.0);
    let way = |name, direction| Way { name, direction: Unit::new_normalize(direction) };
    let mut ways: Vec<Way> = Vec::new();
    if !placed.is_square() {
        ways.push(way("backwards", -along));
        ways.push(way("forwards", along));
    }
    let square = [("-Y", 0.0, -1.0), ("-X", -1.0, 0.0), ("+X", 1.0, 0.0), ("+Y", 0.0, 1.0)];
    ways.extend(square.map(|(name, x, y)| way(name, Vector3::new(x, y, 0.0))));
    ways.push(way(DOWN, Vector3::new(0.0, 0.0, -1.0)));
    ways
}
