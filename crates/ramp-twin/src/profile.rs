//! Time that the engine spends in its stages, and the situation that a period was in: for benchmarks, never
//! for a result.

use std::sync::{Arc, OnceLock};
use std::time::Instant;

use mujoco_rs::mujoco_c::mjcb_time;
use mujoco_rs::prelude::*;

use crate::scene::Scene;
use crate::twin::Twin;

/// Time in the stages of the engine's steps, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StageTimes {
    /// Whole steps.
    pub step: f64,
    /// Poses and inertia.
    pub kinematics: f64,
    /// Selection of pairs of bodies that may touch.
    pub broad: f64,
    /// Trees of shapes, and contacts of pairs of shapes.
    pub narrow: f64,
    /// Rows of the constraints.
    pub constraints: f64,
    /// The solver of the constraints.
    pub solver: f64,
}

/// Lets the engine measure its stages in this process from now on.
pub fn measure_stages() {
    #[expect(unsafe_code, reason = "the engine's clock is a variable of the engine")]
    // SAFETY: nothing else in this process sets the variable, and a write of a function pointer is whole.
    unsafe {
        mjcb_time = Some(now);
    }
}

/// Seconds since the first call, in the unit of the engine's timers.
extern "C" fn now() -> f64 {
    static BEGIN: OnceLock<Instant> = OnceLock::new();
    BEGIN.get_or_init(Instant::now).elapsed().as_secs_f64()
}

/// The situation of a period, from what the hand holds and what is awake.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Situation {
    /// All parts sleep.
    ArmAlone,
    /// The fingers hold nothing, and parts are awake.
    NothingHeld,
    /// They hold a part that touches nothing; all others sleep.
    HeldFree,
    /// They hold a part that touches the table, a holder or the clamped beam; all others sleep.
    HeldOnFixed,
    /// They hold a part that touches nothing, and others are awake.
    HeldFreeFrameAwake,
    /// They hold a beam in contact, and others are awake.
    BeamInContact,
    /// They hold a peg in contact, and others are awake.
    PegInContact,
}

impl Situation {
    /// All of them.
    pub const ALL: [Situation; 7] = [
        Situation::ArmAlone,
        Situation::NothingHeld,
        Situation::HeldFree,
        Situation::HeldOnFixed,
        Situation::HeldFreeFrameAwake,
        Situation::BeamInContact,
        Situation::PegInContact,
    ];

    /// Description for a table.
    pub fn name(self) -> &'static str {
        match self {
            Situation::ArmAlone => "arm alone",
            Situation::NothingHeld => "nothing held, parts awake",
            Situation::HeldFree => "part held, touches nothing",
            Situation::HeldOnFixed => "part held, touches something fixed",
            Situation::HeldFreeFrameAwake => "part held, touches nothing, others awake",
            Situation::BeamInContact => "beam in contact, others awake",
            Situation::PegInContact => "peg in contact, others awake",
        }
    }
}

/// A period: its situation, and the size of the problem that the engine solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// The situation.
    pub situation: Situation,
    /// Contacts.
    pub contacts: usize,
    /// Rows of the constraints.
    pub rows: usize,
    /// Parts that are awake.
    pub awake: usize,
}

impl Twin {
    /// Time in the engine's stages so far; zero unless [`measure_stages`] was called before the first period.
    pub fn stage_times(&self) -> StageTimes {
        let timers = self.data.timer();
        let of = |timer: MjtTimer| timers[timer as usize].duration;
        StageTimes {
            step: of(MjtTimer::mjTIMER_STEP),
            kinematics: of(MjtTimer::mjTIMER_POS_KINEMATICS) + of(MjtTimer::mjTIMER_POS_INERTIA),
            broad: of(MjtTimer::mjTIMER_COL_BROAD),
            narrow: of(MjtTimer::mjTIMER_COL_NARROW),
            constraints: of(MjtTimer::mjTIMER_POS_MAKE) + of(MjtTimer::mjTIMER_POS_PROJECT),
            solver: of(MjtTimer::mjTIMER_CONSTRAINT),
        }
    }

    /// The last period.
    pub fn load(&self) -> Load {
        self.scene.load(&self.data)
    }
}

impl Scene {
    fn load(&self, data: &MjData<Arc<MjModel>>) -> Load {
        let of = |geom: i32| {
            let geom = usize::try_from(geom).ok()?;
            Some((self.model.geom_bodyid()[geom].max(0) as usize, self.part_of[geom]))
        };
        let pairs: Vec<_> =
            data.contact().iter().filter_map(|it| Some([of(it.geom[0])?, of(it.geom[1])?])).collect();
        let fingers = &self.hand_bodies[1..];
        let gripped = |[one, other]: &[(usize, Option<usize>); 2]| {
            let by = |finger: &(usize, Option<usize>), part: &(usize, Option<usize>)| {
                part.1.filter(|_| fingers.contains(&finger.0))
            };
            by(one, other).or(by(other, one))
        };
        let held = pairs.iter().find_map(gripped);
        let touches = |pair: &[(usize, Option<usize>); 2]| {
            pair.iter().any(|it| it.1.is_some() && it.1 == held) && gripped(pair).is_none()
        };
        let touches = pairs.iter().any(touches);
        let is_awake = |(_, body): &&(String, usize)| {
            self.model.body_dofnum()[*body] > 0 && data.body_awake()[*body] == MjtSleepState::mjS_AWAKE
        };
        let awake = self.parts.iter().filter(is_awake).count();
        let others = awake > usize::from(held.is_some());
        let is_peg = held.is_some_and(|held| self.in_holder.contains_key(&self.parts[held].0));
        let situation = match (held, touches, others) {
            (None, _, _) if awake == 0 => Situation::ArmAlone,
            (None, _, _) => Situation::NothingHeld,
            (Some(_), false, false) => Situation::HeldFree,
            (Some(_), true, false) => Situation::HeldOnFixed,
            (Some(_), false, true) => Situation::HeldFreeFrameAwake,
            (Some(_), true, true) if is_peg => Situation::PegInContact,
            (Some(_), true, true) => Situation::BeamInContact,
        };
        let rows = usize::try_from(data.ffi().nefc).unwrap_or(0);
        Load { situation, contacts: pairs.len(), rows, awake }
    }
}
