//! A group of parameters: a struct whose fields a parameter file can set, declared with their units and
//! limits.

use std::collections::BTreeMap;

/// The unit of angles in the file, where it is not rad.
const DEGREES: &str = "°";

/// The values of a parameter file, in its units: by table and field, a single number as a list of one.
pub type Values = BTreeMap<(String, String), Vec<f64>>;

/// Description of one parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field {
    /// Its name in the parameter file.
    pub name: &'static str,
    /// Its unit in the file; empty for a plain number.
    pub unit: &'static str,
    /// Its meaning and the source of its value.
    pub meaning: &'static str,
    /// Its form.
    pub form: Form,
    /// Its least value, in the unit of the file.
    pub least: f64,
    /// Its largest value, in the unit of the file.
    pub most: f64,
}

/// The form of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A number.
    Number,
    /// A whole number.
    Count,
    /// A list of this many numbers.
    List(usize),
}

/// A type that a parameter can have.
pub trait Value: Sized {
    /// Its form.
    const FORM: Form;

    /// From the numbers of the file; `None` when they are of another form.
    fn from_numbers(numbers: &[f64]) -> Option<Self>;

    /// As in the file.
    fn numbers(&self) -> Vec<f64>;
}

impl Value for f64 {
    const FORM: Form = Form::Number;

    fn from_numbers(numbers: &[f64]) -> Option<f64> {
        numbers.first().copied()
    }

    fn numbers(&self) -> Vec<f64> {
        vec![*self]
    }
}

impl Value for usize {
    const FORM: Form = Form::Count;

    fn from_numbers(numbers: &[f64]) -> Option<usize> {
        numbers.first().map(|number| *number as usize)
    }

    fn numbers(&self) -> Vec<f64> {
        vec![*self as f64]
    }
}

impl<const N: usize> Value for [f64; N] {
    const FORM: Form = Form::List(N);

    fn from_numbers(numbers: &[f64]) -> Option<[f64; N]> {
        numbers.try_into().ok()
    }

    fn numbers(&self) -> Vec<f64> {
        self.to_vec()
    }
}

/// A group of parameters: one table of the parameter file.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// The name of the table.
    pub table: &'static str,
    /// The subject of the table.
    pub about: &'static str,
    /// Its parameters.
    pub fields: &'static [Field],
    /// Their values, in the same order.
    pub values: Vec<Vec<f64>>,
}

/// The numbers of a parameter in SI units, from those of the file in `unit`. Angles in degrees become
/// radians; all other units of parameter files are SI.
pub fn to_si(numbers: &[f64], unit: &str) -> Vec<f64> {
    if unit == DEGREES {
        numbers.iter().map(|number| number.to_radians()).collect()
    } else {
        numbers.to_vec()
    }
}

/// The inverse of [`to_si`], to twelve digits.
pub fn from_si(numbers: &[f64], unit: &str) -> Vec<f64> {
    let rounded = |degrees: f64| format!("{degrees:.11e}").parse().unwrap_or(degrees);
    if unit == DEGREES {
        numbers.iter().map(|number| rounded(number.to_degrees())).collect()
    } else {
        numbers.to_vec()
    }
}

/// The unit of a parameter in its struct, from that of the file.
macro_rules! si_unit {
    ("°") => {
        "rad, in the file °"
    };
    ($unit:literal) => {
        $unit
    };
}

/// Declares a struct of parameters: each field with its type, its unit, the least and the largest value that
/// it may have.
macro_rules! parameters {
    (
        $(#[doc = $about:literal])+
        $group:ident {
            $(
                $(#[doc = $meaning:literal])+
                $field:ident: $type:ty = $unit:tt, $least:literal, $most:literal;
            )+
        }
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, Debug, PartialEq)]
        pub struct $group {
            $(
                $(#[doc = $meaning])+
                #[doc = concat!("\n\nUnit: ", si_unit!($unit), ".")]
                pub $field: $type,
            )+
        }

        impl $group {
            /// The subject of the group.
            pub const ABOUT: &'static str = concat!($($about),+);

            /// The descriptions of its parameters.
            pub const FIELDS: &'static [$crate::parameters::group::Field] = &[
                $(
                    $crate::parameters::group::Field {
                        name: stringify!($field),
                        unit: $unit,
                        meaning: concat!($($meaning),+),
                        form: <$type as $crate::parameters::group::Value>::FORM,
                        least: $least,
                        most: $most,
                    },
                )+
            ];

            /// From the values of a table; `None` when one is missing.
            pub(super) fn from_values(
                values: &$crate::parameters::group::Values,
                table: &str,
            ) -> Option<$group> {
                let get = |field: &str, unit: &str| {
                    let numbers = values.get(&(table.to_string(), field.to_string()))?;
                    Some($crate::parameters::group::to_si(numbers, unit))
                };
                Some($group {
                    $($field: $crate::parameters::group::Value::from_numbers(&get(stringify!($field), $unit)?)?,)+
                })
            }

            /// Its values in the units of the file, in the order of [`Self::FIELDS`].
            pub fn values(&self) -> Vec<Vec<f64>> {
                let numbers = [$($crate::parameters::group::Value::numbers(&self.$field),)+];
                numbers.iter().zip(Self::FIELDS).map(|(it, field)| $crate::parameters::group::from_si(it, field.unit)).collect()
            }
        }
    };
}
