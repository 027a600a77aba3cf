//! Drawings of any number of dimensions. Of a CSV its header says what the columns are; without one it is guessed, and
//! what was guessed is said.

use super::csv::{Stop, each_row, is_header};
use super::{Format, read_curve, utf8};
use crate::limits::MAX_BYTES;
use crate::table::is_time;
use crate::{Curve, SketchError, Table, read_table};

/// What was drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum Drawing {
    /// In the plane.
    Plane(Curve),
    /// In as many dimensions as the table has columns.
    Table(Table),
}

/// Reads a drawing from the bytes of a file. Beside it, in a sentence, what was guessed of its columns.
///
/// A CSV whose header names `x` and `y` but no `z` is a curve in the plane; `t`, `time` or `seconds` is its time. With
/// another header of more than two columns, that time aside, it is a curve of as many dimensions. Without a header two
/// columns are x and y. A third is taken for the time when it rises from every row to the next and begins at 0 or above,
/// a fourth then for the pressure of the pen when no value of it is below 0; else all columns are dimensions.
///
/// # Errors
/// As for [`read_curve`] and [`read_table`].
pub fn read_drawing(bytes: &[u8], format: Format) -> Result<(Drawing, Option<String>), SketchError> {
    let columns = match format {
        // The readers say what is wrong with text that is none.
        Format::Csv if bytes.len() <= MAX_BYTES => utf8(bytes).map(Columns::of).unwrap_or_default(),
        _ => Columns::default(),
    };
    if columns.are_dimensions() {
        return Ok((Drawing::Table(read_table(bytes)?), columns.guess()));
    }
    Ok((Drawing::Plane(read_curve(bytes, format)?), columns.guess()))
}

/// What the rows of a CSV look like.
#[derive(Default)]
struct Columns {
    /// Names in small letters.
    header: Option<Vec<String>>,
    /// Fields of the first row of numbers.
    fields: usize,
    /// Whether the third field is a number that rises from 0 or above, and the fourth, if there is one, never below 0.
    is_pen: bool,
}

impl Columns {
    fn of(text: &str) -> Self {
        let mut columns = Self { is_pen: true, ..Self::default() };
        let (mut rows, mut before) = (0_usize, None);
        // What stops the reading stops the reader too, which says where.
        let _ = each_row(text, &SketchError::TooManyPoints, |row| {
            rows += 1;
            if rows == 1 && is_header(row) {
                columns.header = Some(row.iter().map(str::to_lowercase).collect());
                return Ok::<(), Stop>(());
            }
            if columns.fields == 0 {
                columns.fields = crate::table::field_count(row);
            }
            let number = |field: usize| row.get(field).and_then(|field| field.parse::<f64>().ok());
            let seconds = number(2);
            let rises = seconds.is_some_and(|now| now >= 0.0 && before.is_none_or(|before| now > before));
            columns.is_pen &= rises && (columns.fields < 4 || number(3).is_some_and(|value| value >= 0.0));
            before = seconds;
            Ok(())
        });
        columns
    }

    fn are_dimensions(&self) -> bool {
        match &self.header {
            Some(names) => {
                let has = |wanted: &str| names.iter().any(|name| name == wanted);
                let values = names.iter().filter(|name| !name.is_empty() && !is_time(name)).count();
                values > 2 && !(has("x") && has("y") && !has("z"))
            }
            None => self.fields > 4 || self.fields > 2 && !self.is_pen,
        }
    }

    fn guess(&self) -> Option<String> {
        if self.header.is_some() || self.fields <= 2 {
            return None;
        }
        Some(if self.are_dimensions() {
            format!(
                "it was taken as a curve of {} dimensions, since its third column does not rise as time does; a first line \
                 `x,y,t` makes that column the time, in seconds",
                self.fields
            )
        } else {
            "its third column rises and was taken as time in seconds; a first line `x,y,z` makes it a third dimension"
                .to_string()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Dimensions, whether there is time, whether something was guessed.
    fn read(text: &str) -> (usize, bool, bool) {
        let (drawing, guess) = read_drawing(text.as_bytes(), Format::Csv).unwrap();
        match drawing {
            Drawing::Plane(curve) => (2, curve.seconds().is_some(), guess.is_some()),
            Drawing::Table(table) => (table.width(), table.seconds().is_some(), guess.is_some()),
        }
    }

    #[test]
    fn a_header_says_what_columns_are() {
        for (text, told) in [
            ("x,y\n0,0\n1,1\n", (2, false)),
            ("x,y,t\n0,0,0\n1,1,1\n", (2, true)),
            ("x,y,seconds\n0,0,0\n1,1,1\n", (2, true)),
            ("x,y,z\n0,0,0\n1,1,1\n", (3, false)),
            ("X,Y,Z,time\n0,0,0,0\n1,1,1,1\n", (3, true)),
            ("left,right,up\n0,0,0\n1,1,1\n", (3, false)),
            ("time,pressure,x,y\n0,1,0,0\n1,1,1,0\n", (2, true)),
            ("\"Y\",label,\"X\"\n1,a,0\n2,b,3\n", (2, false)),
        ] {
            assert_eq!(read(text), (told.0, told.1, false), "{text:?}");
        }
        // The depth itself is there.
        let (drawing, _) = read_drawing(b"x,y,z\n0,0,5\n1,1,7\n", Format::Csv).unwrap();
        assert!(matches!(drawing, Drawing::Table(table) if table.values() == [0.0, 0.0, 5.0, 1.0, 1.0, 7.0]));
    }

    #[test]
    fn without_a_header_it_is_guessed_and_said() {
        for (text, told) in [
            ("0,0\n1,1\n", (2, false, false)),
            ("0,1,\n2,-3.5,\n", (2, false, false)),
            ("0,0,0\n1,1,0.5\n", (2, true, true)),
            ("0,0,0,1\n1,1,0.5,0.2\n", (2, true, true)),
            ("0,0,0,1\n1,1,0.5,-0.2\n", (4, false, true)),
            ("0,0,-1\n1,1,0.5\n", (3, false, true)),
            ("0,0,0\n1,1,1\n2,2,1\n", (3, false, true)),
            ("0,0,0\n1,1,1\n2,2,0.5\n", (3, false, true)),
            ("0,0,0,1,2\n1,1,1,1,2\n", (5, false, true)),
        ] {
            assert_eq!(read(text), told, "{text:?}");
        }
        let (_, guess) = read_drawing(b"0,0,0\n1,1,1\n", Format::Csv).unwrap();
        assert!(guess.unwrap().contains("x,y,z"));
        assert!(read_drawing(b"0,0,0\n1,1,?\n", Format::Csv).is_err());
        assert!(read_drawing(b"\xff", Format::Csv).is_err());
    }
}
