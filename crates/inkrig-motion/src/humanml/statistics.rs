//! Means and standard deviations that numbers are brought to the same size by.

use super::features::Blocks;
use crate::{Features, MotionError};

/// Mean and standard deviation of every column.
#[derive(Debug, Clone, PartialEq)]
pub struct Statistics {
    mean: Vec<f32>,
    deviation: Vec<f32>,
}

impl Statistics {
    /// Checks and keeps both.
    ///
    /// # Errors
    /// When they differ in length, a number is not finite, or a deviation is not above 0.
    pub fn new(mean: Vec<f32>, deviation: Vec<f32>) -> Result<Self, MotionError> {
        if mean.len() != deviation.len() || mean.is_empty() {
            let what = "the standard deviations";
            return Err(MotionError::Length { what, expected: mean.len().max(1), got: deviation.len() });
        }
        let bad_mean = mean.iter().position(|value| !value.is_finite());
        let bad_deviation = deviation.iter().position(|value| !(value.is_finite() && *value > 0.0));
        match (bad_mean, bad_deviation) {
            (Some(joint), _) => Err(MotionError::NotFinite { what: "a mean", joint, frame: 0 }),
            (_, Some(joint)) => {
                Err(MotionError::NotFinite { what: "the inverse of a standard deviation", joint, frame: 0 })
            }
            _ => Ok(Self { mean, deviation }),
        }
    }

    /// Those of the rows of several tables: see [`Moments::statistics`].
    ///
    /// # Errors
    /// When there is no table, or they differ in width.
    pub fn of<'a>(tables: impl IntoIterator<Item = &'a Features>) -> Result<Self, MotionError> {
        let mut moments = Moments::default();
        for table in tables {
            moments.add(table)?;
        }
        moments.statistics()
    }

    /// Means, one a column.
    pub fn mean(&self) -> &[f32] {
        &self.mean
    }

    /// Standard deviations, one a column.
    pub fn deviation(&self) -> &[f32] {
        &self.deviation
    }

    /// Brings rows of numbers to mean 0 and deviation 1, in place. What is left over at the end stays.
    pub fn normalise(&self, rows: &mut [f32]) {
        for row in rows.chunks_exact_mut(self.mean.len()) {
            for ((value, mean), deviation) in row.iter_mut().zip(&self.mean).zip(&self.deviation) {
                *value = (*value - mean) / deviation;
            }
        }
    }

    /// The inverse of [`Self::normalise`].
    pub fn restore(&self, rows: &mut [f32]) {
        for row in rows.chunks_exact_mut(self.mean.len()) {
            for ((value, mean), deviation) in row.iter_mut().zip(&self.mean).zip(&self.deviation) {
                *value = *value * deviation + mean;
            }
        }
    }
}

/// Sums over rows, from which statistics come: those of many tables are added up without holding the tables.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Moments {
    count: u64,
    sums: Vec<f64>,
    squares: Vec<f64>,
}

impl Moments {
    /// Adds all rows of a table.
    ///
    /// # Errors
    /// When its width is not that of the tables before it.
    pub fn add(&mut self, table: &Features) -> Result<(), MotionError> {
        self.of_width(table.width())?;
        for frame in 0..table.frames() {
            for ((sum, square), &value) in self.sums.iter_mut().zip(&mut self.squares).zip(table.row(frame)) {
                *sum += f64::from(value);
                *square += f64::from(value) * f64::from(value);
            }
        }
        self.count += table.frames() as u64;
        Ok(())
    }

    /// Adds what was summed up elsewhere.
    ///
    /// # Errors
    /// When the widths differ.
    pub fn merge(&mut self, other: &Self) -> Result<(), MotionError> {
        if other.count == 0 {
            return Ok(());
        }
        self.of_width(other.sums.len())?;
        let add = |to: &mut [f64], from: &[f64]| to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
        add(&mut self.sums, &other.sums);
        add(&mut self.squares, &other.squares);
        self.count += other.count;
        Ok(())
    }

    /// Mean and deviation. For [`WIDTH`](super::WIDTH) columns the deviation is the mean over each of the seven blocks,
    /// as HumanML3D does it. A column that never changes gets a deviation of 1.
    ///
    /// # Errors
    /// When nothing was added.
    pub fn statistics(&self) -> Result<Statistics, MotionError> {
        if self.count == 0 {
            return Err(MotionError::NoFrames);
        }
        let count = self.count as f64;
        let mean: Vec<f64> = self.sums.iter().map(|sum| sum / count).collect();
        let own = self
            .squares
            .iter()
            .zip(&mean)
            .map(|(square, mean)| (square / count - mean * mean).max(0.0).sqrt());
        let mut deviation: Vec<f64> = own.collect();
        if deviation.len() == super::WIDTH {
            for block in Blocks::ALL {
                let columns = &mut deviation[block];
                let shared = columns.iter().sum::<f64>() / columns.len() as f64;
                columns.fill(shared);
            }
        }
        let usable = |value: f64| if value > 1e-8 { value as f32 } else { 1.0 };
        Statistics::new(
            mean.into_iter().map(|value| value as f32).collect(),
            deviation.into_iter().map(usable).collect(),
        )
    }

    fn of_width(&mut self, width: usize) -> Result<(), MotionError> {
        if self.sums.is_empty() {
            self.sums = vec![0.0; width];
            self.squares = vec![0.0; width];
        }
        if width == self.sums.len() {
            return Ok(());
        }
        Err(MotionError::Length { what: "the numbers of a frame", expected: self.sums.len(), got: width })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_to_mean_zero_and_deviation_one_and_back() {
        let table = Features::new(vec![1.0, 5.0, 3.0, 5.0], 2).unwrap();
        let statistics = Statistics::of([&table]).unwrap();
        assert_eq!((statistics.mean(), statistics.deviation()), (&[2.0, 5.0][..], &[1.0, 1.0][..]));
        let mut rows = table.as_slice().to_vec();
        statistics.normalise(&mut rows);
        assert_eq!(rows, [-1.0, 0.0, 1.0, 0.0]);
        statistics.restore(&mut rows);
        assert_eq!(rows, table.as_slice());
        assert!(Statistics::new(vec![0.0], vec![0.0]).is_err());
    }

    #[test]
    fn what_is_summed_up_apart_adds_up() {
        let tables: Vec<Features> =
            (0..4).map(|i| Features::new((0..6).map(|k| (i * k) as f32).collect(), 2).unwrap()).collect();
        let sum = |tables: &[Features]| {
            let mut moments = Moments::default();
            tables.iter().for_each(|table| moments.add(table).unwrap());
            moments
        };
        let mut apart = sum(&tables[..1]);
        apart.merge(&sum(&tables[1..])).unwrap();
        apart.merge(&Moments::default()).unwrap();
        assert_eq!(apart.statistics().unwrap(), Statistics::of(&tables).unwrap());
        assert!(apart.merge(&sum(&[Features::new(vec![1.0], 1).unwrap()])).is_err());
        assert!(Moments::default().statistics().is_err());
    }
}
