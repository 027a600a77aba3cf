//! Where joints are over time, as our writer and every importer note it down, and how far two such notes are apart.

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result, bail, ensure};
use serde_json::Value;

/// Places of named joints: frames x joints x 3, metres, y up.
pub(crate) struct Tracks {
    joints: Vec<String>,
    frames: usize,
    places: Vec<f32>,
}

/// What comparing says.
pub(crate) struct Comparison {
    /// How many joints there should be, and how many of them were found by name.
    joints: usize,
    matched: usize,
    frames: usize,
    /// Largest distance between a joint here and there, millimetres.
    pub(crate) most_mm: f64,
    mean_mm: f64,
}

impl Tracks {
    /// A line of JSON with `joints` and `frames`, then little-endian f32.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
        Self::of(&bytes).with_context(|| format!("{} holds no places of joints", path.display()))
    }

    fn of(bytes: &[u8]) -> Result<Self> {
        let end = bytes.iter().position(|&byte| byte == b'\n').context("no first line")?;
        let header: Value = serde_json::from_slice(&bytes[..end])?;
        let joints: Vec<String> = serde_json::from_value(header["joints"].clone())?;
        let frames = usize::try_from(header["frames"].as_u64().context("no frames")?)?;
        let places: Vec<f32> = bytes[end + 1..]
            .chunks_exact(4)
            .map(|four| f32::from_le_bytes([four[0], four[1], four[2], four[3]]))
            .collect();
        ensure!(places.len() == frames * joints.len() * 3, "{} numbers", places.len());
        Ok(Self { joints, frames, places })
    }

    /// How far `found` is from this.
    ///
    /// # Errors
    /// When the numbers of frames differ or no joint has a name of ours.
    pub(crate) fn compare(&self, found: &Self) -> Result<Comparison> {
        ensure!(self.frames == found.frames, "{} frames, not {}", found.frames, self.frames);
        let mut by_name: HashMap<String, usize> = HashMap::new();
        for (index, name) in found.joints.iter().enumerate() {
            by_name.entry(plain(name)).or_insert(index);
        }
        let pairs: Vec<(usize, usize)> = (self.joints.iter().enumerate())
            .filter_map(|(index, name)| Some((index, *by_name.get(&plain(name))?)))
            .collect();
        if pairs.is_empty() {
            bail!("no joint of ours among {}", found.joints.join(", "));
        }
        let (mut most, mut sum) = (0.0_f64, 0.0);
        for frame in 0..self.frames {
            for &(ours, theirs) in &pairs {
                let (a, b) = (self.place(frame, ours), found.place(frame, theirs));
                let apart = a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>().sqrt();
                // A place that is no number is as far as can be.
                most = if apart.is_nan() { f64::INFINITY } else { most.max(apart) };
                sum += apart;
            }
        }
        Ok(Comparison {
            joints: self.joints.len(),
            matched: pairs.len(),
            frames: self.frames,
            most_mm: 1e3 * most,
            mean_mm: 1e3 * sum / (self.frames * pairs.len()).max(1) as f64,
        })
    }

    fn place(&self, frame: usize, joint: usize) -> [f32; 3] {
        let at = 3 * (frame * self.joints.len() + joint);
        [self.places[at], self.places[at + 1], self.places[at + 2]]
    }
}

impl Comparison {
    /// Names of what [`Self::line`] says.
    pub(crate) const HEAD: &str =
        "file                        importer    joints  frames    most mm    mean mm";

    /// Whether every joint was found.
    pub(crate) fn is_whole(&self) -> bool {
        self.matched == self.joints && self.frames > 0
    }

    pub(crate) fn line(&self, file: &str, importer: &str) -> String {
        let joints = format!("{}/{}", self.matched, self.joints);
        let Self { frames, most_mm, mean_mm, .. } = self;
        format!("{file:<28}{importer:<10}{joints:>8}{frames:>8}{most_mm:>11.4}{mean_mm:>11.4}")
    }
}

/// A name without what some programs cannot hold in one.
fn plain(name: &str) -> String {
    // Three takes such letters out, USD writes others in their place, and one more before a digit.
    name.chars().filter(|c| c.is_alphanumeric()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tracks(joints: &[&str], places: &[f32]) -> Tracks {
        let mut bytes = serde_json::to_vec(
            &serde_json::json!({ "joints": joints, "frames": places.len() / 3 / joints.len() }),
        )
        .unwrap();
        bytes.push(b'\n');
        bytes.extend(places.iter().flat_map(|value| value.to_le_bytes()));
        Tracks::of(&bytes).unwrap()
    }

    #[test]
    fn joints_are_compared_by_name_in_any_order() {
        let ours = tracks(&["mixamorig:Hips", "Left Leg"], &[0.0, 1.0, 0.0, 0.0, 0.5, 0.0]);
        let same =
            tracks(&["Left_Leg", "tip", "mixamorigHips"], &[0.0, 0.5, 0.0, 9.0, 9.0, 9.0, 0.0, 1.003, 0.004]);
        let compared = ours.compare(&same).unwrap();
        assert!(compared.is_whole());
        assert!((compared.most_mm - 5.0).abs() < 1e-3 && (compared.mean_mm - 2.5).abs() < 1e-3);
    }

    #[test]
    fn what_is_missing_or_no_number_is_seen() {
        let ours = tracks(&["a", "b"], &[0.0; 6]);
        assert!(!ours.compare(&tracks(&["a"], &[0.0; 3])).unwrap().is_whole());
        assert!(ours.compare(&tracks(&["c"], &[0.0; 3])).is_err());
        assert!(ours.compare(&tracks(&["a", "b"], &[0.0; 12])).is_err());
        let broken = tracks(&["a", "b"], &[f32::NAN, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(ours.compare(&broken).unwrap().most_mm, f64::INFINITY);
        assert!(Tracks::of(b"{\"joints\":[\"a\"],\"frames\":1}\n").is_err());
    }
}
