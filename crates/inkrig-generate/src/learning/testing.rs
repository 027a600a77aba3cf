//! What all gradients are tested by.

use crate::weights::Tensors;

/// Along the gradient of each tensor alone, the loss grows by the square of its length. `without` are parts of names of tensors that
/// have no say in the loss.
pub(super) fn check_gradient(
    weights: &Tensors,
    without: &[&str],
    run: impl FnMut(&[f32]) -> (f64, Vec<f32>),
) {
    check_gradient_within(2e-3, weights, without, run);
}

/// The same with weights moved by `step`: small where a loss is bent.
pub(super) fn check_gradient_within(
    step: f64,
    weights: &Tensors,
    without: &[&str],
    mut run: impl FnMut(&[f32]) -> (f64, Vec<f32>),
) {
    let row = weights.row();
    let (_, gradient) = run(&row);
    assert_eq!(gradient.len(), row.len());
    let mut first = 0;
    for (name, tensor) in weights.iter() {
        let range = first..first + tensor.data().len();
        first = range.end;
        let own = &gradient[range.clone()];
        let length = own.iter().map(|part| f64::from(part * part)).sum::<f64>().sqrt();
        if length < 1e-5 {
            assert!(without.iter().any(|part| name.contains(part)), "{name} {length}");
            continue;
        }
        let by = step / length;
        let moved = |sign: f64| {
            let mut row = row.clone();
            for (weight, part) in row[range.clone()].iter_mut().zip(own) {
                *weight += (sign * by * f64::from(*part)) as f32;
            }
            row
        };
        let slope = (run(&moved(1.0)).0 - run(&moved(-1.0)).0) / (2.0 * by);
        let expected = length * length;
        let apart = (slope - expected).abs();
        assert!(apart < 0.03 * expected || apart * by < 2e-5, "{name}: {slope} {expected}");
    }
}
