//! Windows of motion as latents: worked out once, drawn from at every step.

use super::course::broken;
use super::motions::Motion;
use super::stage::network;
use crate::TrainError;
use inkrig_generate::networks::{Sizes, Vae};
use inkrig_generate::schedule::Noise;
use inkrig_generate::text::VERBS;
use inkrig_motion::humanml::WIDTH;
use rayon::prelude::*;

/// A window of a clip.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Window {
    /// Which of the clips.
    pub motion: usize,
    /// Its first frame.
    pub first: usize,
    /// Its frames.
    pub frames: usize,
}

/// Which windows are taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cut {
    /// Frames of most windows.
    pub frames: usize,
    /// Frames from one to the next.
    pub stride: usize,
    /// One more of another length for this share of them.
    pub other_lengths: f64,
    /// The shortest of those.
    pub shortest: usize,
    /// The longest of those.
    pub longest: usize,
}

impl Cut {
    /// The same, if the autoencoder takes such windows.
    pub(super) fn checked(self, sizes: &Sizes) -> Result<Self, TrainError> {
        let most = sizes.most_frames();
        let fits = [("frames", self.frames <= most), ("longest", self.longest <= most)];
        let range = format!("at most {most}, which the autoencoder takes");
        broken(fits.map(|(name, fits)| (name, fits, range.clone()))).map_err(TrainError::Device)?;
        Ok(self)
    }
}

/// Windows of all clips. A clip that is shorter than one is a window of its own, unless it is shorter than the shortest.
pub(super) fn windows(motions: &[Motion], cut: Cut, seed: u64) -> Vec<Window> {
    let mut noise = Noise::new(seed);
    let mut all = Vec::new();
    for (motion, own) in motions.iter().enumerate() {
        let length = own.frames();
        let frames = cut.frames.min(length);
        if length < cut.shortest.min(cut.frames) || length < 2 {
            continue;
        }
        for first in (0..=length - frames).step_by(cut.stride.max(1)) {
            all.push(Window { motion, first, frames });
            if noise.uniform() < cut.other_lengths {
                let span = (cut.longest - cut.shortest + 1) as f64;
                let frames = (cut.shortest + (noise.uniform() * span) as usize).min(length);
                let first = (noise.uniform() * (length - frames + 1) as f64) as usize;
                all.push(Window { motion, first, frames });
            }
        }
    }
    all
}

impl Window {
    /// Its rows in its clip.
    pub(super) fn rows<'a>(&self, motions: &'a [Motion]) -> &'a [f32] {
        let rows = motions.get(self.motion).map_or(&[][..], |motion| &motion.rows);
        rows.get(self.first * WIDTH..(self.first + self.frames) * WIDTH).unwrap_or_default()
    }
}

/// What the autoencoder says of windows.
#[derive(Debug, Clone)]
pub(super) struct Latents {
    /// Numbers of a latent.
    pub each: usize,
    mean: Vec<f32>,
    deviation: Vec<f32>,
    verbs: Vec<Vec<usize>>,
    /// Sums of weights: where a random number falls, that window is taken.
    upto: Vec<f64>,
    /// Windows of each verb.
    by_verb: Vec<Vec<usize>>,
}

/// How samples are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Drawing {
    /// Share of samples that lose their text.
    pub text_dropped: f64,
    /// Share of samples that are mixed of two windows of a verb.
    pub mixed: f64,
}

impl Latents {
    /// Encodes windows on so many threads.
    pub(super) fn encode(
        vae: &Vae,
        motions: &[Motion],
        windows: &[Window],
        threads: usize,
    ) -> Result<Self, TrainError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|error| TrainError::Threads(error.to_string()))?;
        let encoded = pool.install(|| {
            let encode = |window: &Window| vae.encode(window.rows(motions)).map_err(network);
            windows.par_iter().map(encode).collect::<Result<Vec<_>, _>>()
        })?;
        let mut sum = 0.0;
        let upto = windows.iter().map(|window| {
            sum += motions.get(window.motion).map_or(0.0, |motion| motion.weight);
            sum
        });
        let upto = upto.collect();
        let verbs: Vec<Vec<usize>> = windows
            .iter()
            .map(|window| motions.get(window.motion).map_or_else(Vec::new, |motion| motion.verbs.clone()))
            .collect();
        let mut by_verb = vec![Vec::new(); VERBS.len()];
        for (window, verbs) in verbs.iter().enumerate() {
            for &verb in verbs {
                if let Some(own) = by_verb.get_mut(verb) {
                    own.push(window);
                }
            }
        }
        let deviation = |log_variance: &f32| (0.5 * log_variance).exp();
        Ok(Self {
            each: vae.latent_width(),
            mean: encoded.iter().flat_map(|row| &row.mean).copied().collect(),
            deviation: encoded.iter().flat_map(|row| row.log_variance.iter().map(deviation)).collect(),
            verbs,
            upto,
            by_verb,
        })
    }

    /// How many windows there are.
    pub(super) fn len(&self) -> usize {
        self.verbs.len()
    }

    /// The verbs of a window.
    pub(super) fn verbs(&self, window: usize) -> &[usize] {
        self.verbs.get(window).map_or(&[], Vec::as_slice)
    }

    /// The mean of a window's latent.
    pub(super) fn mean(&self, window: usize) -> &[f32] {
        self.mean.get(window * self.each..(window + 1) * self.each).unwrap_or_default()
    }

    /// A window by the weights.
    pub(super) fn pick(&self, noise: &mut Noise) -> usize {
        let place = noise.uniform() * self.upto.last().copied().unwrap_or(0.0);
        self.upto.partition_point(|&upto| upto <= place).min(self.len().saturating_sub(1))
    }

    /// Adds a latent of a window to `out`: its mean, and fresh noise of its deviation.
    pub(super) fn sample(&self, window: usize, noise: &mut Noise, out: &mut Vec<f32>) {
        let own = window * self.each..(window + 1) * self.each;
        let rows = self.mean.get(own.clone()).into_iter().flatten();
        let deviations = self.deviation.get(own).into_iter().flatten();
        out.extend(rows.zip(deviations).map(|(mean, deviation)| mean + deviation * noise.normal()));
    }

    /// Draws a verb of a window; none where it has none, or where the text is dropped.
    pub(super) fn verb(&self, window: usize, dropped: f64, noise: &mut Noise) -> Option<usize> {
        let drop = noise.uniform() < dropped;
        let place = noise.uniform();
        let verbs = self.verbs(window);
        verbs.get((place * verbs.len() as f64) as usize).copied().filter(|_| !drop)
    }

    /// Draws latents with a verb each.
    pub(super) fn draw(
        &self,
        count: usize,
        drawing: Drawing,
        noise: &mut Noise,
    ) -> (Vec<f32>, Vec<Option<usize>>) {
        let mut latents = Vec::with_capacity(count * self.each);
        let mut verbs = Vec::with_capacity(count);
        let mut other = Vec::new();
        for _ in 0..count {
            let window = self.pick(noise);
            let first = latents.len();
            self.sample(window, noise, &mut latents);
            let verb = self.verb(window, 0.0, noise);
            let fellows = verb.and_then(|verb| self.by_verb.get(verb)).filter(|fellows| fellows.len() > 1);
            if let Some(fellows) = fellows.filter(|_| noise.uniform() < drawing.mixed) {
                let fellow = (noise.uniform() * fellows.len() as f64) as usize;
                let fellow = fellows.get(fellow).copied().unwrap_or(window);
                other.clear();
                self.sample(fellow, noise, &mut other);
                let share = noise.uniform() as f32;
                let own = latents.iter_mut().skip(first);
                own.zip(&other).for_each(|(value, other)| *value += share * (other - *value));
            }
            verbs.push(verb.filter(|_| noise.uniform() >= drawing.text_dropped));
        }
        (latents, verbs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_generate::networks::Parts;
    use inkrig_generate::weights::hashed;

    fn motion(frames: usize, verbs: &[usize], weight: f64) -> Motion {
        let rows = Noise::new(frames as u64).normals(frames * WIDTH);
        Motion { rows, verbs: verbs.to_vec(), key_poses: vec![0], weight }
    }

    #[test]
    fn windows_cover_clips_and_latents_are_drawn_by_weight() {
        let motions = [motion(60, &[3], 1.0), motion(15, &[1, 2], 3.0), motion(5, &[0], 1.0)];
        let cut = Cut { frames: 20, stride: 10, other_lengths: 0.5, shortest: 10, longest: 40 };
        let windows = windows(&motions, cut, 1);
        let usual: Vec<_> =
            windows.iter().filter(|window| window.motion == 0 && window.frames == 20).collect();
        assert!(usual.len() >= 5, "{windows:?}");
        assert!(windows.iter().any(|window| window.frames != 20 && window.motion == 0));
        assert!(windows.iter().all(|window| window.rows(&motions).len() == window.frames * WIDTH));
        assert!(windows.iter().all(|window| window.motion < 2), "five frames are too few");

        let windows = [0, 1].map(|motion| Window { motion, first: 0, frames: 15 });
        let sizes = Sizes::tiny();
        let vae = Vae::new(&sizes, &hashed(&sizes, Parts::VAE)).unwrap();
        let latents = Latents::encode(&vae, &motions, &windows, 1).unwrap();
        assert_eq!((latents.len(), latents.each), (2, sizes.width));
        assert_eq!(latents.mean(1), vae.encode(windows[1].rows(&motions)).unwrap().mean);
        let drawing = Drawing { text_dropped: 0.2, mixed: 0.0 };
        let (numbers, verbs) = latents.draw(2000, drawing, &mut Noise::new(4));
        assert_eq!(numbers.len(), 2000 * sizes.width);
        let share =
            |wanted: Option<usize>| verbs.iter().filter(|verb| **verb == wanted).count() as f64 / 2000.0;
        for (verb, expected) in [(None, 0.2), (Some(3), 0.2), (Some(1), 0.3), (Some(2), 0.3)] {
            assert!((share(verb) - expected).abs() < 0.04, "{verb:?} {}", share(verb));
        }
        assert_eq!(latents.draw(9, drawing, &mut Noise::new(4)).1, verbs[..9]);
    }

    #[test]
    fn mixed_latents_lie_between_two_of_a_verb() {
        let motions = [motion(20, &[3], 1.0), motion(21, &[3], 1.0)];
        let windows = [0, 1].map(|motion| Window { motion, first: 0, frames: 20 });
        let sizes = Sizes::tiny();
        let vae = Vae::new(&sizes, &hashed(&sizes, Parts::VAE)).unwrap();
        let mut latents = Latents::encode(&vae, &motions, &windows, 1).unwrap();
        latents.deviation.fill(0.0);
        let drawing = Drawing { text_dropped: 0.0, mixed: 1.0 };
        let (numbers, _) = latents.draw(50, drawing, &mut Noise::new(4));
        let (a, b) = (latents.mean(0), latents.mean(1));
        let between = |(at, value): (usize, &f32)| {
            let (low, high) = (a[at % a.len()].min(b[at % a.len()]), a[at % a.len()].max(b[at % a.len()]));
            (low - 1e-5..=high + 1e-5).contains(value)
        };
        assert!(numbers.iter().enumerate().all(between));
        assert!(numbers.chunks(a.len()).any(|row| row != a && row != b));
    }
}
