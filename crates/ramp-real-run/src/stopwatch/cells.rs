//! Rows and cells, and checks of their content.

use std::ops::Range;

use ramp_kit::source::{A_NAME, Fault, MAX_TITLE, is_name, is_text, nearest, shorten};
use ramp_robot::Track;

use super::separator::Separator;
use super::{CsvCell, Head, LONGEST, LogProblem, Read, Reader};

impl Reader<'_> {
    /// All non-empty rows, without empty cells at their ends.
    pub(super) fn rows(&self) -> Read<Vec<Vec<CsvCell>>> {
        let whole = self.file.text();
        let separator = Separator::of(whole);
        let begin = separator.begin;
        let text = &whole[begin..];
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .delimiter(separator.byte)
            .flexible(true)
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(text.as_bytes());
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| {
                let at = begin + error.position().map_or(0, |it| it.byte() as usize);
                self.fault(at..at, "this is not CSV".to_string(), "here", Some(error.to_string()))
            })?;
            let mut from = record.position().map_or(0, |it| it.byte() as usize);
            let mut row: Vec<CsvCell> = Vec::new();
            for field in &record {
                // A quoted cell that contains quotes is not found literally; its row is.
                let at = text.get(from..).and_then(|rest| rest.find(field)).map_or(from, |at| from + at);
                let span = begin + at..begin + at + field.len();
                let cell = CsvCell { text: field.to_string(), span };
                if !is_text(field, MAX_TITLE) {
                    let words = format!("found `{}`", shorten(field));
                    let expected =
                        format!("expected at most {MAX_TITLE} characters and no control character");
                    return Err(self.fault(cell.span, words, &expected, None));
                }
                row.push(cell);
                from = at + field.len();
            }
            while row.last().is_some_and(|cell| cell.text.is_empty()) {
                row.pop();
            }
            if !row.is_empty() {
                rows.push(row);
            }
        }
        Ok(rows)
    }

    pub(super) fn fault(
        &self,
        span: Range<usize>,
        found: String,
        expected: &str,
        help: Option<String>,
    ) -> Fault<LogProblem> {
        let problem = LogProblem::Entry { found, expected: expected.to_string(), help };
        Fault::new(problem, self.file.place(span))
    }

    /// The head's value of `name`.
    pub(super) fn entry<'h>(&self, head: &'h Head, name: &str) -> Read<&'h CsvCell> {
        match head.entries.iter().find(|(known, _)| known.text == name) {
            Some((_, value)) => Ok(value),
            None => {
                let near = nearest(name, head.entries.iter().map(|(known, _)| known.text.as_str()));
                Err(self.fault(
                    head.end..head.end,
                    format!("nothing above the table says `{name}`"),
                    &format!("expected a line such as `{name},…`"),
                    near.map(|near| format!("is `{near}` meant to be it?")),
                ))
            }
        }
    }

    pub(super) fn text(&self, head: &Head, name: &str) -> Read<String> {
        Ok(self.entry(head, name)?.text.clone())
    }

    /// The head's value of `name`, which must be a valid name.
    pub(super) fn name(&self, head: &Head, name: &str) -> Read<String> {
        let cell = self.entry(head, name)?;
        if is_name(&cell.text) {
            return Ok(cell.text.clone());
        }
        let words = format!("the {name} is `{}`", shorten(&cell.text));
        Err(self.fault(cell.span.clone(), words, &format!("expected {A_NAME}"), None))
    }

    pub(super) fn track(&self, head: &Head) -> Read<String> {
        let cell = self.entry(head, "track")?;
        let names = Track::ALL.map(Track::name);
        if names.contains(&cell.text.as_str()) {
            return Ok(cell.text.clone());
        }
        let words = format!("there is no track `{}`", shorten(&cell.text));
        Err(self.fault(cell.span.clone(), words, &format!("expected {}", names.join(", ")), None))
    }

    /// The first row of the table must name its columns.
    pub(super) fn check_columns<'t>(
        &self,
        table: &'t [Vec<CsvCell>],
        columns: &[&str],
    ) -> Read<&'t [Vec<CsvCell>]> {
        let end = self.file.text().len();
        let Some((first, rows)) = table.split_first() else {
            let words = "there is no table".to_string();
            return Err(self.fault(end..end, words, &format!("expected {}", columns.join(",")), None));
        };
        for (index, name) in columns.iter().enumerate() {
            if first.get(index).is_none_or(|cell| cell.text != *name) {
                let at = first.get(index).or(first.last()).map_or(0..0, |cell| cell.span.clone());
                let words = format!("column {} of the table is not `{name}`", index + 1);
                return Err(self.fault(at, words, &format!("expected {}", columns.join(",")), None));
            }
        }
        if rows.is_empty() {
            return Err(self.fault(end..end, "the table is empty".to_string(), "expected a line", None));
        }
        for row in rows {
            if let Some(cell) = row.get(columns.len()) {
                let words = format!("this line has {} cells", row.len());
                let expected = format!("expected {} at most", columns.len());
                let character = char::from(Separator::of(self.file.text()).byte).escape_default();
                let help = format!("a `{character}` inside a cell needs the cell in quotation marks");
                return Err(self.fault(cell.span.clone(), words, &expected, Some(help)));
            }
        }
        Ok(rows)
    }

    /// A cell of a row; empty if the row is too short.
    pub(super) fn cell(&self, row: &[CsvCell], column: usize) -> CsvCell {
        let end = row.last().map_or(0, |cell| cell.span.end);
        row.get(column).cloned().unwrap_or(CsvCell { text: String::new(), span: end..end })
    }

    pub(super) fn number(&self, cell: &CsvCell, name: &str, low: f64, high: f64) -> Read<f64> {
        let value: Option<f64> = self.with_point(cell)?.parse().ok();
        match value {
            Some(value) if (low..=high).contains(&value) => Ok(value),
            _ => Err(self.fault(
                cell.span.clone(),
                format!("`{name}` is `{}`", shorten(&cell.text)),
                &format!("expected a number from {low} to {high}"),
                None,
            )),
        }
    }

    pub(super) fn count(&self, cell: &CsvCell, name: &str, highest: u32) -> Read<u32> {
        match cell.text.parse() {
            Ok(value) if (1..=highest).contains(&value) => Ok(value),
            _ => Err(self.fault(
                cell.span.clone(),
                format!("`{name}` is `{}`", shorten(&cell.text)),
                &format!("expected a whole number from 1 to {highest}"),
                None,
            )),
        }
    }

    /// The text of a number with a decimal point, also where it is written with a comma.
    fn with_point(&self, cell: &CsvCell) -> Read<String> {
        let after = cell.text.split_once(',').map(|(_, after)| after);
        // Where commas separate cells, three digits after one may be a group of thousands.
        if Separator::of(self.file.text()).byte == b',' && after.is_some_and(|after| after.len() == 3) {
            let words = format!("the comma in `{}` may be a decimal comma or separate thousands", cell.text);
            let help = "write the number with a decimal point".to_string();
            return Err(self.fault(cell.span.clone(), words, "expected one meaning", Some(help)));
        }
        Ok(if cell.text.contains('.') { cell.text.clone() } else { cell.text.replacen(',', ".", 1) })
    }

    /// Seconds, `m:ss` or `h:mm:ss`.
    pub(super) fn seconds(&self, cell: &CsvCell) -> Read<f64> {
        let bad = |help: &str| {
            let words = format!("the time is `{}`", shorten(&cell.text));
            Err(self.fault(
                cell.span.clone(),
                words,
                "expected seconds, such as 75.2, or 1:15.2, from 0",
                Some(help.to_string()).filter(|help| !help.is_empty()),
            ))
        };
        let text = self.with_point(cell)?;
        let parts: Vec<&str> = text.split(':').collect();
        if parts.len() > 3 {
            return bad("");
        }
        let mut total = 0.0;
        for (index, part) in parts.iter().enumerate() {
            let plain = part.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
            let Some(value) = part.parse::<f64>().ok().filter(|_| plain) else {
                return bad(if part.starts_with('-') { "no time is negative" } else { "" });
            };
            if index > 0 && value >= 60.0 {
                return bad("an hour has 60 minutes, and a minute 60 seconds");
            }
            if index + 1 < parts.len() && value.fract() != 0.0 {
                return bad("only seconds have decimals");
            }
            total = 60.0 * total + value;
        }
        if total > LONGEST { bad("") } else { Ok(total) }
    }
}
