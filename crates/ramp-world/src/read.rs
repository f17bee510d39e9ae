//! Reads a file of quantities, a world or a start, and reports the first error in it with its place.

use std::collections::BTreeMap;
use std::ops::Range;

use ramp_source::{A_NAME, Fault, FormProblem, Problem, SourceFile, is_name, nearest, shorten};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::quantity::{Field, Form, Quantity, Spread};

/// An error in a world file or a start file, with its place.
pub type WorldFault = Fault<WorldProblem>;

/// The longest text that a file may hold as a name, about or source, in bytes.
const LONGEST: usize = 1000;

/// Kinds of errors in a world file or a start file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WorldProblem {
    /// The file cannot be read.
    #[error(transparent)]
    Form(#[from] FormProblem),
    /// The file is not TOML.
    #[error("this is not valid TOML: {why}")]
    Toml {
        /// The parser's reason.
        why: String,
    },
    /// An unknown name.
    #[error("{place} has no `{found}`")]
    Unknown {
        /// A world, a group, or a quantity.
        place: String,
        /// The text in the file.
        found: String,
        /// The most similar name.
        nearest: Option<String>,
    },
    /// A required name is missing.
    #[error("{place} lacks `{lacking}`")]
    Lacking {
        /// A world, or a quantity.
        place: String,
        /// The missing name.
        lacking: String,
    },
    /// A value of another form, or out of range.
    #[error("found {name} = {found}, expected {expected}")]
    Value {
        /// Name of the quantity.
        name: String,
        /// The text in the file.
        found: String,
        /// The allowed values.
        expected: String,
    },
}

impl Problem for WorldProblem {
    fn label(&self) -> String {
        match self {
            WorldProblem::Form(problem) => problem.label(),
            WorldProblem::Toml { .. } => "here".to_string(),
            WorldProblem::Unknown { .. } => "unknown".to_string(),
            WorldProblem::Lacking { lacking, .. } => format!("`{lacking}` is missing"),
            WorldProblem::Value { expected, .. } => format!("expected {expected}"),
        }
    }

    fn help(&self) -> Option<String> {
        match self {
            WorldProblem::Form(problem) => problem.help(),
            WorldProblem::Unknown { nearest: Some(nearest), .. } => {
                Some(format!("did you mean `{nearest}`?"))
            }
            WorldProblem::Unknown { .. } | WorldProblem::Lacking { .. } => Some(
                "`ramp world show real` and `ramp start show moved` print such a file with all that it holds"
                    .to_string(),
            ),
            _ => None,
        }
    }
}

/// The quantities of a world, by group and field.
pub type Quantities = BTreeMap<(&'static str, &'static str), Quantity>;

/// A kind of file: its name in messages, and what it may hold.
pub(crate) struct Kind {
    /// Its name in messages: world or start.
    pub name: &'static str,
    /// Its groups: name, description and quantities.
    pub groups: &'static [(&'static str, &'static str, &'static [Field])],
    /// Whether a file may be based on another one, and its quantities may differ between episodes.
    pub drawn: bool,
}

/// Content of a file.
#[derive(Clone, Debug)]
pub struct Content {
    /// Its name.
    pub name: String,
    /// Its description.
    pub about: String,
    /// The world whose quantities hold where the file gives none, and the place of its name.
    pub based_on: Option<(String, Range<usize>)>,
    /// The quantities that the file gives.
    pub quantities: Quantities,
}

/// Reads a file.
///
/// # Errors
/// The first error in the file.
pub(crate) fn read(file: &SourceFile, kind: &Kind) -> Result<Content, WorldFault> {
    let fault = |problem: WorldProblem, span: Range<usize>| Fault::new(problem, file.place(span));
    let document = DeTable::parse(file.text()).map_err(|error| {
        let why = error.message().trim().replace('\n', ", ");
        fault(WorldProblem::Toml { why }, error.span().unwrap_or(0..0))
    })?;
    let mut read =
        Content { name: String::new(), about: String::new(), based_on: None, quantities: Quantities::new() };
    for (key, content) in document.get_ref() {
        let found = key.get_ref().as_ref();
        match found {
            "name" => {
                read.name = text(file, found, content)?;
                if !is_name(&read.name) {
                    return Err(wrong(file, found, content, A_NAME.to_string()));
                }
            }
            "about" => read.about = text(file, found, content)?,
            "based_on" if kind.drawn => read.based_on = Some((text(file, found, content)?, content.span())),
            _ => {
                let Some((group, _, fields)) = kind.groups.iter().find(|(group, _, _)| *group == found)
                else {
                    let known = ["name", "about"].into_iter().chain(kind.drawn.then_some("based_on"));
                    let known = known.chain(kind.groups.iter().map(|(group, _, _)| *group));
                    return Err(fault(unknown(&format!("a {}", kind.name), found, known), key.span()));
                };
                let table = table(file, found, content)?;
                for (key, content) in table {
                    let found = key.get_ref().as_ref();
                    let Some(field) = fields.iter().find(|field| field.name == found) else {
                        let known = fields.iter().map(|field| field.name);
                        return Err(fault(unknown(&format!("[{group}]"), found, known), key.span()));
                    };
                    let quantity = quantity(file, field, content, kind.drawn)?;
                    read.quantities.insert((group, field.name), quantity);
                }
            }
        }
    }
    if read.name.is_empty() {
        let place = format!("the {}", kind.name);
        return Err(fault(WorldProblem::Lacking { place, lacking: "name".to_string() }, 0..0));
    }
    Ok(read)
}

fn unknown<'a>(place: &str, found: &str, known: impl Iterator<Item = &'a str>) -> WorldProblem {
    let nearest = nearest(found, known).map(str::to_string);
    WorldProblem::Unknown { place: place.to_string(), found: shorten(found), nearest }
}

/// The value as the file has it, shortened.
fn text_at(file: &SourceFile, value: &Spanned<DeValue>) -> String {
    shorten(file.text().get(value.span()).unwrap_or_default())
}

fn wrong(file: &SourceFile, name: &str, value: &Spanned<DeValue>, expected: String) -> WorldFault {
    let problem = WorldProblem::Value { name: name.to_string(), found: text_at(file, value), expected };
    Fault::new(problem, file.place(value.span()))
}

fn table<'v, 'i>(
    file: &SourceFile,
    name: &str,
    value: &'v Spanned<DeValue<'i>>,
) -> Result<&'v DeTable<'i>, WorldFault> {
    match value.get_ref() {
        DeValue::Table(table) => Ok(table),
        _ => Err(wrong(file, name, value, "a table".to_string())),
    }
}

fn text(file: &SourceFile, name: &str, value: &Spanned<DeValue>) -> Result<String, WorldFault> {
    match value.get_ref() {
        DeValue::String(text) if !text.trim().is_empty() && text.len() <= LONGEST => Ok(text.to_string()),
        _ => Err(wrong(file, name, value, format!("a text of 1 to {LONGEST} bytes"))),
    }
}

/// `drawn`: whether it may differ between episodes.
fn quantity(
    file: &SourceFile,
    field: &Field,
    content: &Spanned<DeValue>,
    drawn: bool,
) -> Result<Quantity, WorldFault> {
    let table = table(file, field.name, content)?;
    let (mut value, mut spread, mut unit, mut source) = (None, None, None, None);
    for (key, content) in table {
        let found = key.get_ref().as_ref();
        match found {
            "value" => value = Some(values(file, field, content)?),
            "source" => source = Some(text(file, found, content)?),
            "unit" => {
                unit = match content.get_ref() {
                    DeValue::String(unit) if *unit == field.unit => Some(()),
                    _ => return Err(wrong(file, found, content, format!("\"{}\"", field.unit))),
                };
            }
            "within" | "share" | "sigma" if drawn => {
                let most = if found == "share" { 10.0 } else { field.most - field.least };
                let size = number(content.get_ref()).filter(|size| (0.0..=most).contains(size));
                let Some(size) = size.filter(|_| spread.is_none()) else {
                    let expected = format!("one of `within`, `share` and `sigma`, from 0 to {most}");
                    return Err(wrong(file, found, content, expected));
                };
                spread = Some(match found {
                    "within" => Spread::Within(size),
                    "share" => Spread::Share(size),
                    _ => Spread::Sigma(size),
                });
            }
            _ => {
                let known = ["value", "unit", "source"].into_iter();
                let known = known.chain(["within", "share", "sigma"].into_iter().filter(|_| drawn));
                let problem = unknown(&format!("`{}`", field.name), found, known);
                return Err(Fault::new(problem, file.place(key.span())));
            }
        }
    }
    let lacking = |lacking: &str| {
        let problem =
            WorldProblem::Lacking { place: format!("`{}`", field.name), lacking: lacking.to_string() };
        Fault::new(problem, file.place(content.span()))
    };
    if !field.unit.is_empty() && unit.is_none() {
        return Err(lacking("unit"));
    }
    Ok(Quantity {
        value: value.ok_or_else(|| lacking("value"))?,
        spread: spread.unwrap_or(Spread::Fixed),
        source: source.ok_or_else(|| lacking("source"))?,
    })
}

/// The numbers of a value. A single number stands for all of a list.
fn values(file: &SourceFile, field: &Field, content: &Spanned<DeValue>) -> Result<Vec<f64>, WorldFault> {
    let length = match field.form {
        Form::Number => 1,
        Form::List(length) => length,
        Form::Range => 2,
    };
    let numbers = match (content.get_ref(), field.form) {
        (DeValue::Array(values), Form::List(_) | Form::Range) if values.len() == length => {
            values.iter().map(|value| number(value.get_ref())).collect::<Option<Vec<f64>>>()
        }
        (DeValue::Array(_), _) | (_, Form::Range) => None,
        (value, _) => number(value).map(|value| vec![value; length]),
    };
    let ordered = |numbers: &[f64]| field.form != Form::Range || numbers[0] < numbers[1];
    let within = |numbers: &Vec<f64>| {
        numbers.iter().all(|it| (field.least..=field.most).contains(it)) && ordered(numbers)
    };
    numbers.filter(within).ok_or_else(|| {
        let what = match field.form {
            Form::Number => "a number".to_string(),
            Form::List(length) => format!("a number, or a list of {length},"),
            Form::Range => "a list of two, the smaller one first,".to_string(),
        };
        let expected = format!("{what} from {} to {} {}", field.least, field.most, field.unit);
        wrong(file, field.name, content, expected.trim_end().to_string())
    })
}

/// A number; `None` for anything else.
fn number(value: &DeValue) -> Option<f64> {
    match value {
        DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
        DeValue::Float(float) => float.as_str().parse().ok(),
        _ => None,
    }
}
