//! Tables in CSV: a row for each frame, header optional.

use csv::StringRecord;

use super::{MAX_TABLE_WIDTH, Refusal, Table, TableBuilder, text_of};
use crate::SketchError;
use crate::read::csv::{Stop, Wrong, each_row, is_header, number};

const WHAT: &str = "table";

/// Reads a curve of any dimension from the bytes of a CSV file: one row for each frame.
///
/// Fields are separated by comma, semicolon or tab; `#` begins a comment line; a byte order mark is skipped. A first row
/// without any number is a header. A column that it names `t`, `time` or `seconds` is the time in seconds and no dimension.
///
/// # Errors
/// Any [`SketchError`] that says what the file holds and where: too large, not UTF-8, fewer than two rows, more than
/// [`MAX_TABLE_WIDTH`] columns, rows of other widths, values that are not finite, times that go back, nothing that moves.
pub fn read_table(bytes: &[u8]) -> Result<Table, SketchError> {
    let text = text_of(bytes, WHAT)?;
    let mut reader: Option<Reader> = None;
    each_row(text, &SketchError::TooManyValues { what: WHAT }, |row| match &mut reader {
        Some(reader) => reader.push(row),
        None if is_header(row) => {
            reader = Some(Reader::from_header(row)?);
            Ok(())
        }
        None => reader.insert(Reader::plain(row)?).push(row),
    })?;
    match reader {
        Some(reader) => reader.builder.finish(),
        None => Err(SketchError::TooFewRows { what: WHAT, rows: 0 }),
    }
}

/// Number of fields, without empty ones at the end of the row.
pub(crate) fn field_count(row: &StringRecord) -> usize {
    row.as_byte_record().iter().rposition(|field| !field.is_empty()).map_or(0, |last| last + 1)
}

/// Which name stands for the time.
pub(crate) fn is_time(name: &str) -> bool {
    ["t", "time", "seconds"].iter().any(|time| name.eq_ignore_ascii_case(time))
}

impl From<(usize, Refusal)> for Stop {
    fn from((column, refusal): (usize, Refusal)) -> Self {
        match refusal {
            Refusal::Full(error) => Self::Whole(error),
            Refusal::Wrong(problem) => Self::At(column, problem),
        }
    }
}

struct Reader {
    builder: TableBuilder,
    /// Fields of a row, the time included.
    fields: usize,
    /// The field that holds the time, counted from 0.
    time: Option<usize>,
    names: Vec<String>,
}

impl Reader {
    fn plain(row: &StringRecord) -> Result<Self, Wrong> {
        let fields = checked_width(field_count(row).max(1))?;
        let names = (1..=fields).map(|column| format!("value {column}")).collect();
        Ok(Self { builder: TableBuilder::new(WHAT, fields, Vec::new()), fields, time: None, names })
    }

    fn from_header(row: &StringRecord) -> Result<Self, Wrong> {
        let fields = field_count(row);
        let mut times = row.iter().enumerate().filter(|(_, name)| is_time(name)).map(|(column, _)| column);
        let time = times.next();
        if let Some(second) = times.next() {
            return Err((second + 1, "a second column is named as the time; keep one".into()));
        }
        let names: Vec<String> = row.iter().take(fields).map(str::to_owned).collect();
        let columns = names.iter().filter(|name| !is_time(name)).cloned().collect::<Vec<_>>();
        if columns.is_empty() {
            return Err((1, "the header names no column but the time; add one with values".into()));
        }
        let width = checked_width(columns.len())?;
        Ok(Self { builder: TableBuilder::new(WHAT, width, columns), fields, time, names })
    }

    fn push(&mut self, row: &StringRecord) -> Result<(), Stop> {
        if field_count(row) > self.fields {
            let problem = format!("the row has more fields than the {} of the first row", self.fields);
            return Err(Stop::At(self.fields + 1, problem));
        }
        let required = |column: usize, name: &str| {
            number(row, column, name)?.ok_or_else(|| {
                (column + 1, format!("{name} is missing; each row needs {} fields", self.fields))
            })
        };
        let time = self.time.map(|column| required(column, "t").map(|time| (column, time))).transpose()?;
        let column = time.map_or(1, |(column, _)| column + 1);
        self.builder.begin_row(time.map(|(_, time)| time)).map_err(|refusal| (column, refusal))?;
        for (column, name) in self.names.iter().enumerate() {
            if Some(column) != self.time {
                let value = required(column, name)?;
                self.builder.push(name, value).map_err(|refusal| (column + 1, refusal))?;
            }
        }
        Ok(())
    }
}

fn checked_width(width: usize) -> Result<usize, Wrong> {
    if width <= MAX_TABLE_WIDTH {
        Ok(width)
    } else {
        let problem =
            format!("there are {width} columns; at most {MAX_TABLE_WIDTH} are read. Leave some out");
        Err((MAX_TABLE_WIDTH + 1, problem))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separators_comments_headers_and_line_ends_are_read() {
        for text in [
            "0,1,2\n2,-3.5,4\n",
            "# a\r\n0;1;2\r\n\r\n2; -3.5;4",
            "0\t1\t2\r2\t-3.5\t4\r",
            "left,right,\"up, down\"\n0,1,2\n2,-3.5,4\n",
            "0,1,2,\n2,-3.5,4,\n",
            "a,b,time,c\n0,1,7,2\n2,-3.5,8,4\n",
        ] {
            let table = read_table(text.as_bytes()).unwrap();
            assert_eq!((table.width(), table.row_count()), (3, 2), "{text:?}");
            assert_eq!(table.values(), [0.0, 1.0, 2.0, 2.0, -3.5, 4.0], "{text:?}");
        }
    }

    #[test]
    fn names_and_times_are_kept_apart() {
        let table = read_table(b"T,speed,height\n1,0,0\n1.5,2,1\n").unwrap();
        assert_eq!(table.names(), ["speed", "height"]);
        assert_eq!(table.seconds(), Some([0.0, 0.5].as_slice()));
        assert!(read_table(b"0,0\n1,1\n").unwrap().names().is_empty());
    }

    #[test]
    fn the_widest_table_is_read_and_no_wider() {
        let row = |width: usize, value: &str| vec![value; width].join(",");
        let rows = |width| format!("{}\n{}\n", row(width, "0"), row(width, "1"));
        assert_eq!(read_table(rows(256).as_bytes()).unwrap().width(), 256);
        assert!(matches!(
            read_table(rows(257).as_bytes()),
            Err(SketchError::Csv { line: 1, column: 257, .. })
        ));
    }
}
