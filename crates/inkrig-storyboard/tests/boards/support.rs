//! The model that comes with the program, and what is made with it.

use inkrig_generate::checkpoint::ModelFile;
use inkrig_generate::configuration::Configuration;
use inkrig_generate::guidance::SettleOptions;
use inkrig_generate::readers::file::read;
use inkrig_generate::readers::sketch::SketchReader;
use inkrig_generate::sampling::{Networks, SamplingOptions};
use inkrig_generate::text::{TextEncoder, VerbTable};
use inkrig_motion::Clip;
use inkrig_motion::humanml::{Joints, Statistics};
use inkrig_sketch::storyboard::{Frame, Storyboard, read_storyboard};
use inkrig_storyboard::{Generated, Maker, MakerOptions, Understood, read_figure, understand};
use std::io::Cursor;
use std::sync::LazyLock;

pub(crate) struct Model {
    pub(crate) networks: Networks,
    pub(crate) features: Statistics,
    pub(crate) places: Statistics,
    pub(crate) body: Joints,
    pub(crate) words: VerbTable,
    pub(crate) reader: SketchReader,
    pub(crate) sampling: SamplingOptions,
}

pub(crate) static MODEL: LazyLock<Model> = LazyLock::new(|| {
    let clean = include_bytes!("../../../../models/clean.safetensors");
    let mut file = ModelFile::open(Cursor::new(&clean[..])).unwrap();
    let header = file.header().clone();
    let weights = file.tensors().unwrap();
    let reader = include_bytes!("../../../../models/sketch-reader.safetensors");
    let usual = Configuration::paper().unwrap().sampling_options();
    Model {
        networks: Networks::new(&header.sizes, &weights).unwrap(),
        features: header.statistics().unwrap().0,
        places: header.statistics().unwrap().1,
        body: header.skeleton().unwrap(),
        words: VerbTable::new(&weights, header.sizes.text_width).unwrap(),
        reader: SketchReader::new(&read(Cursor::new(&reader[..]), "sketch").unwrap().1).unwrap(),
        sampling: SamplingOptions {
            text_weight: header.text_weight.unwrap(),
            semantics: header.semantics,
            guide_every: 10,
            // As the program does it.
            settle: Some(SettleOptions::default()),
            ..usual
        },
    }
});

pub(crate) fn board(name: &str) -> Storyboard {
    read_storyboard(inkrig_samples::find(name).unwrap().bytes).unwrap()
}

pub(crate) fn understood(frame: &Frame) -> Result<Understood, String> {
    let model = &*MODEL;
    let figure = read_figure(frame, 1, &model.reader).map_err(|error| error.to_string())?;
    understand(frame, 1, figure, &model.body, None).map_err(|error| error.to_string())
}

/// One candidate a frame, guided at every tenth step.
pub(crate) fn generated(
    read: &Understood,
    number: usize,
    sampling: &SamplingOptions,
    drawn: bool,
) -> Generated {
    let model = &*MODEL;
    let no_text = model.words.encode("").unwrap();
    let maker = Maker {
        networks: &model.networks,
        features: &model.features,
        places: &model.places,
        no_text: &no_text,
        body: &model.body,
        usual_frames: 40,
    };
    let options = MakerOptions { sampling: sampling.clone(), drawn, candidates: 1, seed: 0 };
    maker.clip(number, &read.plan, &model.words.encode(&read.plan.word).unwrap(), &options).unwrap()
}

pub(crate) fn poses(clip: &Clip) -> Vec<Joints> {
    let places = inkrig_motion::kinematics::positions(clip);
    (0..clip.frames()).map(|frame| places.frame(frame).try_into().unwrap()).collect()
}

pub(crate) fn p99(jerk: &[f64]) -> f64 {
    let mut sorted = jerk.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get((0.99 * sorted.len() as f64) as usize).copied().unwrap_or(0.0)
}
