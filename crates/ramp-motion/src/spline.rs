//! A smooth curve through the samples of a joint path.

use crate::space::Joints;

/// A natural cubic spline through equally spaced knots: position, slope and bend are continuous.
#[derive(Clone, Debug)]
pub(crate) struct Spline<const N: usize> {
    knots: Vec<Joints<N>>,
    /// Second derivatives at the knots, by knot number.
    bends: Vec<Joints<N>>,
}

/// A point of a curve, with its derivatives by the knot number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point<const N: usize> {
    /// rad.
    pub position: Joints<N>,
    /// rad a knot.
    pub slope: Joints<N>,
    /// rad a knot².
    pub bend: Joints<N>,
}

impl<const N: usize> Spline<N> {
    /// The spline through `knots`, of which there are at least two.
    pub fn new(knots: &[Joints<N>]) -> Spline<N> {
        Spline { bends: bends(knots), knots: knots.to_vec() }
    }

    /// The number of the last knot: the curve runs from 0 to it.
    pub fn end(&self) -> f64 {
        (self.knots.len() - 1) as f64
    }

    /// The curve at a knot number, whole or between.
    pub fn at(&self, number: f64) -> Point<N> {
        let index = (number.max(0.0).floor() as usize).min(self.knots.len() - 2);
        let b = (number - index as f64).clamp(0.0, 1.0);
        let a = 1.0 - b;
        let (k, m) = (&self.knots[index..], &self.bends[index..]);
        Point {
            position: k[0] * a + k[1] * b + (m[0] * (a * a * a - a) + m[1] * (b * b * b - b)) / 6.0,
            slope: k[1] - k[0] + (m[0] * (1.0 - 3.0 * a * a) + m[1] * (3.0 * b * b - 1.0)) / 6.0,
            bend: m[0] * a + m[1] * b,
        }
    }
}

/// Second derivatives of the natural spline at its knots: its tridiagonal system, solved by elimination.
fn bends<const N: usize>(knots: &[Joints<N>]) -> Vec<Joints<N>> {
    let n = knots.len();
    let mut bends = vec![Joints::zeros(); n];
    if n < 3 {
        return bends;
    }
    let mut factor = vec![0.0; n];
    let mut right = vec![Joints::zeros(); n];
    for i in 1..n - 1 {
        let pivot = 4.0 - factor[i - 1];
        factor[i] = 1.0 / pivot;
        right[i] = ((knots[i + 1] - 2.0 * knots[i] + knots[i - 1]) * 6.0 - right[i - 1]) / pivot;
    }
    for i in (1..n - 1).rev() {
        bends[i] = right[i] - bends[i + 1] * factor[i];
    }
    bends
}
