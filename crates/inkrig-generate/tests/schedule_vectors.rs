//! Schedules are those of the published code.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod reference;

use inkrig_generate::schedule::{Ddim, Lcm, NoiseSchedule};
use reference::{Vectors, assert_near};

#[test]
fn noise_and_steps_are_those_of_the_published_code() {
    let Some(vectors) = Vectors::open("schedulers") else { return };
    let schedule = NoiseSchedule::default();
    assert_near("rates of noise", schedule.betas(), &vectors.numbers("betas"), 1e-6);
    let alphas = vectors.numbers("alphas_cumprod");
    let relative: Vec<f32> = schedule.alphas().iter().zip(&alphas).map(|(a, b)| a / b).collect();
    assert_near("signal left", &relative, &[1.0; 1000], 1e-6);
    assert_eq!(Ddim::new(50).unwrap().timesteps(), vectors.whole("ddim_timesteps_50"));
    assert!((schedule.alpha(0) - vectors.numbers("ddim_final_alpha_cumprod")[0]).abs() < 1e-6);
    for steps in [1, 2, 4] {
        let expected = vectors.whole(&format!("lcm_timesteps_{steps}"));
        assert_eq!(Lcm::new(steps).unwrap().timesteps(), expected);
    }
}
