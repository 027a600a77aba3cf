//! How long steps are over a run.

/// Rises for `warm_up` steps, then falls along a half cosine to a hundredth at `steps`.
pub(crate) fn rate(highest: f64, step: u64, warm_up: u64, steps: u64) -> f64 {
    if step < warm_up {
        return highest * (step + 1) as f64 / warm_up as f64;
    }
    let share = (step - warm_up) as f64 / steps.saturating_sub(warm_up).max(1) as f64;
    let cosine = 0.5 * (1.0 + (std::f64::consts::PI * share.min(1.0)).cos());
    highest * (0.01 + 0.99 * cosine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_rises_falls_and_stays_above_zero() {
        assert_eq!(rate(1.0, 0, 10, 100), 0.1);
        assert_eq!(rate(1.0, 9, 10, 100), 1.0);
        assert_eq!(rate(1.0, 10, 10, 100), 1.0);
        assert!((rate(1.0, 55, 10, 100) - 0.505).abs() < 1e-9);
        assert!((rate(1.0, 100, 10, 100) - 0.01).abs() < 1e-9);
        assert!((rate(1.0, 5000, 10, 100) - 0.01).abs() < 1e-9);
        assert!(rate(1.0, 0, 0, 0) > 0.0);
    }
}
