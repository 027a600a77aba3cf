//! From a file of tensors to a model file.

use super::error::shown;
use super::header::{ModelHeader, ModelStatistics};
use super::mapping::{Detected, ModelKind, detect, is_evaluator, is_table, network, of_header, own_name};
use super::model::write_model;
use super::npy::read_npy;
use super::source::{Listed, TensorSource};
use super::{CheckpointError, NumberKind};
use crate::configuration::TextEncoderKind;
use crate::networks::{Parts, Sizes, tensors};
use crate::sampling::Semantics;
use inkrig_motion::humanml::{JOINTS, Joints, bone_lengths};
use std::collections::BTreeMap;
use std::io::{Seek, Write};

/// Which model a file of tensors is, and which of them go into ours.
#[derive(Debug, Clone)]
pub struct Import {
    detected: Detected,
    /// Our names, with places in the source.
    taken: Vec<(String, usize)>,
    rows: Vec<NetworkRow>,
    ignored: Vec<(String, &'static str)>,
}

/// One network, for a table of what was found.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct NetworkRow {
    /// The part that all its names begin with; `others` for names of no network that is known.
    pub network: &'static str,
    /// Tensors that are read.
    pub found: usize,
    /// How many numbers they have.
    pub numbers: usize,
    /// Names of tensors that are needed and not there.
    pub missing: Vec<String>,
    /// Tensors that are there and not read.
    pub ignored: usize,
}

/// What a file of tensors does not say of itself.
#[derive(Debug, Clone, Default)]
pub struct About {
    /// What to call the model.
    pub name: String,
    /// What it was trained on.
    pub data: String,
    /// What may be done with it.
    pub licence: String,
    /// Where text vectors come from; else what the published model uses.
    pub text: Option<TextEncoderKind>,
    /// What features and poses are normalised by.
    pub statistics: Option<ModelStatistics>,
    /// The body that motions were brought to.
    pub skeleton: Option<Joints>,
    /// Half precision: half the size.
    pub half: bool,
}

impl Import {
    /// Looks at names and shapes only. With `evaluator` the networks that measure motions are taken too.
    ///
    /// # Errors
    /// [`CheckpointError::Unknown`] for tensors of no model that is known, [`CheckpointError::Tensor`] where a shape is not the one that
    /// the others ask for. Missing tensors are no error yet: see [`Self::missing`].
    pub fn plan(listed: &[Listed], evaluator: bool) -> Result<Self, CheckpointError> {
        Self::of(detect(listed)?, listed, |name| evaluator && is_evaluator(name))
    }

    /// The same of a model file of ours, whose header says the sizes and which may have networks that no published model has; all is taken
    /// that belongs to it.
    ///
    /// # Errors
    /// [`CheckpointError::Tensor`] where a shape is not the one that the header asks for.
    pub fn of_model(header: &ModelHeader, listed: &[Listed]) -> Result<Self, CheckpointError> {
        // One that was imported is still what it was.
        let published = detect(listed).ok().filter(|found| found.sizes == header.sizes);
        let detected = published.unwrap_or_else(|| of_header(header, listed));
        Self::of(detected, listed, |name| is_evaluator(name) || is_table(name))
    }

    /// `more` says which tensors are taken that belong to no network that makes motions.
    fn of(
        detected: Detected,
        listed: &[Listed],
        more: impl Fn(&str) -> bool,
    ) -> Result<Self, CheckpointError> {
        let needed = tensors(&detected.sizes, detected.parts);
        let mut needed: BTreeMap<&str, _> = needed.iter().map(|spec| (spec.name.as_str(), spec)).collect();
        let mut rows: BTreeMap<&'static str, NetworkRow> = BTreeMap::new();
        let mut row = |name: &str, change: &dyn Fn(&mut NetworkRow)| {
            let network = network(name);
            change(rows.entry(network).or_insert_with(|| NetworkRow { network, ..NetworkRow::default() }));
        };
        let (mut taken, mut ignored) = (Vec::new(), Vec::new());
        for (at, tensor) in listed.iter().enumerate() {
            let own = own_name(detected.kind, &tensor.name);
            let spec = own.as_deref().and_then(|name| needed.remove(name));
            let keep = more(&tensor.name) && tensor.kind.is_float();
            let (Some(name), true) =
                (own.or_else(|| keep.then(|| tensor.name.clone())), spec.is_some() || keep)
            else {
                row(&tensor.name, &|row| row.ignored += 1);
                ignored.push((shown(&tensor.name), why_ignored(detected.kind, tensor)));
                continue;
            };
            if let Some(spec) = spec
                && spec.shape != tensor.shape
            {
                let what =
                    format!("its shape is {:?}, but {:?} follows from the others", tensor.shape, spec.shape);
                return Err(CheckpointError::tensor(&tensor.name, what));
            }
            if !tensor.kind.is_float() {
                return Err(CheckpointError::tensor(
                    &tensor.name,
                    "it has whole numbers, so it is no weight",
                ));
            }
            row(&name, &|row| {
                row.found += 1;
                row.numbers += tensor.numbers();
            });
            taken.push((name, at));
        }
        for (name, _) in needed.into_iter().filter(|(_, spec)| spec.used) {
            row(name, &|row| row.missing.push(name.to_owned()));
        }
        taken.sort();
        Ok(Self { detected, taken, rows: rows.into_values().collect(), ignored })
    }

    /// Which model it is.
    pub fn kind(&self) -> ModelKind {
        self.detected.kind
    }

    /// How large its networks are.
    pub fn sizes(&self) -> &Sizes {
        &self.detected.sizes
    }

    /// Which networks it has.
    pub fn parts(&self) -> Parts {
        self.detected.parts
    }

    /// What was found, network by network.
    pub fn rows(&self) -> &[NetworkRow] {
        &self.rows
    }

    /// Tensors that are not taken, and why.
    pub fn ignored(&self) -> &[(String, &'static str)] {
        &self.ignored
    }

    /// Names of tensors that the model needs and does not have.
    pub fn missing(&self) -> impl Iterator<Item = &str> {
        self.rows.iter().flat_map(|row| row.missing.iter().map(String::as_str))
    }

    /// What else a user should know.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        if self.detected.sizes.guidance_width > 0 {
            remarks.push(
                "The model was distilled for few steps (LCM). Blending clips goes from a motion back to noise, which it cannot: for that, give a second model that was not distilled by --blend-model.".into(),
            );
        }
        if !self.detected.parts.vae {
            remarks.push(
                "It has no autoencoder: it is only what differs from another model, and no motion is made with it by itself.".into(),
            );
            return remarks;
        }
        if !self.detected.parts.control {
            remarks.push(
                "It has no control networks: key poses and trajectories are held by guidance alone.".into(),
            );
        }
        if !self.detected.parts.denoiser {
            remarks.push("It has no denoiser: motions can be encoded and decoded, but not made.".into());
        }
        remarks
    }

    /// Writes the model file, reading one tensor at a time.
    ///
    /// # Errors
    /// [`CheckpointError::Unknown`] when tensors are missing; what reading and writing may say.
    pub fn write<W: Write + Seek>(
        &self,
        source: &mut dyn TensorSource,
        about: &About,
        out: W,
    ) -> Result<ModelHeader, CheckpointError> {
        let missing: Vec<&str> = self.missing().collect();
        if let Some(first) = missing.first() {
            let what = format!(
                "it looks like {}, but {} tensors are missing, such as {first}",
                self.kind().name(),
                missing.len()
            );
            return Err(CheckpointError::Unknown { what });
        }
        let (semantics, text) = match self.kind() {
            ModelKind::Mld => (Semantics::Official, TextEncoderKind::Clip),
            _ => (Semantics::Official, TextEncoderKind::SentenceT5),
        };
        let header = ModelHeader {
            statistics: about.statistics.clone(),
            skeleton: about.skeleton.map(|bones| bones.map(Into::into).to_vec()),
            data: about.data.clone(),
            licence: about.licence.clone(),
            ..ModelHeader::new(&about.name, self.sizes().clone(), semantics, about.text.unwrap_or(text))
        };
        let kind = if about.half { NumberKind::F16 } else { NumberKind::F32 };
        let shapes = source.listed();
        let of = |(name, at): &(String, usize)| {
            Some(Listed { name: name.clone(), shape: shapes.get(*at)?.shape.clone(), kind })
        };
        let gone = || CheckpointError::damaged("the file has other tensors than were planned with");
        let listed: Vec<Listed> = self.taken.iter().map(of).collect::<Option<_>>().ok_or_else(gone)?;
        write_model(out, &header, &listed, |number| {
            let (_, at) = self.taken.get(number).ok_or_else(gone)?;
            source.read(*at)
        })
    }
}

fn why_ignored(kind: ModelKind, tensor: &Listed) -> &'static str {
    let name = tensor.name.as_str();
    if is_evaluator(name) {
        "measures motions, makes none; --evaluator keeps it"
    } else if name.starts_with("text_encoder.") {
        "text encoders are files of their own"
    } else if !tensor.kind.is_float() {
        "whole numbers, no weight"
    } else if kind != ModelKind::Sketch2Anim
        && (name.starts_with("controlnet.") || name.starts_with("traj_encoder."))
    {
        "control networks of another make"
    } else {
        "no network of ours reads it"
    }
}

/// Statistics and, where it is there, the body, from the files of a folder. `file` gives the bytes of one by its name, `None` where
/// there is none: `Mean.npy`, `Std.npy`, `Mean_raw.npy`, `Std_raw.npy`; and `skeleton.npy` (22 x 3 bones, metres) or HumanML3D's `000021.npy`
/// (frames x joints x 3, metres).
///
/// # Errors
/// [`CheckpointError::Npy`] when one of the first four is missing, or any of them is not as it should be.
pub fn read_statistics(
    mut file: impl FnMut(&str) -> Result<Option<Vec<u8>>, CheckpointError>,
) -> Result<(ModelStatistics, Option<Joints>), CheckpointError> {
    let mut table = |name: &str, length: usize| {
        let wrong = |what: String| CheckpointError::Npy { name: name.into(), what };
        let bytes = file(name)?.ok_or_else(|| wrong("is not in the folder of statistics".into()))?;
        let (shape, numbers) = read_npy(&bytes, name)?;
        if numbers.len() != length {
            return Err(wrong(format!("has the shape {shape:?}, but {length} numbers are needed")));
        }
        Ok(numbers)
    };
    let statistics = ModelStatistics {
        mean: table("Mean.npy", inkrig_motion::humanml::WIDTH)?,
        std: table("Std.npy", inkrig_motion::humanml::WIDTH)?,
        mean_raw: table("Mean_raw.npy", 3 * JOINTS)?,
        std_raw: table("Std_raw.npy", 3 * JOINTS)?,
    };
    for (name, is_pose) in [("skeleton.npy", false), ("000021.npy", true)] {
        let Some(bytes) = file(name)? else { continue };
        let (shape, numbers) = read_npy(&bytes, name)?;
        let places = numbers.as_chunks::<3>().0;
        let first = places.get(..JOINTS).and_then(|places| <&[[f32; 3]; JOINTS]>::try_from(places).ok());
        let right = if is_pose {
            matches!(shape[..], [_, joints, 3] if joints >= JOINTS)
        } else {
            shape == [JOINTS, 3]
        };
        let (Some(first), true) = (first, right) else {
            let what = format!("has the shape {shape:?}, which is no skeleton of {JOINTS} joints");
            return Err(CheckpointError::Npy { name: name.into(), what });
        };
        let joints: Joints = first.map(Into::into);
        return Ok((statistics, Some(if is_pose { bone_lengths(&joints) } else { joints })));
    }
    Ok((statistics, None))
}
