//! Distance and duration of the arm's motion to some poses of the tip: the measure by which skills choose
//! among grasps, rotations and viewpoints.

use std::cmp::Ordering;

use ramp_motion::{Joints, PathPlanner, TimeLaw};

use crate::Pose;
use crate::parameters::motion::TravelParameters;

/// The effort to bring the tip to some poses, one after another.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// Least distance of the joints from the ends of their ranges at these poses, rad; negative when one is
    /// out of reach.
    pub margin: f64,
    /// Least time for all of it, straight in joint space, s.
    pub time: f64,
}

impl Way {
    /// The way of the tip from `q` (rad) to `stops`.
    pub fn along(stops: &[Pose], q: &Joints, planner: &PathPlanner, law: &TimeLaw) -> Way {
        let mut way = Way { margin: f64::INFINITY, time: 0.0 };
        let mut from = *q;
        for stop in stops {
            let Ok(to) = planner.solve(stop, &from) else { return Way { margin: -1.0, time: f64::INFINITY } };
            way.margin = way.margin.min(planner.kinematics.range_margin(&to));
            way.time += law.least_time(&from, &to);
            from = to;
        }
        way
    }

    /// Compares two ways; the greater is better. First comes a way that leaves the joints room. Then counts
    /// the distance from the ends of their ranges, up to the distance that is good enough, less the cost of
    /// the time.
    pub fn compare(&self, other: &Way, travel: &TravelParameters) -> Ordering {
        let has_room = |way: &Way| way.margin >= travel.least_margin;
        let score = |way: &Way| way.margin.min(travel.good_margin) - travel.time_cost * way.time;
        has_room(self).cmp(&has_room(other)).then(score(self).total_cmp(&score(other)))
    }
}
