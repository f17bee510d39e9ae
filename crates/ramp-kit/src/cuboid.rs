//! Boxes along the axes of a frame.

/// An axis-parallel box, metres, in the frame of its part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    /// The corner with the smallest coordinates.
    pub min: [f64; 3],
    /// The corner with the largest coordinates.
    pub max: [f64; 3],
}

impl Cuboid {
    /// A box from the ranges of its three coordinates, m; each range in either order.
    pub fn new(x: [f64; 2], y: [f64; 2], z: [f64; 2]) -> Cuboid {
        let low = |r: [f64; 2]| r[0].min(r[1]);
        let high = |r: [f64; 2]| r[0].max(r[1]);
        Cuboid { min: [low(x), low(y), low(z)], max: [high(x), high(y), high(z)] }
    }

    /// Its centre, m.
    pub fn centre(&self) -> [f64; 3] {
        std::array::from_fn(|axis| 0.5 * (self.min[axis] + self.max[axis]))
    }

    /// Half its edges, m.
    pub fn half(&self) -> [f64; 3] {
        std::array::from_fn(|axis| 0.5 * (self.max[axis] - self.min[axis]))
    }
}
