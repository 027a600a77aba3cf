//! AdamW (Loshchilov and Hutter 2019) on plain numbers, so that its state is saved and taken up again to the bit.

/// How it walks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AdamW {
    /// Decay of the mean of gradients and of that of their squares.
    pub betas: (f64, f64),
    /// Share of a weight that a step at rate 1 takes away.
    pub weight_decay: f64,
}

/// What it remembers of its way.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Moments {
    /// Steps that were taken.
    pub step: u64,
    pub mean: Vec<f32>,
    pub square: Vec<f32>,
}

impl Moments {
    /// Of no step, for so many weights.
    pub(crate) fn new(weights: usize) -> Self {
        Self { step: 0, mean: vec![0.0; weights], square: vec![0.0; weights] }
    }
}

impl AdamW {
    /// Moves the weights by one step at a rate.
    pub(crate) fn step(self, weights: &mut [f32], gradient: &[f32], moments: &mut Moments, rate: f64) {
        moments.step += 1;
        let (first, second) = self.betas;
        let steps = moments.step.min(1 << 30) as i32;
        let (rise_mean, rise_square) = (1.0 - first.powi(steps), 1.0 - second.powi(steps));
        let (first, second) = (first as f32, second as f32);
        let step = (rate / rise_mean) as f32;
        let (root, keep) = (1.0 / (rise_square.sqrt() as f32), 1.0 - (rate * self.weight_decay) as f32);
        let rows = weights.iter_mut().zip(gradient).zip(&mut moments.mean).zip(&mut moments.square);
        for (((weight, &gradient), mean), square) in rows {
            *mean = first * *mean + (1.0 - first) * gradient;
            *square = second * *square + (1.0 - second) * gradient * gradient;
            *weight = *weight * keep - step * *mean / (square.sqrt() * root + 1e-8);
        }
    }
}

/// Shortens a gradient that is longer than `most`; gives its length.
pub(crate) fn clip(gradient: &mut [f32], most: f64) -> f64 {
    let length = gradient.iter().map(|&part| f64::from(part) * f64::from(part)).sum::<f64>().sqrt();
    if length > most {
        let by = (most / length) as f32;
        gradient.iter_mut().for_each(|part| *part *= by);
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_walks_into_the_middle_of_a_bowl() {
        let adam = AdamW { betas: (0.9, 0.99), weight_decay: 0.0 };
        let (mut weights, mut moments) = (vec![3.0_f32, -2.0], Moments::new(2));
        for _ in 0..500 {
            let gradient: Vec<f32> = weights.iter().map(|weight| 2.0 * (weight - 1.0)).collect();
            adam.step(&mut weights, &gradient, &mut moments, 0.05);
        }
        assert!(weights.iter().all(|weight| (weight - 1.0).abs() < 0.02), "{weights:?}");
        // The first step is as long as the rate, whatever the gradient.
        let (mut one, mut fresh) = (vec![0.0_f32], Moments::new(1));
        adam.step(&mut one, &[1e-3], &mut fresh, 0.1);
        assert!((one[0] + 0.1).abs() < 1e-4, "{one:?}");
        let decaying = AdamW { weight_decay: 0.5, ..adam };
        let (mut one, mut fresh) = (vec![1.0_f32], Moments::new(1));
        decaying.step(&mut one, &[0.0], &mut fresh, 0.1);
        assert!((one[0] - 0.95).abs() < 1e-6);
    }

    #[test]
    fn a_long_gradient_is_shortened_and_a_short_one_left() {
        let mut gradient = [3.0, 4.0];
        assert_eq!(clip(&mut gradient, 1.0), 5.0);
        assert!((gradient[0] - 0.6).abs() < 1e-6 && (gradient[1] - 0.8).abs() < 1e-6);
        assert!((clip(&mut gradient, 2.0) - 1.0).abs() < 1e-6);
        assert!(clip(&mut [f32::NAN], 1.0).is_nan());
    }
}
