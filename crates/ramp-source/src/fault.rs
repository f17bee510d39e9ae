//! A problem at its place in a file, and how it prints.

use crate::file::Place;
use crate::text::visible;
use std::borrow::Cow;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// The problems of one kind of file; its `Display` is one sentence that says what was found.
pub trait Problem: std::error::Error + Send + Sync + 'static {
    /// The few words under the caret: the expected content.
    fn label(&self) -> String;
    /// Advice on how to fix it, where there is any.
    fn help(&self) -> Option<String> {
        None
    }
}

/// A [`Problem`] at its place.
pub struct Fault<P> {
    inner: Box<Inner<P>>,
}

struct Inner<P> {
    problem: P,
    place: Place,
    /// Further places that help to understand it, each with its label.
    also: Vec<(Range<usize>, String)>,
    /// The text in the form that miette needs.
    named: miette::NamedSource<Arc<str>>,
}

impl<P: Problem> Fault<P> {
    /// A problem at a place.
    pub fn new(problem: P, place: Place) -> Fault<P> {
        // Control characters in the file must not reach the terminal.
        let text: Arc<str> = match place.file().kept_text() {
            Some(text) => match visible(text) {
                Cow::Borrowed(_) => text.clone(),
                Cow::Owned(text) => text.into(),
            },
            None => Arc::default(),
        };
        let named = miette::NamedSource::new(place.file().name(), text);
        Fault { inner: Box::new(Inner { problem, place, also: Vec::new(), named }) }
    }

    /// Adds a second place of the same file with a label.
    pub fn also(mut self, span: Range<usize>, words: &str) -> Fault<P> {
        self.inner.also.push((span, words.to_string()));
        self
    }

    /// The problem.
    pub fn problem(&self) -> &P {
        &self.inner.problem
    }

    /// Its place.
    pub fn place(&self) -> &Place {
        &self.inner.place
    }

    /// `file:line:column`, or only the file if it could not be read.
    pub fn location(&self) -> String {
        self.inner.place.to_string()
    }
}

impl<P: Problem> fmt::Display for Fault<P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !f.alternate() {
            return write!(f, "{}", self.inner.problem);
        }
        // A file that could not be read is named in the problem.
        if self.inner.place.file().kept_text().is_some() {
            write!(f, "{}: ", self.inner.place)?;
        }
        write!(f, "{}", self.inner.problem)?;
        match self.inner.problem.help() {
            Some(help) => write!(f, " ({help})"),
            None => Ok(()),
        }
    }
}

impl<P: Problem> fmt::Debug for Fault<P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self:#}")
    }
}

impl<P: Problem> std::error::Error for Fault<P> {}

impl<P: Problem> miette::Diagnostic for Fault<P> {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.inner.problem.help().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        self.inner.place.file().kept_text().map(|_| &self.inner.named as &dyn miette::SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = miette::LabeledSpan> + '_>> {
        self.inner.place.file().kept_text()?;
        let main = miette::LabeledSpan::new_primary_with_span(
            Some(self.inner.problem.label()),
            self.inner.place.span(),
        );
        let also = self
            .inner
            .also
            .iter()
            .map(|(span, words)| miette::LabeledSpan::new_with_span(Some(words.clone()), span.clone()));
        Some(Box::new(std::iter::once(main).chain(also)))
    }
}
