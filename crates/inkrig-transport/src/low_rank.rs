use crate::check::check_length;
use crate::padded::Padded;
use crate::{MatRef, Real, TransportError};

/// Self-distances of n points by r factors each: `D_ij = g_i + g_j - 2 phi_i . phi_j` off the diagonal and exactly 0 on
/// it. Takes O(n r) memory.
///
/// Distances that are not squared, as between motions, are squared distances of other points: each has a place `phi_i`,
/// of many dimensions, and a norm `g_i = |phi_i|^2`. Cutting off dimensions of the places but keeping the norms whole leaves
/// errors that are small and of both signs; see [`Nystrom`](crate::Nystrom), which makes one from a few rows of distances.
#[derive(Debug)]
pub struct LowRank<T> {
    /// `A = [g, 1, -2 Phi]`, n x k with k = r + 2; `D = A B^T` off the diagonal.
    pub(crate) left: Padded<T>,
    /// `B^T`, k x n, where `B = [1, g, Phi]`.
    pub(crate) right: Padded<T>,
    /// What `A B^T` has on the diagonal, 1 x n.
    pub(crate) excess: Padded<T>,
}

impl<T: Real> Clone for LowRank<T> {
    fn clone(&self) -> Self {
        Self { left: self.left.clone(), right: self.right.clone(), excess: self.excess.clone() }
    }
}

impl<T: Real> LowRank<T> {
    /// Takes n self-norms and n x r factors.
    ///
    /// # Errors
    /// [`TransportError::Empty`], [`TransportError::Shape`] when the numbers of points differ, [`TransportError::Bias`]
    /// for a value that is not finite or larger than 1e6.
    ///
    /// ```
    /// use inkrig_transport::{LowRank, Mat};
    /// // Points 0, 1 and 3 on a line, whose squared distances are 1, 4 and 9.
    /// let at = Mat::from_vec(3, 1, vec![0.0f32, 1.0, 3.0])?;
    /// let distances = LowRank::from_parts(&[0.0, 1.0, 9.0], at.view())?;
    /// assert_eq!([distances.distance(0, 2), distances.distance(2, 1), distances.distance(1, 1)], [9.0, 4.0, 0.0]);
    /// # Ok::<(), inkrig_transport::TransportError>(())
    /// ```
    pub fn from_parts(self_norms: &[T], factors: MatRef<'_, T>) -> Result<Self, TransportError> {
        let (n, r) = (factors.rows(), factors.cols());
        if n == 0 {
            return Err(TransportError::Empty { name: "factors" });
        }
        check_length("self_norms", self_norms.len(), n, "one self-norm per row of the factors")?;
        let limit = T::from_f64(1e6);
        let good = |x: T| x >= -limit && x <= limit;
        for row in 0..n {
            let values = self_norms[row..=row].iter().chain(factors.row(row));
            if let Some((col, value)) = values.enumerate().find(|(_, x)| !good(**x)) {
                let name = if col == 0 { "self_norms" } else { "factors" };
                let value = value.to_f64();
                return Err(TransportError::Bias { name, row, col: col.saturating_sub(1), value });
            }
        }
        let (mut left, mut right, mut excess) = (Padded::default(), Padded::default(), Padded::default());
        left.reset(n, r + 2, T::ZERO);
        right.reset(r + 2, n, T::ZERO);
        excess.reset(1, n, T::ZERO);
        let two = T::from_f64(2.0);
        for (i, &g) in self_norms.iter().enumerate() {
            let row = left.row_mut(i);
            (row[0], row[1]) = (g, T::ONE);
            (right.row_mut(0)[i], right.row_mut(1)[i]) = (T::ONE, g);
            let mut norm = T::ZERO;
            for (k, &phi) in factors.row(i).iter().enumerate() {
                row[k + 2] = -two * phi;
                right.row_mut(k + 2)[i] = phi;
                norm += phi * phi;
            }
            excess.row_mut(0)[i] = two * (g - norm);
        }
        Ok(Self { left, right, excess })
    }

    /// n, the number of points.
    pub fn len(&self) -> usize {
        self.left.rows()
    }

    /// Whether there are no points; never, as none can be made.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// r, the factors of each point.
    pub fn rank(&self) -> usize {
        self.left.cols() - 2
    }

    /// The distance between two points; it may be a little below 0. 0 for points that are not there.
    pub fn distance(&self, i: usize, j: usize) -> T {
        if i == j || i.max(j) >= self.len() {
            return T::ZERO;
        }
        self.left.row(i).iter().enumerate().map(|(k, &a)| a * self.right.row(k)[j]).sum()
    }

    /// The mean over all n x n distances, in O(n r).
    pub fn mean(&self) -> f64 {
        let sum = |row: &[T]| row.iter().map(|x| x.to_f64()).sum::<f64>();
        let n = self.len() as f64;
        let norms = sum(self.right.row(1));
        let places: f64 = (2..self.right.rows()).map(|k| sum(self.right.row(k)).powi(2)).sum();
        (2.0 * n * norms - 2.0 * places - sum(self.excess.row(0))) / (n * n)
    }

    /// Multiplies every distance by `factor`: by one over the mean, to bring them to the solver's unit.
    ///
    /// # Errors
    /// [`TransportError::Parameter`] unless the factor is between 1e-9 and 1e9.
    pub fn scale(&mut self, factor: f64) -> Result<(), TransportError> {
        if !(1e-9..=1e9).contains(&factor) {
            let range = "between 1e-9 and 1e9";
            return Err(TransportError::Parameter { name: "factor", value: factor, range });
        }
        let (whole, root) = (T::from_f64(factor), T::from_f64(factor.sqrt()));
        let rank = self.rank();
        for i in 0..self.len() {
            let row = self.left.row_mut(i);
            row[0] *= whole;
            row[2..].iter_mut().for_each(|x| *x *= root);
        }
        for k in 1..rank + 2 {
            let by = if k == 1 { whole } else { root };
            self.right.row_mut(k).iter_mut().for_each(|x| *x *= by);
        }
        self.excess.row_mut(0).iter_mut().for_each(|x| *x *= whole);
        Ok(())
    }

    /// `sum_ij D_ij^2 a_i a_j` for n masses a: D_ij^2 = B_i^T (A_j A_j^T) B_i, so O(n r^2).
    pub fn square_form(&self, mass: &[f64]) -> f64 {
        let k = self.left.cols();
        let mut moments = vec![0.0f64; k * k];
        for (j, &mass) in mass.iter().enumerate() {
            let a = self.left.row(j);
            for (line, &x) in moments.chunks_exact_mut(k).zip(a) {
                let x = x.to_f64() * mass;
                line.iter_mut().zip(a).for_each(|(s, y)| *s += x * y.to_f64());
            }
        }
        let mut sum = 0.0;
        let mut b = vec![0.0f64; k];
        for (i, (&mass, excess)) in mass.iter().zip(self.excess.row(0)).enumerate() {
            b.iter_mut().enumerate().for_each(|(t, b)| *b = self.right.row(t)[i].to_f64());
            let form: f64 = moments
                .chunks_exact(k)
                .zip(&b)
                .map(|(line, x)| x * line.iter().zip(&b).map(|(s, y)| s * y).sum::<f64>())
                .sum();
            sum += mass * (form - mass * excess.to_f64().powi(2));
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mat;

    #[test]
    fn sums_agree_with_the_entries() {
        let norms: Vec<f64> = (0..7).map(|i| 0.3 + 0.1 * i as f64).collect();
        let factors = Mat::from_fn(7, 3, |i, k| ((i * 5 + k * 3) % 7) as f64 * 0.1 - 0.3);
        let mut low = LowRank::from_parts(&norms, factors.view()).unwrap();
        let mass: Vec<f64> = (0..7).map(|i| (i + 1) as f64 / 28.0).collect();
        for _ in 0..2 {
            let all = Mat::from_fn(7, 7, |i, j| low.distance(i, j));
            assert!((low.mean() - all.as_slice().iter().sum::<f64>() / 49.0).abs() < 1e-14);
            let form: f64 = (0..49).map(|s| all.row(s / 7)[s % 7].powi(2) * mass[s / 7] * mass[s % 7]).sum();
            assert!((low.square_form(&mass) - form).abs() < 1e-14);
            let before = low.distance(1, 4);
            low.scale(2.0).unwrap();
            assert!((low.distance(1, 4) - 2.0 * before).abs() < 1e-14);
        }
        assert_eq!((low.len(), low.rank(), low.distance(3, 3), low.distance(7, 0)), (7, 3, 0.0, 0.0));
    }

    #[test]
    fn bad_parts_are_refused() {
        let factors = Mat::from_vec(2, 1, vec![0.0f32, f32::NAN]).unwrap();
        let says = |norms: &[f32], factors: &Mat<f32>| {
            LowRank::from_parts(norms, factors.view()).unwrap_err().to_string()
        };
        assert!(says(&[0.0, 0.0], &factors).contains("`factors` holds NaN at row 1, column 0"));
        assert!(says(&[0.0], &Mat::zeros(2, 1)).contains("`self_norms` is 1 x 1, expected 2 x 1"));
        assert!(says(&[], &Mat::zeros(0, 1)).contains("`factors` is empty"));
        let mut low = LowRank::from_parts(&[1.0f32], Mat::zeros(1, 1).view()).unwrap();
        assert!(low.scale(f64::NAN).is_err() && low.scale(0.0).is_err());
    }
}
