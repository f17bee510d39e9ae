//! Parts that slide past each other on a straight line: the swept-box test.
//!
//! A [`Solid`] is a part at its place, as upright boxes. [`Solid::meeting`] says where one that is drawn out meets one
//! that stands, without steps in between. [`clear_distance`] turns the meetings with all that stands into the length of
//! an insertion path.

use crate::block::{ALL_AXES, Block, FROM_ABOVE, LEAST_DISTANCE, MARGIN, MOST_DISTANCE, TOUCH, merge};
use nalgebra::Vector3;
use ramp_kit::Pose;
use ramp_kit::shape::{Cuboid, Shape};

/// A part at its place, as upright boxes.
#[derive(Clone, Debug)]
pub struct Solid {
    blocks: Vec<Block>,
    /// A block around all of them.
    around: Block,
}

/// How a part that is drawn out meets one that stands: ranges of the distance gone, m.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Meeting {
    /// They collide.
    pub hits: Vec<[f64; 2]>,
    /// Seen from above, they cover each other. Empty where the motion is vertical: a part that comes down onto its
    /// place is clear as soon as it no longer touches.
    pub covers: Vec<[f64; 2]>,
}

impl Solid {
    /// The shapes of a part, which is at `x`.
    pub fn new(shapes: &[Shape], x: &Pose) -> Solid {
        let both = |a: Cuboid, b: Cuboid| Cuboid {
            min: std::array::from_fn(|axis| a.min[axis].min(b.min[axis])),
            max: std::array::from_fn(|axis| a.max[axis].max(b.max[axis])),
        };
        let bounds = shapes.iter().map(Shape::bounds).reduce(both);
        let bounds = bounds.unwrap_or(Cuboid::new([0.0; 2], [0.0; 2], [0.0; 2]));
        Solid {
            blocks: shapes.iter().map(|shape| Block::new(shape, x)).collect(),
            around: Block::new(&Shape::Solid(bounds), x),
        }
    }

    fn pairs<'s>(&'s self, other: &'s Solid) -> impl Iterator<Item = (&'s Block, &'s Block)> {
        self.blocks.iter().flat_map(move |a| other.blocks.iter().map(move |b| (a, b)))
    }

    /// Do they reach deeper into each other than `touch`, m?
    pub fn overlaps(&self, other: &Solid, touch: f64) -> bool {
        self.around.depth(&other.around) > touch && self.pairs(other).any(|(a, b)| a.depth(b) > touch)
    }

    /// How deep they reach into each other, m; `None` when it is no deeper than `touch`.
    pub fn overlap(&self, other: &Solid, touch: f64) -> Option<f64> {
        if self.around.depth(&other.around) <= touch {
            return None;
        }
        let depth = self.pairs(other).map(|(a, b)| a.depth(b)).fold(f64::NEG_INFINITY, f64::max);
        (depth > touch).then_some(depth)
    }

    /// The distance between them, m; 0 when they overlap.
    pub fn gap(&self, other: &Solid) -> f64 {
        self.pairs(other).map(|(a, b)| a.gap(b)).fold(f64::INFINITY, f64::min)
    }

    /// A distance that [`Solid::gap`] does not go below, m; faster.
    pub fn least_gap(&self, other: &Solid) -> f64 {
        self.around.gap(&other.around)
    }

    /// Could this one, drawn out along the unit vector `back`, come near the other? Never says no where it does.
    pub fn may_meet(&self, other: &Solid, back: &Vector3<f64>) -> bool {
        self.around.meets(&other.around, back, -MARGIN, FROM_ABOVE).is_some()
    }

    /// Where this one, drawn out along the unit vector `back`, reaches deeper than `slack` (m) into the other: ranges of
    /// the distance gone, m. `axes` is [`ALL_AXES`], or [`FROM_ABOVE`] to look from above.
    pub fn ranges(&self, other: &Solid, back: &Vector3<f64>, slack: f64, axes: usize) -> Vec<[f64; 2]> {
        // Most of their blocks are nowhere near the other part. What is around a part has other axes than its blocks: where
        // two blocks are apart by the slack along both axes of the plane, they may be by half as much more along another.
        let loose = 1.5 * slack.min(0.0);
        let near = self.blocks.iter().filter(|a| a.meets(&other.around, back, loose, axes).is_some());
        let theirs = other.blocks.iter().filter(|b| self.around.meets(b, back, loose, axes).is_some());
        let theirs: Vec<&Block> = theirs.collect();
        merge(near.flat_map(|a| theirs.iter().filter_map(|b| a.meets(b, back, slack, axes))).collect())
    }

    /// How this one, drawn out along the unit vector `back`, meets the other. They collide deeper than [`TOUCH`], and
    /// cover each other where they are nearer than [`MARGIN`].
    pub fn meeting(&self, other: &Solid, back: &Vector3<f64>) -> Meeting {
        // Most parts are nowhere near the insertion path.
        if !self.may_meet(other, back) {
            return Meeting::default();
        }
        let covers = if back.z == 0.0 { self.ranges(other, back, -MARGIN, FROM_ABOVE) } else { Vec::new() };
        Meeting { hits: self.ranges(other, back, TOUCH, ALL_AXES), covers }
    }
}

impl Meeting {
    /// Does the one that stands block the other, by itself?
    pub fn blocks(&self) -> bool {
        let distance = first_clear(self.covers.clone());
        self.hits.iter().any(|hit| hit[0] < distance)
    }
}

/// The length of the straight motion with which a part gets to its place past others, m: where it begins, the part
/// covers none of them, and on it the part meets none. `None` when there is no such motion.
pub fn clear_distance<'m>(meetings: impl Iterator<Item = &'m Meeting> + Clone) -> Option<f64> {
    let distance = first_clear(meetings.clone().flat_map(|meeting| meeting.covers.iter().copied()).collect());
    let free = meetings.flat_map(|meeting| &meeting.hits).all(|hit| hit[0] >= distance);
    (free && distance < MOST_DISTANCE).then_some(distance)
}

/// The first distance from [`LEAST_DISTANCE`] on that no range covers, m.
fn first_clear(covers: Vec<[f64; 2]>) -> f64 {
    merge(covers).into_iter().fold(LEAST_DISTANCE, |distance, cover| {
        if cover[0] <= distance && distance < cover[1] { cover[1] } else { distance }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(x: f64, y: f64) -> Solid {
        let half = [-10e-3, 10e-3];
        Solid::new(&[Shape::Solid(Cuboid::new(half, half, half))], &Pose::translation(x, y, 0.0))
    }

    #[test]
    fn a_part_beside_the_path_is_clear_and_one_on_it_is_not() {
        let (moving, back) = (cube(0.0, 0.0), Vector3::x());
        let [beside, ahead, behind] = [cube(0.0, 0.1), cube(0.04, 0.0), cube(-0.04, 0.0)];
        let meetings = [&beside, &behind].map(|other| moving.meeting(other, &back));
        assert_eq!(clear_distance(meetings.iter()), Some(LEAST_DISTANCE));
        let meeting = moving.meeting(&ahead, &back);
        assert!(meeting.blocks());
        assert_eq!(clear_distance([meeting].iter()), None);
    }

    #[test]
    fn a_part_that_is_covered_from_above_is_drawn_out_further() {
        let shelf = Cuboid::new([0.02, 0.12], [-0.05, 0.05], [0.05, 0.06]);
        let above = Solid::new(&[Shape::Solid(shelf)], &Pose::identity());
        let meeting = cube(0.0, 0.0).meeting(&above, &Vector3::x());
        assert!(meeting.hits.is_empty() && !meeting.blocks());
        let distance = clear_distance([meeting].iter()).unwrap();
        assert!((distance - (0.12 + 0.01 + MARGIN)).abs() < 1e-12, "{distance}");
    }
}
