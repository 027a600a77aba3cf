//! Matrices with all singular values made equal: what the optimiser Muon moves weights along.

use crate::numeric::product::{Out, Packed, Rows, multiply};

/// Of the polynomial that pushes singular values towards one (Jordan 2024).
const QUINTIC: [f32; 3] = [3.4445, -4.7750, 2.0315];
/// How often it is applied.
const ROUNDS: usize = 5;

/// The nearest matrix, roughly, whose singular values are all between .7 and 1.2; in place, `rows x columns` numbers.
pub fn orthogonalise(matrix: &mut Vec<f32>, rows: usize, columns: usize) {
    if rows > columns {
        *matrix = turned(matrix, columns);
        orthogonalise(matrix, columns, rows);
        *matrix = turned(matrix, rows);
        return;
    }
    let length = matrix.iter().map(|x| f64::from(x * x)).sum::<f64>().sqrt() as f32 + 1e-12;
    matrix.iter_mut().for_each(|x| *x /= length);
    let [a, b, c] = QUINTIC;
    let (mut packed, mut square, mut more) =
        (Packed::default(), vec![0.0; rows * rows], vec![0.0; rows * rows]);
    for _ in 0..ROUNDS {
        packed.fill_transposed(matrix, columns, rows, columns);
        product(matrix, columns, rows, &packed, &mut square, false);
        packed.fill(&square, rows, rows, rows);
        product(&square, rows, rows, &packed, &mut more, false);
        for (more, square) in more.iter_mut().zip(&square) {
            *more = b * square + c * *more;
        }
        packed.fill(matrix, rows, columns, columns);
        matrix.iter_mut().for_each(|x| *x *= a);
        product(&more, rows, rows, &packed, matrix, true);
    }
}

fn product(x: &[f32], stride: usize, count: usize, packed: &Packed, out: &mut [f32], add: bool) {
    let out = Out { data: out, stride: packed.columns(), add };
    multiply(Rows { data: x, stride, count }, packed, None, out);
}

fn turned(matrix: &[f32], columns: usize) -> Vec<f32> {
    (0..columns).flat_map(|column| matrix.iter().skip(column).step_by(columns).copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::Noise;

    #[test]
    fn singular_values_become_about_one() {
        // Two orthogonal rows of very different length.
        let mut two = vec![100.0, 0.0, 0.0, 0.0, 0.0, 5.0, 0.0, 0.0];
        orthogonalise(&mut two, 2, 4);
        assert!((two[0] - 1.0).abs() < 0.35 && (two[5] - 1.0).abs() < 0.35 && two[1].abs() < 1e-3, "{two:?}");
        for (rows, columns) in [(20, 33), (33, 20)] {
            let mut matrix = Noise::new(1).normals(rows * columns);
            orthogonalise(&mut matrix, rows, columns);
            // The squares of singular values add up to the square of the matrix.
            let mean = matrix.iter().map(|x| x * x).sum::<f32>() / rows.min(columns) as f32;
            assert!((0.6..1.3).contains(&mean), "{mean}");
        }
    }
}
