//! How long the second engine takes, full size, 40 frames, one core: the least CPU time of some rounds, in milliseconds.
//!
//!     cargo run --release -p inkrig-generate --example generation_speed [ROUNDS]
//!
//! With `serve` it takes the name of a workload a line and answers with milliseconds, for `benches/peers/generate.py`.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "an example for developers")]

use inkrig_generate::guidance::{Ask, Guide, GuidedClip, Mean, Target, View};
use inkrig_generate::networks::{Decoding, Domain, Parts, Sizes};
use inkrig_generate::sampling::{Conditions, Networks, Sampler, SamplingOptions, Semantics, Steps};
use inkrig_generate::schedule::Noise;
use inkrig_generate::weights::hashed;
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{Camera, Statistics, WIDTH};
use std::io::{BufRead, Write};

const FRAMES: usize = 40;
const WORKLOADS: [&str; 6] = ["lcm2", "evaluation", "ddim50", "decode", "denoiser", "trajectory"];

struct Bench {
    networks: Networks,
    features: Statistics,
    conditions: Vec<Conditions>,
    no_text: Vec<f32>,
    decoding: Decoding,
}

fn main() {
    let mut bench = Bench::new();
    let argument = std::env::args().nth(1).unwrap_or_else(|| "5".into());
    if argument == "serve" {
        println!("ready");
        for line in std::io::stdin().lock().lines() {
            println!("{}", bench.run(line.unwrap().trim()));
            std::io::stdout().flush().unwrap();
        }
        return;
    }
    let rounds: usize = argument.parse().unwrap();
    for name in WORKLOADS {
        bench.run(name);
        let least = (0..rounds).map(|_| bench.run(name)).fold(f64::INFINITY, f64::min);
        println!("{name:12} {least:8.2} ms");
    }
}

impl Bench {
    fn new() -> Self {
        let sizes = Sizes::full();
        let networks = Networks::new(&sizes, &hashed(&sizes, Parts::ALL)).unwrap();
        let row = |seed: usize| Noise::new(seed as u64).normals(66);
        let asks =
            (0..35).map(|frame| Ask { frame, joint: 10, place: Vec3::new(0.1, 0.2, 0.01 * frame as f32) });
        let target =
            Target { view: View::Plane(Camera::default()), asks: asks.collect(), depths: Vec::new() };
        let rows = (0..FRAMES).map(|frame| (frame, row(frame))).collect();
        let text = Noise::new(100).normals(sizes.text_width);
        let keypose = Some((0, row(200)));
        let conditions = Conditions::from_tables(FRAMES, text, Domain::Plane, rows, keypose, target).unwrap();
        Self {
            networks,
            features: Statistics::new(vec![0.0; WIDTH], vec![0.1; WIDTH]).unwrap(),
            conditions: vec![conditions],
            no_text: vec![0.1; sizes.text_width],
            decoding: Decoding::default(),
        }
    }

    /// CPU milliseconds of one run.
    fn run(&mut self, name: &str) -> f64 {
        let before = cpu();
        match name {
            "lcm2" => self.sample(Steps::Lcm(2)),
            "ddim50" => self.sample(Steps::Ddim(50)),
            "decode" => self.decode(&Noise::new(1).normals(256)),
            "evaluation" => return self.evaluate(),
            "denoiser" => self.denoise(),
            "trajectory" => {
                let rows: Vec<Vec<f32>> = (0..FRAMES).map(|frame| vec![0.1 * frame as f32; 66]).collect();
                let rows: Vec<_> = rows.iter().enumerate().map(|(frame, row)| (frame, &row[..])).collect();
                self.networks.control.as_ref().unwrap().space.trajectory.encode(&rows).unwrap();
            }
            other => println!("no workload {other}"),
        }
        (cpu() - before) * 1e3
    }

    fn sample(&mut self, steps: Steps) {
        let sampler = Sampler { networks: &self.networks, features: &self.features, no_text: &self.no_text };
        let semantics = Semantics::Official;
        let options = SamplingOptions { steps, semantics, guidance: None, ..SamplingOptions::default() };
        let sampled = sampler.sample(&self.conditions, &options, 1).unwrap();
        self.decode(&sampled.latents);
    }

    fn decode(&mut self, latents: &[f32]) {
        self.networks.vae.decode(latents, &[FRAMES], &mut self.decoding).unwrap();
    }

    /// One loss with its gradient; buffers are there already, as in the second and later ones of a run.
    fn evaluate(&self) -> f64 {
        let asks =
            (0..35).map(|frame| Ask { frame, joint: 10, place: Vec3::new(0.1, 0.2, 0.01 * frame as f32) });
        let target =
            Target { view: View::Plane(Camera::default()), asks: asks.collect(), depths: Vec::new() };
        let clips = [GuidedClip { target: &target, frames: FRAMES }];
        let mut guide = Guide::new(&self.networks.vae, &self.features, &clips);
        let (latent, mut gradient) = (Noise::new(1).normals(256), vec![0.0; 256]);
        guide.loss(&latent, Mean::AllEntries, &mut gradient).unwrap();
        let before = cpu();
        guide.loss(&latent, Mean::AllEntries, &mut gradient).unwrap();
        (cpu() - before) * 1e3
    }

    fn denoise(&self) {
        use inkrig_generate::networks::{Noisy, Work};
        let (latents, texts) = (Noise::new(1).normals(256), Noise::new(2).normals(768));
        let noisy = Noisy { latents: &latents, timesteps: &[999], texts: &texts, guidance: None };
        self.networks.denoiser.noise(&noisy, None, &mut Work::default()).unwrap();
    }
}

/// CPU time of this process, seconds: what else runs on the machine does not count.
fn cpu() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}
