//! The model that a client of version 5 downloads from the arm.

use franka::model::{Frame, Model};
use franka::{RealtimeConfig, Robot as Client, RobotState};
use nalgebra::{Matrix4, SMatrix, SVector};
use ramp_control::StateModel;
use ramp_franka_model as _;
use ramp_robot::random::Stream;
use ramp_robot::{GRAVITY, Track};
use ramp_served_twin::{FciVersion, Pace};

use crate::served::{Served, goal_for, ideal};

type Jacobian = SMatrix<f64, 6, 7>;
type Joints = SVector<f64, 7>;

/// How far numbers of two models may be apart, in their own units: rounding.
const ROUNDING: f64 = 1e-9;

fn zero_jacobian(model: &Model, frame: Frame, state: &RobotState) -> Jacobian {
    Jacobian::from_column_slice(&model.zero_jacobian(frame, state))
}

/// A client's model equals the controller's: pose, Jacobian, inertia and gravity. Loads count as bodies on
/// the flange, and the other frames move as their Jacobians say.
#[test]
fn a_downloaded_model_is_the_controllers() {
    let version = FciVersion::V5;
    let served = Served::new(version, ideal(), Track::State, Pace::LockStep);
    let robot = Client::new(&served.address.to_string(), RealtimeConfig::Ignore).unwrap();
    let model = robot.load_model_from_robot().unwrap();
    let seen = robot.read_once().unwrap();
    let own = StateModel::new(&goal_for(version, "easy-1").arm, Joints::zeros());
    let mut stream = Stream::new(1, "model");
    for _ in 0..50 {
        let q = Joints::from(seen.q) + Joints::from_fn(|_, _| stream.symmetric(0.5));
        let dq = Joints::from_fn(|_, _| stream.symmetric(1.0));
        let state = RobotState { q: q.into(), dq: dq.into(), ..seen };
        let same = own.state(&q, &dq);
        let pose = Matrix4::from_column_slice(&model.pose(Frame::EndEffector, &state));
        assert!((pose - same.x_wt.to_homogeneous()).amax() < ROUNDING);
        let jacobian = zero_jacobian(&model, Frame::EndEffector, &state);
        assert!((jacobian - same.jacobian).amax() < ROUNDING);
        let inertia = SMatrix::<f64, 7, 7>::from_column_slice(&model.mass(&state));
        assert!((inertia - same.inertia).amax() < ROUNDING, "{inertia} {}", same.inertia);
        let gravity = Joints::from(model.gravity(&state));
        assert!((gravity - own.weight(&q)).amax() < ROUNDING);
        loads_count(&model, &state);
        frames_move_as_their_jacobians_say(&model, &state);
        coriolis_torques_do_the_work_of_a_changing_inertia(&model, &state);
    }
}

/// A load on the flange needs the torques of the transposed Jacobian of its centre, against any gravity.
fn loads_count(model: &Model, state: &RobotState) {
    let (mass, centre) = (1.3, [0.03, -0.02, 0.15]);
    let mut at = *state;
    at.F_T_EE = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., centre[0], centre[1], centre[2], 1.];
    let jacobian = zero_jacobian(model, Frame::EndEffector, &at);
    for earth in [[0.0, 0.0, -GRAVITY], [3.0, -5.0, 7.0]] {
        let loaded = Joints::from(model.gravity_q(&state.q, mass, &centre, &earth));
        let bare = Joints::from(model.gravity_q(&state.q, 0.0, &[0.0; 3], &earth));
        let weight = jacobian.fixed_rows::<3>(0).transpose() * SVector::<f64, 3>::from(earth) * -mass;
        assert!((loaded - bare - weight).amax() < ROUNDING, "{loaded} {bare} {weight}");
    }
}

fn frames_move_as_their_jacobians_say(model: &Model, state: &RobotState) {
    let step = 1e-6;
    let frames = [
        Frame::Joint1,
        Frame::Joint2,
        Frame::Joint3,
        Frame::Joint4,
        Frame::Joint5,
        Frame::Joint6,
        Frame::Joint7,
        Frame::Flange,
        Frame::EndEffector,
    ];
    for frame in frames {
        let at = |share: f64| {
            let q = Joints::from(state.q) + Joints::from(state.dq) * share;
            let moved = RobotState { q: q.into(), ..*state };
            Matrix4::from_column_slice(&model.pose(frame, &moved))
        };
        let rate = (at(step) - at(-step)) / (2.0 * step);
        let turn = at(0.0).fixed_view::<3, 3>(0, 0).into_owned();
        let spin = rate.fixed_view::<3, 3>(0, 0) * turn.transpose();
        let motion = zero_jacobian(model, frame, state) * Joints::from(state.dq);
        let expected = [rate[(0, 3)], rate[(1, 3)], rate[(2, 3)], spin[(2, 1)], spin[(0, 2)], spin[(1, 0)]];
        assert!((motion - SVector::<f64, 6>::from(expected)).amax() < 1e-6, "{frame:?}");
        let own = Jacobian::from_column_slice(&model.body_jacobian(frame, state)) * Joints::from(state.dq);
        for rows in [0, 3] {
            let back = turn * own.fixed_rows::<3>(rows) - motion.fixed_rows::<3>(rows);
            assert!(back.amax() < ROUNDING, "{frame:?}");
        }
    }
}

/// Without acceleration, the power of the Coriolis torques is the rate of the kinetic energy.
fn coriolis_torques_do_the_work_of_a_changing_inertia(model: &Model, state: &RobotState) {
    let (step, dq) = (1e-5, Joints::from(state.dq));
    let energy = |share: f64| {
        let q = Joints::from(state.q) + dq * share;
        let mass = model.mass(&RobotState { q: q.into(), ..*state });
        dq.dot(&(SMatrix::<f64, 7, 7>::from_column_slice(&mass) * dq)) / 2.0
    };
    let rate = (energy(step) - energy(-step)) / (2.0 * step);
    assert!((dq.dot(&Joints::from(model.coriolis(state))) - rate).abs() < 1e-6);
}
