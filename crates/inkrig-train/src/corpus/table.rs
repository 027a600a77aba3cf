//! Joints that stand in NumPy's tables: those of HumanML3D, and AMASS-like ones.

use super::check::{Rejected, check};
use super::config::Up;
use inkrig_generate::checkpoint::{Npz, read_table};
use inkrig_motion::Features;
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{self, FRAME_RATE, JOINTS, Joints, Offsets, WIDTH};
use std::io::Cursor;
use std::ops::RangeInclusive;

/// Bytes of a file, and of a table in it once unpacked: half an hour of 52 joints at 120 frames a second in double precision.
pub(super) const MOST_BYTES: usize = 256 << 20;
/// Frames at 20 a second: an hour.
const MOST_FRAMES: usize = 72_000;
/// No joint is farther from the origin, metres.
const FARTHEST: f32 = 1000.0;
/// Frames a second that motion can have.
pub(super) const RATES: RangeInclusive<f64> = 1.0..=1000.0;
/// What tables of joints are called, the first that is there is taken.
const JOINT_TABLES: [&str; 3] = ["joints", "Jtr", "positions"];
/// What numbers of frames a second are called.
const RATE_TABLES: [&str; 4] = ["mocap_framerate", "mocap_frame_rate", "frame_rate", "fps"];

/// How a table is meant.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Table {
    pub rows: Rows,
    /// Frames a second, where the file does not say.
    pub frame_rate: Option<f64>,
    pub up: Up,
    /// The part of it that is a clip, seconds; `None` for all.
    pub span: Option<(f64, f64)>,
}

/// What a row of a table is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rows {
    /// 263 numbers.
    Features,
    /// Places of 22 joints or more, the first 22 in the order of SMPL.
    Joints,
}

impl Table {
    /// What it says, as bytes of a key.
    pub(super) fn key(&self) -> Vec<u8> {
        format!("{self:?}").into_bytes()
    }

    /// The joints at 20 frames a second, metres, y up.
    pub(super) fn joints(&self, bytes: &[u8]) -> Result<Vec<Joints>, Rejected> {
        let (shape, numbers, own_rate) = read(bytes)?;
        let wrong = |what: &str| Rejected::Unreadable(format!("its table is {shape:?}: {what}"));
        let frames = match (self.rows, &shape[..]) {
            (Rows::Features, &[frames, WIDTH]) if (1..=MOST_FRAMES).contains(&frames) => {
                let broken = |error: inkrig_motion::MotionError| Rejected::Broken(error.to_string());
                humanml::recover_positions(&Features::new(numbers, WIDTH).map_err(broken)?).map_err(broken)?
            }
            (Rows::Features, _) => return Err(wrong("frames x 263 numbers are needed, an hour at most")),
            (Rows::Joints, &[_, WIDTH]) => {
                return Err(wrong(
                    "these are HumanML3D's numbers; give its [[source]] format = \"humanml3d\"",
                ));
            }
            (Rows::Joints, &[_, joints @ 0..JOINTS, 3]) => {
                return Err(Rejected::NoBody(format!(
                    "{joints} joints, {JOINTS} in the order of SMPL are needed"
                )));
            }
            (Rows::Joints, &[frames, joints, 3]) if frames > 0 => {
                let rate = own_rate.or(self.frame_rate).ok_or_else(|| {
                    Rejected::Unreadable(
                        "it does not say how many frames a second it has: give frame_rate in its [[source]], or a column fps in the index".into(),
                    )
                })?;
                if !RATES.contains(&rate) {
                    let what = format!("{rate} frames a second are none that motion has, which is 1 to 1000");
                    return Err(Rejected::Unreadable(what));
                }
                if frames as f64 * FRAME_RATE / rate > MOST_FRAMES as f64 {
                    return Err(wrong("it is longer than an hour; cut it"));
                }
                at_frame_rate(&self.frames(&numbers, joints), rate)
            }
            (Rows::Joints, _) => return Err(wrong("frames x joints x 3 is needed")),
        };
        let far = |place: &Vec3| place.abs().max_element() > FARTHEST;
        if frames.iter().flatten().any(far) {
            let what = "a joint is farther than a kilometre from the origin: places must be metres";
            return Err(Rejected::Unreadable(what.into()));
        }
        Ok(self.cut(frames))
    }

    /// The bones of its first frame, if it is fit to learn from.
    pub(super) fn body(&self, bytes: &[u8], least_frames: usize) -> Result<Offsets, Rejected> {
        let joints = self.joints(bytes)?;
        check(&joints, least_frames)?;
        joints.first().map(humanml::bone_lengths).ok_or(Rejected::Short { frames: 0, least: least_frames })
    }

    fn frames(&self, numbers: &[f32], joints: usize) -> Vec<Joints> {
        let turned = |&[x, y, z]: &[f32; 3]| match self.up {
            Up::Y => Vec3::new(x, y, z),
            Up::Z => Vec3::new(x, z, -y),
        };
        let frames = numbers.as_chunks::<3>().0.chunks_exact(joints);
        frames
            .map(|frame| std::array::from_fn(|joint| frame.get(joint).map(turned).unwrap_or_default()))
            .collect()
    }

    fn cut(&self, mut frames: Vec<Joints>) -> Vec<Joints> {
        let Some((start, end)) = self.span else { return frames };
        // As the form's authors count: towards zero. Casts of what is too large stay within the clip.
        let frame = |seconds: f64| ((seconds * FRAME_RATE) as usize).min(frames.len());
        let (start, end) = (frame(start), frame(end));
        frames.truncate(end);
        frames.drain(..start.min(end));
        frames
    }
}

/// The table of a file, and its frames a second where it says them.
#[allow(clippy::type_complexity, reason = "shape, numbers and rate, used once")]
fn read(bytes: &[u8]) -> Result<(Vec<usize>, Vec<f32>, Option<f64>), Rejected> {
    let unreadable = |error: inkrig_generate::CheckpointError| Rejected::Unreadable(error.to_string());
    if !bytes.starts_with(b"PK") {
        let (shape, numbers) = read_table(bytes, "the file").map_err(unreadable)?;
        return Ok((shape, numbers, None));
    }
    let mut tables = Npz::open(Cursor::new(bytes)).map_err(unreadable)?;
    let has = |name: &str| tables.names().any(|own| own == name);
    let Some(name) = JOINT_TABLES.into_iter().find(|name| has(name)) else {
        if has("poses") {
            let what = "it has the turns of a body model (poses) and no places of joints; those come out of that model, which is not \
                        in this program: save them beside it as a table `joints`, frames x 22 x 3";
            return Err(Rejected::NoBody(what.into()));
        }
        return Err(Rejected::Unreadable("it has no table `joints`, `Jtr` or `positions`".into()));
    };
    let rate = RATE_TABLES.into_iter().find(|name| has(name));
    let rate = rate.map(|name| tables.number(name)).transpose().map_err(unreadable)?;
    let (shape, numbers) = tables.table(name, MOST_BYTES).map_err(unreadable)?;
    Ok((shape, numbers, rate.map(f64::from)))
}

/// Places at 20 frames a second; those in between are interpolated.
fn at_frame_rate(own: &[Joints], rate: f64) -> Vec<Joints> {
    let step = rate / FRAME_RATE;
    let count = (own.len().saturating_sub(1) as f64 / step + 1e-6).floor() as usize + 1;
    let at = |index: usize| {
        let place = index as f64 * step;
        let low = own.get((place.floor() as usize).min(own.len().saturating_sub(1)))?;
        let high = own.get(place.floor() as usize + 1).unwrap_or(low);
        let part = (place - place.floor()) as f32;
        Some(std::array::from_fn(|joint| low[joint].lerp(high[joint], part)))
    };
    (0..count).filter_map(at).collect()
}
