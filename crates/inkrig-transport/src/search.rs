use crate::parallel::{Chunk, for_blocks, with_threads};
use crate::{Real, Support, TransportError};

/// Finds a support by looking at every entry, a block of rows at a time: for each row the columns of the least scores.
/// Takes O(N M) time, but memory for a block of rows only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// Most columns for each row, at least 1.
    pub keep: usize,
    /// Columns whose score is more than this above the row's least are left out, at least 0: for an entropic plan a few
    /// times epsilon, as an entry's share falls by e with each.
    pub reach: f64,
    /// Threads, of the current rayon pool. The result does not depend on it.
    pub threads: usize,
}

/// Values of a block of scores: small enough for the processor's cache to help, large enough for products.
const BLOCK_VALUES: usize = 1 << 18;

impl Search {
    /// Asks `scores(first, out)` for blocks of rows of scores, as many rows of `cols` as `out` holds, from row `first` on.
    /// `out` comes with values of no meaning. A score that is not finite, or as large as those of forbidden columns in
    /// [`GradientRows`](crate::GradientRows), is never chosen.
    ///
    /// # Errors
    /// As [`Support::from_rows`]; [`TransportError::Parameter`] for a setting out of its range.
    ///
    /// ```
    /// use inkrig_transport::Search;
    /// let search = Search { keep: 3, reach: 1.5, threads: 1 };
    /// // The nearest places on a line.
    /// let support = search.run(5, 100, |first, out: &mut [f32]| {
    ///     for (i, row) in (first..).zip(out.chunks_exact_mut(100)) {
    ///         row.iter_mut().enumerate().for_each(|(j, score)| *score = (20.0 * i as f32 - j as f32).abs());
    ///     }
    /// })?;
    /// assert_eq!((support.row(0), support.row(2)), (&[0, 1][..], &[39, 40, 41][..]));
    /// # Ok::<(), inkrig_transport::TransportError>(())
    /// ```
    pub fn run<T: Real>(
        &self,
        rows: usize,
        cols: usize,
        scores: impl Fn(usize, &mut [T]) + Sync,
    ) -> Result<Support, TransportError> {
        let check = |name, value: f64, good: bool, range| {
            if good { Ok(()) } else { Err(TransportError::Parameter { name, value, range }) }
        };
        check("keep", self.keep as f64, self.keep >= 1, "at least 1")?;
        check("reach", self.reach, (0.0..=1e9).contains(&self.reach), "between 0 and 1e9")?;
        let block = (BLOCK_VALUES / cols.max(1)).clamp(8, 64);
        let mut found: Vec<Vec<u32>> = vec![Vec::new(); rows];
        with_threads(self.threads, || {
            let work = Chunk::new(&mut found, 1);
            for_blocks(self.threads, rows, block, work, &|first, count, out: Chunk<'_, Vec<u32>>| {
                let mut values = vec![T::ZERO; count * cols];
                scores(first, &mut values);
                let mut near = Vec::new();
                for (out, row) in out.data.iter_mut().zip(values.chunks_exact(cols)) {
                    self.least(row, &mut near, out);
                }
            });
        });
        Support::from_rows(rows, cols, |i, out| out.extend(found[i].iter().map(|&j| j as usize)))
    }

    fn least<T: Real>(&self, row: &[T], near: &mut Vec<(T, u32)>, out: &mut Vec<u32>) {
        // In this order a NaN is passed over.
        let least = row.iter().fold(T::HUGE, |least, &x| x.lesser(least));
        if least >= T::HUGE {
            return;
        }
        let limit = least + T::from_f64(self.reach);
        near.clear();
        let columns = row.iter().zip(0u32..).filter(|(x, _)| **x <= limit);
        near.extend(columns.map(|(&x, j)| (x, j)));
        if near.len() > self.keep {
            near.select_nth_unstable_by(self.keep - 1, |a, b| {
                a.0.to_f64().total_cmp(&b.0.to_f64()).then(a.1.cmp(&b.1))
            });
            near.truncate(self.keep);
        }
        out.extend(near.iter().map(|(_, j)| j));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn score(i: usize, j: usize) -> f64 {
        ((i * 31 + j * 17) % 101) as f64 + 0.001 * j as f64
    }

    #[test]
    fn the_least_are_found_whatever_the_threads() {
        let (rows, cols) = (200, 301);
        let fill = |first: usize, out: &mut [f64]| {
            for (i, row) in (first..).zip(out.chunks_exact_mut(cols)) {
                row.iter_mut().enumerate().for_each(|(j, x)| *x = score(i, j));
            }
        };
        let search = Search { keep: 5, reach: 1e3, threads: 1 };
        let support = search.run(rows, cols, fill).unwrap();
        for i in 0..rows {
            let mut all: Vec<usize> = (0..cols).collect();
            all.sort_by(|&a, &b| score(i, a).total_cmp(&score(i, b)));
            let mut want = all[..5].to_vec();
            want.sort_unstable();
            assert_eq!(support.row(i).iter().map(|&j| j as usize).collect::<Vec<_>>(), want);
        }
        assert_eq!(Search { threads: 3, ..search }.run(rows, cols, fill).unwrap(), support);
        let near = Search { reach: 0.5, ..search }.run(rows, cols, fill).unwrap();
        assert!(near.len() < support.len());
    }

    #[test]
    fn what_is_forbidden_is_not_chosen() {
        let search = Search { keep: 5, reach: 10.0, threads: 1 };
        let fill = |_: usize, out: &mut [f32]| {
            for row in out.chunks_exact_mut(3) {
                row.copy_from_slice(&[f32::HUGE, 1.0, f32::NAN]);
            }
        };
        assert_eq!(search.run(2, 3, fill).unwrap().row(1), [1]);
        let nothing = search.run(2, 3, |_, out: &mut [f32]| out.fill(f32::HUGE));
        assert_eq!(nothing, Err(TransportError::NoColumn { row: 0 }));
        assert!(Search { keep: 0, ..search }.run(2, 3, fill).is_err());
        assert!(Search { reach: f64::NAN, ..search }.run(2, 3, fill).is_err());
    }
}
