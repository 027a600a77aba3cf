//! Eigenvalues of symmetric matrices.

/// All of them, in no order. `matrix` is square, row-major, and is used up.
///
/// Householder's reflections make it tridiagonal, then the QL method with implicit shifts (Bowdler et al. 1968).
pub(super) fn eigenvalues(mut matrix: Vec<f64>, size: usize) -> Vec<f64> {
    let mut beside = vec![0.0; size];
    let mut reflector = vec![0.0; size];
    let mut product = vec![0.0; size];
    for step in 0..size.saturating_sub(2) {
        let first = step + 1;
        for row in first..size {
            reflector[row] = matrix[row * size + step];
        }
        let length = reflector[first..].iter().map(|x| x * x).sum::<f64>().sqrt();
        let head = reflector[first];
        beside[first] = if head > 0.0 { -length } else { length };
        if length == 0.0 {
            continue;
        }
        reflector[first] -= beside[first];
        let half = reflector[first..].iter().map(|x| x * x).sum::<f64>() / 2.0;
        if half == 0.0 {
            continue;
        }
        // A' = A - v w^T - w v^T, with w = p - v (v.p) / (2 half) and p = A v / half.
        for row in first..size {
            let line = &matrix[row * size + first..(row + 1) * size];
            product[row] = line.iter().zip(&reflector[first..]).map(|(a, v)| a * v).sum::<f64>() / half;
        }
        let along: f64 = product[first..].iter().zip(&reflector[first..]).map(|(p, v)| p * v).sum();
        for row in first..size {
            product[row] -= reflector[row] * along / (2.0 * half);
        }
        for row in first..size {
            let (v, w) = (reflector[row], product[row]);
            for column in first..size {
                matrix[row * size + column] -= v * product[column] + w * reflector[column];
            }
        }
    }
    if size > 1 {
        beside[size - 1] = matrix[(size - 1) * size + size - 2];
    }
    let diagonal = (0..size).map(|at| matrix[at * size + at]).collect();
    tridiagonal(diagonal, beside)
}

/// `beside[k]` stands next to `diagonal[k]` and `diagonal[k - 1]`.
fn tridiagonal(mut diagonal: Vec<f64>, mut beside: Vec<f64>) -> Vec<f64> {
    let size = diagonal.len();
    if size == 0 {
        return diagonal;
    }
    beside.rotate_left(1);
    beside[size - 1] = 0.0;
    for first in 0..size {
        // Each takes two or three rounds; the limit is for numbers that are none.
        for _ in 0..60 {
            let small = |at: usize| {
                let scale = diagonal[at].abs() + diagonal[at + 1].abs();
                beside[at].abs() <= f64::EPSILON * scale
            };
            let last = (first..size - 1).find(|&at| small(at)).unwrap_or(size - 1);
            if last == first {
                break;
            }
            let slope = (diagonal[first + 1] - diagonal[first]) / (2.0 * beside[first]);
            let root = slope.hypot(1.0).copysign(slope);
            let mut g = diagonal[last] - diagonal[first] + beside[first] / (slope + root);
            let (mut sine, mut cosine, mut shift) = (1.0, 1.0, 0.0);
            let mut stopped = false;
            for at in (first..last).rev() {
                let f = sine * beside[at];
                let b = cosine * beside[at];
                let r = f.hypot(g);
                beside[at + 1] = r;
                if r == 0.0 {
                    diagonal[at + 1] -= shift;
                    beside[last] = 0.0;
                    stopped = true;
                    break;
                }
                (sine, cosine) = (f / r, g / r);
                g = diagonal[at + 1] - shift;
                let r = (diagonal[at] - g) * sine + 2.0 * cosine * b;
                shift = sine * r;
                diagonal[at + 1] = g + shift;
                g = cosine * r - b;
            }
            if !stopped {
                diagonal[first] -= shift;
                beside[first] = g;
                beside[last] = 0.0;
            }
        }
    }
    diagonal
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_matrices_have_their_eigenvalues() {
        let sorted = |matrix: Vec<f64>, size| {
            let mut values = eigenvalues(matrix, size);
            values.sort_by(f64::total_cmp);
            values
        };
        assert_eq!(sorted(vec![], 0), [0.0; 0]);
        assert_eq!(sorted(vec![3.0], 1), [3.0]);
        let two = sorted(vec![2.0, 1.0, 1.0, 2.0], 2);
        assert!((two[0] - 1.0).abs() < 1e-14 && (two[1] - 3.0).abs() < 1e-14);
        // Second differences: 2 - 2 cos(k pi / (n + 1)).
        let n = 40;
        let at = |row: usize, column: usize| match row.abs_diff(column) {
            0 => 2.0,
            1 => -1.0,
            _ => 0.0,
        };
        let values = sorted((0..n * n).map(|place| at(place / n, place % n)).collect(), n);
        for (k, value) in values.iter().enumerate() {
            let exact = 2.0 - 2.0 * (std::f64::consts::PI * (k + 1) as f64 / (n + 1) as f64).cos();
            assert!((value - exact).abs() < 1e-12, "{k}: {value} {exact}");
        }
        // A full one, by traces of its powers.
        let full: Vec<f64> =
            (0..n * n).map(|place| ((place / n * 7 + place % n * 7) % 11) as f64 - 5.0).collect();
        let trace: f64 = (0..n).map(|at| full[at * n + at]).sum();
        let squares: f64 = full.iter().map(|x| x * x).sum();
        let values = sorted(full, n);
        assert!((values.iter().sum::<f64>() - trace).abs() < 1e-9);
        assert!((values.iter().map(|x| x * x).sum::<f64>() - squares).abs() < 1e-7);
    }
}
