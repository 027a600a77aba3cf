//! What a channel does to its node over time (glTF 2.0, appendix C).

use super::{
    accessor::{self, Accessor},
    buffers::Buffers,
    damaged,
    document::{Document, Interpolation, Path, Sampler, Shape},
};
use crate::{FormatError, lexer::LARGEST_NUMBER};
use inkrig_motion::glam::{DQuat, DVec3};

/// One channel: keys of one property of one node.
#[derive(Debug)]
pub(super) struct Track<'a> {
    pub(super) node: usize,
    pub(super) path: Path,
    interpolation: Interpolation,
    times: Accessor<'a>,
    values: Accessor<'a>,
    /// The last key at or before the time asked for last: time goes forward.
    key: usize,
}

impl<'a> Track<'a> {
    /// Opens a channel and checks every key. `most` bounds keys without bytes.
    pub(super) fn open(
        node: usize,
        path: Path,
        sampler: &Sampler,
        document: &Document,
        buffers: &'a Buffers<'_>,
        most: usize,
    ) -> Result<Self, FormatError> {
        let shape = if path == Path::Rotation { Shape::Vec4 } else { Shape::Vec3 };
        let times = accessor::open(sampler.input, Shape::Scalar, document, buffers, most)?;
        let values = accessor::open(sampler.output, shape, document, buffers, most)?;
        let track = Self { node, path, interpolation: sampler.interpolation, times, values, key: 0 };
        track.check(sampler)?;
        Ok(track)
    }

    /// How many keys, at least 1.
    pub(super) fn keys(&self) -> usize {
        self.times.count
    }

    /// Time of a key, seconds.
    pub(super) fn time(&self, key: usize) -> f64 {
        self.times.scalar(key)
    }

    /// Goes back to the first key.
    pub(super) fn rewind(&mut self) {
        self.key = 0;
    }

    /// The vector at a time, which may not be before that of an earlier call. Keys up to `slack` seconds ahead count
    /// as reached: f32 times lie beside their frames.
    pub(super) fn vector(&mut self, time: f64, slack: f64) -> DVec3 {
        let at = |values: &Accessor<'_>, element| DVec3::from_array(values.get(element));
        let (key, part, step) = self.find(time, slack);
        match self.interpolation {
            Interpolation::CubicSpline if part > 0.0 => {
                self.cubic(key, part, step, |element| at(&self.values, element))
            }
            Interpolation::CubicSpline => at(&self.values, 3 * key + 1),
            Interpolation::Linear if part > 0.0 => {
                at(&self.values, key).lerp(at(&self.values, key + 1), part)
            }
            _ => at(&self.values, key),
        }
    }

    /// As [`Self::vector`], a rotation.
    pub(super) fn rotation(&mut self, time: f64, slack: f64) -> DQuat {
        let at = |values: &Accessor<'_>, element| DQuat::from_array(values.get(element));
        let (key, part, step) = self.find(time, slack);
        let raw = match self.interpolation {
            Interpolation::CubicSpline if part > 0.0 => {
                self.cubic(key, part, step, |element| at(&self.values, element))
            }
            Interpolation::CubicSpline => at(&self.values, 3 * key + 1),
            Interpolation::Linear if part > 0.0 => {
                let (from, to) = (at(&self.values, key).normalize(), at(&self.values, key + 1).normalize());
                from.slerp(to, part)
            }
            _ => at(&self.values, key),
        };
        // A spline may pass through zero.
        if raw.length_squared() > 1e-24 { raw.normalize() } else { DQuat::IDENTITY }
    }

    /// The key that holds at a time, how far the time is towards the next (0 to 1), and the seconds between them.
    fn find(&mut self, time: f64, slack: f64) -> (usize, f64, f64) {
        while self.key + 1 < self.times.count && self.times.scalar(self.key + 1) <= time + slack {
            self.key += 1;
        }
        let from = self.times.scalar(self.key);
        if self.key + 1 >= self.times.count || time <= from + slack {
            return (self.key, 0.0, 0.0);
        }
        let step = self.times.scalar(self.key + 1) - from;
        (self.key, ((time - from) / step).clamp(0.0, 1.0), step)
    }

    /// Each key has a tangent in, a value and a tangent out.
    fn cubic<T>(&self, key: usize, part: f64, step: f64, at: impl Fn(usize) -> T) -> T
    where
        T: std::ops::Mul<f64, Output = T> + std::ops::Add<Output = T>,
    {
        let (t, t2, t3) = (part, part * part, part * part * part);
        at(3 * key + 1) * (2.0 * t3 - 3.0 * t2 + 1.0)
            + at(3 * key + 2) * (step * (t3 - 2.0 * t2 + t))
            + at(3 * key + 4) * (3.0 * t2 - 2.0 * t3)
            + at(3 * key + 3) * (step * (t3 - t2))
    }

    fn check(&self, sampler: &Sampler) -> Result<(), FormatError> {
        let hint = "the file is damaged; export it again";
        let times = format!("accessor {}", sampler.input);
        let values = format!("accessor {}", sampler.output);
        if self.times.count == 0 {
            return Err(damaged("gltf-keys", times, "a channel without keys", hint));
        }
        let each = if self.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let wanted = self.times.count.saturating_mul(each);
        if self.values.count < wanted {
            let what =
                format!("{} values for {} keys, which need {wanted}", self.values.count, self.times.count);
            return Err(damaged("gltf-keys", values, what, hint));
        }
        let mut before = f64::NEG_INFINITY;
        for key in 0..self.times.count {
            let time = self.times.scalar(key);
            if !(time.is_finite() && time >= before && time.abs() <= 1e9) {
                let what = format!("key {key} is at {time} s, and times are numbers that rise");
                return Err(damaged("gltf-times", times, what, hint));
            }
            before = time;
        }
        for element in 0..wanted {
            let value: [f64; 4] = self.values.get(element);
            if !value.iter().all(|number| number.abs() <= LARGEST_NUMBER) {
                let what = format!("element {element} has a number that is none or too large");
                return Err(damaged("gltf-values", values, what, hint));
            }
            let is_key = each == 1 || element % 3 == 1;
            if self.path == Path::Rotation && is_key && DQuat::from_array(value).length_squared() < 1e-12 {
                let what = format!("element {element} is a rotation of zero");
                return Err(damaged("gltf-values", values, what, hint));
            }
        }
        Ok(())
    }
}
