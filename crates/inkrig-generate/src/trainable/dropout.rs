//! Numbers that are dropped in training, by a stream that the caller gives: a run can be stopped and repeated to the bit, whatever
//! else runs beside it.

use crate::schedule::mix;
use burn::tensor::{Tensor, TensorData};
use std::cell::Cell;

thread_local! {
    /// State of the stream; none, and nothing is dropped.
    static STREAM: Cell<Option<u64>> = const { Cell::new(None) };
}

/// Runs networks on this thread with their shares of numbers dropped; which they are belongs to `seed`. Outside of this nothing is.
pub fn dropping<T>(seed: u64, run: impl FnOnce() -> T) -> T {
    let before = STREAM.replace(Some(mix(seed)));
    let result = run();
    STREAM.set(before);
    result
}

/// Sets a share of the numbers to zero and makes the others so much larger that the mean stays.
pub(crate) fn drop_out<const D: usize>(x: Tensor<D>, share: f64) -> Tensor<D> {
    let Some(mut state) = STREAM.get().filter(|_| share > 0.0) else { return x };
    let kept = (1.0 / (1.0 - share)) as f32;
    let below = (share * 65_536.0) as u64;
    let count = x.shape().num_elements();
    let mut mask = Vec::with_capacity(count.next_multiple_of(4));
    for _ in 0..count.div_ceil(4) {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let bits = mix(state);
        // Sixteen bits decide on one number.
        mask.extend([0, 16, 32, 48].map(|at| if (bits >> at) & 0xFFFF < below { 0.0 } else { kept }));
    }
    mask.truncate(count);
    STREAM.set(Some(state));
    let mask = Tensor::from_data(TensorData::new(mask, x.dims()), &x.device());
    x * mask
}

#[cfg(test)]
mod tests {
    use super::*;
    use burn::tensor::Device;

    #[test]
    fn the_share_is_dropped_by_the_seed_and_nothing_outside() {
        let ones = || Tensor::<2>::ones([100, 103], &Device::flex());
        let numbers = |x: Tensor<2>| -> Vec<f32> { x.into_data().try_into_vec().unwrap() };
        assert_eq!(numbers(drop_out(ones(), 0.25)), numbers(ones()));
        let one = dropping(7, || numbers(drop_out(ones(), 0.25)));
        assert_eq!(one, dropping(7, || numbers(drop_out(ones(), 0.25))));
        assert_ne!(one, dropping(8, || numbers(drop_out(ones(), 0.25))));
        let zeros = one.iter().filter(|x| **x == 0.0).count() as f64 / one.len() as f64;
        assert!((zeros - 0.25).abs() < 0.02, "{zeros}");
        let mean = one.iter().sum::<f32>() / one.len() as f32;
        assert!((mean - 1.0).abs() < 0.03, "{mean}");
        let [first, second] = dropping(7, || [drop_out(ones(), 0.25), drop_out(ones(), 0.25)]).map(numbers);
        assert_ne!(first, second, "the stream goes on");
    }
}
