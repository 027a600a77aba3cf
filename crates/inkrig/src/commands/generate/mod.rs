//! `inkrig generate`: a motion from a word, a key pose and trajectories in space.

mod conditions;
mod record;
pub(super) mod text;

use crate::cli::{GenerateArgs, GuidanceArg, StepsArg};
use crate::console::Console;
use crate::error::CliError;
use crate::printable;
use crate::provenance::licence::LicenceNote;
use crate::provenance::{Facts, Run};
use crate::read_back::ReadBack;
use crate::{inputs, load, names, results};
use conditions::{KeyPose, keypose, trajectory};
use inkrig_formats::{ExportOptions, HumanBone, write_motion};
use inkrig_generate::checkpoint::{CheckpointError, ModelFile, ModelHeader};
use inkrig_generate::configuration::Configuration;
use inkrig_generate::guidance::{Ask, Guided, View};
use inkrig_generate::networks::Decoding;
use inkrig_generate::sampling::{Conditions, Networks, Request, Sampler, SamplingOptions, Semantics, Steps};
use inkrig_generate::text::TextEncoder;
use inkrig_generate::{GenerateError, weights::Tensors};
use inkrig_motion::humanml::{FRAME_RATE, Joints, Statistics, WIDTH, recover_positions, skeleton, to_clip};
use inkrig_motion::{Clip, Features};
use record::Record;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub(super) fn run(args: &GenerateArgs, run: &Run<'_>, console: &Console) -> Result<(), CliError> {
    let format = results::format_of(&args.out)?;
    let named = args.model.clone().or_else(|| std::env::var_os("INKRIG_MODEL").map(PathBuf::from));
    let path = named.filter(|path| !path.as_os_str().is_empty()).ok_or(CliError::NoModel)?;
    let results = || std::iter::once(args.out.as_path()).chain(args.report.as_deref());
    let inputs = [Some(&path), args.keypose3d.as_ref(), args.trajectory3d.as_ref()].into_iter().flatten();
    names::results_differ(inputs.map(PathBuf::as_path), results())?;
    run.check_motion(&args.out, &args.sidecar)?;
    args.report.as_deref().map_or(Ok(()), |path| run.check(path))?;
    if args.guidance.is_some() && args.trajectory3d.is_none() {
        return Err(CliError::NoEffect { flag: "--guidance", with: "no --trajectory3d" });
    }
    let stage = console.stage(format!("reading {}", printable::path(&path)));
    let mut model = Model::open(&path)?;
    let frames = model.frames(args)?;
    let wanted = Wanted {
        trajectory: args.trajectory3d.as_deref().map(|path| trajectory(path, frames)).transpose()?,
        keypose: args.keypose3d.as_deref().map(|path| keypose(path, frames)).transpose()?,
        frames,
    };
    let (options, encoder) = (model.options(args)?, model.read(args)?);
    drop(stage);
    let stage = console.stage("making the motion");
    let made = model.generate(args, &wanted, &options, encoder.as_ref())?;
    let humanoid = HUMANOID.map(|(name, joint)| HumanBone { name, joint }).to_vec();
    let export = ExportOptions { name: Some(args.word.clone()), humanoid, ..ExportOptions::default() };
    let written = write_motion(&made.clip, format, &export)?;
    let read_back = ReadBack::of(&written.bytes, format, &made.clip, &export);
    drop(stage);
    let mut warnings = load::warnings(&written.findings, &args.out);
    let wrong = read_back.and_then(|found| found.warning());
    warnings.extend(wrong.map(|wrong| format!("{}: {wrong}", printable::path(&args.out))));
    for warning in &warnings {
        console.warn(warning);
    }
    let record = Record::of(args, (&path, &model.header), (&wanted, &options), &made, (read_back, warnings));
    let arguments = run.arguments.with_option("model", &path, args.model.is_none());
    let facts = Facts { seed: Some(args.seed), ..Facts::of_files(&[]) };
    let run = Run { arguments: &arguments, sink: run.sink };
    run.write_motion(&args.out, &written.bytes, &args.sidecar, &facts)?;
    if let Some(path) = &args.report {
        run.write(path, &serde_json::to_vec_pretty(&record)?)?;
    }
    console.say(record.text())?;
    run.say(&args.out, &args.sidecar, console)?;
    if let Some(path) = &args.report {
        console.say(format!("wrote {}", printable::path(path)))?;
    }
    console.result(&record)
}

/// What the motion shall meet.
struct Wanted {
    trajectory: Option<Vec<Ask>>,
    keypose: Option<KeyPose>,
    frames: usize,
}

/// What came of it.
struct Made {
    clip: Clip,
    guided: Vec<Guided>,
}

/// A model file whose header is one that motions can be made with.
struct Model {
    path: PathBuf,
    file: ModelFile<File>,
    header: ModelHeader,
    configuration: Configuration,
    features: Statistics,
    places: Statistics,
    body: Joints,
    networks: Option<Networks>,
}

impl Model {
    /// Reads the header, and no weights yet.
    fn open(path: &Path) -> Result<Self, CliError> {
        let wrong = |cause: CheckpointError| CliError::Model { path: path.into(), cause: Box::new(cause) };
        let file = ModelFile::open(inputs::open_large(path)?).map_err(wrong)?;
        let header = file.header().clone();
        if !header.licence.is_empty() {
            let note = LicenceNote { text: header.licence.clone(), from: "its header".into() };
            inputs::add_licence(path, &note);
        }
        let (features, places) = header.statistics().map_err(wrong)?;
        let body = header.skeleton().map_err(wrong)?;
        let configuration = match header.semantics {
            Semantics::Paper => Configuration::paper(),
            Semantics::Official => Configuration::official(),
        };
        let configuration = configuration.map_err(|cause| about(path, cause))?;
        Ok(Self { path: path.into(), file, header, configuration, features, places, body, networks: None })
    }

    /// The length that was asked for, if the networks can make it.
    fn frames(&self, args: &GenerateArgs) -> Result<usize, CliError> {
        let (frames, most) = (args.length.frames(FRAME_RATE), self.header.sizes.most_frames());
        if (2..=most).contains(&frames) {
            return Ok(frames);
        }
        Err(CliError::LengthOfModel { path: self.path.clone(), frames, most })
    }

    fn options(&self, args: &GenerateArgs) -> Result<SamplingOptions, CliError> {
        let distilled = self.header.is_distilled();
        let steps = steps(args.steps, distilled);
        let usual = self.configuration.sampling_options();
        Ok(SamplingOptions {
            steps: steps.ok_or_else(|| CliError::StepsOfModel { path: self.path.clone(), distilled })?,
            semantics: self.header.semantics,
            guidance: usual.guidance.filter(|_| args.guidance != Some(GuidanceArg::Off)),
            ..usual
        })
    }

    /// Reads the weights, and whatever makes vectors of words.
    fn read(&mut self, args: &GenerateArgs) -> Result<Box<dyn TextEncoder>, CliError> {
        let wrong = |cause| CliError::Model { path: self.path.clone(), cause: Box::new(cause) };
        let weights: Tensors = self.file.tensors().map_err(wrong)?;
        let encoder = text::encoder(&self.header, &weights, args.text_model.as_deref(), &self.path)?;
        let networks =
            Networks::new(&self.header.sizes, &weights).map_err(|cause| about(&self.path, cause))?;
        if networks.control.is_none() && (args.keypose3d.is_some() || args.trajectory3d.is_some()) {
            return Err(CliError::NoControl { path: self.path.clone() });
        }
        self.networks = Some(networks);
        Ok(encoder)
    }

    fn generate(
        &self,
        args: &GenerateArgs,
        wanted: &Wanted,
        options: &SamplingOptions,
        encoder: &dyn TextEncoder,
    ) -> Result<Made, CliError> {
        let Some(networks) = &self.networks else {
            return Err(about(&self.path, GenerateError::MissingTensor { name: "vae".into() }));
        };
        let wrong = |cause| about(&self.path, cause);
        let description = text::description(&self.header, &self.configuration, &args.word);
        let no_text = encoder.encode("").map_err(wrong)?;
        // As in training: a shorter clip is cut from one of the usual length.
        let usual = self.configuration.sampling.frames.min(self.header.sizes.most_frames());
        let request = Request {
            frames: wanted.frames.max(usual),
            text: encoder.encode(&description).map_err(wrong)?,
            view: View::Space,
            trajectory: wanted.trajectory.clone().unwrap_or_default(),
            keypose: wanted.keypose.as_ref().map(|pose| (pose.frame, pose.joints)),
        };
        let conditions = Conditions::new(&request, &self.places, options.semantics).map_err(wrong)?;
        let sampler = Sampler { networks, features: &self.features, no_text: &no_text };
        let sampled = sampler.sample(&[conditions], options, args.seed).map_err(wrong)?;
        let mut decoding = Decoding::default();
        networks.vae.decode(&sampled.latents, &[request.frames], &mut decoding).map_err(wrong)?;
        let mut rows = decoding.features().to_vec();
        rows.truncate(wanted.frames * WIDTH);
        self.features.restore(&mut rows);
        let clip = self.clip(rows).map_err(|cause| wrong(cause.into()))?;
        Ok(Made { clip, guided: sampled.guided })
    }

    /// The motion on the model's body, by the joints' places: those are what conditions and guidance are about.
    fn clip(&self, rows: Vec<f32>) -> Result<Clip, inkrig_motion::MotionError> {
        let frames = recover_positions(&Features::new(rows, WIDTH)?)?;
        to_clip(&frames, &Arc::new(skeleton(&self.body, &frames)?), FRAME_RATE)
    }
}

/// The steps that were asked for, or the usual ones; none where a model of this kind cannot take them.
pub(super) fn steps(asked: Option<StepsArg>, distilled: bool) -> Option<Steps> {
    let few = |steps| Some(Steps::Lcm(steps)).filter(|_| distilled);
    match asked {
        Some(StepsArg::One) => few(1),
        Some(StepsArg::Two) => few(2),
        Some(StepsArg::Four) => few(4),
        Some(StepsArg::Ddim) => Some(Steps::Ddim(DDIM_STEPS)).filter(|_| !distilled),
        None if distilled => few(2),
        None => Some(Steps::Ddim(DDIM_STEPS)),
    }
}

/// What the joints are called in VRM.
const HUMANOID: [(&str, usize); 22] = [
    ("hips", 0),
    ("spine", 3),
    ("chest", 6),
    ("upperChest", 9),
    ("neck", 12),
    ("head", 15),
    ("leftUpperLeg", 1),
    ("leftLowerLeg", 4),
    ("leftFoot", 7),
    ("leftToes", 10),
    ("rightUpperLeg", 2),
    ("rightLowerLeg", 5),
    ("rightFoot", 8),
    ("rightToes", 11),
    ("leftShoulder", 13),
    ("leftUpperArm", 16),
    ("leftLowerArm", 18),
    ("leftHand", 20),
    ("rightShoulder", 14),
    ("rightUpperArm", 17),
    ("rightLowerArm", 19),
    ("rightHand", 21),
];

/// Steps of models that were not distilled.
const DDIM_STEPS: usize = 50;

fn about(path: &Path, cause: GenerateError) -> CliError {
    CliError::Generate { path: path.into(), cause: Box::new(cause) }
}
