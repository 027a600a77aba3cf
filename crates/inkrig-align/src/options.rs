//! What may be set, with defaults that were measured.

use crate::{AlignError, ControlKind, Key, Solver};
use inkrig_motion::{FeatureOptions, VelocityFrame};

/// How much the result shall follow the control, and how much it shall stay what the clip is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Preset {
    /// Structure first: alpha 0.9.
    #[default]
    Follow,
    /// The clip's own poses first: alpha 0.7.
    Natural,
}

/// By what a table of distances is divided, so that distances of a drawing and of a motion can be compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Norm {
    /// Their mean (measured: better or equal everywhere).
    #[default]
    Mean,
    /// Their largest. Weights mean something else then: try an epsilon of 0.002.
    Max,
    /// Their 90th percentile: as the largest, but a single odd pose does not count.
    Quantile,
    /// The control's distances only: their mean first, then at every level the factor that fits them best to the
    /// motion's at the plan found so far (Sec. 7, "Pairwise Distance Scaling").
    Learned,
}

/// Everything that steers an alignment. `Options::default()` is the preset [`Preset::Follow`].
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Weight of the control's structure (Gromov-Wasserstein) against nearness to the clip, 0..=1 (Sec. 5.1).
    pub alpha: f64,
    /// Weight of using all of the clip evenly, > 0 (the soft marginal, Sec. 3.2.4).
    pub lambda: f64,
    /// Entropy: how many source frames one output frame may mix, > 0.
    pub epsilon: f64,
    /// Length of a patch, seconds. 11 frames of 30 a second in the paper.
    pub patch_seconds: f64,
    /// Number of levels from coarse to fine, at least 1 (Sec. 3.2.5).
    pub levels: usize,
    /// How many times shorter the coarsest level is, at least 1. It is held back where it would leave fewer than
    /// five patches' length.
    pub ratio: f64,
    /// Match-and-blend rounds of every level.
    pub rounds: usize,
    /// Gradients of every round.
    pub iterations: usize,
    /// Starts that are scouted at the coarsest level, at least 1: a single one may end in a poor local minimum.
    pub starts: usize,
    /// Gradients of every scout, at least 1.
    pub scouting: usize,
    /// Gradients with which the best scout goes on; structure only, as for the scouts.
    pub first_iterations: usize,
    /// Match-and-blend steps at the end that only look at nearness to the clip (alpha 0).
    pub polish: usize,
    /// Scaling of the motion's distances; [`Norm::Learned`] counts as [`Norm::Mean`] here.
    pub source_norm: Norm,
    /// Scaling of the control's distances.
    pub control_norm: Norm,
    /// Frames a second at which motion and control are compared.
    pub matching_rate: f64,
    /// What frames are compared by.
    pub features: FeatureOptions,
    /// How the root's travel is carried over.
    pub travel: VelocityFrame,
    /// Poses that shall, or shall not, appear.
    pub keys: Vec<Key>,
    /// Begin with the mirror image of the first plan: what the control has alike on two sides (the rising and the falling
    /// slopes of a wave, two halves of a figure) changes places. Nothing happens where it has no such sides.
    pub mirror: bool,
    /// Every seed scouts starts of its own, so another may find another of the equally good solutions.
    pub seed: u64,
    /// How the transport problems are solved.
    pub solver: Solver,
    /// Threads to work with, at least 1. The result does not depend on it.
    pub threads: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            alpha: 0.9,
            lambda: 0.05,
            epsilon: 0.005,
            patch_seconds: 11.0 / 30.0,
            levels: 6,
            ratio: 4.0,
            rounds: 3,
            iterations: 4,
            starts: 4,
            scouting: 9,
            first_iterations: 24,
            polish: 2,
            source_norm: Norm::Mean,
            control_norm: Norm::Mean,
            matching_rate: 30.0,
            features: FeatureOptions::default(),
            travel: VelocityFrame::default(),
            keys: Vec::new(),
            mirror: false,
            seed: 0,
            solver: Solver::Auto,
            threads: std::thread::available_parallelism().map_or(1, |count| count.get().min(16)),
        }
    }
}

impl Options {
    /// The options of a preset, for a drawn curve.
    pub fn preset(preset: Preset) -> Self {
        Self::for_control(ControlKind::Curve, preset)
    }

    /// The options of a preset for a kind of control, as measured.
    ///
    /// Motions are scaled by a high quantile: over five pairs of motions that gave structure .84 at a distance of .175
    /// to the clip, against .82 and .187 by the mean; for drawn curves it was not better.
    pub fn for_control(kind: ControlKind, preset: Preset) -> Self {
        let mut options = Self::default();
        match kind {
            ControlKind::Curve | ControlKind::Wave => {}
            // A small lambda freezes: all of a label's frames would be drawn to one moment. A small epsilon keeps movements
            // apart that are alike for the control.
            ControlKind::Labels => {
                options.lambda = 0.2;
                options.epsilon = 0.0025;
            }
            // A plan that mixes more poses needs no polish, which costs structure here, and a control scaled to be
            // smaller than the clip asks for no leaps.
            ControlKind::Sound => {
                options.lambda = 0.02;
                options.epsilon = 0.01;
                options.polish = 0;
                options.control_norm = Norm::Quantile;
            }
            ControlKind::Motion => {
                options.source_norm = Norm::Quantile;
                options.control_norm = Norm::Quantile;
            }
        }
        if preset == Preset::Natural {
            options.alpha = 0.7;
        }
        options
    }

    /// The same with a schedule for answers while a stroke is being drawn: 4 levels of 2 rounds of 3 gradients, 3 scouts
    /// of 5 and 12 more: 51 gradients for 132, at about a third of the time.
    #[must_use]
    pub fn preview_schedule(self) -> Self {
        Self { levels: 4, rounds: 2, iterations: 3, starts: 3, scouting: 5, first_iterations: 12, ..self }
    }

    /// Frames of a patch at the matching rate, at least 2.
    pub fn patch(&self) -> usize {
        ((self.patch_seconds * self.matching_rate).round() as usize).max(2)
    }

    /// Solver gradients of a whole run.
    pub fn gradients(&self) -> usize {
        self.starts * self.scouting + self.first_iterations + self.levels * self.rounds * self.iterations
    }

    /// Checks that every number is one that the solver can work with.
    ///
    /// # Errors
    /// Names the first option that is not.
    pub fn validate(&self) -> Result<(), AlignError> {
        let check = |name, value: f64, good: bool, range| {
            if good { Ok(()) } else { Err(AlignError::Option { name, value, range }) }
        };
        let within = |value: f64, low: f64, high: f64| value.is_finite() && value >= low && value <= high;
        check("alpha", self.alpha, within(self.alpha, 0.0, 1.0), "from 0 to 1")?;
        check("lambda", self.lambda, within(self.lambda, 1e-4, 100.0), "from 0.0001 to 100")?;
        check("epsilon", self.epsilon, within(self.epsilon, 1e-4, 10.0), "from 0.0001 to 10")?;
        check(
            "patch",
            self.patch_seconds,
            within(self.patch_seconds, 0.01, 60.0),
            "from 0.01 to 60 seconds",
        )?;
        check("ratio", self.ratio, within(self.ratio, 1.0, 64.0), "from 1 to 64")?;
        let rate = self.matching_rate;
        check("matching rate", rate, within(rate, 1.0, 240.0), "from 1 to 240 frames a second")?;
        let counts = [
            ("levels", self.levels, 1, 16, "from 1 to 16"),
            ("rounds", self.rounds, 1, 1000, "from 1 to 1000"),
            ("iterations", self.iterations, 1, 100_000, "from 1 to 100000"),
            ("starts", self.starts, 1, 1000, "from 1 to 1000"),
            ("scouting", self.scouting, 1, 100_000, "from 1 to 100000"),
            ("first iterations", self.first_iterations, 1, 100_000, "from 1 to 100000"),
            ("polish", self.polish, 0, 100, "from 0 to 100"),
            ("threads", self.threads, 1, 1024, "from 1 to 1024"),
        ];
        for (name, value, low, high, range) in counts {
            check(name, value as f64, (low..=high).contains(&value), range)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_valid_and_cost_what_is_written() {
        let options = Options::default();
        assert!(options.validate().is_ok());
        assert_eq!((options.patch(), options.gradients()), (11, 132));
        assert_eq!(options.preview_schedule().gradients(), 51);
    }

    #[test]
    fn bad_numbers_are_named() {
        let bad = Options { epsilon: f64::NAN, ..Options::default() };
        assert!(bad.validate().unwrap_err().to_string().starts_with("epsilon is NaN"));
        let bad = Options { levels: 0, ..Options::default() };
        assert!(bad.validate().unwrap_err().to_string().contains("levels is 0, but must be from 1 to 16"));
    }
}
