//! Simulates a plan with the arm's model before anything moves, and reports what the arm or the hand cannot
//! do.
//!
//! Each skill rehearses itself: it outlines the motions that it will ask for, and the alternatives among
//! which it chooses ([`outline`]). A [`Rehearsal`] carries them out one after another in a [`scene`], with
//! the kinematics and the motion planner alone ([`walk`]). It begins with the parts where they are believed
//! to be. An action that is impossible becomes a [`MotionFact`](ramp_planner::MotionFact) for the planner
//! ([`blame`]). [`plan_with_motion`] plans and rehearses in turns until a plan passes.

pub mod blame;
pub mod outline;
pub mod planning;
pub mod scene;
pub mod search;
pub mod walk;

pub use outline::{Done, InHand, Leg, Motion, Outline, Stage};
pub use planning::{Quicker, Rehearsed, check_for_arm, plan_for_arm, plan_with_motion, quicker_for_arm};
pub use scene::Scene;
pub use search::{Rehearsal, Stuck, UnusualGrasp};
