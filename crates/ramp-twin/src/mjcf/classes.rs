//! Which shapes may meet which.
//!
//! Two shapes meet if one of them is of a kind that the other one [`Class::meets`]. Most of a frame's shapes
//! are seldom needed: only a stem notices that a plate has a hole, and only a finger that the edges of a head
//! are round. Those shapes are in bodies of their own, rigid pieces of the part, which the search for
//! contacts leaves out as a whole where nothing that meets them is near ([`pieces`](crate::pieces)).

/// The kinds, one bit each.
mod kind {
    /// The arm, with its hand and fingers.
    pub const ARM: u32 = 1;
    /// Beams and holders.
    pub const PART: u32 = 2;
    /// Shapes that meet the table.
    pub const LOW: u32 = 4;
    /// A link of the arm to other links.
    pub const LINK: u32 = 8;
    /// A peg's head.
    pub const HEAD: u32 = 16;
    /// A peg's stem.
    pub const STEM: u32 = 32;
}
use kind::{ARM, HEAD, LINK, LOW, PART, STEM};

/// A class of shapes.
#[derive(Clone, Copy)]
pub(super) struct Class {
    /// Its kinds.
    pub is: u32,
    /// The kinds that it meets.
    pub meets: u32,
}

/// The solid pieces of beams and holders.
pub(super) const SOLID: Class = Class { is: PART, meets: ARM | PART | HEAD | STEM };
/// The feet of a beam.
pub(super) const FEET: Class = Class { is: PART | LOW, meets: SOLID.meets };
/// The undersides of a beam, for the table alone.
pub(super) const REST: Class = Class { is: LOW, meets: 0 };
/// A plate of a joint without its hole.
pub(super) const PLATE: Class = Class { is: PART, meets: ARM | PART | HEAD };
/// The boxes around a hole.
pub(super) const HOLE: Class = Class { is: 0, meets: STEM };
/// A head as parts meet it: a box.
pub(super) const HEAD_BOX: Class = Class { is: LOW | HEAD, meets: HEAD | STEM };
/// A head as the hand meets it: with rounded edges.
pub(super) const HEAD_GRIP: Class = Class { is: 0, meets: ARM };
/// A stem with its cone.
pub(super) const STEM_ROD: Class = Class { is: LOW | STEM, meets: ARM | HEAD | STEM };
/// Links, hand and fingers.
pub(super) const OF_ARM: Class = Class { is: ARM | LINK, meets: LINK };
/// The table.
pub(super) const TABLE: Class = Class { is: 0, meets: ARM | LOW };

/// Whether a shape of these kinds belongs to the arm.
pub(crate) fn is_arm(contype: i32) -> bool {
    contype & ARM as i32 != 0
}

impl std::fmt::Display for Class {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, r#"contype="{}" conaffinity="{}""#, self.is, self.meets)
    }
}
