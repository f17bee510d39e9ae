//! The fastest motion within limits of velocity, acceleration and jerk, found anew each period by Ruckig (the
//! crate `rsruckig`).

use nalgebra::{SVector, Vector6};
use ramp_robot::arm::{ArmModel, CartesianLimits};
use ramp_robot::{DOF, PERIOD};
use rsruckig::prelude::{InputParameter, OutputParameter, Ruckig, ThrowErrorHandler};

use crate::state::JointVector;

/// The share of the limits of joints that is used. Chosen: a tenth is left for the rounding of differences.
const SHARE: f64 = 0.9;
/// The share of the limits of the tip, on each of three axes: their sum must keep the limit.
const POSE_SHARE: f64 = 0.5;

/// Shares of the limits that are tried one after another: from rare states Ruckig finds no motion, though it
/// finds one with slightly other limits. Chosen: all are within the room that [`SHARE`] and [`POSE_SHARE`]
/// leave.
const TRIED_LIMITS: [f64; 5] = [1.0, 1.01, 0.99, 1.05, 0.95];

/// Position and motion on each axis, in the unit of the axis and s.
#[derive(Clone, Debug)]
pub(crate) struct Moving<const N: usize> {
    pub position: SVector<f64, N>,
    pub velocity: SVector<f64, N>,
    pub acceleration: SVector<f64, N>,
}

/// The largest velocity, acceleration and jerk on each axis.
pub(crate) type Limits<const N: usize> = [SVector<f64, N>; 3];

impl<const N: usize> Moving<N> {
    /// At `position`, with derivatives from differences of the last positions: their velocity is that of half
    /// a period ago.
    pub fn estimated(
        position: SVector<f64, N>,
        velocity: SVector<f64, N>,
        acceleration: SVector<f64, N>,
    ) -> Moving<N> {
        Moving { position, velocity: velocity + acceleration * (PERIOD / 2.0), acceleration }
    }
}

/// State one period later on the fastest motion to rest at `target`; `None` when there is none.
pub(crate) fn towards<const N: usize>(
    from: &Moving<N>,
    target: &SVector<f64, N>,
    limits: &Limits<N>,
) -> Option<Moving<N>> {
    let scaled = |share: f64| limits.map(|limit| limit * share);
    TRIED_LIMITS.into_iter().find_map(|share| quickest(from, target, &scaled(share)))
}

/// As [`towards`], with exactly these limits.
fn quickest<const N: usize>(
    from: &Moving<N>,
    target: &SVector<f64, N>,
    [velocity, acceleration, jerk]: &Limits<N>,
) -> Option<Moving<N>> {
    let mut ruckig = Ruckig::<N, ThrowErrorHandler>::new(None, PERIOD);
    let mut input = InputParameter::<N>::new(None);
    let mut output = OutputParameter::<N>::new(None);
    for axis in 0..N {
        input.current_position[axis] = from.position[axis];
        input.current_velocity[axis] = from.velocity[axis];
        input.current_acceleration[axis] = from.acceleration[axis];
        input.target_position[axis] = target[axis];
        input.max_velocity[axis] = velocity[axis];
        input.max_acceleration[axis] = acceleration[axis];
        input.max_jerk[axis] = jerk[axis];
    }
    ruckig.update(&input, &mut output).ok()?;
    let next = Moving::<N> {
        position: SVector::from_fn(|axis, _| output.new_position[axis]),
        velocity: SVector::from_fn(|axis, _| output.new_velocity[axis]),
        acceleration: SVector::from_fn(|axis, _| output.new_acceleration[axis]),
    };
    next.position.iter().all(|value| value.is_finite()).then_some(next)
}

/// The limits of joints (rad/s and so on) on the way from `positions` to `target`, rad.
pub(crate) fn joint_limits(arm: &ArmModel, positions: &JointVector, target: &JointVector) -> Limits<DOF> {
    let joint = |index: usize| &arm.joints[index];
    [
        JointVector::from_fn(|index, _| {
            let [backward, forward] = joint(index).velocity_at(positions[index]);
            SHARE * if target[index] < positions[index] { -backward } else { forward }
        }),
        JointVector::from_fn(|index, _| SHARE * joint(index).acceleration),
        JointVector::from_fn(|index, _| SHARE * joint(index).jerk),
    ]
}

/// The limits of the tip on six axes: of its point, then of its turn.
pub(crate) fn pose_limits(limits: &CartesianLimits) -> Limits<6> {
    [limits.velocity, limits.acceleration, limits.jerk]
        .map(|[point, turn]| Vector6::new(point, point, point, turn, turn, turn) * POSE_SHARE)
}
