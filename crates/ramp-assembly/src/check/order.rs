//! An order of straight insertions: the best one of a small assembly, a good one of a large one.

use super::set::{MAX_BEAMS, Set};
use crate::block::LEAST_DISTANCE;
use crate::paths::Paths;
use crate::placed::{Connection, Insertion, PlacedBeam};
use std::collections::HashMap;

/// Up to so many beams the best of all orders is found, for which every subset of them may have to be looked at;
/// with more, one good order.
const MAX_EXACT: usize = 16;

/// There is no order: none of these beams can be taken out while the others stand. With no beams: there are more
/// than [`MAX_BEAMS`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stuck {
    pub beams: Vec<usize>,
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
    // What can be taken apart one by one can be built one by one, so the search does not fail.
    while let Some((_, insertion)) = order.best_next(standing, all) {
        standing = standing.with(insertion.beam);
        insertions.push(insertion);
    }
    Ok(insertions)
}

struct Order<'a> {
    count: usize,
    /// For each beam: does it lie along X or Y?
    square: Vec<bool>,
    connections: &'a [Connection],
    paths: &'a Paths,
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
        let mut candidates: Vec<usize> = (0..self.count).filter(|&beam| !standing.holds(beam)).collect();
        // Beams that go into others before those that close over others (caps), square ones before those at an
        // angle, which rely on them; then as in the file.
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

    /// The standing beams whose males the females of `beam` would close over.
    fn swallowed(&self, beam: usize, standing: Set) -> impl Iterator<Item = usize> + '_ {
        let ours = move |c: &&Connection| c.female.beam == beam && standing.holds(c.male.beam);
        self.connections.iter().filter(ours).map(|c| c.male.beam)
    }

    fn first_connection(&self, beam: usize) -> Option<usize> {
        self.connections.iter().position(|c| c.female.beam == beam || c.male.beam == beam)
    }

    /// The cheapest insertion path for a beam past those that stand.
    fn insertion(&self, beam: usize, standing: Set) -> Option<(u32, Insertion)> {
        let connected = self.connections.iter().any(|c| {
            (c.female.beam == beam && standing.holds(c.male.beam))
                || (c.male.beam == beam && standing.holds(c.female.beam))
        });
        let mut best: Option<(u32, Insertion)> = None;
        // Down comes last in the list, and first for a beam that nothing guides.
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

    /// The beams that are joined with the base through others of the set.
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
        while standing != Set::default().with(base) {
            let mut best: Option<((u32, usize, i64, usize), Insertion)> = None;
            for beam in (0..self.count).rev().filter(|&beam| beam != base && standing.holds(beam)) {
                let without = standing.without(beam);
                let Some((cost, insertion)) = self.insertion(beam, without) else { continue };
                let lost = without.beyond(&self.joined(base, without));
                // The usual directions; what lies furthest out last, and of that what closes over others.
                let mut ways = self.paths.ways(beam).iter();
                let way = ways.position(|way| way.direction == insertion.direction).unwrap_or(usize::MAX);
                let others = self.count - self.swallowed(beam, without).count();
                // Whole millimetres, so that holes that meet are equally far out.
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

    /// The beams that hold each other: take out of the whole whatever can be taken out, in any order, for taking
    /// one out never holds another one back.
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
