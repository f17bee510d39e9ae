//! XML with places: elements and attributes know their position in the file.
//!
//! [`parse_xml`] checks the size and the syntax; [`Element`] returns children and attributes and
//! refuses missing or unknown ones; [`Value`] reads an attribute as a name, a number or a choice.

use crate::fault::{Fault, Problem};
use crate::file::{MAX_FILE, SourceFile};
use crate::form::FormProblem;
use crate::names::{is_name, nearest};
use crate::text::{MAX_SENTENCE, plain, shorten};
use crate::xml_size::check_size;
use std::marker::PhantomData;
use std::ops::{Range, RangeInclusive};

/// Largest number of XML nodes in one file.
const MAX_NODES: u32 = 100_000;

/// An XML element with its file, so that a message can point at it; `P` is the list of problems of
/// the reading crate.
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
///
/// # Errors
/// When the file is too large; where an element has too many attributes, too long ones or too deep
/// nesting; or at the first syntax error.
pub fn parse_xml<P: Problem + From<FormProblem>>(
    file: &SourceFile,
) -> Result<roxmltree::Document<'_>, Fault<P>> {
    if file.text().len() > MAX_FILE {
        return Err(Fault::new(FormProblem::TooLarge.into(), file.place(0..0)));
    }
    check_size(file.text()).map_err(|(problem, at)| Fault::new(problem.into(), file.place(at)))?;
    let options = roxmltree::ParsingOptions { nodes_limit: MAX_NODES, ..Default::default() };
    roxmltree::Document::parse_with_options(file.text(), options).map_err(|error| {
        let at = error.pos();
        let offset = offset_of(file.text(), at.row as usize, at.col as usize);
        // The parser appends " at line:column", which the place repeats.
        let why = error.to_string();
        let why = why.strip_suffix(&format!(" at {at}")).unwrap_or(&why);
        let why = plain(why, MAX_SENTENCE);
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
    ///
    /// # Errors
    /// When it has another name.
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

    /// Its file.
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

    /// The child elements, each of which must have one of these names.
    ///
    /// # Errors
    /// At the first element with another name.
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

    /// Finds attributes that look like a misspelling of one of `names`. Other unknown attributes
    /// are ignored, so that files of other tools can be read.
    ///
    /// # Errors
    /// At the first attribute that looks like one.
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

    /// An optional attribute.
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

    /// A required attribute.
    ///
    /// # Errors
    /// At the opening tag, when it is missing.
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

    /// As a name: [`A_NAME`](crate::A_NAME).
    ///
    /// # Errors
    /// When it is not a name.
    pub fn name(&self) -> Result<&'a str, Fault<P>> {
        if is_name(self.text) {
            return Ok(self.text);
        }
        Err(self.fault(FormProblem::Name { found: shorten(self.text) }.into()))
    }

    /// As a number in a range; `unit` is for the message.
    ///
    /// # Errors
    /// When it is not a number, or out of range.
    pub fn number(&self, range: RangeInclusive<f64>, unit: &str) -> Result<f64, Fault<P>> {
        let number = self.text.trim().parse::<f64>().ok();
        // A NaN is outside every range.
        number.filter(|number| range.contains(number)).ok_or_else(|| {
            let expected = format!("a number from {} to {} {unit}", range.start(), range.end());
            self.bad_number(expected.trim_end().to_string())
        })
    }

    /// As a whole number in a range.
    ///
    /// # Errors
    /// When it is not a whole number, or out of range.
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
    ///
    /// # Errors
    /// When it is neither.
    pub fn flag(&self) -> Result<bool, Fault<P>> {
        match self.text {
            "True" => Ok(true),
            "False" => Ok(false),
            _ => Err(self.bad_choice("True or False")),
        }
    }

    /// A fault that lists the allowed values.
    pub fn bad_choice(&self, expected: &'static str) -> Fault<P> {
        let found = shorten(self.text);
        self.fault(FormProblem::Choice { attribute: self.attribute, found, expected }.into())
    }
}
