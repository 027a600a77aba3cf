//! What training makes small, as plain functions of numbers: the definitions, without gradients. Training has them once more on
//! tensors that know their gradients, and tests compare the two.
//!
//! All tables of a call have one length; means are over all their numbers.

use crate::GenerateError;

/// The mean of `x^2 / 2` near 0 and `|x| - 1/2` beyond 1, x being differences: VAE features and joint positions, weight 1 each.
///
/// # Errors
/// [`GenerateError::Length`] when lengths differ, or there is nothing.
pub fn smooth_l1(made: &[f32], wanted: &[f32]) -> Result<f64, GenerateError> {
    mean(made, wanted, |off| if off.abs() < 1.0 { off * off / 2.0 } else { off.abs() - 0.5 })
}

/// The mean squared difference: reconstruction of noise or latents (the paper's L_recon), and the match of 2D embeddings with
/// those of the same conditions in 3D (L_match).
///
/// # Errors
/// [`GenerateError::Length`] when lengths differ, or there is nothing.
pub fn squared(made: &[f32], wanted: &[f32]) -> Result<f64, GenerateError> {
    mean(made, wanted, |off| off * off)
}

/// The mean divergence of normal distributions from the standard one, weight 1e-4 in the VAE's loss.
///
/// # Errors
/// [`GenerateError::Length`] when lengths differ, or there is nothing.
pub fn divergence(means: &[f32], log_variances: &[f32]) -> Result<f64, GenerateError> {
    same(means, log_variances)?;
    let of = |(mean, log): (&f32, &f32)| {
        let (mean, log) = (f64::from(*mean), f64::from(*log));
        (mean * mean + log.exp() - 1.0 - log) / 2.0
    };
    Ok(means.iter().zip(log_variances).map(of).sum::<f64>() / means.len() as f64)
}

/// Squared differences where something was asked for, added up over the three numbers of a joint, divided by how many joints were
/// asked for: the trajectory's loss (L_tr) and, at its one frame, the key pose's (L_key), on normalised positions. For the
/// paper's key pose (Eq. 8) take both relative to the pelvis first. 0 where nothing was asked for.
///
/// # Errors
/// [`GenerateError::Length`] when `mask` has not one truth for every three numbers.
pub fn masked_squares(made: &[f32], wanted: &[f32], mask: &[bool]) -> Result<f64, GenerateError> {
    same(made, wanted)?;
    if made.len() != 3 * mask.len() {
        return Err(GenerateError::Length { what: "mask", expected: made.len() / 3, got: mask.len() });
    }
    let joints = made.as_chunks::<3>().0.iter().zip(wanted.as_chunks::<3>().0).zip(mask);
    let of = |(made, wanted): (&[f32; 3], &[f32; 3])| {
        made.iter().zip(wanted).map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).sum::<f64>()
    };
    let total: f64 = joints.filter(|(_, asked)| **asked).map(|(pair, _)| of(pair)).sum();
    let asked = mask.iter().filter(|asked| **asked).count();
    Ok(total / asked.max(1) as f64)
}

/// How badly each row is told from the others by its partner: cross entropy of cosines divided by `temperature`, each row of
/// `from` among all rows of `among` (L_contrast: 3D among 2D, temperature 0.07, one direction).
///
/// # Errors
/// [`GenerateError::Length`] when lengths differ, or rows are not whole.
pub fn contrast(from: &[f32], among: &[f32], width: usize, temperature: f64) -> Result<f64, GenerateError> {
    same(from, among)?;
    let width = width.max(1);
    if !from.len().is_multiple_of(width) {
        let expected = from.len() / width * width;
        return Err(GenerateError::Length { what: "table of embeddings", expected, got: from.len() });
    }
    let unit = |row: &[f32]| -> Vec<f64> {
        let length = row.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>().sqrt().max(1e-12);
        row.iter().map(|x| f64::from(*x) / length).collect()
    };
    let from: Vec<Vec<f64>> = from.chunks_exact(width).map(unit).collect();
    let among: Vec<Vec<f64>> = among.chunks_exact(width).map(unit).collect();
    let mut total = 0.0;
    for (own, row) in from.iter().enumerate() {
        let cosine = |other: &Vec<f64>| row.iter().zip(other).map(|(a, b)| a * b).sum::<f64>() / temperature;
        let scores: Vec<f64> = among.iter().map(cosine).collect();
        let most = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let log_sum = scores.iter().map(|score| (score - most).exp()).sum::<f64>().ln() + most;
        total += log_sum - scores[own];
    }
    Ok(total / from.len() as f64)
}

fn mean(made: &[f32], wanted: &[f32], of: impl Fn(f64) -> f64) -> Result<f64, GenerateError> {
    same(made, wanted)?;
    let total: f64 = made.iter().zip(wanted).map(|(a, b)| of(f64::from(*a) - f64::from(*b))).sum();
    Ok(total / made.len() as f64)
}

fn same(a: &[f32], b: &[f32]) -> Result<(), GenerateError> {
    if a.len() == b.len() && !a.is_empty() {
        return Ok(());
    }
    Err(GenerateError::Length { what: "second table of a loss", expected: a.len().max(1), got: b.len() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn losses_worked_out_by_hand() {
        assert_eq!(smooth_l1(&[0.0, 3.0], &[0.5, 0.0]).unwrap(), (0.125 + 2.5) / 2.0);
        assert_eq!(squared(&[1.0, 2.0], &[0.0, 0.0]).unwrap(), 2.5);
        assert_eq!(divergence(&[2.0, 0.0], &[0.0, 0.0]).unwrap(), 1.0);
        let (made, wanted) = ([1.0, 2.0, 2.0, 9.0, 9.0, 9.0], [0.0; 6]);
        assert_eq!(masked_squares(&made, &wanted, &[true, false]).unwrap(), 9.0);
        assert_eq!(masked_squares(&made, &wanted, &[false; 2]).unwrap(), 0.0);
        // Two rows at right angles: the wrong partner has cosine 0.
        let rows = [2.0, 0.0, 0.0, 5.0];
        let exact = (1.0 + (-1.0_f64 / 0.5).exp()).ln();
        assert!((contrast(&rows, &rows, 2, 0.5).unwrap() - exact).abs() < 1e-12);
        assert!(squared(&[], &[]).is_err() && smooth_l1(&[1.0], &[]).is_err());
        assert!(
            masked_squares(&made, &wanted, &[true]).is_err()
                && contrast(&rows[..3], &rows[..3], 2, 1.0).is_err()
        );
    }
}
