//! Parts without tags: found by comparing an image with a drawing of the scene that is believed.
//!
//! Data passes one way: [`solids`] turns the kit's solids and the hand into triangles; [`canvas`] draws all
//! believed bodies through a lens without distortion; [`contours`] takes the places where the drawn colour
//! steps and says to which part each belongs; [`marks`] keeps of each what the drawing shows across it;
//! [`profile`] measures how far from there the image has that step; [`depths`] does the same with measured
//! depth, where there is some; [`pose`] moves a part until its steps lie on those of the image; [`search`]
//! gives a start where a part is known only roughly. [`look`] does this for every part of a [`scene`],
//! measures again where it is by then, and draws again what moved far; [`acceptance`] rejects poses that the
//! image does not support; [`lost`] looks for a peg that may be anywhere in any position, [`anywhere`] for
//! beams and pegs that lie or stand as usual, but anywhere, [`leaning`] for a beam with one end on something;
//! [`finder`] is the whole.
//!
//! Since the drawing has the neighbours, the fingers and the holders in it, hidden edges and parts in one
//! another need no case of their own.

pub mod acceptance;
pub mod anywhere;
pub mod canvas;
pub mod contours;
pub mod depths;
pub mod finder;
pub mod leaning;
pub mod look;
pub mod lost;
pub mod marks;
pub mod pose;
pub mod profile;
pub mod scene;
pub mod search;
pub mod solids;

pub use acceptance::is_one_place;
pub use anywhere::{Comparison, Strewn, strewn_covariance};
pub use finder::SceneFinder;
pub use lost::Trace;
pub use scene::{Believed, Found, Scene, Seen};
