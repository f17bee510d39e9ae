//! A text with its name, and places in it, to which every message points.

use crate::text::plain;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// Size limit of a file, bytes; the project's own are under 20 kB.
pub const MAX_FILE: usize = 1 << 20;

/// A text file with its name, cheap to clone.
#[derive(Clone)]
pub struct SourceFile {
    name: Arc<str>,
    /// `None` when it could not be read.
    text: Option<Arc<str>>,
}

impl fmt::Debug for SourceFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SourceFile({:?}, {} bytes)", self.name, self.text().len())
    }
}

impl SourceFile {
    /// A file that is already in memory; `name` is its name in messages. A byte order mark is dropped.
    pub fn new(name: &str, text: &str) -> SourceFile {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        SourceFile { name: plain(name, usize::MAX).into(), text: Some(text.into()) }
    }

    /// A file that could not be read.
    pub(crate) fn unreadable(name: &str) -> SourceFile {
        SourceFile { name: plain(name, usize::MAX).into(), text: None }
    }

    /// Its text; `None` when it could not be read.
    pub(crate) fn kept_text(&self) -> Option<&Arc<str>> {
        self.text.as_ref()
    }

    /// Its name in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its text.
    pub fn text(&self) -> &str {
        self.text.as_deref().unwrap_or_default()
    }

    /// A place in it, by byte offsets, clamped to the text.
    pub fn place(&self, span: Range<usize>) -> Place {
        let into_text = |offset: usize| {
            let mut offset = offset.min(self.text().len());
            while !self.text().is_char_boundary(offset) {
                offset -= 1;
            }
            offset
        };
        let start = into_text(span.start);
        Place { span: start..into_text(span.end).max(start), file: self.clone() }
    }
}

/// A stretch of text in a file.
#[derive(Clone, Debug)]
pub struct Place {
    file: SourceFile,
    span: Range<usize>,
}

impl Place {
    /// The file.
    pub fn file(&self) -> &SourceFile {
        &self.file
    }

    /// Byte offsets into the file.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// Line and column of its start, both from 1; the column counts characters.
    pub fn line_column(&self) -> (usize, usize) {
        let before = &self.file.text()[..self.span.start];
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, column) = self.line_column();
        // A file that could not be read has no lines.
        match self.file.text {
            Some(_) => write!(f, "{}:{line}:{column}", self.file.name),
            None => write!(f, "{}", self.file.name),
        }
    }
}
