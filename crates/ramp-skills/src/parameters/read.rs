//! Reads a parameter file and reports errors with their location.

use std::ops::Range;

use ramp_kit::source::{Fault, FormProblem, Problem, SourceFile, nearest, shorten};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::group::{Field, Form, Values};

/// An error in a parameter file, with its location.
pub type ParameterFault = Fault<ParameterProblem>;

/// Kinds of errors in a parameter file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterProblem {
    /// The file cannot be read.
    #[error(transparent)]
    Form(#[from] FormProblem),
    /// The file is not TOML.
    #[error("this is not valid TOML: {why}")]
    Toml {
        /// The parser's reason.
        why: String,
    },
    /// A table that no group of parameters has.
    #[error("there is no table [{found}]")]
    Table {
        /// The value found in the file.
        found: String,
        /// The most similar table.
        nearest: Option<String>,
    },
    /// A value where a table must be.
    #[error("found {found} for {table}, expected a table")]
    NoTable {
        /// The value found in the file.
        found: String,
        /// The table.
        table: String,
    },
    /// A parameter that the table does not have.
    #[error("[{table}] has no parameter `{found}`")]
    Parameter {
        /// The value found in the file.
        found: String,
        /// The table.
        table: String,
        /// The most similar parameter.
        nearest: Option<String>,
    },
    /// A value of another form, or out of range.
    #[error("found {parameter} = {found}, expected {expected}")]
    Value {
        /// The parameter.
        parameter: String,
        /// The value found in the file.
        found: String,
        /// The expected value.
        expected: String,
    },
}

impl Problem for ParameterProblem {
    fn label(&self) -> String {
        match self {
            ParameterProblem::Form(problem) => problem.label(),
            ParameterProblem::Toml { .. } => "here".to_string(),
            ParameterProblem::Table { .. } => "unknown table".to_string(),
            ParameterProblem::NoTable { .. } => "expected a table".to_string(),
            ParameterProblem::Parameter { .. } => "unknown parameter".to_string(),
            ParameterProblem::Value { expected, .. } => format!("expected {expected}"),
        }
    }

    fn help(&self) -> Option<String> {
        match self {
            ParameterProblem::Form(problem) => problem.help(),
            ParameterProblem::Table { nearest: Some(nearest), .. }
            | ParameterProblem::Parameter { nearest: Some(nearest), .. } => {
                Some(format!("did you mean `{nearest}`?"))
            }
            ParameterProblem::Table { .. } | ParameterProblem::Parameter { .. } => {
                Some("`ramp skills` prints all parameters".to_string())
            }
            _ => None,
        }
    }
}

/// Adds the values of a file to `values`, in place of those that are there.
///
/// # Errors
/// The first error in the file.
pub fn read_values(
    file: &SourceFile,
    tables: &[(&str, &[Field])],
    values: &mut Values,
) -> Result<(), ParameterFault> {
    let fault = |problem: ParameterProblem, span: Range<usize>| Fault::new(problem, file.place(span));
    let document = DeTable::parse(file.text()).map_err(|error| {
        let why = error.message().trim().replace('\n', ", ");
        fault(ParameterProblem::Toml { why }, error.span().unwrap_or(0..0))
    })?;
    for (name, content) in document.get_ref() {
        let found = name.get_ref().as_ref();
        let Some((table, fields)) = tables.iter().find(|(table, _)| *table == found) else {
            let nearest = nearest(found, tables.iter().map(|(table, _)| *table)).map(str::to_string);
            return Err(fault(ParameterProblem::Table { found: shorten(found), nearest }, name.span()));
        };
        let DeValue::Table(content_table) = content.get_ref() else {
            let problem =
                ParameterProblem::NoTable { found: text_at(file, content), table: (*table).to_string() };
            return Err(fault(problem, content.span()));
        };
        for (key, value) in content_table {
            let found = key.get_ref().as_ref();
            let Some(field) = fields.iter().find(|field| field.name == found) else {
                let nearest = nearest(found, fields.iter().map(|field| field.name)).map(str::to_string);
                let (found, table) = (shorten(found), (*table).to_string());
                return Err(fault(ParameterProblem::Parameter { found, table, nearest }, key.span()));
            };
            let Some(numbers) = numbers(value.get_ref(), field) else {
                let problem = ParameterProblem::Value {
                    parameter: field.name.to_string(),
                    found: text_at(file, value),
                    expected: expected(field),
                };
                return Err(fault(problem, value.span()));
            };
            values.insert(((*table).to_string(), field.name.to_string()), numbers);
        }
    }
    Ok(())
}

/// The value as the file has it, shortened.
fn text_at(file: &SourceFile, value: &Spanned<DeValue>) -> String {
    shorten(file.text().get(value.span()).unwrap_or_default())
}

/// The numbers of a value; `None` when it is not of the field's form, or out of its range.
fn numbers(value: &DeValue, field: &Field) -> Option<Vec<f64>> {
    let numbers = match (value, field.form) {
        (DeValue::Array(values), Form::List(length)) if values.len() == length => {
            values.iter().map(|value| number(value.get_ref())).collect::<Option<Vec<f64>>>()?
        }
        (DeValue::Array(_), _) | (_, Form::List(_)) => return None,
        (value, _) => vec![number(value)?],
    };
    let within = |number: &f64| (field.least..=field.most).contains(number);
    let whole = field.form != Form::Count || numbers.iter().all(|number| number.fract() == 0.0);
    (whole && numbers.iter().all(within)).then_some(numbers)
}

/// A number; `None` for anything else.
fn number(value: &DeValue) -> Option<f64> {
    match value {
        DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
        DeValue::Float(float) => float.as_str().parse().ok(),
        _ => None,
    }
}

/// The permitted values of a field.
fn expected(field: &Field) -> String {
    let Field { least, most, unit, .. } = field;
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let what = match field.form {
        Form::Number => "a number".to_string(),
        Form::Count => "a whole number".to_string(),
        Form::List(length) => format!("a list of {length} numbers"),
    };
    format!("{what} from {least} to {most}{unit}")
}
