//! Curves in CSV: rows `x,y[,t[,pressure]]`, header optional.

use std::borrow::Cow;

use csv::{ReaderBuilder, StringRecord, Trim};

use crate::builder::{CurveBuilder, Refusal, Sample};
use crate::limits::MAX_POINTS;
use crate::table::is_time;
use crate::{Curve, Origin, SketchError};

/// Delimiters that a file may hold for each point that it may hold: bounds what one row can make us allocate.
const FIELDS_PER_POINT: usize = 16;

pub(super) fn read(text: &str) -> Result<Curve, SketchError> {
    let mut builder = CurveBuilder::default();
    let mut columns = None;
    each_row(text, &SketchError::TooManyPoints, |row| {
        let columns = match &columns {
            Some(columns) => columns,
            None if is_header(row) => {
                columns = Some(Columns::from_header(row)?);
                return Ok(());
            }
            None => &*columns.insert(Columns::PLAIN),
        };
        builder.push(columns.sample(row)?).map_err(|refusal| match refusal {
            Refusal::Full => Stop::Whole(SketchError::TooManyPoints),
            Refusal::Wrong(_, problem) => Stop::At(1, problem),
        })
    })?;
    builder.finish(Origin::Sampled)
}

/// Why the reading of rows ends early.
pub(crate) enum Stop {
    /// Field, counted from 1, and what is wrong with it.
    At(usize, String),
    /// The file as a whole.
    Whole(SketchError),
}

impl From<Wrong> for Stop {
    fn from((column, problem): Wrong) -> Self {
        Self::At(column, problem)
    }
}

/// Hands over each row that is not empty, header included, with its fields trimmed.
///
/// A file with more fields than we take in any case ends in `full` before they are read.
pub(crate) fn each_row(
    text: &str,
    full: &SketchError,
    mut take: impl FnMut(&StringRecord) -> Result<(), Stop>,
) -> Result<(), SketchError> {
    // The reader ends a comment at a line feed only.
    let text = &*if text.contains('\r') {
        Cow::from(text.replace("\r\n", "\n").replace('\r', "\n"))
    } else {
        Cow::from(text)
    };
    let delimiter = sniff_delimiter(text);
    if text.bytes().filter(|&byte| byte == delimiter).count() > FIELDS_PER_POINT * MAX_POINTS {
        return Err(full.clone());
    }
    let mut rows = ReaderBuilder::new()
        .delimiter(delimiter)
        .has_headers(false)
        .flexible(true)
        .comment(Some(b'#'))
        .trim(Trim::All)
        .from_reader(text.as_bytes());
    let mut row = StringRecord::new();
    loop {
        let start = rows.position().byte();
        let at = |column, problem| SketchError::Csv { line: line_of_row(text, start), column, problem };
        if !rows.read_record(&mut row).map_err(|error| at(1, error.to_string()))? {
            return Ok(());
        }
        if row.iter().all(str::is_empty) && row.len() == 1 {
            continue;
        }
        take(&row).map_err(|stop| match stop {
            Stop::At(column, problem) => at(column, problem),
            Stop::Whole(error) => error,
        })?;
    }
}

/// The line of the row whose reading began at a byte; the reader then skipped empty lines and comments.
fn line_of_row(text: &str, start: u64) -> u64 {
    let start = usize::try_from(start).unwrap_or(usize::MAX);
    let (before, after) = text.split_at_checked(start).unwrap_or((text, ""));
    let skipped = after.lines().take_while(|line| line.is_empty() || line.starts_with('#'));
    (1 + before.matches('\n').count() + skipped.count()) as u64
}

/// Field, counted from 1, and what is wrong with it.
pub(crate) type Wrong = (usize, String);

/// The delimiter of the first line that is neither empty nor a comment.
fn sniff_delimiter(text: &str) -> u8 {
    let mut lines = text.lines();
    let line = lines.find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or_default();
    [b'\t', b';'].into_iter().find(|delimiter| line.as_bytes().contains(delimiter)).unwrap_or(b',')
}

/// A first row without any number is a header.
pub(crate) fn is_header(row: &StringRecord) -> bool {
    row.iter().any(|field| !field.is_empty())
        && row.iter().all(|field| field.parse::<f64>().is_err())
        && row.iter().any(|field| field.starts_with(char::is_alphabetic))
}

/// Which field is what, counted from 0.
struct Columns {
    x: usize,
    y: usize,
    seconds: Option<usize>,
    pressure: Option<usize>,
}

impl Columns {
    const PLAIN: Self = Self { x: 0, y: 1, seconds: Some(2), pressure: Some(3) };

    fn from_header(header: &StringRecord) -> Result<Self, Wrong> {
        let (mut x, mut y, mut seconds, mut pressure) = (None, None, None, None);
        for (column, name) in header.iter().enumerate() {
            let place = match name.to_lowercase().as_str() {
                "x" => &mut x,
                "y" => &mut y,
                name if is_time(name) => &mut seconds,
                "pressure" => &mut pressure,
                "z" => {
                    return Err((
                        column + 1,
                        "z makes a third dimension, and a plane has two; leave z out".into(),
                    ));
                }
                _ => continue,
            };
            if place.replace(column).is_some() {
                return Err((column + 1, format!("a second column is named {name:?}")));
            }
        }
        match (x, y) {
            (Some(x), Some(y)) => Ok(Self { x, y, seconds, pressure }),
            _ => Err((1, "the header names no columns x and y; name them, or leave the header out".into())),
        }
    }

    fn sample(&self, row: &StringRecord) -> Result<Sample, Wrong> {
        let number = |column: usize, name: &str| number(row, column, name);
        let required = |column: usize, name: &str| {
            number(column, name)?.ok_or_else(|| (column + 1, format!("{name} is missing; a row is x,y[,t]")))
        };
        Ok(Sample {
            point: [required(self.x, "x")?, required(self.y, "y")?],
            seconds: self.seconds.map_or(Ok(None), |column| number(column, "t"))?,
            pressure: self.pressure.map_or(Ok(None), |column| number(column, "pressure"))?,
        })
    }
}

/// The finite number in a field, counted from 0; `None` where the field is missing or empty.
pub(crate) fn number(row: &StringRecord, column: usize, name: &str) -> Result<Option<f64>, Wrong> {
    match row.get(column) {
        None | Some("") => Ok(None),
        Some(field) => match field.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Some(value)),
            _ => Err((column + 1, not_a_number(field, name))),
        },
    }
}

fn not_a_number(field: &str, name: &str) -> String {
    let shown: String = field.chars().take(40).collect();
    let hint = if field.contains(',') {
        "; write decimals with a point"
    } else if field.contains(char::is_whitespace) {
        "; separate numbers with comma, semicolon or tab"
    } else {
        ""
    };
    format!("{name} is {shown:?}, not a finite number{hint}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separators_comments_and_line_ends_are_read() {
        let plain = [[0.0, 1.0], [2.0, -3.5]];
        for text in [
            "0,1\n2,-3.5\n",
            "# drawn by hand\r\n0;1\r\n\r\n2; -3.5",
            "0\t1\r2\t-3.5\r",
            "x,y\n0,1\n# half way\n2,-3.5\n",
            "\"Y\",label,\"X\"\n1,\"a, b\",0\n-3.5,c,2\n",
            "0,1,\n2,-3.5,\n",
        ] {
            assert_eq!(read(text).unwrap().points(), plain, "{text:?}");
        }
    }

    #[test]
    fn rows_are_found_again_whatever_ends_a_line() {
        for end in ["\n", "\r\n", "\r"] {
            let text = ["# a", "x,y", "", "0,0", "# b", "  ", "1,?", "2,2", ""].join(end);
            let message = read(&text).unwrap_err().to_string();
            assert!(message.starts_with("CSV, line 7, column 2: y is \"?\""), "{end:?} {message}");
            let message = read(&["0,0", "1,1", "2"].join(end)).unwrap_err().to_string();
            assert!(message.starts_with("CSV, line 3, column 2: y is missing"), "{end:?} {message}");
        }
    }

    #[test]
    fn time_and_pressure_are_read() {
        let curve = read("time,pressure,x,y\n3,0.5,0,0\n4.5,1,1,0\n").unwrap();
        assert_eq!(curve.seconds(), Some([0.0, 1.5].as_slice()));
        assert_eq!(curve.pressure(), Some([0.5, 1.0].as_slice()));
        let curve = read("0,0,0\n1,0,0.25\n").unwrap();
        assert_eq!(curve.seconds(), Some([0.0, 0.25].as_slice()));
    }
}
