//! A rehearsed action as data: the motions that its skill will ask for, and the alternatives among them.

use ramp_motion::Joints;

use crate::Pose;
use crate::grasp::{BeamGrasp, Grasp};

/// The stages of a motion that brings a part to its place. The refusal of a later stage says more about a
/// plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// To the part, around it, and up again.
    Grasp,
    /// A pose on the way to the place that the arm does not reach.
    Reach,
    /// With the part to where its insertion begins.
    Approach,
    /// The insertion, in contact.
    Insertion,
}

/// A motion of the arm or the fingers. Poses of the tip are in the world.
#[derive(Clone, Debug)]
pub enum Motion {
    /// Through free space, around everything but the held part. After [`Stage::Grasp`] the hand stays level.
    Travel {
        /// The pose of the tip at its end.
        x_wt: Pose,
        /// Distance of the fingers, m.
        open: f64,
        /// Its stage.
        stage: Stage,
    },
    /// In a straight line. Arm and hand touch nothing on it but the held part and one other.
    Straight {
        /// The pose of the tip at its end.
        x_wt: Pose,
        /// Distance of the fingers, m.
        open: f64,
        /// The part that they may touch, by name.
        around: Option<String>,
        /// Its stage: at [`Stage::Insertion`] no margin is kept.
        stage: Stage,
        /// The beginning of the reason if something is in the way, such as `the fingers would touch`.
        would_touch: &'static str,
    },
    /// In contact over a distance, m. Arm and hand stay where they are: the motion is short.
    Contact(f64),
    /// The fingers open or close by a distance, m, with the tip at rest.
    Fingers(f64),
    /// The hand holds a part from now on.
    Hold(InHand),
    /// Straight up to travelling height, around nothing.
    Retreat,
}

/// A part in the hand.
#[derive(Clone, Debug)]
pub struct InHand {
    /// Its name.
    pub part: String,
    /// Its frame in the tip's frame.
    pub x_tp: Pose,
    /// The grasp, for a beam.
    pub grasp: Option<BeamGrasp>,
}

impl InHand {
    /// The part at `x_wp` (world), held in a grasp.
    pub fn by(part: &str, x_wp: &Pose, grasp: &Grasp) -> InHand {
        InHand { part: part.to_string(), x_tp: grasp.x_wt.inverse() * x_wp, grasp: grasp.beam }
    }
}

/// The rehearsal of one action.
#[derive(Clone, Debug)]
pub enum Outline {
    /// The skill cannot say. The action counts as possible.
    Unknown,
    /// Series of motions, each of which carries the action out; the preferred one first.
    Alternatives(Vec<Vec<Motion>>),
}

impl Outline {
    /// An action without a motion of its own: the skill that follows moves.
    pub fn nothing() -> Outline {
        Outline::one(Vec::new())
    }

    /// The same with a motion more at the end of every series.
    #[must_use]
    pub fn then(self, motion: &Motion) -> Outline {
        let Outline::Alternatives(mut alternatives) = self else { return Outline::Unknown };
        for motions in &mut alternatives {
            motions.push(motion.clone());
        }
        Outline::Alternatives(alternatives)
    }

    /// One way to carry the action out.
    pub fn one(motions: Vec<Motion>) -> Outline {
        Outline::Alternatives(vec![motions])
    }
}

/// A motion that was carried out in a rehearsal.
#[derive(Clone, Debug)]
pub enum Done {
    /// A motion through free space, straight or not, s.
    Free(f64),
    /// A straight motion in contact, m.
    Contact(f64),
    /// The fingers open or close by a distance, m, with the tip at rest at a pose in the world.
    Fingers(Pose, f64),
}

/// A motion through free space that a plan asks for.
#[derive(Clone, Debug)]
pub struct Leg {
    /// Joint positions at its start, rad.
    pub q: Joints,
    /// Pose of the tip at its end, in the world.
    pub x_wt: Pose,
    /// The hand stays level on the way.
    pub level: bool,
    /// Distance of the fingers, m.
    pub open: f64,
    /// Boxes of the held part, in the tip's frame.
    pub held: Vec<ramp_motion::Obstacle>,
    /// Boxes of everything else, in the world.
    pub around: Vec<ramp_motion::Obstacle>,
}

/// The reason why a motion does not exist.
#[derive(Clone, Debug)]
pub struct Refusal {
    /// In a few words, such as `the arm would touch b3`.
    pub because: String,
    /// The part in the way, by name.
    pub touched: Option<String>,
    /// The stage of the motion.
    pub stage: Stage,
}
