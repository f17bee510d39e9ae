//! An order of straight insertions: the best one of a small assembly, a good one of a large one.

use super::solids::Solids;
use crate::assembly::{Connection, Insertion, PlacedBeam};
use crate::block::LEAST_DISTANCE;
use crate::sweep::{Meeting, clear_distance};
use nalgebra::{Unit, Vector3};
use std::collections::HashMap;

/// The most beams in one goal.
pub const MAX_BEAMS: usize = 128;
/// Up to so many beams the best of all orders is found, for which every subset of them may have to be looked at;
/// with more, one good order.
const MAX_EXACT: usize = 16;

/// A set of beams, one bit each.
type Set = u128;

/// The set of this beam alone.
fn bit(beam: usize) -> Set {
    1 << beam
}

/// There is no order: none of these beams can be taken out while the others stand. With no beams: there are more
/// than [`MAX_BEAMS`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stuck {
    pub beams: Vec<usize>,
}

/// From above.
const DOWN: Vector3<f64> = Vector3::new(0.0, 0.0, -1.0);

/// The directions of motion that are tried, the usual ones first: a beam at an angle along its own axis, any other
/// towards the clamped beam, then along it.
fn directions(placed: &PlacedBeam) -> Vec<Unit<Vector3<f64>>> {
    let axis = placed.x_ab.rotation * Vector3::x();
    let along = Vector3::new(axis.x, axis.y, 0.0);
    let square = [[0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vector3::from);
    let own = [-along, along];
    let mut candidates = if placed.is_square() { [&square[..], &own] } else { [&own[..], &square] }.concat();
    candidates.push(DOWN);
    let candidates = candidates.into_iter().map(Unit::new_normalize);
    let mut kept: Vec<Unit<Vector3<f64>>> = Vec::new();
    for direction in candidates {
        if kept.iter().all(|other| other.dot(&direction) < 1.0 - 1e-9) {
            kept.push(direction);
        }
    }
    kept
}

/// What an insertion costs beyond the plain case; the order with the least total is taken.
mod cost {
    /// A beam that nothing holds yet, laid down at its place (or, failing that, pushed there): the next one may
    /// push it away.
    pub const LAID: u32 = 10;
    /// A beam that comes down onto others from above.
    pub const FROM_ABOVE: u32 = 5;
    /// A female threaded over the long free end of a standing beam, which droops by up to 3 mm.
    pub const THREADED: u32 = 20;
}

/// Finds an order of straight insertions, each of which meets nothing that stands already.
pub(crate) fn find_order(
    beams: &[PlacedBeam],
    base: usize,
    connections: &[Connection],
) -> Result<Vec<Insertion>, Stuck> {
    if beams.len() > MAX_BEAMS {
        return Err(Stuck { beams: Vec::new() });
    }
    let solids = Solids::new(beams);
    let directions: Vec<_> = beams.iter().map(directions).collect();
    let ways = (0..beams.len())
        .map(|moving| {
            let to = |direction: &Unit<Vector3<f64>>| {
                let back = -direction.into_inner();
                let way = |standing: usize| {
                    if standing == moving {
                        Meeting::default()
                    } else {
                        solids.all()[moving].meeting(&solids.all()[standing], &back)
                    }
                };
                (0..beams.len()).map(way).collect()
            };
            directions[moving].iter().map(to).collect()
        })
        .collect();
    let square = beams.iter().map(PlacedBeam::is_square).collect();
    let mut order = Order { count: beams.len(), square, connections, directions, ways, best: HashMap::new() };
    let all: Set = (0..beams.len()).fold(0, |set, beam| set | bit(beam));
    if beams.len() > MAX_EXACT {
        return order.taken_apart(beams, base, all);
    }
    let stuck = order.stuck(base, all);
    if !stuck.is_empty() {
        return Err(Stuck { beams: stuck });
    }
    let mut standing: Set = bit(base);
    let mut insertions = Vec::new();
    // What can be taken apart one by one can be built one by one, so the search does not fail.
    while let Some((_, insertion)) = order.best_next(standing, all) {
        standing |= bit(insertion.beam);
        insertions.push(insertion);
    }
    Ok(insertions)
}

struct Order<'a> {
    count: usize,
    /// For each beam: does it lie along X or Y?
    square: Vec<bool>,
    connections: &'a [Connection],
    /// For each beam.
    directions: Vec<Vec<Unit<Vector3<f64>>>>,
    /// For each beam, each of its directions, each other beam.
    ways: Vec<Vec<Vec<Meeting>>>,
    /// For each set of standing beams, the least cost to build the rest and the first step; `None` when it cannot
    /// be built.
    best: HashMap<Set, Option<(u32, Insertion)>>,
}

impl Order<'_> {
    /// As deep as there are beams at most; every set is looked at once.
    fn best_next(&mut self, standing: Set, all: Set) -> Option<(u32, Insertion)> {
        if let Some(known) = self.best.get(&standing) {
            return known.clone();
        }
        let mut candidates: Vec<usize> = (0..self.count).filter(|&beam| standing & bit(beam) == 0).collect();
        // Beams that go into others before those that close over others (caps), square ones before those at an
        // angle, which rely on them; then as in the file.
        candidates.sort_by_key(|&beam| {
            (self.swallowed(beam, standing).count(), !self.square[beam], self.first_connection(beam))
        });
        let mut best: Option<(u32, Insertion)> = None;
        for beam in candidates {
            let Some((cost, insertion)) = self.insertion(beam, standing) else { continue };
            let after = standing | bit(beam);
            let rest = if after == all { Some(0) } else { self.best_next(after, all).map(|(cost, _)| cost) };
            let Some(total) = rest.map(|rest| rest + cost) else { continue };
            if best.as_ref().is_none_or(|(least, _)| total < *least) {
                best = Some((total, insertion));
            }
            if total == 0 {
                break;
            }
        }
        self.best.insert(standing, best.clone());
        best
    }

    /// The standing beams whose males the females of `beam` would close over.
    fn swallowed(&self, beam: usize, standing: Set) -> impl Iterator<Item = usize> + '_ {
        let ours = move |c: &&Connection| c.female.beam == beam && standing & bit(c.male.beam) != 0;
        self.connections.iter().filter(ours).map(|c| c.male.beam)
    }

    fn first_connection(&self, beam: usize) -> Option<usize> {
        self.connections.iter().position(|c| c.female.beam == beam || c.male.beam == beam)
    }

    /// The cheapest insertion path for a beam past those that stand.
    fn insertion(&self, beam: usize, standing: Set) -> Option<(u32, Insertion)> {
        let connected = self.connections.iter().any(|c| {
            (c.female.beam == beam && standing & bit(c.male.beam) != 0)
                || (c.male.beam == beam && standing & bit(c.female.beam) != 0)
        });
        let mut best: Option<(u32, Insertion)> = None;
        // Down comes last in the list, and first for a beam that nothing guides.
        let count = self.directions[beam].len();
        let first = if connected { 0 } else { count - 1 };
        for index in (0..count).map(|index| (index + first) % count) {
            let direction = &self.directions[beam][index];
            let vertical = direction.z != 0.0;
            let Some(distance) = self.clear_distance(beam, index, standing) else { continue };
            let threaded = self.swallowed(beam, standing).any(|male| {
                self.ways[beam][index][male].covers.first().is_some_and(|cover| cover[1] > LEAST_DISTANCE)
            });
            let cost = match (connected, vertical) {
                (false, _) => cost::LAID,
                (true, true) => cost::FROM_ABOVE,
                (true, false) if threaded => cost::THREADED,
                (true, false) => 0,
            };
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, Insertion { beam, direction: *direction, distance }));
            }
            if cost == 0 {
                break;
            }
        }
        best
    }

    /// The length of the insertion path, m; `None` when there is no clear one.
    fn clear_distance(&self, beam: usize, direction: usize, standing: Set) -> Option<f64> {
        let others = (0..self.count).filter(|&other| standing & bit(other) != 0);
        clear_distance(others.map(|other| &self.ways[beam][direction][other]))
    }

    /// The beams that are joined with the base through others of the set.
    fn joined(&self, base: usize, set: Set) -> Set {
        let mut joined = bit(base);
        loop {
            let before = joined;
            for c in self.connections {
                let both = bit(c.female.beam) | bit(c.male.beam);
                if both & set == both && both & joined != 0 {
                    joined |= both;
                }
            }
            if joined == before {
                return joined;
            }
        }
    }

    /// An order found backwards: the whole is taken apart, each time by the beam that would be put there last at
    /// the least cost and leaves the others joined with the base. Taking one out never holds another one back, so
    /// this finds an order whenever there is one.
    fn taken_apart(&self, beams: &[PlacedBeam], base: usize, all: Set) -> Result<Vec<Insertion>, Stuck> {
        // How far out along its insertion path a beam reaches, m.
        let reach = |insertion: &Insertion| {
            let placed = &beams[insertion.beam];
            let out = |index| -(placed.x_ab * placed.beam.p_b_hole(index)).coords.dot(&insertion.direction);
            (0..placed.beam.joints.len()).map(out).fold(f64::NEG_INFINITY, f64::max)
        };
        let mut standing = all;
        let mut insertions = Vec::new();
        while standing != bit(base) {
            let mut best: Option<((u32, usize, i64, usize), Insertion)> = None;
            for beam in (0..self.count).rev().filter(|&beam| beam != base && standing & bit(beam) != 0) {
                let without = standing & !bit(beam);
                let Some((cost, insertion)) = self.insertion(beam, without) else { continue };
                let lost = (without & !self.joined(base, without)).count_ones();
                // The usual directions; what lies furthest out last, and of that what closes over others.
                let same = |direction: &Unit<Vector3<f64>>| *direction == insertion.direction;
                let way = self.directions[beam].iter().position(same).unwrap_or(usize::MAX);
                let others = self.count - self.swallowed(beam, without).count();
                // Whole millimetres, so that holes that meet are equally far out.
                let nearness = (-reach(&insertion) * 1e3).round() as i64;
                let rank = (cost + lost * cost::LAID, way, nearness, others);
                if best.as_ref().is_none_or(|(least, _)| rank < *least) {
                    best = Some((rank, insertion));
                }
            }
            let Some((_, insertion)) = best else {
                let beams = (0..self.count).filter(|&beam| beam != base && standing & bit(beam) != 0);
                return Err(Stuck { beams: beams.collect() });
            };
            standing &= !bit(insertion.beam);
            insertions.push(insertion);
        }
        insertions.reverse();
        Ok(insertions)
    }

    /// The beams that hold each other: take out of the whole whatever can be taken out, in any order, for taking
    /// one out never holds another one back.
    fn stuck(&self, base: usize, all: Set) -> Vec<usize> {
        let mut standing = all;
        let members = |set: Set| (0..self.count).filter(move |&beam| set & bit(beam) != 0 && beam != base);
        let free = |beam: usize, standing: Set| {
            let without = standing & !bit(beam);
            (0..self.directions[beam].len()).any(|index| self.clear_distance(beam, index, without).is_some())
        };
        while let Some(beam) = members(standing).find(|&beam| free(beam, standing)) {
            standing &= !bit(beam);
        }
        members(standing).collect()
    }
}
