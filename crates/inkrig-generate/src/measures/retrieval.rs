//! How well motions belong to their texts, and how much they differ, by distances of embeddings.

use crate::GenerateError;
use crate::schedule::Noise;

/// Means over all groups.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Retrieval {
    /// R-precision: how often a text's own motion is among the 1, 2 and 3 nearest of its group.
    pub precision: [f64; 3],
    /// MM-Dist: the mean distance of a text from its own motion.
    pub distance: f64,
}

/// Compares each text with the motions of its group: rows of `width` numbers, text by text and motion by motion in one order,
/// shuffled by the caller. The paper has groups of 32; rows that fill no group are left out, as there.
///
/// # Errors
/// [`GenerateError::Length`] when there are not as many motions as texts, or no group is full.
pub fn retrieval(
    texts: &[f32],
    motions: &[f32],
    width: usize,
    group: usize,
) -> Result<Retrieval, GenerateError> {
    same_length("table of motions", texts, motions)?;
    let size = width.max(1) * group.max(1);
    let groups = texts.len() / size;
    if groups == 0 {
        return Err(GenerateError::Length { what: "table of texts", expected: size, got: texts.len() });
    }
    let (mut hits, mut total) = ([0_usize; 3], 0.0);
    for (texts, motions) in texts.chunks_exact(size).zip(motions.chunks_exact(size)) {
        for (at, text) in texts.chunks_exact(width).enumerate() {
            let distances: Vec<f64> =
                motions.chunks_exact(width).map(|motion| distance(text, motion)).collect();
            let own = distances[at];
            total += own;
            let nearer = distances.iter().filter(|distance| **distance < own).count();
            for (most, hits) in hits.iter_mut().enumerate() {
                *hits += usize::from(nearer <= most);
            }
        }
    }
    let count = (groups * group) as f64;
    Ok(Retrieval { precision: hits.map(|hits| hits as f64 / count), distance: total / count })
}

/// The mean distance of random pairs of rows, as many as asked for (the paper has 300), or as there are rows.
///
/// # Errors
/// [`GenerateError::Length`] when there are fewer than two rows, or they are not whole.
pub fn diversity(motions: &[f32], width: usize, pairs: usize, seed: u64) -> Result<f64, GenerateError> {
    let rows: Vec<&[f32]> = motions.chunks_exact(width.max(1)).collect();
    if rows.len() < 2 || !motions.len().is_multiple_of(width.max(1)) {
        return Err(GenerateError::Length {
            what: "table of motions",
            expected: 2 * width,
            got: motions.len(),
        });
    }
    let mut noise = Noise::new(seed);
    let mut shuffled = || {
        let mut rows = rows.clone();
        for last in (1..rows.len()).rev() {
            rows.swap(last, (noise.uniform() * (last + 1) as f64) as usize);
        }
        rows
    };
    let (first, second) = (shuffled(), shuffled());
    let pairs = pairs.clamp(1, rows.len());
    Ok(first.iter().zip(&second).take(pairs).map(|(a, b)| distance(a, b)).sum::<f64>() / pairs as f64)
}

pub(super) fn same_length(what: &'static str, a: &[f32], b: &[f32]) -> Result<(), GenerateError> {
    if a.len() == b.len() {
        Ok(())
    } else {
        Err(GenerateError::Length { what, expected: a.len(), got: b.len() })
    }
}

fn distance(a: &[f32], b: &[f32]) -> f64 {
    let square = |(a, b): (&f32, &f32)| (f64::from(*a) - f64::from(*b)).powi(2);
    a.iter().zip(b).map(square).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_those_of_distances() {
        // On a line: texts at 0, 10, 20, 30; the third's motion is beyond the fourth's.
        let texts = [0.0, 10.0, 20.0, 30.0];
        let motions = [1.0, 10.0, 34.0, 29.0];
        let result = retrieval(&texts, &motions, 1, 4).unwrap();
        assert_eq!(result.precision, [0.75, 0.75, 1.0]);
        assert!((result.distance - (1.0 + 0.0 + 14.0 + 1.0) / 4.0).abs() < 1e-12);
        assert!(retrieval(&texts, &motions, 1, 5).is_err());
        assert!(retrieval(&texts, &motions[..3], 1, 2).is_err());
    }

    #[test]
    fn what_is_all_alike_has_no_diversity() {
        assert_eq!(diversity(&[3.0; 40], 4, 300, 1).unwrap(), 0.0);
        // Pairs of 0 and 1 in equal shares differ half of the time.
        let rows: Vec<f32> = (0..2000).map(|at| (at % 2) as f32).collect();
        let mean = diversity(&rows, 1, 2000, 1).unwrap();
        assert!((mean - 0.5).abs() < 0.05, "{mean}");
        assert!(diversity(&[1.0; 4], 4, 3, 0).is_err() && diversity(&[1.0; 7], 2, 3, 0).is_err());
    }
}
