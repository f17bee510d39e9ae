//! Insertion paths: from which directions each beam can be put to its place, and which others block it there.
//!
//! This is the only place that decides what blocks what. The checker finds a first order with it, the generator proves
//! that its goals can be built, and the planner tells it to its rules.

use crate::block::LEAST_DISTANCE;
use crate::placed::{Connection, PlacedBeam};
use crate::sweep::{Meeting, Solid, clear_distance};
use nalgebra::{Point3, Unit, Vector3};
use ramp_kit::Link;
use ramp_kit::shape::beam_shapes;

/// Half a fingertip and 1 mm, which a grasp keeps from both ends of a link, m.
pub const FINGER: f64 = 11.0e-3;
/// What must then be left of the link, for the hand to choose from, m.
const ROOM: f64 = 5.0e-3;
/// The insertion path from above.
pub const DOWN: &str = "down";

/// A straight insertion path to a beam's place.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    /// For people and for the rules.
    pub name: &'static str,
    /// The direction of the motion, in the assembly frame.
    pub direction: Unit<Vector3<f64>>,
}

/// How a beam that is drawn out meets one that stands.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Obstacle {
    /// Where they meet.
    pub meeting: Meeting,
    /// No link would stay behind the one that stands, where a hand has room.
    pub handless: bool,
}

impl Obstacle {
    /// Does it block the path, by itself?
    pub fn blocks(&self) -> bool {
        self.handless || self.meeting.blocks()
    }
}

/// The insertion paths of all beams of an assembly.
#[derive(Clone, Debug)]
pub struct Paths {
    solids: Vec<Solid>,
    ways: Vec<Vec<Way>>,
    /// By beam and way: the beams that are near it, by index, and how they meet.
    near: Vec<Vec<Vec<(usize, Obstacle)>>>,
}

impl Paths {
    /// Those of beams at their places. The clamped beam `base` has none.
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

    /// The beams at their places, by index.
    pub fn solids(&self) -> &[Solid] {
        &self.solids
    }

    /// The ways to a beam's place, the usual ones first, the one from above last.
    pub fn ways(&self, beam: usize) -> &[Way] {
        &self.ways[beam]
    }

    /// The beams that are near a way of a beam, by index, and how they meet it.
    pub fn near(&self, beam: usize, way: usize) -> &[(usize, Obstacle)] {
        &self.near[beam][way]
    }

    /// How one beam meets another on a way; `None` where they are not near each other.
    pub fn obstacle(&self, beam: usize, way: usize, other: usize) -> Option<&Obstacle> {
        let near = &self.near[beam][way];
        near.binary_search_by_key(&other, |(other, _)| *other).ok().map(|index| &near[index].1)
    }

    /// Which beams block a way of a beam, each by itself.
    pub fn blocked(&self, beam: usize, way: usize) -> impl Iterator<Item = usize> + '_ {
        self.near[beam][way].iter().filter(|(_, obstacle)| obstacle.blocks()).map(|(other, _)| *other)
    }

    /// Pairs of beams that block a way of a beam only together: one makes the path longer, and the other one stands
    /// further out.
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

    /// The length of the straight motion with which a beam gets to its place while others stand, m; `None` when something
    /// blocks this way.
    pub fn distance(&self, beam: usize, way: usize, stands: impl Fn(usize) -> bool) -> Option<f64> {
        let near = self.near[beam][way].iter().filter(|(other, _)| stands(*other)).map(|(_, it)| it);
        if near.clone().any(|obstacle| obstacle.handless) {
            return None;
        }
        clear_distance(near.map(|obstacle| &obstacle.meeting))
    }
}

/// Is a link long enough for a hand?
pub fn usable(link: &Link) -> bool {
    link.grasp[1] - link.grasp[0] - 2.0 * FINGER >= ROOM
}

/// Where the fingers close on a link, from j1, m.
pub fn middle(link: &Link) -> f64 {
    0.5 * (link.grasp[0] + link.grasp[1])
}

/// Must every link of a beam go through a joint of the other one on this way?
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

/// The directions that are tried: a beam at an angle along its own axis first, any other towards the clamped beam.
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
