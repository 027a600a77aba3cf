use crate::parallel::{Chunk, for_blocks, with_threads};
use crate::{LowRank, Mat, MatRef, Real, TransportError, matmul, matmul_transposed};

/// Makes a [`LowRank`] from the distances of a few landmarks to all points: landmark multidimensional scaling ("de Silva &
/// Tenenbaum 2004") of distances that are not squared, with exact self-norms.
///
/// Landmarks are spread evenly over the points in their order, which suits points along a time. With B the inner products
/// about the landmarks' centroid, the places are a partial Cholesky factor of B, cut to the `rank` directions that carry
/// most. Costs `landmarks` rows of distances, O(n landmarks^2) time and O(n landmarks) memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Nystrom {
    /// Factors of each point, at least 1: 32 is enough for smooth motion.
    pub rank: usize,
    /// Rows of distances to ask for, at least 1; 4 times the rank or more. Cut to the number of points.
    pub landmarks: usize,
    /// Threads for the rows, of the current rayon pool. The result does not depend on it.
    pub threads: usize,
}

impl Default for Nystrom {
    /// Rank 32 by 192 landmarks, one thread.
    fn default() -> Self {
        Self { rank: 32, landmarks: 192, threads: 1 }
    }
}

/// Landmarks whose remaining norm is below this share of the largest add nothing but rounding.
const NEGLIGIBLE: f64 = 1e-6;
/// Steps of the subspace iteration; it starts near its end.
const STEPS: usize = 10;

impl Nystrom {
    /// Distances of `points` points, where `row(i, out)` writes the distances from point i to all points. They must be a
    /// metric that embeds (Euclidean distances do), symmetric, between 0 and 1e6, and are not squared.
    ///
    /// # Errors
    /// [`TransportError::Empty`] without points, [`TransportError::Parameter`] for a setting of 0,
    /// [`TransportError::Value`] for a distance out of its range, at its landmark's row.
    ///
    /// ```
    /// use inkrig_transport::Nystrom;
    /// let low = Nystrom::default().fit(500, |i, out: &mut [f32]| {
    ///     out.iter_mut().enumerate().for_each(|(j, d)| *d = (i as f32 - j as f32).abs() / 500.0);
    /// })?;
    /// assert!((low.distance(100, 400) - 0.6).abs() < 0.02);
    /// # Ok::<(), inkrig_transport::TransportError>(())
    /// ```
    pub fn fit<T: Real>(
        &self,
        points: usize,
        row: impl Fn(usize, &mut [T]) + Sync,
    ) -> Result<LowRank<T>, TransportError> {
        let chosen = self.choose(points)?;
        let mut rows = Mat::zeros(chosen.len(), points);
        let work = Chunk::new(rows.as_mut_slice(), points);
        with_threads(self.threads, || {
            for_blocks(self.threads, chosen.len(), 4, work, &|first, count, out: Chunk<'_, T>| {
                let out = out.data.chunks_exact_mut(points);
                chosen[first..first + count].iter().zip(out).for_each(|(&i, out)| row(i, out));
            });
        });
        self.finish(&chosen, &rows)
    }

    /// Distances `scale * |f_i - f_j|` between the rows of an n x d matrix.
    ///
    /// # Errors
    /// As [`fit`](Self::fit).
    pub fn fit_features<T: Real>(
        &self,
        features: MatRef<'_, T>,
        scale: f64,
    ) -> Result<LowRank<T>, TransportError> {
        let chosen = self.choose(features.rows())?;
        let marks: Vec<T> = chosen.iter().flat_map(|&i| features.row(i)).copied().collect();
        let marks = Mat::from_vec(chosen.len(), features.cols(), marks)?;
        let mut rows = Mat::zeros(0, 0);
        matmul_transposed(marks.view(), features, &mut rows, self.threads)?;
        let norm = |x: &[T]| x.iter().map(|&x| x * x).sum::<T>();
        let norms: Vec<T> = (0..features.rows()).map(|i| norm(features.row(i))).collect();
        let (two, scale) = (T::from_f64(2.0), T::from_f64(scale));
        for (l, &i) in chosen.iter().enumerate() {
            let row = rows.row_mut(l);
            for (d, &norm) in row.iter_mut().zip(&norms) {
                let square = norms[i] + norm - two * *d;
                // Not `greater`: a NaN must stay one, to be found.
                *d = if square < T::ZERO { T::ZERO } else { square }.sqrt() * scale;
            }
            row[i] = T::ZERO;
        }
        self.finish(&chosen, &rows)
    }

    fn choose(&self, points: usize) -> Result<Vec<usize>, TransportError> {
        for (name, value) in [("rank", self.rank), ("landmarks", self.landmarks)] {
            if value == 0 {
                return Err(TransportError::Parameter { name, value: 0.0, range: "at least 1" });
            }
        }
        if points == 0 {
            return Err(TransportError::Empty { name: "points" });
        }
        let count = self.landmarks.min(points);
        Ok((0..count).map(|l| (2 * l + 1) * points / (2 * count)).collect())
    }

    fn finish<T: Real>(&self, chosen: &[usize], rows: &Mat<T>) -> Result<LowRank<T>, TransportError> {
        let limit = T::from_f64(1e6);
        for (l, &row) in chosen.iter().enumerate() {
            if let Some(col) = rows.row(l).iter().position(|&d| !(d >= T::ZERO && d <= limit)) {
                return Err(TransportError::Value {
                    name: "distances",
                    row,
                    col,
                    value: rows.row(l)[col].to_f64(),
                });
            }
        }
        let norms = self_norms(chosen, rows);
        let mut places = cholesky(chosen, rows, &norms);
        if places.rows() > self.rank {
            places = leading(&places, self.rank)?;
        }
        let norms: Vec<T> = norms.iter().map(|&g| T::from_f64(g)).collect();
        let factors = Mat::from_fn(rows.cols(), places.rows(), |i, k| T::from_f64(places.row(k)[i]));
        LowRank::from_parts(&norms, factors.view())
    }
}

/// Squared distances of the points' places from the landmarks' centroid: `mean_l D_li - mean_lm D_lm / 2`.
fn self_norms<T: Real>(chosen: &[usize], rows: &Mat<T>) -> Vec<f64> {
    let mut norms = vec![0.0f64; rows.cols()];
    let share = 1.0 / chosen.len() as f64;
    for l in 0..rows.rows() {
        norms.iter_mut().zip(rows.row(l)).for_each(|(g, d)| *g += d.to_f64() * share);
    }
    let half = 0.5 * share * chosen.iter().map(|&i| norms[i]).sum::<f64>();
    norms.iter_mut().for_each(|g| *g -= half);
    norms
}

/// `F`, k x n, with `F^T F` = B between landmarks and points, `B_li = (g_l + g_i - D_li) / 2`; largest pivot first.
fn cholesky<T: Real>(chosen: &[usize], rows: &Mat<T>, norms: &[f64]) -> Mat<f64> {
    let n = norms.len();
    let mut rest: Vec<f64> = chosen.iter().map(|&i| norms[i]).collect();
    let least = NEGLIGIBLE * rest.iter().copied().fold(0.0, f64::max);
    let mut factor: Vec<f64> = Vec::new();
    let mut found = 0;
    while found < chosen.len() {
        let by_size = |a: &(usize, &f64), b: &(usize, &f64)| a.1.total_cmp(b.1);
        let Some((l, &pivot)) = rest.iter().enumerate().max_by(by_size) else { break };
        if pivot <= least {
            break;
        }
        let mark = chosen[l];
        let (gl, scale) = (norms[mark], 1.0 / pivot.sqrt());
        let inner = |(g, d): (&f64, &T)| 0.5 * (gl + g - d.to_f64());
        let mut line: Vec<f64> = norms.iter().zip(rows.row(l)).map(inner).collect();
        for before in factor.chunks_exact(n) {
            let weight = before[mark];
            line.iter_mut().zip(before).for_each(|(x, f)| *x -= weight * f);
        }
        line.iter_mut().for_each(|x| *x *= scale);
        rest.iter_mut().zip(chosen).for_each(|(r, &i)| *r -= line[i] * line[i]);
        rest[l] = f64::NEG_INFINITY;
        factor.extend_from_slice(&line);
        found += 1;
    }
    if found == 0 {
        // All landmarks in one place.
        return Mat::zeros(1, n);
    }
    Mat::from_fn(found, n, |k, i| factor[k * n + i])
}

/// The `rank` combinations of the factor's rows that carry most of `F^T F`: subspace iteration on `F F^T`, from the first
/// pivots.
fn leading(factor: &Mat<f64>, rank: usize) -> Result<Mat<f64>, TransportError> {
    let k = factor.rows();
    let (mut gram, mut next, mut out) = (Mat::zeros(0, 0), Mat::zeros(0, 0), Mat::zeros(0, 0));
    matmul_transposed(factor.view(), factor.view(), &mut gram, 1)?;
    let mut basis = Mat::from_fn(rank, k, |i, j| f64::from(u8::from(i == j)));
    for _ in 0..STEPS {
        matmul(basis.view(), gram.view(), &mut next, 1)?;
        std::mem::swap(&mut basis, &mut next);
        orthonormalise(&mut basis);
    }
    matmul(basis.view(), factor.view(), &mut out, 1)?;
    Ok(out)
}

/// Modified Gram-Schmidt of the rows; a row that depends on those before becomes 0.
fn orthonormalise(rows: &mut Mat<f64>) {
    let k = rows.cols();
    for i in 0..rows.rows() {
        let (before, row) = rows.as_mut_slice().split_at_mut(i * k);
        let row = &mut row[..k];
        let length = |row: &[f64]| row.iter().map(|x| x * x).sum::<f64>().sqrt();
        let start = length(row);
        for other in before.chunks_exact(k) {
            let inner: f64 = row.iter().zip(other).map(|(a, b)| a * b).sum();
            row.iter_mut().zip(other).for_each(|(a, b)| *a -= inner * b);
        }
        let end = length(row);
        let scale = if end > 1e-10 * start { 1.0 / end } else { 0.0 };
        row.iter_mut().for_each(|x| *x *= scale);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of a closed curve in three dimensions.
    fn curve(n: usize) -> Mat<f64> {
        Mat::from_fn(n, 3, |i, k| {
            let t = i as f64 / n as f64 * std::f64::consts::TAU;
            [(3.0 * t).sin() * (1.0 + 0.3 * t.cos()), (3.0 * t).cos(), 0.2 * t][k]
        })
    }

    fn distance(points: &Mat<f64>, i: usize, j: usize) -> f64 {
        points.row(i).iter().zip(points.row(j)).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    }

    fn error(points: &Mat<f64>, low: &LowRank<f64>) -> f64 {
        let n = points.rows();
        let (mut off, mut all) = (0.0, 0.0);
        for i in 0..n {
            for j in 0..n {
                off += (low.distance(i, j) - distance(points, i, j)).abs();
                all += distance(points, i, j);
            }
        }
        off / all
    }

    #[test]
    fn error_falls_with_the_rank_and_ends_at_zero() {
        let points = curve(200);
        let fit = |rank, landmarks| {
            Nystrom { rank, landmarks, threads: 2 }.fit_features(points.view(), 1.0).unwrap()
        };
        let errors: Vec<f64> =
            [(8, 192), (16, 192), (32, 192), (200, 200)].map(|(r, l)| error(&points, &fit(r, l))).to_vec();
        println!("mean error over mean distance at rank 8, 16, 32, all: {errors:.5?}");
        assert!(errors[1] < 0.8 * errors[0] && errors[2] < 0.8 * errors[1], "{errors:?}");
        assert!(errors[2] < 0.02 && errors[3] < 1e-6, "{errors:?}");
        assert!(error(&points, &fit(32, 100)) < 0.03);
    }

    #[test]
    fn rows_and_features_give_the_same() {
        let points = curve(90);
        let job = Nystrom { rank: 12, landmarks: 40, threads: 1 };
        let rows = |i: usize, out: &mut [f64]| {
            out.iter_mut().enumerate().for_each(|(j, d)| *d = 0.5 * distance(&points, i, j));
        };
        let (a, b) = (job.fit(90, rows).unwrap(), job.fit_features(points.view(), 0.5).unwrap());
        assert!((0..90 * 90).all(|s| (a.distance(s / 90, s % 90) - b.distance(s / 90, s % 90)).abs() < 1e-6));
        let many = Nystrom { threads: 3, ..job }.fit(90, rows).unwrap();
        assert!((0..90).all(|i| a.left.row(i) == many.left.row(i)));
    }

    #[test]
    fn few_places_are_exact_and_one_place_is_no_trouble() {
        // Labels: three places, far apart.
        let labels = Mat::from_fn(60, 3, |i, k| f64::from(u8::from(i / 20 == k)));
        let low = Nystrom { rank: 4, landmarks: 30, threads: 1 }.fit_features(labels.view(), 1.0).unwrap();
        assert!(low.rank() <= 3 && error(&labels, &low) < 1e-12);
        let still = Nystrom::default().fit(5, |_, out: &mut [f32]| out.fill(0.0)).unwrap();
        assert_eq!((still.mean(), still.distance(0, 4)), (0.0, 0.0));
    }

    #[test]
    fn bad_settings_and_rows_are_refused() {
        let fit = |job: Nystrom, n, value: f32| {
            job.fit(n, |_, out: &mut [f32]| out.fill(value)).map(|_| ()).unwrap_err().to_string()
        };
        assert!(fit(Nystrom { rank: 0, ..Nystrom::default() }, 5, 0.0).contains("`rank` is 0"));
        assert!(fit(Nystrom { landmarks: 0, ..Nystrom::default() }, 5, 0.0).contains("`landmarks` is 0"));
        assert!(fit(Nystrom::default(), 0, 0.0).contains("empty"));
        assert!(fit(Nystrom::default(), 5, f32::NAN).contains("`distances` holds NaN at row 0, column 0"));
        let features = Mat::from_vec(2, 1, vec![0.0, f32::NAN]).unwrap();
        assert!(Nystrom::default().fit_features(features.view(), 1.0).is_err());
    }
}
