//! Text files written by people: reading them, pointing at a place in them, and reporting what is
//! wrong there.
//!
//! [`SourceFile::read`] turns a path into a text with a name, within limits. A crate that reads
//! such files has its own list of [`Problem`]s. A [`Fault`] is one of them at its [`Place`]. It
//! prints with [`miette`] as the line with a caret under the fault, with `{}` as one sentence, and
//! with `{:#}` as that sentence after `file:line:column`. [`parse_xml`] and [`Element`] do the same
//! for XML files. [`nearest`] finds the name that a misspelt one was meant to be.
//!
//! Rules that hold for every untrusted file are here as well: names ([`is_name`]), text for a
//! person ([`is_text`]), encodings ([`decode`]), size limits ([`read_bytes`], [`read_text`]), atomic writing
//! ([`write_whole`]) and cells of a spreadsheet ([`cell`]).
//!
//! ```
//! use ramp_source::{Fault, Problem, SourceFile};
//!
//! #[derive(Debug, thiserror::Error)]
//! #[error("there is no colour `{0}`")]
//! struct NoColour(String);
//!
//! impl Problem for NoColour {
//!     fn label(&self) -> String {
//!         "expected a colour".to_string()
//!     }
//! }
//!
//! let file = SourceFile::new("wall.txt", "paint it\nrad");
//! let fault = Fault::new(NoColour("rad".to_string()), file.place(9..12));
//! assert_eq!(format!("{fault:#}"), "wall.txt:2:1: there is no colour `rad`");
//! ```

mod cell;
mod debris;
mod decode;
mod fault;
mod file;
mod form;
mod names;
mod read;
mod text;
mod write;
mod xml;
mod xml_size;

pub use cell::cell;
pub use debris::{describe_debris, is_debris};
pub use decode::{NoText, decode, without_mark};
pub use fault::{Fault, Problem};
pub use file::{MAX_FILE, Place, SourceFile};
pub use form::FormProblem;
pub use names::{A_NAME, MAX_NAME, is_name, nearest, to_name};
pub use read::{ReadError, read_bytes, read_text};
pub use text::{MAX_SENTENCE, MAX_TITLE, is_text, plain, shorten};
pub use write::{WholeFile, WriteError, remove_unfinished, write_whole};
pub use xml::{Element, Value, parse_xml};
