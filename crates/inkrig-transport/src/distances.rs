use crate::{LowRank, MatRef, Real};

/// Distances within one side of a problem: all of them, or by factors.
///
/// With factors of rank r the gradient costs O(N M r) instead of O(N M (N + M)).
#[derive(Clone, Copy, Debug)]
pub enum Distances<'a, T: Real> {
    /// n x n, symmetric, zero diagonal.
    Dense(MatRef<'a, T>),
    /// n points by r factors each.
    LowRank(&'a LowRank<T>),
}

impl<'a, T: Real> Distances<'a, T> {
    /// n, the number of points.
    pub fn len(self) -> usize {
        match self {
            Self::Dense(mat) => mat.rows(),
            Self::LowRank(low) => low.len(),
        }
    }

    /// Whether there are no points.
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// The matrix, when all distances are there.
    pub fn dense(self) -> Option<MatRef<'a, T>> {
        match self {
            Self::Dense(mat) => Some(mat),
            Self::LowRank(_) => None,
        }
    }

    /// The distance between two points; 0 for points that are not there.
    pub fn distance(self, i: usize, j: usize) -> T {
        match self {
            Self::Dense(mat) => mat.row(i).get(j).copied().unwrap_or(T::ZERO),
            Self::LowRank(low) => low.distance(i, j),
        }
    }

    /// `sum_ij D_ij^2 a_i a_j`.
    pub(crate) fn square_form(self, mass: &[f64]) -> f64 {
        match self {
            Self::Dense(mat) => {
                let row =
                    |i| mat.row(i).iter().zip(mass).map(|(d, a)| d.to_f64() * d.to_f64() * a).sum::<f64>();
                mass.iter().enumerate().map(|(i, a)| a * row(i)).sum()
            }
            Self::LowRank(low) => low.square_form(mass),
        }
    }
}

impl<'a, T: Real> From<MatRef<'a, T>> for Distances<'a, T> {
    fn from(mat: MatRef<'a, T>) -> Self {
        Self::Dense(mat)
    }
}

impl<'a, T: Real> From<&'a LowRank<T>> for Distances<'a, T> {
    fn from(low: &'a LowRank<T>) -> Self {
        Self::LowRank(low)
    }
}
