//! `inkrig generate`: a motion from a word, a key pose and trajectories in space.

mod conditions;
mod ground;
mod record;
pub(super) mod text;

use crate::cli::{GenerateArgs, GroundArg, GuidanceArg, StartArg, StepsArg};
use crate::console::Console;
use crate::error::CliError;
use crate::printable;
use crate::provenance::licence::LicenceNote;
use crate::provenance::{Facts, Run};
use crate::read_back::ReadBack;
use crate::sheet::{SheetOptions, contact_sheet};
use crate::shipped::{CLEAN, EXAMPLES, QUICK, Shipped};
use crate::{inputs, load, names, results};
use conditions::{KeyPose, keypose, trajectory};
use ground::{GroundRecord, ground};
use inkrig_formats::{ExportOptions, HumanBone, write_motion};
use inkrig_generate::checkpoint::{CheckpointError, ModelFile, ModelHeader};
use inkrig_generate::configuration::{Configuration, TextEncoderKind};
use inkrig_generate::guidance::{Ask, Guided, SettleOptions, View};
use inkrig_generate::networks::{Decoding, Domain};
use inkrig_generate::sampling::{
    Conditions, Examples, Networks, Request, Sampler, SamplingOptions, Semantics, Steps,
};
use inkrig_generate::schedule::Noise;
use inkrig_generate::text::{TextEncoder, actions_in};
use inkrig_generate::{GenerateError, weights::Tensors};
use inkrig_motion::humanml::{FRAME_RATE, Joints, Statistics, WIDTH, recover_positions, skeleton, to_clip};
use inkrig_motion::{Clip, Features};
use record::Record;
use std::io::{Cursor, Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub(super) fn run(args: &GenerateArgs, run: &Run<'_>, console: &Console) -> Result<(), CliError> {
    let format = results::format_of(&args.out)?;
    let named = named_model(args.model.as_ref());
    let more = || [&args.report, &args.sheet].into_iter().flatten().map(PathBuf::as_path);
    let results = || std::iter::once(args.out.as_path()).chain(more());
    let inputs = [named.as_ref(), args.keypose3d.as_ref(), args.trajectory3d.as_ref()].into_iter().flatten();
    names::results_differ(inputs.map(PathBuf::as_path), results())?;
    results::check_picture(args.sheet.as_ref())?;
    run.check_motion(&args.out, &args.sidecar)?;
    more().try_for_each(|path| run.check(path))?;
    if args.guidance.is_some() && args.trajectory3d.is_none() {
        return Err(CliError::NoEffect { flag: "--guidance", with: "no --trajectory3d" });
    }
    if args.word.trim().is_empty() {
        return Err(CliError::NoWord);
    }
    let stage = console.stage("reading the model");
    let mut model = Model::asked(named.as_deref(), args.steps)?;
    let body = model.body()?;
    let frames = model.frames(args)?;
    let wanted = Wanted {
        trajectory: args.trajectory3d.as_deref().map(|path| trajectory(path, frames)).transpose()?,
        keypose: args.keypose3d.as_deref().map(|path| keypose(path, frames, &model.body()?)).transpose()?,
        frames,
    };
    let options = model.options(args)?;
    let encoder = model.read(args.text_model.as_deref())?;
    if !model.has_control() && (args.keypose3d.is_some() || args.trajectory3d.is_some()) {
        return Err(CliError::NoControl { path: model.path.clone() });
    }
    drop(stage);
    let stage = console.stage("making the motion");
    let made = model.generate(args, (&wanted, &body), &options, encoder.as_ref())?;
    let humanoid = HUMANOID.map(|(name, joint)| HumanBone { name, joint }).to_vec();
    let export = ExportOptions { name: Some(args.word.clone()), humanoid, ..ExportOptions::default() };
    let written = write_motion(&made.clip, format, &export)?;
    let read_back = ReadBack::of(&written.bytes, format, &made.clip, &export);
    drop(stage);
    let mut warnings = load::warnings(&written.findings, &args.out);
    if model.header.text == TextEncoderKind::Verbs {
        warnings.extend(text::left_out(&args.word));
    }
    let wrong = read_back.and_then(|found| found.warning());
    warnings.extend(wrong.map(|wrong| format!("{}: {wrong}", printable::path(&args.out))));
    for warning in &warnings {
        console.warn(warning);
    }
    let record =
        Record::of(args, (&model.path, &model.header), (&wanted, &options), &made, (read_back, warnings));
    let arguments = match &named {
        Some(path) => run.arguments.with_option("model", path, args.model.is_none()),
        None => run.arguments.clone(),
    };
    let facts = Facts { seed: Some(args.seed), ..Facts::of_files(&[]) };
    let run = Run { arguments: &arguments, sink: run.sink };
    run.write_motion(&args.out, &written.bytes, &args.sidecar, &facts)?;
    if let Some(path) = &args.report {
        run.write(path, &serde_json::to_vec_pretty(&record)?)?;
    }
    if let Some(path) = &args.sheet {
        run.write(path, &contact_sheet(&made.clip, &SheetOptions::default())?)?;
    }
    console.say(record.text())?;
    run.say(&args.out, &args.sidecar, console)?;
    for path in more() {
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
    /// What was done to put its feet on the floor.
    ground: Option<GroundRecord>,
}

trait Bytes: Read + Seek + Send {}

impl<T: Read + Seek + Send> Bytes for T {}

/// The model that is asked for by name: on the command line, or by INKRIG_MODEL.
pub(in crate::commands) fn named_model(given: Option<&PathBuf>) -> Option<PathBuf> {
    let named = given.cloned().or_else(|| std::env::var_os("INKRIG_MODEL").map(PathBuf::from));
    named.filter(|path| !path.as_os_str().is_empty())
}

/// A model whose header is one that motions can be made with.
pub(in crate::commands) struct Model {
    pub(in crate::commands) path: PathBuf,
    base: ModelFile<Box<dyn Bytes>>,
    /// Weights that take the place of those of `base`.
    over: Option<ModelFile<Box<dyn Bytes>>>,
    pub(in crate::commands) header: ModelHeader,
    configuration: Configuration,
    pub(in crate::commands) features: Statistics,
    pub(in crate::commands) places: Statistics,
    networks: Option<Networks>,
}

impl Model {
    /// Reads the header, and no weights yet.
    pub(in crate::commands) fn open(path: &Path) -> Result<Self, CliError> {
        Self::of(path, Box::new(inputs::open_large(path)?), None)
    }

    /// The one that comes inside the program; for few steps the one that was distilled for them.
    pub(in crate::commands) fn shipped(steps: Option<StepsArg>) -> Result<Self, CliError> {
        let quick = steps.is_some_and(|steps| steps != StepsArg::Ddim);
        let bytes = |own: Shipped| -> Result<Box<dyn Bytes>, CliError> {
            inputs::note(&own.path(), own.bytes)?;
            Ok(Box::new(Cursor::new(own.bytes)))
        };
        // Few steps begin with noise.
        let [name, over] = if quick { [QUICK, QUICK] } else { [CLEAN, EXAMPLES] };
        Self::of(&name.path(), bytes(CLEAN)?, Some(bytes(over)?))
    }

    /// With `over`, the header is that of `over`.
    fn of(path: &Path, base: Box<dyn Bytes>, over: Option<Box<dyn Bytes>>) -> Result<Self, CliError> {
        let wrong = |cause: CheckpointError| CliError::Model { path: path.into(), cause: Box::new(cause) };
        let base = ModelFile::open(base).map_err(wrong)?;
        let over = over.map(ModelFile::open).transpose().map_err(wrong)?;
        if !base.is_whole() {
            return Err(wrong(CheckpointError::Incomplete { what: not_whole(base.header()) }));
        }
        let header = over.as_ref().unwrap_or(&base).header().clone();
        if !header.licence.is_empty() {
            let note = LicenceNote { text: header.licence.clone(), from: "its header".into() };
            inputs::add_licence(path, &note);
            if over.is_some() {
                [CLEAN, EXAMPLES].iter().for_each(|own| inputs::add_licence(&own.path(), &note));
            }
        }
        let (features, places) = header.statistics().map_err(wrong)?;
        let configuration = configuration(&header, path)?;
        Ok(Self { path: path.into(), base, over, header, configuration, features, places, networks: None })
    }

    /// The length that was asked for, if the networks can make it.
    fn frames(&self, args: &GenerateArgs) -> Result<usize, CliError> {
        let (frames, most) = (args.length.frames(FRAME_RATE), self.header.sizes.most_frames());
        if (2..=most).contains(&frames) {
            return Ok(frames);
        }
        Err(CliError::LengthOfModel { flag: "--length", path: self.path.clone(), frames, most })
    }

    fn options(&self, args: &GenerateArgs) -> Result<SamplingOptions, CliError> {
        let usual = sampling(&self.header, args.steps, &self.path)?;
        Ok(SamplingOptions {
            text_weight: args.text_weight.map_or(usual.text_weight, |weight| weight as f32),
            guidance: usual.guidance.filter(|_| args.guidance != Some(GuidanceArg::Off)),
            // Settling draws to what was asked for, too.
            settle: Some(SettleOptions::default())
                .filter(|_| args.ground == GroundArg::On && args.guidance != Some(GuidanceArg::Off)),
            ..usual
        })
    }

    /// The one that is asked for by name, see [`named_model`], or else the one inside the program.
    pub(in crate::commands) fn asked(
        named: Option<&Path>,
        steps: Option<StepsArg>,
    ) -> Result<Self, CliError> {
        named.map_or_else(|| Self::shipped(steps), Self::open)
    }

    /// The bones of its body: motions are made on it, measuring needs none.
    pub(in crate::commands) fn body(&self) -> Result<Joints, CliError> {
        let wrong = |cause| CliError::Model { path: self.path.clone(), cause: Box::new(cause) };
        self.header.skeleton().map_err(wrong)
    }

    /// Reads the weights.
    pub(in crate::commands) fn tensors(&mut self) -> Result<Tensors, CliError> {
        let wrong = |cause| CliError::Model { path: self.path.clone(), cause: Box::new(cause) };
        let mut weights = self.base.tensors().map_err(wrong)?;
        if let Some(over) = &mut self.over {
            weights.extend(over.tensors().map_err(wrong)?);
        }
        Ok(weights)
    }

    /// Reads the weights, and whatever makes vectors of words.
    pub(in crate::commands) fn read(
        &mut self,
        text_model: Option<&Path>,
    ) -> Result<Box<dyn TextEncoder>, CliError> {
        let weights = self.tensors()?;
        let encoder = text::encoder(&self.header, &weights, text_model, &self.path)?;
        let networks =
            Networks::new(&self.header.sizes, &weights).map_err(|cause| about(&self.path, cause))?;
        self.networks = Some(networks);
        Ok(encoder)
    }

    fn has_control(&self) -> bool {
        self.networks.as_ref().is_some_and(|networks| networks.follows(Domain::Space))
    }

    /// The networks, once they are read.
    pub(in crate::commands) fn networks(&self) -> Result<&Networks, CliError> {
        let missing = || about(&self.path, GenerateError::MissingTensor { name: "vae".into() });
        self.networks.as_ref().ok_or_else(missing)
    }

    /// What the encoder of words is told.
    pub(in crate::commands) fn description(&self, word: &str) -> String {
        text::description(&self.header, &self.configuration, word)
    }

    /// Frames of the clips that it was trained with, as far as it can make them.
    pub(in crate::commands) fn usual_frames(&self) -> usize {
        self.configuration.sampling.frames.min(self.header.sizes.most_frames())
    }

    fn generate(
        &self,
        args: &GenerateArgs,
        (wanted, body): (&Wanted, &Joints),
        options: &SamplingOptions,
        encoder: &dyn TextEncoder,
    ) -> Result<Made, CliError> {
        let networks = self.networks()?;
        let wrong = |cause| about(&self.path, cause);
        let description = self.description(&args.word);
        let no_text = encoder.encode("").map_err(wrong)?;
        // As in training: a shorter clip is cut from one of the usual length.
        let usual = self.usual_frames();
        let request = Request {
            frames: wanted.frames.max(usual),
            text: encoder.encode(&description).map_err(wrong)?,
            view: View::Space,
            trajectory: wanted.trajectory.clone().unwrap_or_default(),
            keypose: wanted.keypose.as_ref().map(|pose| (pose.frame, pose.joints)),
        };
        let conditions = Conditions::new(&request, &self.places, options.semantics).map_err(wrong)?;
        let sampler = Sampler { networks, features: &self.features, no_text: &no_text };
        let conditions = [conditions];
        let sampled = match self.example(args, options)? {
            Some(example) => {
                let options = SamplingOptions { from: Some(Examples::TIMESTEP), ..options.clone() };
                sampler.sample_near(&example, &conditions, &options, args.seed)
            }
            None => sampler.sample(&conditions, options, args.seed),
        };
        let sampled = sampled.map_err(wrong)?;
        let mut decoding = Decoding::default();
        networks.vae.decode(&sampled.latents, &[request.frames], &mut decoding).map_err(wrong)?;
        let mut rows = decoding.features().to_vec();
        rows.truncate(wanted.frames * WIDTH);
        self.features.restore(&mut rows);
        let mut made = Made {
            clip: clip(body, &rows).map_err(|cause| wrong(cause.into()))?,
            guided: sampled.guided,
            ground: None,
        };
        if args.ground == GroundArg::On {
            let grounded = ground(&made.clip, &rows, wanted, options.semantics);
            let (clip, record) = grounded.map_err(|cause| wrong(cause.into()))?;
            (made.clip, made.ground) = (clip, Some(record));
        }
        Ok(made)
    }

    /// What denoising begins with, where that is a motion that was learned from.
    fn example(&self, args: &GenerateArgs, options: &SamplingOptions) -> Result<Option<Vec<f32>>, CliError> {
        let asked = args.keypose3d.is_some() || args.trajectory3d.is_some();
        let many = matches!(options.steps, Steps::Ddim(_));
        let mut noise = Noise::new(args.seed ^ 0x6578_616d_706c_6573);
        let of_word = actions_in(&args.word).into_iter().next();
        let picked = self.networks()?.examples.as_ref().zip(of_word);
        let picked = picked.and_then(|(examples, verb)| examples.pick(verb, &mut noise));
        match args.start {
            Some(StartArg::Noise) => Ok(None),
            None => Ok(picked.filter(|_| many && !asked).map(<[f32]>::to_vec)),
            Some(StartArg::Example) if !many => {
                Err(CliError::NoEffect { flag: "--start example", with: "--steps 1, 2 or 4" })
            }
            Some(StartArg::Example) => match picked {
                Some(example) => Ok(Some(example.to_vec())),
                None => Err(CliError::NoExample { path: self.path.clone(), word: args.word.clone() }),
            },
        }
    }
}

/// The motion on the model's body, by the joints' places: those are what conditions and guidance are about.
fn clip(body: &Joints, rows: &[f32]) -> Result<Clip, inkrig_motion::MotionError> {
    let frames = recover_positions(&Features::new(rows.to_vec(), WIDTH)?)?;
    to_clip(&frames, &Arc::new(skeleton(body, &frames)?), FRAME_RATE)
}

/// Why a model that has only some weights cannot be used, and where the others are.
fn not_whole(header: &ModelHeader) -> String {
    let quick = ModelFile::open(Cursor::new(QUICK.bytes)).map(|quick| quick.header().sha256.clone());
    if quick.is_ok_and(|quick| quick == header.sha256) {
        return "it has only the weights in which it differs from clean.safetensors, and both come inside the program: leave --model out and say --steps 2".into();
    }
    let base = header.laid_over.as_deref().unwrap_or("another model");
    format!(
        "it has only the weights in which it differs from {base}: pack it once more from what training wrote, and leave --without out"
    )
}

/// How a model's motions are sampled, if nothing else is said.
pub(super) fn sampling(
    header: &ModelHeader,
    steps: Option<StepsArg>,
    path: &Path,
) -> Result<SamplingOptions, CliError> {
    let distilled = header.is_distilled();
    let steps = steps_of(steps, distilled);
    let usual = configuration(header, path)?.sampling_options();
    Ok(SamplingOptions {
        steps: steps.ok_or_else(|| CliError::StepsOfModel { path: path.into(), distilled })?,
        semantics: header.semantics,
        text_weight: header.text_weight.unwrap_or(usual.text_weight),
        ..usual
    })
}

fn configuration(header: &ModelHeader, path: &Path) -> Result<Configuration, CliError> {
    let configuration = match header.semantics {
        Semantics::Paper => Configuration::paper(),
        Semantics::Official => Configuration::official(),
    };
    configuration.map_err(|cause| about(path, cause))
}

/// The steps that were asked for, or the usual ones; none where a model of this kind cannot take them.
fn steps_of(asked: Option<StepsArg>, distilled: bool) -> Option<Steps> {
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
pub(in crate::commands) const HUMANOID: [(&str, usize); 22] = [
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

pub(in crate::commands) fn about(path: &Path, cause: GenerateError) -> CliError {
    CliError::Generate { path: path.into(), cause: Box::new(cause) }
}
