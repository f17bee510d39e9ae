//! Files that people write: reading them, pointing at a place in them, and saying what is wrong there.
//!
//! Every crate that reads a file has its own list of [`Problem`]s; a [`Fault`] is one of them at its place. It
//! prints with [`miette`] as the line with a caret under the fault, with `{}` as one sentence and with `{:#}` as
//! that sentence after `file:line:column`.

use std::fmt;
use std::marker::PhantomData;
use std::ops::{Range, RangeInclusive};
use std::path::Path;
use std::sync::Arc;

/// The largest file that is read, bytes; the project's own are under 20 kB.
pub const MAX_FILE: usize = 1 << 20;
/// The most XML nodes in one file.
const MAX_NODES: u32 = 100_000;
/// The longest name, in bytes; also keeps the search for the nearest name fast.
pub const MAX_NAME: usize = 64;

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
    /// A file that is already in memory; `name` is what messages call it.
    pub fn new(name: &str, text: &str) -> SourceFile {
        SourceFile { name: name.into(), text: Some(text.into()) }
    }

    /// Reads a file, which must be UTF-8 and no larger than [`MAX_FILE`].
    pub fn read<P: Problem + From<FormProblem>>(path: &Path) -> Result<SourceFile, Fault<P>> {
        use std::io::Read;
        let name = path.display().to_string();
        let unreadable = |why: String| {
            let file = SourceFile { name: name.as_str().into(), text: None };
            Fault::new(FormProblem::Unreadable { file: name.clone(), why }.into(), file.place(0..0))
        };
        let mut bytes = Vec::new();
        // One byte more than allowed tells a file that is too large from one that just fits.
        let limit = MAX_FILE as u64 + 1;
        std::fs::File::open(path)
            .and_then(|file| file.take(limit).read_to_end(&mut bytes))
            .map_err(|error| unreadable(describe_io(&error)))?;
        if bytes.len() > MAX_FILE {
            return Err(unreadable(FormProblem::TooLarge.to_string()));
        }
        match String::from_utf8(bytes) {
            Ok(text) => Ok(SourceFile::new(&name, &text)),
            Err(error) => {
                let valid = error.utf8_error().valid_up_to();
                let file = SourceFile::new(&name, &String::from_utf8_lossy(error.as_bytes()));
                // What stands in front is valid, so the offset is the same in the lossy text.
                let byte = error.as_bytes()[valid];
                Err(Fault::new(FormProblem::NotUtf8 { byte }.into(), file.place(valid..valid)))
            }
        }
    }

    /// What messages call it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its text.
    pub fn text(&self) -> &str {
        self.text.as_deref().unwrap_or_default()
    }

    /// A place in it, by byte offsets; pulled into the text where they leave it.
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

/// Why the system could not read a file, in plain words.
fn describe_io(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "there is no such file".to_string(),
        std::io::ErrorKind::PermissionDenied => "its permissions forbid it".to_string(),
        std::io::ErrorKind::IsADirectory => "it is a folder".to_string(),
        _ => error.to_string(),
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
        // A file that could not be read has no line to name.
        match self.file.text {
            Some(_) => write!(f, "{}:{line}:{column}", self.file.name),
            None => write!(f, "{}", self.file.name),
        }
    }
}

/// What can be wrong in one kind of file; its `Display` is one sentence that says what was found.
pub trait Problem: std::error::Error + Send + Sync + 'static {
    /// The few words under the caret: what was expected there.
    fn label(&self) -> String;
    /// What to do about it, where there is something to say.
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
    /// Other places that help to understand it, with the words to put there.
    also: Vec<(Range<usize>, String)>,
    /// The text once more, in the form that miette asks for.
    named: miette::NamedSource<Arc<str>>,
}

impl<P: Problem> Fault<P> {
    /// A problem at a place.
    pub fn new(problem: P, place: Place) -> Fault<P> {
        let text = place.file.text.clone().unwrap_or_default();
        let named = miette::NamedSource::new(place.file.name(), text);
        Fault { inner: Box::new(Inner { problem, place, also: Vec::new(), named }) }
    }

    /// Points at a second place of the same file, with a few words.
    pub fn also(mut self, span: Range<usize>, words: &str) -> Fault<P> {
        self.inner.also.push((span, words.to_string()));
        self
    }

    /// What is wrong.
    pub fn problem(&self) -> &P {
        &self.inner.problem
    }

    /// Where.
    pub fn place(&self) -> &Place {
        &self.inner.place
    }

    /// `file:line:column`, or only the file where it could not be read.
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
        if self.inner.place.file.text.is_some() {
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
        self.inner.place.file.text.as_ref().map(|_| &self.inner.named as &dyn miette::SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = miette::LabeledSpan> + '_>> {
        self.inner.place.file.text.as_ref()?;
        let main = miette::LabeledSpan::new_primary_with_span(
            Some(self.inner.problem.label()),
            self.inner.place.span.clone(),
        );
        let also = self
            .inner
            .also
            .iter()
            .map(|(span, words)| miette::LabeledSpan::new_with_span(Some(words.clone()), span.clone()));
        Some(Box::new(std::iter::once(main).chain(also)))
    }
}

/// What can be wrong with the form of any of the project's XML files.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FormProblem {
    /// The system cannot read the file.
    #[error("cannot read {file}: {why}")]
    Unreadable {
        /// The file.
        file: String,
        /// The system's reason.
        why: String,
    },
    /// The file is larger than [`MAX_FILE`].
    #[error("this file is larger than {} kB", MAX_FILE / 1024)]
    TooLarge,
    /// The file is not UTF-8.
    #[error("this file is not UTF-8 text: found the byte 0x{byte:02x}")]
    NotUtf8 {
        /// The first byte that does not fit.
        byte: u8,
    },
    /// The file is not XML.
    #[error("this is not valid XML: {why}")]
    Xml {
        /// The parser's reason.
        why: String,
    },
    /// The outermost element is another one.
    #[error("found the outermost element <{found}>, expected <{expected}>")]
    Root {
        /// What the file has.
        found: String,
        /// What it must have.
        expected: &'static str,
    },
    /// An element that does not belong here.
    #[error("found <{found}> inside <{parent}>, expected {expected}")]
    Element {
        /// What the file has.
        found: String,
        /// The element around it.
        parent: String,
        /// The elements that may stand here.
        expected: String,
        /// The most similar of them.
        nearest: Option<String>,
    },
    /// An attribute that looks like a misspelt one.
    #[error("<{element}> has no attribute `{found}`")]
    Attribute {
        /// What the file has.
        found: String,
        /// The element it stands in.
        element: String,
        /// The most similar attribute.
        nearest: String,
    },
    /// An attribute that must be there is not.
    #[error("<{element}> has no attribute `{attribute}`, which it needs")]
    Missing {
        /// The element.
        element: String,
        /// The attribute.
        attribute: &'static str,
    },
    /// Not a number, or one out of range.
    #[error("found {attribute}=\"{found}\", expected {expected}")]
    Number {
        /// The attribute.
        attribute: &'static str,
        /// Its value.
        found: String,
        /// What it may be.
        expected: String,
    },
    /// Neither `True` nor `False`, or the like.
    #[error("found {attribute}=\"{found}\", expected {expected}")]
    Choice {
        /// The attribute.
        attribute: &'static str,
        /// Its value.
        found: String,
        /// What it may be.
        expected: &'static str,
    },
    /// A name that is empty or too long or has blanks at its ends.
    #[error("found the name \"{found}\", expected 1 to {MAX_NAME} characters without blanks")]
    Name {
        /// The name, shortened.
        found: String,
    },
}

impl Problem for FormProblem {
    fn label(&self) -> String {
        match self {
            FormProblem::Unreadable { .. } | FormProblem::TooLarge => String::new(),
            FormProblem::NotUtf8 { .. } => "from here on".to_string(),
            FormProblem::Xml { .. } => "here".to_string(),
            FormProblem::Root { expected, .. } => format!("expected <{expected}>"),
            FormProblem::Element { expected, .. } => format!("expected {expected}"),
            FormProblem::Attribute { .. } => "unknown attribute".to_string(),
            FormProblem::Missing { attribute, .. } => format!("needs {attribute}=\"…\""),
            FormProblem::Number { expected, .. } => format!("expected {expected}"),
            FormProblem::Choice { expected, .. } => format!("expected {expected}"),
            FormProblem::Name { .. } => "not a name".to_string(),
        }
    }

    fn help(&self) -> Option<String> {
        match self {
            FormProblem::Element { nearest: Some(nearest), .. } => Some(format!("did you mean <{nearest}>?")),
            FormProblem::Attribute { nearest, .. } => Some(format!("did you mean `{nearest}`?")),
            _ => None,
        }
    }
}

/// The name among `names` that is most like `wanted`, when one is like enough to be worth suggesting.
///
/// ```
/// # use ramp_kit::source::nearest;
/// assert_eq!(nearest("easy-33", ["easy-3", "hard-3"]), Some("easy-3"));
/// assert_eq!(nearest("table", ["easy-3", "hard-3"]), None);
/// ```
pub fn nearest<'a>(wanted: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let allowed = 1 + wanted.chars().count().min(MAX_NAME) / 4;
    names
        .into_iter()
        .filter_map(|name| Some((edits(wanted, name)?, name)))
        .min_by_key(|(distance, _)| *distance)
        .filter(|(distance, name)| *distance <= allowed && *distance < name.chars().count())
        .map(|(_, name)| name)
}

/// How many characters must be added, dropped, changed or swapped with their neighbour to turn `a` into `b`, not
/// counting case; `None` when one of them is too long to be a name.
fn edits(a: &str, b: &str) -> Option<usize> {
    if a.len() > MAX_NAME || b.len() > MAX_NAME {
        return None;
    }
    let fold = |text: &str| text.chars().flat_map(char::to_lowercase).collect::<Vec<char>>();
    let (a, b) = (fold(a), fold(b));
    let width = b.len() + 1;
    // Row i holds the distances from the first i characters of a to every beginning of b.
    let mut table = vec![0; (a.len() + 1) * width];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            table[i * width + j] = if i == 0 || j == 0 {
                i + j
            } else {
                let change = table[(i - 1) * width + j - 1] + usize::from(a[i - 1] != b[j - 1]);
                let drop = table[(i - 1) * width + j] + 1;
                let add = table[i * width + j - 1] + 1;
                let swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
                let swap = if swapped { table[(i - 2) * width + j - 2] + 1 } else { usize::MAX };
                change.min(drop).min(add).min(swap)
            };
        }
    }
    table.last().copied()
}

/// An XML element with its file, so that whatever is wrong with it can be pointed at; `P` is the list of problems
/// of the crate that reads.
pub struct Element<'a, P> {
    node: roxmltree::Node<'a, 'a>,
    file: &'a SourceFile,
    problems: PhantomData<fn() -> P>,
}

impl<P> Clone for Element<'_, P> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<P> Copy for Element<'_, P> {}

/// Parses the XML of a file; the tree borrows its text.
pub fn parse_xml<P: Problem + From<FormProblem>>(
    file: &SourceFile,
) -> Result<roxmltree::Document<'_>, Fault<P>> {
    if file.text().len() > MAX_FILE {
        return Err(Fault::new(FormProblem::TooLarge.into(), file.place(0..0)));
    }
    let options = roxmltree::ParsingOptions { nodes_limit: MAX_NODES, ..Default::default() };
    roxmltree::Document::parse_with_options(file.text(), options).map_err(|error| {
        let at = error.pos();
        let offset = offset_of(file.text(), at.row as usize, at.col as usize);
        // The parser puts " at line:column" at the end, which the place says already.
        let why = error.to_string();
        let why = why.strip_suffix(&format!(" at {at}")).unwrap_or(&why).to_string();
        Fault::new(FormProblem::Xml { why }.into(), file.place(offset..offset))
    })
}

/// The byte offset of a line and column, both from 1.
fn offset_of(text: &str, line: usize, column: usize) -> usize {
    let start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let rest = text.get(start..).unwrap_or("");
    start + rest.chars().take(column.saturating_sub(1)).map(char::len_utf8).sum::<usize>()
}

impl<'a, P: Problem + From<FormProblem>> Element<'a, P> {
    /// The outermost element, which must have this name.
    pub fn root(
        document: &'a roxmltree::Document<'a>,
        file: &'a SourceFile,
        name: &'static str,
    ) -> Result<Element<'a, P>, Fault<P>> {
        let root = Element { node: document.root_element(), file, problems: PhantomData };
        if root.tag() == name {
            return Ok(root);
        }
        Err(root.fault(FormProblem::Root { found: shorten(root.tag()), expected: name }.into()))
    }

    /// Its name.
    pub fn tag(&self) -> &'a str {
        self.node.tag_name().name()
    }

    /// The file it stands in.
    pub fn file(&self) -> &'a SourceFile {
        self.file
    }

    /// Its opening tag, as byte offsets.
    pub fn span(&self) -> Range<usize> {
        let whole = self.node.range();
        // The end of the last attribute, or of the name; the closing bracket follows.
        let inside = self.node.attributes().map(|attribute| attribute.range().end).max();
        let after = inside.unwrap_or(whole.start + 1 + self.tag().len()).min(whole.end);
        let rest = &self.file.text()[after..whole.end];
        whole.start..rest.find('>').map_or(after, |at| after + at + 1)
    }

    /// A fault at its opening tag.
    pub fn fault(&self, problem: P) -> Fault<P> {
        Fault::new(problem, self.file.place(self.span()))
    }

    /// The elements in it, each of which must have one of these names.
    pub fn children(&self, names: &[&str]) -> Result<Vec<Element<'a, P>>, Fault<P>> {
        let mut children = Vec::new();
        for node in self.node.children().filter(roxmltree::Node::is_element) {
            let child = Element { node, file: self.file, problems: PhantomData };
            if !names.contains(&child.tag()) {
                let known: Vec<String> = names.iter().map(|name| format!("<{name}>")).collect();
                let problem = FormProblem::Element {
                    found: shorten(child.tag()),
                    parent: self.tag().to_string(),
                    expected: if known.is_empty() { "nothing".to_string() } else { known.join(", ") },
                    nearest: nearest(child.tag(), names.iter().copied()).map(str::to_string),
                };
                return Err(child.fault(problem.into()));
            }
            children.push(child);
        }
        Ok(children)
    }

    /// Finds attributes that look like a misspelt one of `names`. Others are passed over, so that files of other
    /// tools, which may say more, can be read.
    pub fn check_attributes(&self, names: &[&str]) -> Result<(), Fault<P>> {
        for attribute in self.node.attributes() {
            let found = attribute.name();
            if names.contains(&found) {
                continue;
            }
            if let Some(near) =
                nearest(found, names.iter().copied().filter(|name| self.node.attribute(*name).is_none()))
            {
                let problem = FormProblem::Attribute {
                    found: shorten(found),
                    element: self.tag().to_string(),
                    nearest: near.to_string(),
                };
                return Err(Fault::new(problem.into(), self.file.place(attribute.range_qname())));
            }
        }
        Ok(())
    }

    /// An attribute that may be there.
    pub fn optional(&self, attribute: &'static str) -> Option<Value<'a, P>> {
        let node = self.node.attribute_node(attribute)?;
        Some(Value {
            attribute,
            text: node.value(),
            span: node.range_value(),
            file: self.file,
            problems: PhantomData,
        })
    }

    /// An attribute that must be there.
    pub fn required(&self, attribute: &'static str) -> Result<Value<'a, P>, Fault<P>> {
        self.optional(attribute).ok_or_else(|| {
            self.fault(FormProblem::Missing { element: self.tag().to_string(), attribute }.into())
        })
    }
}

/// The value of an attribute, with its place.
pub struct Value<'a, P> {
    attribute: &'static str,
    text: &'a str,
    span: Range<usize>,
    file: &'a SourceFile,
    problems: PhantomData<fn() -> P>,
}

impl<P> Clone for Value<'_, P> {
    fn clone(&self) -> Self {
        Value { span: self.span.clone(), ..*self }
    }
}

impl<'a, P: Problem + From<FormProblem>> Value<'a, P> {
    /// The text between the quotation marks.
    pub fn text(&self) -> &'a str {
        self.text
    }

    /// Its place, as byte offsets.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// A fault at this value.
    pub fn fault(&self, problem: P) -> Fault<P> {
        Fault::new(problem, self.file.place(self.span()))
    }

    /// As a name: 1 to [`MAX_NAME`] bytes without blanks or control characters.
    pub fn name(&self) -> Result<&'a str, Fault<P>> {
        let fits = (1..=MAX_NAME).contains(&self.text.len());
        if fits && !self.text.contains(|c: char| c.is_whitespace() || c.is_control()) {
            return Ok(self.text);
        }
        Err(self.fault(FormProblem::Name { found: shorten(self.text) }.into()))
    }

    /// As a number in a range; `unit` is for the message.
    pub fn number(&self, range: RangeInclusive<f64>, unit: &str) -> Result<f64, Fault<P>> {
        let number = self.text.trim().parse::<f64>().ok();
        // A NaN is in no range.
        number.filter(|number| range.contains(number)).ok_or_else(|| {
            let expected = format!("a number from {} to {} {unit}", range.start(), range.end());
            self.bad_number(expected.trim_end().to_string())
        })
    }

    /// As a whole number in a range.
    pub fn integer(&self, range: RangeInclusive<i64>) -> Result<i64, Fault<P>> {
        let number = self.text.trim().parse::<i64>().ok();
        number.filter(|number| range.contains(number)).ok_or_else(|| {
            self.bad_number(format!("a whole number from {} to {}", range.start(), range.end()))
        })
    }

    fn bad_number(&self, expected: String) -> Fault<P> {
        let found = shorten(self.text);
        self.fault(FormProblem::Number { attribute: self.attribute, found, expected }.into())
    }

    /// As `True` or `False`.
    pub fn flag(&self) -> Result<bool, Fault<P>> {
        match self.text {
            "True" => Ok(true),
            "False" => Ok(false),
            _ => Err(self.bad_choice("True or False")),
        }
    }

    /// A fault that says which values may stand here.
    pub fn bad_choice(&self, expected: &'static str) -> Fault<P> {
        let found = shorten(self.text);
        self.fault(FormProblem::Choice { attribute: self.attribute, found, expected }.into())
    }
}

/// Text from a file as it may stand in a message: at most [`MAX_NAME`] characters, none of them a control
/// character.
pub fn shorten(text: &str) -> String {
    let mut short: String =
        text.chars().take(MAX_NAME).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().count() > MAX_NAME {
        short.push('…');
    }
    short
}
