//! The arithmetic of the networks: everything on slices, nothing allocated in a call that ran before.
//!
//! Vector instructions are chosen at run time by the `pulp` crate. Every number is the same sum in the same order
//! whatever the batch, so a clip does not depend on what else is computed beside it.

pub(crate) mod attention;
pub(crate) mod elementwise;
pub(crate) mod half;
pub(crate) mod normal;
pub(crate) mod product;

/// Makes a buffer as long as it has to be; what was in it is of no use.
pub(crate) fn fit<T: Clone + Default>(buffer: &mut Vec<T>, length: usize) -> &mut [T] {
    buffer.resize(length, T::default());
    buffer
}

#[cfg(test)]
pub(crate) mod testing {
    use crate::schedule::Noise;

    pub(crate) fn numbers(seed: u64, count: usize) -> Vec<f32> {
        Noise::new(seed).normals(count)
    }

    pub(crate) fn apart(a: &[f32], b: &[f32]) -> f32 {
        assert_eq!(a.len(), b.len());
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    }
}
