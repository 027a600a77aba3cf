use crate::kernels::{Softmax, dispatch};
use crate::{Isa, Mat, MatRef, Real, TransportError};

/// Row-wise `out_i = softmax(-(cost_i - min cost_i) / temperature)`: the limit of a plan without the transport terms, with
/// rows that sum to 1. Entries below the flush limit become 0. `out` takes the shape of `cost`, N x M; costs are finite,
/// in the unit of `temperature`.
///
/// # Errors
/// [`TransportError::Parameter`] unless `temperature` is finite and greater than 0.
///
/// ```
/// use inkrig_transport::{Mat, row_softmax};
/// let cost = Mat::from_vec(1, 3, vec![0.0f32, 0.02, 9.0])?;
/// let mut out = Mat::zeros(0, 0);
/// row_softmax(cost.view(), 0.02, &mut out)?;
/// assert!((out.row(0)[0] - 0.7311).abs() < 1e-4 && out.row(0)[2] == 0.0);
/// # Ok::<(), inkrig_transport::TransportError>(())
/// ```
pub fn row_softmax<T: Real>(
    cost: MatRef<'_, T>,
    temperature: f64,
    out: &mut Mat<T>,
) -> Result<(), TransportError> {
    row_softmax_at(Isa::current(), cost, temperature, out)
}

fn row_softmax_at<T: Real>(
    isa: Isa,
    cost: MatRef<'_, T>,
    temperature: f64,
    out: &mut Mat<T>,
) -> Result<(), TransportError> {
    if !(1e-9..=1e9).contains(&temperature) {
        let range = "between 1e-9 and 1e9";
        return Err(TransportError::Parameter { name: "temperature", value: temperature, range });
    }
    out.reshape(cost.rows(), cost.cols());
    if cost.cols() > 0 {
        let inverse_temperature = T::from_f64(1.0 / temperature);
        let (cols, cost, out) = (cost.cols(), cost.as_slice(), out.as_mut_slice());
        dispatch(isa, Softmax { cost, out, cols, inverse_temperature });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_level_agrees_with_the_definition(
            cols in 1usize..80,
            seed in 0u32..1000,
            temperature in 0.01f64..2.0,
        ) {
            let cost = Mat::from_fn(3, cols, |i, j| {
                f64::from(((i * cols + j) as u32).wrapping_mul(2_654_435_761).wrapping_add(seed * 40_503) >> 16) / 65536.0
            });
            for isa in Isa::ALL.into_iter().filter(|&isa| isa <= Isa::detect()) {
                let mut out = Mat::zeros(0, 0);
                row_softmax_at(isa, cost.view(), temperature, &mut out).unwrap();
                let small = Mat::from_fn(3, cols, |i, j| cost.row(i)[j] as f32);
                let mut out_small = Mat::zeros(0, 0);
                row_softmax_at(isa, small.view(), temperature, &mut out_small).unwrap();
                for i in 0..3 {
                    let total: f64 = cost.row(i).iter().map(|c| (-c / temperature).exp()).sum();
                    for j in 0..cols {
                        let want = (-cost.row(i)[j] / temperature).exp() / total;
                        prop_assert!((out.row(i)[j] - want).abs() < 1e-14);
                        prop_assert!((f64::from(out_small.row(i)[j]) - want).abs() < 2e-5);
                    }
                }
            }
        }
    }

    #[test]
    fn bad_temperatures_are_refused() {
        let cost = Mat::<f32>::zeros(1, 1);
        for temperature in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(row_softmax(cost.view(), temperature, &mut Mat::zeros(0, 0)).is_err());
        }
    }
}
