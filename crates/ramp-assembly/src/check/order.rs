//! An order of straight insertions: the optimum for a small assembly, a good one for a large one.

use super::set::{MAX_BEAMS, Set};
use crate::block::LEAST_DISTANCE;
use crate::paths::Paths;
use crate::placed::{Connection, Insertion, PlacedBeam};
use std::collections::HashMap;

/// Up to this number of beams the optimal order is searched, which may visit every subset of them;
/// with more beams, a greedy search finds one good order.
const MAX_EXACT: usize = 16;

/// No order exists: none of these beams can be removed while the others remain. Without beams:
/// there are more than [`MAX_BEAMS`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stuck {
    pub beams: Vec<usize>,
}

/// Extra costs of an insertion; the order with the smallest sum is chosen.
mod cost {
    /// A beam without support, laid down (or, failing that, pushed) at its goal pose: the next
    /// insertion may push it away.
    pub const LAID: u32 = 10;
    /// A beam lowered onto others from above.
    pub const FROM_ABOVE: u32 = 5;
    /// A female threaded over the long free end of a beam, which droops by up to 3 mm.
    pub const THREADED: u32 = 20;
}

/// Finds an order of straight insertions, each free of collisions with the beams already placed.
pub(crate) fn find_order(
    beams: &[PlacedBeam],
    base: usize,
    connections: &[Connection],
    paths: &Paths,
) -> Result<Vec<Insertion>, Stuck> {
    if beams.len() > MAX_BEAMS {
        return Err(Stuck { beams: Vec::new() });
    }
    let square = beams.iter().map(PlacedBeam::is_square).collect();
    let mut order = Order { count: beams.len(), square, connections, paths, best: HashMap::new() };
    let all = Set::first(beams.len());
    if beams.len() > MAX_EXACT {
        return order.taken_apart(beams, base, all);
    }
    let stuck = order.stuck(base, all);
    if !stuck.is_empty() {
        return Err(Stuck { beams: stuck });
    }
    let mut standing = Set::default().with(base);
    let mut insertions = Vec::new();
    // An assembly that can be taken apart one by one can be built one by one, so the search does
    // not fail.
    while let Some((_, insertion)) = order.best_next(standing, all) {
        standing = standing.with(insertion.beam);
        insertions.push(insertion);
    }
    Ok(insertions)
}

struct Order<'a> {
    count: usize,
    /// For each beam: whether it lies along X or Y.
    square: Vec<bool>,
    connections: &'a [Connection],
    paths: &'a Paths,
    /// For each set of placed beams, the least cost to build the rest, and the first step; `None`
    /// when the rest cannot be built.
    best: HashMap<Set, Option<(u32, Insertion)>>,
}

impl Order<'_> {
    /// The recursion is at most as deep as the number of beams; every set is visited once.
    fn best_next(&mut self, standing: Set, all: Set) -> Option<(u32, Insertion)> {
        if let Some(known) = self.best.get(&standing) {
            return known.clone();
        }
        let mut candidates: Vec<usize> = (0..self.count).filter(|&beam| !standing.holds(beam)).collect();
        // Beams that enter others before those that close over others (caps). Square ones before
        // oblique ones, which depend on them. Otherwise in the order of the file.
        candidates.sort_by_key(|&beam| {
            (self.swallowed(beam, standing).count(), !self.square[beam], self.first_connection(beam))
        });
        let mut best: Option<(u32, Insertion)> = None;
        for beam in candidates {
            let Some((cost, insertion)) = self.insertion(beam, standing) else { continue };
            let after = standing.with(beam);
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

    /// The placed beams whose males the females of `beam` would close over.
    fn swallowed(&self, beam: usize, standing: Set) -> impl Iterator<Item = usize> + '_ {
        let ours = move |c: &&Connection| c.female.beam == beam && standing.holds(c.male.beam);
        self.connections.iter().filter(ours).map(|c| c.male.beam)
    }

    fn first_connection(&self, beam: usize) -> Option<usize> {
        self.connections.iter().position(|c| c.female.beam == beam || c.male.beam == beam)
    }

    /// The cheapest insertion path of a beam past the placed ones.
    fn insertion(&self, beam: usize, standing: Set) -> Option<(u32, Insertion)> {
        let connected = self.connections.iter().any(|c| {
            (c.female.beam == beam && standing.holds(c.male.beam))
                || (c.male.beam == beam && standing.holds(c.female.beam))
        });
        let mut best: Option<(u32, Insertion)> = None;
        // The vertical path is last in the list, and the first choice for an unguided beam.
        let ways = self.paths.ways(beam);
        let count = ways.len();
        let first = if connected { 0 } else { count - 1 };
        for index in (0..count).map(|index| (index + first) % count) {
            let direction = &ways[index].direction;
            let vertical = direction.z != 0.0;
            let Some(distance) = self.paths.distance(beam, index, |other| standing.holds(other)) else {
                continue;
            };
            let threaded = self.swallowed(beam, standing).any(|male| {
                let covers = self.paths.obstacle(beam, index, male).and_then(|it| it.meeting.covers.first());
                covers.is_some_and(|cover| cover[1] > LEAST_DISTANCE)
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

    /// The beams connected with the base through others of the set.
    fn joined(&self, base: usize, set: Set) -> Set {
        let mut joined = Set::default().with(base);
        loop {
            let before = joined;
            for c in self.connections {
                let both = [c.female.beam, c.male.beam];
                if both.iter().all(|&beam| set.holds(beam)) && both.iter().any(|&beam| joined.holds(beam)) {
                    joined = joined.with(both[0]).with(both[1]);
                }
            }
            if joined == before {
                return joined;
            }
        }
    }

    /// An order found backwards: from the complete assembly, repeatedly remove the beam that would
    /// be inserted last at the least cost and leaves the others connected with the base. A removal
    /// never blocks another one, so this finds an order whenever one exists.
    fn taken_apart(&self, beams: &[PlacedBeam], base: usize, all: Set) -> Result<Vec<Insertion>, Stuck> {
        // Reach of a beam along its insertion path, m.
        let reach = |insertion: &Insertion| {
            let placed = &beams[insertion.beam];
            let out = |index| -(placed.x_ab * placed.beam.p_b_hole(index)).coords.dot(&insertion.direction);
            (0..placed.beam.joints.len()).map(out).fold(f64::NEG_INFINITY, f64::max)
        };
        let mut standing = all;
        let mut insertions = Vec::new();
        while standing != Set::default().with(base) {
            let mut best: Option<((u32, usize, i64, usize), Insertion)> = None;
            for beam in (0..self.count).rev().filter(|&beam| beam != base && standing.holds(beam)) {
                let without = standing.without(beam);
                let Some((cost, insertion)) = self.insertion(beam, without) else { continue };
                let lost = without.beyond(&self.joined(base, without));
                // The usual directions. The outermost beam comes last, and among those the one that
                // closes over others.
                let mut ways = self.paths.ways(beam).iter();
                let way = ways.position(|way| way.direction == insertion.direction).unwrap_or(usize::MAX);
                let others = self.count - self.swallowed(beam, without).count();
                // Rounded to millimetres, so that coincident holes have equal distances.
                let nearness = (-reach(&insertion) * 1e3).round() as i64;
                let rank = (cost + lost * cost::LAID, way, nearness, others);
                if best.as_ref().is_none_or(|(least, _)| rank < *least) {
                    best = Some((rank, insertion));
                }
            }
            let Some((_, insertion)) = best else {
                return Err(Stuck { beams: standing.without(base).beams().collect() });
            };
            standing = standing.without(insertion.beam);
            insertions.push(insertion);
        }
        insertions.reverse();
        Ok(insertions)
    }

    /// The beams that block each other: all that remain after every possible removal. The order
    /// does not matter, because a removal never blocks another one.
    fn stuck(&self, base: usize, all: Set) -> Vec<usize> {
        let mut standing = all;
        let free = |beam: usize, standing: Set| {
            let without = standing.without(beam);
            let ways = 0..self.paths.ways(beam).len();
            ways.into_iter().any(|way| self.paths.distance(beam, way, |other| without.holds(other)).is_some())
        };
        while let Some(beam) = standing.without(base).beams().find(|&beam| free(beam, standing)) {
            standing = standing.without(beam);
        }
        standing.without(base).beams().collect()
    }
}
