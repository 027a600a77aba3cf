//! What a model file says of itself.

use super::CheckpointError;
use crate::configuration::TextEncoderKind;
use crate::networks::Sizes;
use crate::sampling::Semantics;
use inkrig_motion::humanml::{JOINTS, Joints, NAMES, Statistics, WIDTH};
use serde::{Deserialize, Serialize};

/// The form of the header that this program writes.
const VERSION: u32 = 1;

/// All that is needed to make motions with a model's weights. It is written as JSON into the metadata of a safetensors file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelHeader {
    /// Of this header's form; 1.
    pub version: u32,
    /// What to call the model.
    pub name: String,
    /// How large the networks are.
    pub sizes: Sizes,
    /// How its conditions are meant.
    pub semantics: Semantics,
    /// Where its text vectors come from.
    pub text: TextEncoderKind,
    /// The joints of a pose, in order.
    pub joints: Vec<String>,
    /// What features and poses are normalised by; published files lack it.
    pub statistics: Option<ModelStatistics>,
    /// The bone that ends at each joint where nothing is turned, metres; published files lack it.
    pub skeleton: Option<Vec<[f32; 3]>>,
    /// How much more its words count than no word does, where that is not the papers' 7.5.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text_weight: Option<f32>,
    /// What it was trained on.
    pub data: String,
    /// What may be done with it.
    pub licence: String,
    /// The name of the model that the rest of its weights is in, where the file has only those that differ.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub laid_over: Option<String>,
    /// SHA-256 of all bytes after the header, in hexadecimal digits.
    pub sha256: String,
}

/// Means and deviations of the training data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelStatistics {
    /// Of the 263 numbers of a frame.
    pub mean: Vec<f32>,
    /// Their deviations.
    pub std: Vec<f32>,
    /// Of the 66 numbers of joint positions, metres.
    pub mean_raw: Vec<f32>,
    /// Their deviations, metres.
    pub std_raw: Vec<f32>,
}

impl ModelHeader {
    /// For weights that are not written yet: without statistics, skeleton and checksum.
    pub fn new(name: impl Into<String>, sizes: Sizes, semantics: Semantics, text: TextEncoderKind) -> Self {
        Self {
            version: VERSION,
            name: name.into(),
            sizes,
            semantics,
            text,
            joints: NAMES.map(String::from).to_vec(),
            statistics: None,
            skeleton: None,
            text_weight: None,
            data: String::new(),
            licence: String::new(),
            laid_over: None,
            sha256: String::new(),
        }
    }

    /// Whether it was distilled for few steps (LCM). Such a model cannot go back from a motion to noise, which blending needs.
    pub fn is_distilled(&self) -> bool {
        self.sizes.guidance_width > 0
    }

    /// Whether the parts fit each other.
    ///
    /// # Errors
    /// [`CheckpointError::Header`] with the first that does not, [`CheckpointError::Unsupported`] for a later form.
    pub fn check(&self) -> Result<(), CheckpointError> {
        if self.version != VERSION {
            let what =
                format!("the model file is of form {}, and this program knows form {VERSION}", self.version);
            return Err(CheckpointError::Unsupported {
                what,
                todo: "use the version of inkrig that it was made for",
            });
        }
        self.sizes.check()?;
        let wrong = |what: String| Err(CheckpointError::Header { what });
        if self.joints != NAMES {
            return wrong(format!("its joints are not the {JOINTS} of the HumanML3D form, in their order"));
        }
        if let Some(weight) = self.text_weight.filter(|weight| !(0.0..=100.0).contains(weight)) {
            return wrong(format!("its weight of words is {weight}, and 0 to 100 is possible"));
        }
        if let Some(statistics) = &self.statistics {
            statistics.check()?;
        }
        if let Some(skeleton) = &self.skeleton
            && (skeleton.len() != JOINTS
                || skeleton.iter().flatten().any(|number| !(-10.0..10.0).contains(number)))
        {
            return wrong(format!("its skeleton is not {JOINTS} bones of less than 10 m"));
        }
        Ok(())
    }

    /// What features are normalised by (263 numbers), and what positions are (66).
    ///
    /// # Errors
    /// [`CheckpointError::Incomplete`] when the model has none, with what to do.
    pub fn statistics(&self) -> Result<(Statistics, Statistics), CheckpointError> {
        let missing = "it has no statistics: import it once more, with --stats and a folder that has Mean.npy, Std.npy, Mean_raw.npy and Std_raw.npy";
        let of =
            self.statistics.as_ref().ok_or_else(|| CheckpointError::Incomplete { what: missing.into() })?;
        of.check()
    }

    /// The bones of the body that it makes motions of.
    ///
    /// # Errors
    /// [`CheckpointError::Incomplete`] when the model has none, with what to do.
    pub fn skeleton(&self) -> Result<Joints, CheckpointError> {
        let missing = "it has no skeleton: import it once more, with a folder for --stats that also has 000021.npy of HumanML3D, whose first pose is the body that all its motions were brought to, or skeleton.npy with 22 x 3 bones";
        let bones = self.skeleton.as_deref().and_then(|bones| <&[[f32; 3]; JOINTS]>::try_from(bones).ok());
        let bones = bones.ok_or_else(|| CheckpointError::Incomplete { what: missing.into() })?;
        Ok(bones.map(Into::into))
    }
}

impl ModelStatistics {
    /// # Errors
    /// [`CheckpointError::Header`] when a table has the wrong length, or a deviation is not above 0.
    fn check(&self) -> Result<(Statistics, Statistics), CheckpointError> {
        let wrong = |what: String| CheckpointError::Header { what: format!("its statistics: {what}") };
        let lengths = [self.mean.len(), self.std.len(), self.mean_raw.len(), self.std_raw.len()];
        if lengths != [WIDTH, WIDTH, 3 * JOINTS, 3 * JOINTS] {
            return Err(wrong(format!(
                "{lengths:?} numbers, not {WIDTH}, {WIDTH}, {} and as many",
                3 * JOINTS
            )));
        }
        let of = |mean: &[f32], deviation: &[f32]| {
            Statistics::new(mean.to_vec(), deviation.to_vec()).map_err(|error| wrong(error.to_string()))
        };
        Ok((of(&self.mean, &self.std)?, of(&self.mean_raw, &self.std_raw)?))
    }
}
