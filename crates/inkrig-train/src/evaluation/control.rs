//! How exactly a model meets key poses and trajectories of held-out clips (the paper's Table 1, on our own corpus).

use super::windows::EvaluationWindow;
use crate::TrainError;
use inkrig_generate::GenerateError;
use inkrig_generate::guidance::{Ask, View};
use inkrig_generate::measures::{
    ControlSummary, area_under_jerk, control_errors, jerk, mean_jerk, peak_jerk, pose_error, pose_error_2d,
    skating,
};
use inkrig_generate::networks::{Decoding, Vae};
use inkrig_generate::sampling::{Conditions, Request, Sampler, SamplingOptions};
use inkrig_generate::schedule::Noise;
use inkrig_generate::text::TextEncoder;
use inkrig_motion::Features;
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{
    Blocks, Camera, FRAME_RATE, JOINTS, Joints, Kept, Statistics, WIDTH, augment, keep_footing,
    recover_positions,
};
use rayon::prelude::*;
use serde::Serialize;

/// Joints that are controlled: pelvis, feet, head, wrists.
const CONTROLLED: [usize; 6] = [0, 10, 11, 15, 20, 21];

/// Clips that are sampled at once.
const TOGETHER: usize = 8;

/// Which joints are controlled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Protocol {
    /// One joint after the other; the mean of six runs.
    Average,
    /// Any of the 63 sets of joints, drawn for each clip.
    Cross,
}

/// What is measured.
#[derive(Debug, Clone)]
pub struct ControlOptions {
    /// Which joints.
    pub protocol: Protocol,
    /// Whether conditions are given as a camera sees them (pitch 15 to 30 degrees, yaw 30 to 45).
    pub plane: bool,
    /// How clips are sampled.
    pub sampling: SamplingOptions,
    /// Whether feet are put on the floor behind it.
    pub footing: bool,
    /// Of noise, cameras and joints.
    pub seed: u64,
}

/// Means over all clips. Lengths in metres.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct ControlRow {
    /// Clips that were made.
    pub clips: usize,
    /// Mean distance of joints at the key pose's frame, pelvis at its place, in space and as the camera sees it.
    pub pose: [f64; 2],
    /// Mean distance at all places that are asked for, in space and as the camera sees it.
    pub places: [f64; 2],
    /// Share of clips with a place that is missed by more than 20 and 50 cm in space.
    pub failed: [f64; 2],
    /// Share of places that are.
    pub places_failed: [f64; 2],
    /// Share of frames in which a foot skates.
    pub skating: f64,
    /// Area under the mean jerk beyond that of real motion, and its peak.
    pub jerk: [f64; 2],
}

/// A table of rows with their names.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ControlTable {
    /// Names, protocols and figures.
    pub rows: Vec<(String, Protocol, ControlRow)>,
}

/// What is measured of one clip.
struct Measured {
    pose: [f64; 2],
    errors: [inkrig_generate::measures::ControlErrors; 2],
    skating: f64,
    jerk: Vec<f64>,
}

/// What one clip is asked for.
struct Asked<'a> {
    window: &'a EvaluationWindow,
    camera: Camera,
    joints: Vec<usize>,
}

/// Makes a clip for every window (six for [`Protocol::Average`]) and compares it with the window; `progress` hears of every batch that
/// was made, of how many, and stops everything by saying no.
///
/// # Errors
/// When the model has not the networks for it, or it was stopped.
pub fn control(
    sampler: &Sampler<'_>,
    places: &Statistics,
    texts: &dyn TextEncoder,
    windows: &[EvaluationWindow],
    options: &ControlOptions,
    progress: &(dyn Fn(usize, usize) -> bool + Sync),
) -> Result<ControlRow, TrainError> {
    let asked = asked(windows, options);
    let batches: Vec<(usize, &[Asked<'_>])> = asked.chunks(TOGETHER).enumerate().collect();
    let done = std::sync::atomic::AtomicUsize::new(0);
    let each = batches.par_iter().map(|(at, batch)| {
        let made = generate(sampler, places, texts, batch, options, *at as u64)?;
        let count = 1 + done.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        if !progress(count, batches.len()) {
            return Err(TrainError::Stopped);
        }
        made.iter().zip(*batch).map(|(motion, asked)| measure(motion, asked)).collect::<Result<Vec<_>, _>>()
    });
    let measured = each.collect::<Result<Vec<_>, TrainError>>()?;
    Ok(ControlRow::of(&measured.into_iter().flatten().collect::<Vec<_>>()))
}

/// The windows themselves, and what the autoencoder makes of them: the best that a model on it can do.
///
/// # Errors
/// When a window is longer than the network takes.
pub fn bounds(
    vae: &Vae,
    features: &Statistics,
    windows: &[EvaluationWindow],
    options: &ControlOptions,
) -> Result<[ControlRow; 2], TrainError> {
    let asked = asked(windows, options);
    let real = asked.iter().map(|asked| measure(&asked.window.joints, asked));
    let real = real.collect::<Result<Vec<_>, _>>()?;
    let back = asked.par_iter().map(|asked| {
        let mut rows = asked.window.features.clone();
        features.normalise(&mut rows);
        let encoded = vae.encode(&rows)?;
        let mut decoding = Decoding::default();
        vae.decode(&encoded.mean, &[asked.window.joints.len()], &mut decoding)?;
        measure(&motion(decoding.features().to_vec(), features)?, asked)
    });
    let back = back.collect::<Result<Vec<_>, _>>()?;
    Ok([ControlRow::of(&real), ControlRow::of(&back)])
}

fn asked<'a>(windows: &'a [EvaluationWindow], options: &ControlOptions) -> Vec<Asked<'a>> {
    let mut noise = Noise::new(options.seed ^ 0x6361_6d65_7261);
    let mut asked = Vec::new();
    for window in windows {
        let (pitch, yaw) = (15.0 + 15.0 * noise.uniform(), 30.0 + 15.0 * noise.uniform());
        let camera = Camera::new((pitch as f32).to_radians(), (yaw as f32).to_radians());
        match options.protocol {
            Protocol::Average => {
                asked.extend(CONTROLLED.map(|joint| Asked { window, camera, joints: vec![joint] }));
            }
            Protocol::Cross => {
                let set = 1 + (noise.uniform() * 63.0) as usize;
                let joints = CONTROLLED.iter().enumerate().filter(|(bit, _)| set >> bit & 1 == 1);
                asked.push(Asked { window, camera, joints: joints.map(|(_, joint)| *joint).collect() });
            }
        }
    }
    asked
}

fn generate(
    sampler: &Sampler<'_>,
    places: &Statistics,
    texts: &dyn TextEncoder,
    batch: &[Asked<'_>],
    options: &ControlOptions,
    number: u64,
) -> Result<Vec<Vec<Joints>>, GenerateError> {
    let conditions = batch.iter().map(|asked| {
        let seen = |joints: &Joints| {
            if options.plane { joints.map(|joint| asked.camera.project(joint).extend(1.0)) } else { *joints }
        };
        let frames = asked.window.joints.len();
        let trajectory = asked.window.joints.iter().enumerate().flat_map(|(frame, joints)| {
            // Drawn joints are augmented ones; guidance sees the joints as they are. The six are the same in both.
            let joints = seen(joints);
            asked.joints.iter().map(move |&joint| Ask { frame, joint, place: joints[joint] })
        });
        let key_pose = asked.window.key_pose;
        let word = asked.window.actions.first().map_or("", String::as_str);
        let request = Request {
            frames,
            text: texts.encode(word)?,
            view: if options.plane { View::Plane(asked.camera) } else { View::Space },
            trajectory: trajectory.collect(),
            keypose: asked.window.joints.get(key_pose).map(|joints| (key_pose, seen(&augment(joints)))),
        };
        Conditions::new(&request, places, options.sampling.semantics)
    });
    let conditions = conditions.collect::<Result<Vec<_>, _>>()?;
    let seed = options.seed.wrapping_mul(0x9e37_79b9).wrapping_add(number);
    let latents = sampler.sample(&conditions, &options.sampling, seed)?.latents;
    let lengths: Vec<usize> = batch.iter().map(|asked| asked.window.joints.len()).collect();
    let mut decoding = Decoding::default();
    sampler.networks.vae.decode(&latents, &lengths, &mut decoding)?;
    let mut rest = decoding.features();
    let mut made = Vec::with_capacity(batch.len());
    for (length, asked) in lengths.into_iter().zip(batch) {
        let (own, others) = rest.split_at(length * WIDTH);
        rest = others;
        let mut rows = own.to_vec();
        sampler.features.restore(&mut rows);
        let contacts =
            rows.chunks_exact(WIDTH).map(|row| std::array::from_fn(|at| row[Blocks::CONTACTS.start + at]));
        let contacts: Vec<[f32; 4]> = contacts.collect();
        let joints = recover_positions(&Features::new(rows, WIDTH)?)?;
        if !options.footing {
            made.push(joints);
            continue;
        }
        // On the picture nobody says how deep a joint is: it stays where it came to be.
        let places = if options.plane { &joints } else { &asked.window.joints };
        let mut kept = Vec::new();
        for (frame, places) in places.iter().enumerate().take(length) {
            let pose = frame == asked.window.key_pose;
            let own = (0..JOINTS).filter(|joint| pose || asked.joints.contains(joint));
            kept.extend(own.map(|joint| Kept { frame, joint, place: places[joint] }));
        }
        made.push(keep_footing(&joints, &contacts, FRAME_RATE, &kept)?.frames);
    }
    Ok(made)
}

fn motion(mut rows: Vec<f32>, features: &Statistics) -> Result<Vec<Joints>, TrainError> {
    features.restore(&mut rows);
    Ok(recover_positions(&Features::new(rows, WIDTH)?)?)
}

fn measure(motion: &[Joints], asked: &Asked<'_>) -> Result<Measured, TrainError> {
    let (wanted, key_pose) = (&asked.window.joints, asked.window.key_pose);
    let table = |flat: bool| {
        let place = |joint: Vec3| if flat { asked.camera.project(joint).extend(0.0) } else { joint };
        let rows = wanted.iter().enumerate().map(|(frame, joints)| {
            let mut row = [None; JOINTS];
            for (joint, entry) in row.iter_mut().enumerate() {
                if frame == key_pose || asked.joints.contains(&joint) {
                    *entry = Some(place(joints[joint]));
                }
            }
            row
        });
        let own: Vec<Joints> = motion.iter().map(|joints| joints.map(place)).collect();
        control_errors(&own, &rows.collect::<Vec<_>>())
    };
    let pose = match (motion.get(key_pose), wanted.get(key_pose)) {
        (Some(own), Some(wanted)) => [pose_error(own, wanted), pose_error_2d(own, wanted, &asked.camera)],
        _ => [0.0; 2],
    };
    Ok(Measured {
        pose,
        errors: [table(false)?, table(true)?],
        skating: skating(motion).ratio,
        jerk: jerk(motion),
    })
}

impl ControlRow {
    fn of(measured: &[Measured]) -> Self {
        let mean = |of: &dyn Fn(&Measured) -> f64| {
            measured.iter().map(of).sum::<f64>() / measured.len().max(1) as f64
        };
        let summary =
            |at: usize| ControlSummary::of(&measured.iter().map(|one| one.errors[at]).collect::<Vec<_>>());
        let (space, plane) = (summary(0), summary(1));
        let curve = mean_jerk(&measured.iter().map(|one| one.jerk.clone()).collect::<Vec<_>>());
        Self {
            clips: measured.len(),
            pose: [mean(&|one| one.pose[0]), mean(&|one| one.pose[1])],
            places: [space.mean, plane.mean],
            failed: space.failed,
            places_failed: space.places_failed,
            skating: mean(&|one| one.skating),
            jerk: [area_under_jerk(&curve), peak_jerk(&curve)],
        }
    }
}

impl ControlTable {
    /// As Markdown.
    pub fn text(&self) -> String {
        let mut text = String::from(
            "| | joints | clips | MPJPE-3D | MPJPE-2D | Avg. Err-3D | Avg. Err-2D | fail 20 / 50 cm | places 20 / 50 cm | skating | jerk area | jerk peak |\n\
             |---|---|---|---|---|---|---|---|---|---|---|---|\n",
        );
        for (name, protocol, row) in &self.rows {
            let joints = if *protocol == Protocol::Average { "one" } else { "several" };
            text += &format!(
                "| {name} | {joints} | {} | {:.4} | {:.4} | {:.4} | {:.4} | {:.3} / {:.3} | {:.3} / {:.3} | {:.3} | {:.3} | {:.4} |\n",
                row.clips,
                row.pose[0],
                row.pose[1],
                row.places[0],
                row.places[1],
                row.failed[0],
                row.failed[1],
                row.places_failed[0],
                row.places_failed[1],
                row.skating,
                row.jerk[0],
                row.jerk[1],
            );
        }
        text
    }
}
