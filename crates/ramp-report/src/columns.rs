//! Tables of a page. On a narrow screen each row becomes a list, in which every value stands beside the
//! heading of its column.

use maud::{Markup, html};

/// Content of a column, which decides how it is aligned.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Number,
    Name,
    Sentences,
}

/// A column.
#[derive(Clone, Copy)]
pub(crate) struct Column<'a> {
    heading: &'a str,
    /// Unit or remark below the heading; may be empty.
    unit: &'a str,
    kind: Kind,
}

/// A column of numbers, with their unit.
pub(crate) const fn number<'a>(heading: &'a str, unit: &'a str) -> Column<'a> {
    Column { heading, unit, kind: Kind::Number }
}

/// A column of names.
pub(crate) const fn name(heading: &str) -> Column<'_> {
    Column { heading, unit: "", kind: Kind::Name }
}

/// A column of sentences.
pub(crate) const fn sentences(heading: &str) -> Column<'_> {
    Column { heading, unit: "", kind: Kind::Sentences }
}

impl<'a> Column<'a> {
    /// With a remark below its heading.
    pub(crate) const fn with(mut self, remark: &'a str) -> Column<'a> {
        self.unit = remark;
        self
    }

    fn class(self) -> Option<&'static str> {
        match self.kind {
            Kind::Number => None,
            Kind::Name => Some("name"),
            Kind::Sentences => Some("long"),
        }
    }

    /// Heading and unit in one line.
    fn label(self) -> String {
        if self.unit.is_empty() {
            self.heading.to_string()
        } else {
            format!("{}, {}", self.heading, self.unit)
        }
    }
}

/// A row: a cell for each column.
pub(crate) struct Row {
    pub(crate) cells: Vec<Markup>,
    /// Whether it sums up the rows above it.
    pub(crate) is_sum: bool,
}

impl From<Vec<Markup>> for Row {
    fn from(cells: Vec<Markup>) -> Row {
        Row { cells, is_sum: false }
    }
}

/// A table with a line of headings.
pub(crate) fn table<R: Into<Row>>(columns: &[Column<'_>], rows: impl IntoIterator<Item = R>) -> Markup {
    html! {
        div.wide {
            table.rows {
                thead { tr {
                    @for it in columns {
                        th class=[it.class()] { (it.heading) @if !it.unit.is_empty() { small { (it.unit) } } }
                    }
                } }
                tbody {
                    @for Row { cells, is_sum } in rows.into_iter().map(Into::into) {
                        tr.sum[is_sum] {
                            @for (column, cell) in columns.iter().zip(cells) {
                                td class=[column.class()] data-label=(column.label()) {
                                    @if !cell.0.is_empty() { div { (cell) } }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}
