//! Swept-box test: collisions of parts along a straight motion.
//!
//! A [`Solid`] is a placed part made of upright boxes. [`Solid::meeting`] computes in closed form
//! where a part being withdrawn meets a placed one. [`clear_distance`] turns the meetings with all
//! placed parts into the length of an insertion path.

use crate::block::{ALL_AXES, Block, FROM_ABOVE, LEAST_DISTANCE, MARGIN, MOST_DISTANCE, TOUCH, merge};
use nalgebra::Vector3;
use ramp_kit::Pose;
use ramp_kit::shape::{Cuboid, Shape};

/// A placed part, made of upright boxes.
#[derive(Clone, Debug)]
pub struct Solid {
    blocks: Vec<Block>,
    /// Bounding block of all of them.
    around: Block,
}

/// Collisions between a part being withdrawn and a placed one: ranges of the travelled distance, m.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Meeting {
    /// Ranges with a collision.
    pub hits: Vec<[f64; 2]>,
    /// Ranges in which they overlap seen from above. Empty for a vertical motion: a part that is
    /// lowered is clear as soon as it no longer touches.
    pub covers: Vec<[f64; 2]>,
}

impl Solid {
    /// The shapes of a part at pose `x`.
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

    /// Whether they penetrate deeper than `touch`, m.
    pub fn overlaps(&self, other: &Solid, touch: f64) -> bool {
        self.around.depth(&other.around) > touch && self.pairs(other).any(|(a, b)| a.depth(b) > touch)
    }

    /// Penetration, m; `None` when it is no deeper than `touch`.
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

    /// A lower bound of [`Solid::gap`], m; faster.
    pub fn least_gap(&self, other: &Solid) -> f64 {
        self.around.gap(&other.around)
    }

    /// Whether this part, withdrawn along the unit vector `back`, could come near the other.
    /// Conservative: never false when it does.
    pub fn may_meet(&self, other: &Solid, back: &Vector3<f64>) -> bool {
        self.around.meets(&other.around, back, -MARGIN, FROM_ABOVE).is_some()
    }

    /// The ranges of travelled distance, m, in which this part, withdrawn along the unit vector
    /// `back`, penetrates the other deeper than `slack` (m). `axes` is [`ALL_AXES`], or
    /// [`FROM_ABOVE`] for the view from above.
    pub fn ranges(&self, other: &Solid, back: &Vector3<f64>, slack: f64, axes: usize) -> Vec<[f64; 2]> {
        // Most blocks are far from the other part. The bounding block has other axes than the
        // blocks: two blocks separated by the slack along both axes of the plane may be half as
        // much further apart along another axis.
        let loose = 1.5 * slack.min(0.0);
        let near = self.blocks.iter().filter(|a| a.meets(&other.around, back, loose, axes).is_some());
        let theirs = other.blocks.iter().filter(|b| self.around.meets(b, back, loose, axes).is_some());
        let theirs: Vec<&Block> = theirs.collect();
        merge(near.flat_map(|a| theirs.iter().filter_map(|b| a.meets(b, back, slack, axes))).collect())
    }

    /// Collisions of this part, withdrawn along the unit vector `back`, with the other. They
    /// collide above a penetration of [`TOUCH`], and overlap from above when nearer than
    /// [`MARGIN`].
    pub fn meeting(&self, other: &Solid, back: &Vector3<f64>) -> Meeting {
        // Most parts are far from the insertion path.
        if !self.may_meet(other, back) {
            return Meeting::default();
        }
        let covers = if back.z == 0.0 { self.ranges(other, back, -MARGIN, FROM_ABOVE) } else { Vec::new() };
        Meeting { hits: self.ranges(other, back, TOUCH, ALL_AXES), covers }
    }
}

impl Meeting {
    /// Whether the placed part blocks the other on its own.
    pub fn blocks(&self) -> bool {
        let distance = first_clear(self.covers.clone());
        self.hits.iter().any(|hit| hit[0] < distance)
    }
}

/// Length of the straight motion that brings a part to its goal pose past others, m: at its start
/// the part overlaps none of them from above, and along it the part collides with none. `None` when
/// no such motion exists.
pub fn clear_distance<'m>(meetings: impl Iterator<Item = &'m Meeting> + Clone) -> Option<f64> {
    let distance = first_clear(meetings.clone().flat_map(|meeting| meeting.covers.iter().copied()).collect());
    let free = meetings.flat_map(|meeting| &meeting.hits).all(|hit| hit[0] >= distance);
    (free && distance < MOST_DISTANCE).then_some(distance)
}

/// The first distance from [`LEAST_DISTANCE`] on that no range contains, m.
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
