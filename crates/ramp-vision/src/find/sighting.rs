//! Findings in an image: parts with poses, and unexpected observations.

use crate::detect::Detection;
use nalgebra::Matrix6;
use ramp_robot::Pose;

/// A part that was seen, and where.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenPart {
    /// Its name in the kit; `sheet` for the sheet, whose frame is the world.
    pub part: String,
    /// Pose of its frame in the world, as far as the camera is where it is said to be.
    pub x_wp: Pose,
    /// Covariance of a small translation (m) and then rotation (rad) about the part's origin, axes of the
    /// world, from image noise. It does not include the error of the camera's calibration.
    pub covariance: Matrix6<f64>,
    /// The tags it was seen by.
    pub tags: Vec<u32>,
    /// Root of the mean square of how far edges are from where this pose has them, pixels.
    pub pixel_error: f64,
    /// Distance from the camera to the middle of its tags, m.
    pub distance: f64,
    /// Mean length of an edge of its tags in the image, pixels.
    pub tag_size: f64,
}

/// Something in an image that is not as it should be. None of it leads to a pose.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Oddity {
    /// A tag that no part of the kit carries.
    #[error("tag {id} belongs to no part of the kit")]
    UnknownTag {
        /// Its id.
        id: u32,
    },
    /// Two tags with one id: two parts carry the same one, or one was read wrongly.
    #[error("tag {id} of {part} is in the image {count} times")]
    SameTagTwice {
        /// The id.
        id: u32,
        /// The part that should carry it.
        part: String,
        /// Number of times.
        count: usize,
    },
    /// The tags of a part are not where they should be on one and the same part: one sticks on another part.
    #[error("tags {tags:?} cannot both be on {part}: {pixels:.1} pixels apart from where they should be")]
    TagsDisagree {
        /// The part.
        part: String,
        /// Its tags in the image.
        tags: Vec<u32>,
        /// Root of the mean square of the residuals, pixels.
        pixels: f64,
    },
    /// A single tag that could as well be tilted the other way.
    #[error("ambiguous tilt of {part}: two poses {degrees:.0} degrees apart")]
    Ambiguous {
        /// The part.
        part: String,
        /// Between the two.
        degrees: f64,
    },
    /// An implausible pose.
    #[error("implausible height of {part}: {height:.3} m")]
    Height {
        /// The part.
        part: String,
        /// m.
        height: f64,
    },
    /// Known to lie flat, but seen otherwise.
    #[error("{part} does not lie flat as expected")]
    NotLying {
        /// The part.
        part: String,
    },
    /// Edges of its tags that are hidden or not where they should be.
    #[error("{part} is partly hidden, or tag {id} on it is damaged")]
    Hidden {
        /// The part.
        part: String,
        /// The tag.
        id: u32,
    },
    /// Too small in the image to be trusted.
    #[error("{part} is too far away or seen too flatly: its tags are {pixels:.0} pixels wide")]
    Small {
        /// The part.
        part: String,
        /// The narrowest extent of a tag.
        pixels: f64,
    },
    /// A pose too uncertain to be of use.
    #[error("the position of {part} is too uncertain: {sigma:.4} m")]
    Vague {
        /// The part.
        part: String,
        /// Standard deviation of its tags' place in the worst direction, m.
        sigma: f64,
    },
}

/// Detections in one image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sighting {
    /// Robot time of the exposure, s.
    pub time: f64,
    /// Parts, in the order of the kit, beams before pegs.
    pub parts: Vec<SeenPart>,
    /// The sheet, when its own tag is in view. The pose of its frame is the identity if camera and sheet are
    /// in their nominal poses.
    pub sheet: Option<SeenPart>,
    /// All tags that were read, believed or not.
    pub detections: Vec<Detection>,
    /// Unexpected findings.
    pub oddities: Vec<Oddity>,
}

/// Name of the sheet among the parts.
pub const SHEET: &str = "sheet";
