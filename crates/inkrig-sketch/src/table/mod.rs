//! Numbers over time with any number of columns: curves of more than two dimensions, waves, what a sensor recorded.

mod file;
mod read;
mod resample;

pub(crate) use file::{located, text_of};
pub use read::read_table;
pub(crate) use read::{field_count, is_time};

use crate::SketchError;
use crate::limits::{MAX_FRAMES, MAX_MAGNITUDE};

/// Most columns of a table, without its time.
pub const MAX_TABLE_WIDTH: usize = 256;
/// Most numbers of a table or of one-hot labels, rows times columns (128 MB as `f64`).
pub const MAX_CONTROL_VALUES: usize = 16_000_000;

/// Rows of numbers over time: 2 to [`MAX_FRAMES`] rows of 1 to [`MAX_TABLE_WIDTH`] columns.
///
/// Every value is finite and at most [`MAX_MAGNITUDE`]; at least two rows differ. Times, where there are any, are in
/// seconds, never go back, advance at least once, and start at 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    what: &'static str,
    names: Vec<String>,
    width: usize,
    values: Vec<f64>,
    seconds: Option<Vec<f64>>,
}

impl Table {
    /// Number of columns, without the time.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    pub fn row_count(&self) -> usize {
        self.values.len() / self.width
    }

    /// All numbers, row after row: rows x width.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The columns' names, `width` of them, or none where the file had no header.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Time of each row in seconds from the first, or `None` where the file gave none.
    pub fn seconds(&self) -> Option<&[f64]> {
        self.seconds.as_deref()
    }

    /// Time from the first row to the last, in seconds, where the file gave times.
    pub fn duration(&self) -> Option<f64> {
        self.seconds.as_ref().and_then(|seconds| seconds.last().copied())
    }

    /// How many frames the table is of itself at a rate, in frames a second.
    ///
    /// d seconds make `round(d * rate) + 1` frames; n rows without time are n frames. Never more than [`MAX_FRAMES`].
    pub fn frame_count(&self, rate: f64) -> usize {
        let Some(duration) = self.duration() else {
            return self.row_count();
        };
        (duration * rate).round().clamp(0.0, (MAX_FRAMES - 1) as f64) as usize + 1
    }

    /// Brings the table to `frames` rows at equal steps of time, with straight lines between its rows: frames x width.
    ///
    /// The first frame is the first row and, for two frames or more, the last frame is the last row. As many frames as
    /// rows, without times, are the rows unchanged. There is no low pass: where there are many more rows than frames,
    /// [`crate::smooth`] what moves faster than the frames.
    ///
    /// # Errors
    /// [`SketchError::FrameCount`] for no frame or more than [`MAX_FRAMES`]; [`SketchError::TooManyValues`] where frames
    /// times width is above [`MAX_CONTROL_VALUES`].
    pub fn resample(&self, frames: usize) -> Result<Vec<f64>, SketchError> {
        self.at(frames, self.seconds.as_deref())
    }

    /// As [`Self::resample`], at equal steps of the way through its rows instead of time.
    ///
    /// # Errors
    /// As for [`Self::resample`].
    pub fn resample_evenly(&self, frames: usize) -> Result<Vec<f64>, SketchError> {
        let mut way = 0.0;
        let steps = self.steps().map(|step| {
            way += step;
            way
        });
        let places: Vec<f64> = std::iter::once(0.0).chain(steps).collect();
        self.at(frames, Some(&places))
    }

    /// Whether the last row is where the first is, nearer than half of an ordinary step: a loop.
    pub fn repeats_its_first(&self) -> bool {
        let steps = self.row_count().saturating_sub(1).max(1) as f64;
        let (first, last) =
            (self.values.iter().take(self.width), self.values.iter().rev().take(self.width).rev());
        let apart = first.zip(last).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        apart < 0.5 * self.steps().sum::<f64>() / steps
    }

    /// How far it is from every row to the next.
    fn steps(&self) -> impl Iterator<Item = f64> + '_ {
        let rows = self.values.chunks_exact(self.width);
        let pairs = rows.clone().zip(rows.skip(1));
        pairs.map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt())
    }

    fn at(&self, frames: usize, places: Option<&[f64]>) -> Result<Vec<f64>, SketchError> {
        if frames == 0 || frames > MAX_FRAMES {
            return Err(SketchError::FrameCount { frames });
        }
        if frames * self.width > MAX_CONTROL_VALUES {
            return Err(SketchError::TooManyValues { what: self.what });
        }
        Ok(resample::at_equal_steps(&self.values, self.width, places, frames))
    }
}

/// A table in the making. Its readers go through it row by row.
#[derive(Debug)]
pub(crate) struct TableBuilder {
    what: &'static str,
    names: Vec<String>,
    width: usize,
    rows: usize,
    values: Vec<f64>,
    seconds: Vec<f64>,
}

/// Why a number was refused; the reader adds the place in its file.
#[derive(Debug)]
pub(crate) enum Refusal {
    Full(SketchError),
    Wrong(String),
}

impl TableBuilder {
    /// `what` names the table in messages; there are `width` columns, at least one.
    pub(crate) fn new(what: &'static str, width: usize, names: Vec<String>) -> Self {
        Self { what, names, width: width.max(1), rows: 0, values: Vec::new(), seconds: Vec::new() }
    }

    /// Number of rows that are complete.
    pub(crate) fn row_count(&self) -> usize {
        self.values.len() / self.width
    }

    /// Begins a row, to be filled with `width` numbers. Either all rows have a time or none.
    pub(crate) fn begin_row(&mut self, time: Option<f64>) -> Result<(), Refusal> {
        if self.rows >= MAX_FRAMES {
            return Err(Refusal::Full(SketchError::TooManyRows { what: self.what }));
        }
        if (self.rows + 1) * self.width > MAX_CONTROL_VALUES {
            return Err(Refusal::Full(SketchError::TooManyValues { what: self.what }));
        }
        if let Some(time) = time {
            check("t", time).map_err(Refusal::Wrong)?;
            if let Some(previous) = self.seconds.last().filter(|&&previous| time < previous) {
                return Err(Refusal::Wrong(format!(
                    "time goes back from {previous} s to {time} s; t is in seconds and never falls"
                )));
            }
            self.seconds.push(time);
        }
        self.rows += 1;
        Ok(())
    }

    pub(crate) fn push(&mut self, name: &str, value: f64) -> Result<(), Refusal> {
        check(name, value).map_err(Refusal::Wrong)?;
        self.values.push(value);
        Ok(())
    }

    /// The same table with rows at equal steps of a rate, in rows a second.
    pub(crate) fn finish_at_rate(mut self, rate: f64) -> Result<Table, SketchError> {
        self.seconds = (0..self.rows).map(|row| row as f64 / rate).collect();
        self.finish()
    }

    pub(crate) fn finish(mut self) -> Result<Table, SketchError> {
        let (what, rows) = (self.what, self.rows);
        if rows < 2 {
            return Err(SketchError::TooFewRows { what, rows });
        }
        let mut kept = self.values.chunks_exact(self.width);
        let first = kept.next().unwrap_or_default();
        if kept.all(|row| row == first) {
            return Err(SketchError::Still { what, rows });
        }
        let start = self.seconds.first().copied().unwrap_or(0.0);
        for time in &mut self.seconds {
            *time -= start;
        }
        let seconds = (!self.seconds.is_empty()).then_some(self.seconds);
        if seconds.as_ref().is_some_and(|seconds| seconds.last().is_none_or(|&duration| duration <= 0.0)) {
            return Err(SketchError::TimeStands { what });
        }
        Ok(Table { what, names: self.names, width: self.width, values: self.values, seconds })
    }
}

fn check(name: &str, value: f64) -> Result<(), String> {
    if value.is_finite() && value.abs() <= MAX_MAGNITUDE {
        Ok(())
    } else {
        Err(format!("{name} is {value:e}; a finite number of at most {MAX_MAGNITUDE:e} is expected"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: &[(Option<f64>, f64)]) -> Result<Table, SketchError> {
        let mut builder = TableBuilder::new("table", 1, Vec::new());
        for &(time, value) in rows {
            builder.begin_row(time).unwrap();
            builder.push("value", value).unwrap();
        }
        builder.finish()
    }

    #[test]
    fn rows_without_time_are_frames() {
        let table = table(&[(None, 0.0), (None, 3.0), (None, 1.0)]).unwrap();
        assert_eq!((table.row_count(), table.width(), table.duration()), (3, 1, None));
        assert_eq!(table.frame_count(30.0), 3);
        assert_eq!(table.resample(3).unwrap(), [0.0, 3.0, 1.0]);
    }

    #[test]
    fn times_begin_at_zero_and_set_the_length() {
        let table = table(&[(Some(5.0), 0.0), (Some(5.5), 1.0), (Some(7.0), 0.0)]).unwrap();
        assert_eq!(table.seconds(), Some([0.0, 0.5, 2.0].as_slice()));
        assert_eq!(table.frame_count(30.0), 61);
        assert_eq!(table.frame_count(f64::INFINITY), MAX_FRAMES);
        assert_eq!(table.frame_count(f64::NAN), 1);
    }

    #[test]
    fn what_cannot_be_followed_is_refused() {
        assert_eq!(table(&[]), Err(SketchError::TooFewRows { what: "table", rows: 0 }));
        assert_eq!(table(&[(None, 1.0)]), Err(SketchError::TooFewRows { what: "table", rows: 1 }));
        assert_eq!(table(&[(None, 1.0); 4]), Err(SketchError::Still { what: "table", rows: 4 }));
        let stands = table(&[(Some(1.0), 0.0), (Some(1.0), 1.0)]);
        assert_eq!(stands, Err(SketchError::TimeStands { what: "table" }));
        let two = table(&[(None, 0.0), (None, 1.0)]).unwrap();
        assert_eq!(two.resample(0), Err(SketchError::FrameCount { frames: 0 }));
        assert_eq!(two.resample(usize::MAX), Err(SketchError::FrameCount { frames: usize::MAX }));
    }

    #[test]
    fn rows_and_numbers_have_limits() {
        let mut wide = TableBuilder::new("table", 256, Vec::new());
        wide.rows = MAX_CONTROL_VALUES / 256;
        assert!(matches!(wide.begin_row(None), Err(Refusal::Full(SketchError::TooManyValues { .. }))));
        let mut long = TableBuilder::new("table", 1, Vec::new());
        long.rows = MAX_FRAMES;
        assert!(matches!(long.begin_row(None), Err(Refusal::Full(SketchError::TooManyRows { .. }))));
        let mut values = TableBuilder::new("table", 1, Vec::new());
        for value in [f64::NAN, f64::INFINITY, -2e15] {
            assert!(matches!(values.push("value", value), Err(Refusal::Wrong(_))), "{value}");
        }
    }
}
