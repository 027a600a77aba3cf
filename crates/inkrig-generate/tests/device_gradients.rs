//! The gradient that burn finds, on the processor and on a graphics processor, is that of our own arithmetic.
#![cfg(feature = "train")]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test may panic, and says what it ran on"
)]

use inkrig_generate::GenerateError;
use inkrig_generate::learning::{VaeLearner, VaeLosses, VaeObjective};
use inkrig_generate::networks::{Parts, Sizes};
use inkrig_generate::schedule::Noise;
use inkrig_generate::trainable::{DeviceVaeLearner, TrainingDevice, TrainingDeviceKind};
use inkrig_generate::weights::{Tensors, hashed};
use inkrig_motion::humanml::{Statistics, WIDTH};
use std::sync::mpsc;
use std::time::{Duration, Instant};

/// How far a tensor's gradient may be off, as a part of its length: sums of some thousand f32 in another order. What is shorter than
/// a thousandth of the longest tensor's gradient is measured by that.
const TENSOR: f64 = 1e-4;
/// The same on a graphics processor, whose exponentials may be some units in the last place off, and which sums in parts.
const TENSOR_ON_DEVICE: f64 = 2e-3;
/// The same for the loss and its parts.
const LOSS: f64 = 1e-5;

/// A device that has not answered after so long is broken; a program that stands in for one takes some seconds.
const PATIENCE: Duration = Duration::from_secs(600);

#[test]
fn burn_on_the_processor_finds_our_gradient() {
    compare(TrainingDeviceKind::Cpu);
}

#[test]
#[cfg(feature = "wgpu")]
fn a_device_through_wgpu_finds_our_gradient() {
    compare(TrainingDeviceKind::Wgpu);
}

#[test]
#[cfg(feature = "vulkan")]
fn a_vulkan_device_finds_our_gradient() {
    compare(TrainingDeviceKind::Vulkan);
}

#[test]
#[cfg(feature = "cuda")]
fn a_cuda_device_finds_our_gradient() {
    compare(TrainingDeviceKind::Cuda);
}

#[test]
#[cfg(feature = "metal")]
fn a_metal_device_finds_our_gradient() {
    compare(TrainingDeviceKind::Metal);
}

/// Fails when a gradient differs, or the device does not answer; one line says what was run on, or that there is nothing.
fn compare(kind: TrainingDeviceKind) {
    let (say, heard) = mpsc::channel();
    let worker = std::thread::spawn(move || {
        // Who no more listens has given up.
        let _ = say.send(on_device(kind));
    });
    match heard.recv_timeout(PATIENCE) {
        Ok(()) => worker.join().unwrap(),
        Err(mpsc::RecvTimeoutError::Disconnected) => std::panic::resume_unwind(worker.join().unwrap_err()),
        Err(mpsc::RecvTimeoutError::Timeout) => panic!("the {kind} device has not answered for {PATIENCE:?}"),
    }
}

fn on_device(kind: TrainingDeviceKind) {
    let device = match TrainingDevice::open(kind) {
        Ok(device) => device,
        Err(error @ GenerateError::NoDevice { .. }) => return println!("skipped: {error}"),
        Err(error) => panic!("{error}"),
    };
    for (what, sizes) in [
        ("tiny, one token", Sizes::tiny()),
        ("tiny, three tokens and a linear path", Sizes { latent_tokens: 3, cosines: 5, ..Sizes::tiny() }),
        ("small", Sizes { cosines: 0, ..Sizes::small() }),
    ] {
        let case = Case::new(sizes);
        let began = Instant::now();
        let mut learner = DeviceVaeLearner::new(&case.sizes, &case.weights, &device).unwrap();
        let (losses, gradient) = case.run(|row, clips, noise, objective, gradient| {
            learner.step(row, clips, noise, objective, gradient).unwrap()
        });
        let seconds = began.elapsed().as_secs_f64();
        let mut learner = VaeLearner::new(&case.sizes, &case.weights).unwrap();
        let (our_losses, our_gradient) = case.run(|row, clips, noise, objective, gradient| {
            learner.step(row, clips, noise, objective, gradient).unwrap()
        });
        let by = |losses: VaeLosses| [losses.total, losses.features, losses.places, losses.divergence];
        let losses = by(losses).into_iter().zip(by(our_losses));
        let loss = losses.map(|(got, ours)| (got / ours - 1.0).abs()).fold(0.0, f64::max);
        let (tensor, name) = furthest(&case.weights, &gradient, &our_gradient);
        println!(
            "{kind} ({}), {what}: {} tensors, gradients {tensor:.1e} of their length off at most ({name}), losses {loss:.1e}; {seconds:.1} s",
            device.name(),
            case.weights.len(),
        );
        let most = if kind == TrainingDeviceKind::Cpu { TENSOR } else { TENSOR_ON_DEVICE };
        assert!(tensor < most, "{name}: {tensor:e}");
        assert!(loss < LOSS, "{loss:e}");
    }
}

/// A seeded network and a batch of clips of two lengths.
struct Case {
    sizes: Sizes,
    weights: Tensors,
    lengths: [usize; 2],
    features: Vec<f32>,
    noise: Vec<f32>,
    statistics: Statistics,
}

impl Case {
    fn new(sizes: Sizes) -> Self {
        let lengths = [24, 17];
        let deviation = Noise::new(9).normals(WIDTH).iter().map(|x| 0.1 + 0.1 * x.abs()).collect();
        Self {
            weights: hashed(&sizes, Parts::VAE),
            features: Noise::new(1).normals(lengths.iter().sum::<usize>() * WIDTH),
            noise: Noise::new(2).normals(lengths.len() * sizes.latent_tokens * sizes.width),
            statistics: Statistics::new(vec![0.0; WIDTH], deviation).unwrap(),
            lengths,
            sizes,
        }
    }

    fn run(
        &self,
        mut step: impl FnMut(&[f32], (&[f32], &[usize]), &[f32], &VaeObjective<'_>, &mut Vec<f32>) -> VaeLosses,
    ) -> (VaeLosses, Vec<f32>) {
        let statistics = &self.statistics;
        let objective = VaeObjective { features: 1.0, places: 20.0, divergence: 0.1, noise: 0.7, statistics };
        let mut gradient = vec![f32::NAN; 3];
        let clips = (&self.features[..], &self.lengths[..]);
        let losses = step(&self.weights.row(), clips, &self.noise, &objective, &mut gradient);
        (losses, gradient)
    }
}

/// The largest difference of any tensor's gradient, as a part of its length, and that tensor's name.
fn furthest<'a>(weights: &'a Tensors, got: &[f32], expected: &[f32]) -> (f64, &'a str) {
    assert_eq!((got.len(), expected.len()), (weights.numbers(), weights.numbers()));
    let length = |row: &mut dyn Iterator<Item = f32>| row.map(|x| f64::from(x).powi(2)).sum::<f64>().sqrt();
    let mut first = 0;
    let mut rows = Vec::new();
    for (name, tensor) in weights.iter() {
        let range = first..first + tensor.data().len();
        first = range.end;
        let (got, expected) = (&got[range.clone()], &expected[range]);
        let apart = length(&mut got.iter().zip(expected).map(|(a, b)| a - b));
        rows.push((apart, length(&mut expected.iter().copied()), name));
    }
    let longest = rows.iter().fold(0.0, |most: f64, row| most.max(row.1));
    let parts = rows.into_iter().map(|(apart, length, name)| {
        let part = apart / length.max(1e-3 * longest);
        (if part.is_nan() { f64::INFINITY } else { part }, name)
    });
    parts.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
}
