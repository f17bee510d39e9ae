//! A quantity of a world: its value, how it is spread, and where both come from; and the declaration of a
//! group of them.

use std::collections::BTreeMap;

use ramp_robot::random::Stream;

/// Description of one quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field {
    /// Its name in a world file.
    pub name: &'static str,
    /// Its unit; empty for a plain number.
    pub unit: &'static str,
    /// Its meaning, in English.
    pub meaning: &'static str,
    /// Its form.
    pub form: Form,
    /// The least value that it may have.
    pub least: f64,
    /// The largest value that it may have.
    pub most: f64,
}

/// The form of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A number.
    Number,
    /// A list with this many numbers, such as one for each joint.
    List(usize),
    /// Two numbers, the smaller one first.
    Range,
}

/// Distribution of a quantity over episodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spread {
    /// Not at all.
    Fixed,
    /// Uniformly, by at most this, in the unit of the quantity.
    Within(f64),
    /// Uniformly, by at most this share of the value.
    Share(f64),
    /// Normally, with this standard deviation, in the unit of the quantity.
    Sigma(f64),
}

/// A quantity in a world file.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// The middle of its distribution: one number, or one for each of a list.
    pub value: Vec<f64>,
    /// Its distribution over episodes; each number of a list is drawn independently.
    pub spread: Spread,
    /// Source of the numbers.
    pub source: String,
}

impl Quantity {
    /// Numbers for one episode. What the distribution puts beyond the limits of the quantity is moved to the
    /// limit.
    pub fn draw(&self, field: &Field, stream: &mut Stream) -> Vec<f64> {
        let mut one = |value: f64| {
            let drawn = match self.spread {
                Spread::Fixed => value,
                Spread::Within(half) => value + stream.symmetric(half),
                Spread::Share(share) => value * (1.0 + stream.symmetric(share)),
                Spread::Sigma(sigma) => value + stream.normal(sigma),
            };
            drawn.clamp(field.least, field.most)
        };
        self.value.iter().map(|value| one(*value)).collect()
    }
}

/// The numbers of an episode: by group and field.
pub(crate) type Numbers = BTreeMap<(&'static str, &'static str), Vec<f64>>;

/// A type that a quantity can have.
pub(crate) trait Value: Sized {
    const FORM: Form;

    /// From the numbers of an episode; `None` when they are of another form.
    fn from_numbers(numbers: &[f64]) -> Option<Self>;
}

impl Value for f64 {
    const FORM: Form = Form::Number;

    fn from_numbers(numbers: &[f64]) -> Option<f64> {
        numbers.first().copied()
    }
}

impl<const N: usize> Value for [f64; N] {
    const FORM: Form = Form::List(N);

    fn from_numbers(numbers: &[f64]) -> Option<[f64; N]> {
        numbers.try_into().ok()
    }
}

/// A range of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Its lower end.
    pub from: f64,
    /// Its upper end.
    pub to: f64,
}

impl Range {
    /// Whether a number lies in it.
    pub fn holds(&self, number: f64) -> bool {
        (self.from..=self.to).contains(&number)
    }
}

impl Value for Range {
    const FORM: Form = Form::Range;

    fn from_numbers(numbers: &[f64]) -> Option<Range> {
        let [from, to] = numbers.try_into().ok()?;
        Some(Range { from, to })
    }
}

/// Declares a group of quantities: each with its type, its unit, the least and the largest value that it may
/// have.
macro_rules! quantities {
    (
        $(#[doc = $about:literal])+
        $group:ident {
            $(
                $(#[doc = $meaning:literal])+
                $field:ident: $type:ty = $unit:literal, $least:literal, $most:literal;
            )+
        }
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, Debug, PartialEq)]
        pub struct $group {
            $(
                $(#[doc = $meaning])+
                #[doc = concat!("\n\nUnit: ", $unit, ".")]
                pub $field: $type,
            )+
        }

        impl $group {
            /// Description of the group.
            pub const ABOUT: &'static str = concat!($($about),+);

            /// Its quantities.
            pub const FIELDS: &'static [$crate::Field] = &[
                $(
                    $crate::Field {
                        name: stringify!($field),
                        unit: $unit,
                        meaning: concat!($($meaning),+),
                        form: <$type as $crate::quantity::Value>::FORM,
                        least: $least,
                        most: $most,
                    },
                )+
            ];

            fn from_numbers(numbers: &$crate::quantity::Numbers, group: &'static str) -> Option<$group> {
                Some($group {
                    $(
                        $field: $crate::quantity::Value::from_numbers(
                            numbers.get(&(group, stringify!($field)))?,
                        )?,
                    )+
                })
            }
        }
    };
}
