//! Search over the free angle q7: the solution nearest to a posture, and the one of least cost.

use ramp_robot::DOF;

use super::{Analytic, Solution};
use crate::space::{Joints, Pose};

/// Distance between the values of q7 that [`Analytic::best`] tries first, rad. For 200 random poses the
/// quickest solution was missed by more than 1 ms 5 times with 0.05 rad, twice with 0.03 and once with 0.02;
/// windows of q7 that are narrower than the grid are lost.
const GRID: f64 = 0.03;
/// Local minima of the grid that are refined.
const REFINED: usize = 3;
/// Step of q7 at which refinement ends, rad: at 2 rad/s it is worth 0.05 ms.
const FINE: f64 = 1e-4;
/// Step of q7 in the finite differences of [`Analytic::nearest`], rad. Chosen.
const PROBE: f64 = 1e-4;
/// Its largest step of q7, rad.
const STEP: f64 = 0.3;
/// Its last step is shorter than this, rad: the remaining error is the square of it.
const NEAR: f64 = 1e-4;
/// Most steps; it takes two or three.
const TURNS: usize = 10;

/// The best solution over all q7 and branches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice<const N: usize = DOF> {
    /// The solution.
    pub solution: Solution<N>,
    /// Its cost.
    pub cost: f64,
}

impl<const N: usize> Analytic<N> {
    /// The solution with q7 as in `q` that is nearest to it (rad), every joint at least `margin` (rad) inside
    /// its range.
    pub fn beside(&self, x_wt: &Pose, q: &Joints<N>, margin: f64) -> Option<Joints<N>> {
        let apart = |other: &Joints<N>| (other - q).norm_squared();
        let all = self.within(x_wt, q[6], margin);
        all.iter().map(|solution| solution.q).min_by(|a, b| apart(a).total_cmp(&apart(b)))
    }

    /// Of the solutions on the branch of `seed`, the one nearest to `posture` (rad), every joint at least
    /// `margin` (rad) inside its range. Found from the solution beside `seed` by steps of Newton's method
    /// over q7; `None` when there is none there.
    pub fn nearest(
        &self,
        x_wt: &Pose,
        seed: &Joints<N>,
        posture: &Joints<N>,
        margin: f64,
    ) -> Option<Joints<N>> {
        let apart = |q: &Joints<N>| (q - posture).norm_squared();
        let turned = |q: &Joints<N>, by: f64| {
            let mut near = *q;
            near[6] += by;
            self.beside(x_wt, &near, margin)
        };
        let (low, high) = (self.low[6] + margin + PROBE, self.high[6] - margin - PROBE);
        let mut seed = *seed;
        seed[6] = seed[6].clamp(low, high);
        let mut q = self.beside(x_wt, &seed, margin)?;
        for _ in 0..TURNS {
            let (Some(before), Some(after)) = (turned(&q, -PROBE), turned(&q, PROBE)) else { break };
            let (a, here, b) = (apart(&before), apart(&q), apart(&after));
            let (slope, bend) = ((b - a) / (2.0 * PROBE), (a - 2.0 * here + b) / (PROBE * PROBE));
            let step = if bend > 0.0 { -slope / bend } else { -STEP * slope.signum() };
            let step = (q[6] + step.clamp(-STEP, STEP)).clamp(low, high) - q[6];
            let Some(next) = turned(&q, step) else { break };
            q = next;
            if step.abs() < NEAR {
                break;
            }
        }
        Some(q)
    }

    /// The solution of least `cost` over all q7 and branches, every joint at least `margin` (rad) inside its
    /// range; `None` when there is none, or none of finite cost. A cost of infinity refuses a solution.
    ///
    /// A grid over q7 comes first; then q7 is refined around the best places of the grid. What is found is a
    /// local minimum, in practice nearly always the least.
    pub fn best(
        &self,
        x_wt: &Pose,
        margin: f64,
        mut cost: impl FnMut(&Joints<N>) -> f64,
    ) -> Option<Choice<N>> {
        let (low, high) = (self.low.add_scalar(margin), self.high.add_scalar(-margin));
        let mut at = |q7: f64| {
            let mut best: Option<Choice<N>> = None;
            for solution in self.bounded(x_wt, q7, &low, &high).iter() {
                let cost = cost(&solution.q);
                if cost < best.map_or(f64::INFINITY, |best| best.cost) {
                    best = Some(Choice { solution: *solution, cost });
                }
            }
            best
        };
        let steps = ((high[6] - low[6]) / GRID).ceil().max(1.0);
        let step = (high[6] - low[6]) / steps;
        // Local minima of the grid, the best first.
        let mut minima: [Option<Choice<N>>; REFINED] = [None; REFINED];
        let value = |choice: &Option<Choice<N>>| choice.map_or(f64::INFINITY, |choice| choice.cost);
        let (mut before, mut here) = (None, at(low[6]));
        for index in 1..=steps as usize + 1 {
            let next =
                if index as f64 <= steps { at((low[6] + index as f64 * step).min(high[6])) } else { None };
            if value(&here) <= value(&before) && value(&here) < value(&next) {
                let place = minima.iter().position(|minimum| value(&here) < value(minimum));
                if let Some(place) = place {
                    minima[place..].rotate_right(1);
                    minima[place] = here;
                }
            }
            (before, here) = (here, next);
        }
        minima
            .into_iter()
            .flatten()
            .map(|mut best| {
                let mut step = step / 2.0;
                while step > FINE {
                    let q7 = best.solution.q[6];
                    let better =
                        [q7 - step, q7 + step].into_iter().filter_map(&mut at).find(|it| it.cost < best.cost);
                    match better {
                        Some(better) => best = better,
                        None => step /= 2.0,
                    }
                }
                best
            })
            .min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    /// The solution that the arm reaches first from `from` (rad), every joint at least `margin` (rad) inside
    /// its range. Its cost is [`Analytic::least_time`].
    pub fn quickest(&self, x_wt: &Pose, from: &Joints<N>, margin: f64) -> Option<Choice<N>> {
        self.best(x_wt, margin, |q| self.least_time(from, q))
    }

    /// A lower bound on the time from `from` to `to` (rad), s: every joint goes straight at its largest
    /// speed.
    pub fn least_time(&self, from: &Joints<N>, to: &Joints<N>) -> f64 {
        (to - from).component_div(&self.velocity).amax()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Translation3, UnitQuaternion, Vector3};
    use ramp_robot::random::Stream;

    use super::super::tests::{arm, error, uniform};
    use super::*;
    use crate::Kinematics;

    /// The iteration and the closed form come to rest in the same place: paths do not depend on which of them
    /// found them.
    #[test]
    fn the_nearest_solution_is_that_of_the_iteration() {
        let arm = arm("panda.json");
        let (kinematics, analytic) = (Kinematics::new(&arm), Analytic::new(&arm).unwrap());
        let mut stream = Stream::new(4, "nearest");
        let mut compared = 0;
        for _ in 0..200 {
            let mut draw = |most: f64| Joints::from(arm.home).map(|angle| angle + stream.symmetric(most));
            let (seed, posture) = (draw(0.2), draw(0.2));
            let x_wt = kinematics.tip(&draw(0.2));
            let Some(iterated) = kinematics.inverse(&x_wt, &seed, &posture) else { continue };
            let nearest = analytic.nearest(&x_wt, &iterated, &posture, 0.05).unwrap();
            assert!((nearest - iterated).amax() < 1e-4, "{nearest} {iterated}");
            let from_afar = analytic.nearest(&x_wt, &seed, &posture, 0.05).unwrap();
            assert!((from_afar - posture).norm() < (iterated - posture).norm() + 1e-6);
            compared += 1;
        }
        assert!(compared > 150, "{compared}");
    }

    /// Against a grid over q7 thirty times as fine: random poses, and the hand down over the table.
    #[test]
    fn the_quickest_solution_is_the_quickest() {
        let arm = arm("panda.json");
        let (kinematics, analytic) = (Kinematics::new(&arm), Analytic::new(&arm).unwrap());
        let mut stream = Stream::new(3, "quickest");
        let [low, high] = arm.joints[6].range;
        let (margin, steps) = (0.05, 5800);
        let mut missed = [0, 0];
        for round in 0..400 {
            let (from, x_wt) = if round % 2 == 0 {
                (uniform(&arm, &mut stream), kinematics.tip(&uniform(&arm, &mut stream)))
            } else {
                let down = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), stream.symmetric(3.0))
                    * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
                let (x, y) = (0.45 + stream.symmetric(0.15), stream.symmetric(0.4));
                let place = Translation3::new(x, y, 0.1 + stream.symmetric(0.1));
                (Joints::from(arm.home), Pose::from_parts(place, down))
            };
            let exhaustive = (0..=steps)
                .flat_map(|step| {
                    let q7 = low + (high - low) * f64::from(step) / f64::from(steps);
                    analytic.within(&x_wt, q7, margin).to_vec()
                })
                .map(|solution| analytic.least_time(&from, &solution.q))
                .fold(f64::INFINITY, f64::min);
            let Some(choice) = analytic.quickest(&x_wt, &from, margin) else {
                missed[round % 2] += usize::from(exhaustive.is_finite());
                continue;
            };
            assert!(error(&kinematics, &[choice.solution], &x_wt) < 1e-9);
            assert!(kinematics.range_margin(&choice.solution.q) >= margin - 1e-12);
            assert_eq!(choice.cost, analytic.least_time(&from, &choice.solution.q));
            missed[round % 2] += usize::from(choice.cost > exhaustive + 1e-3);
        }
        println!("{missed:?} missed");
        assert!(missed[0] <= 4 && missed[1] <= 2, "{missed:?}");
    }
}
