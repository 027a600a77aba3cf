//! What the page is told: the data of a [`Preview`], cut to a size that a browser shows well.

use super::{
    ControlView, HeatMap, Preview,
    board::BoardData,
    encode::{base64, decimals, shorten},
    guide::GuideData,
    track::Track,
};
use inkrig_motion::Clip;
use inkrig_motion::capsules::{Body, Limb, Side};
use serde::Serialize;

const MOST_JOINTS: usize = 512;
const MOST_CONTROL_FRAMES: usize = 20_000;
/// Source and control steps of the heat map: what its place on a page can show.
const MOST_HEAT: [usize; 2] = [240, 480];
const MOST_LINES: usize = 200;
const RESULT_RATE: f64 = 60.0;
/// The source is only shown beside the result: half the rate will do.
const SOURCE_RATE: f64 = 30.0;

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Payload {
    title: String,
    seconds: f64,
    source_seconds: f64,
    /// Frames a second of the clips themselves, which may be more than is sent.
    result_rate: f64,
    result_frames: usize,
    control_rate: f64,
    control: Control,
    /// Samples a second of what follows.
    sample_rate: f64,
    best_source: Vec<f64>,
    confidence: Vec<f64>,
    guide: Option<GuideData>,
    /// Frames of a storyboard; without them a curve or a way is shown.
    board: Vec<BoardData>,
    heat_map: Heat,
    result: Character,
    source: Character,
    figures: Vec<[String; 3]>,
    notes: Vec<String>,
}

#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum Control {
    /// x right, y up, the longer side of the bounding box is 1.
    Curve { points: Vec<[f64; 2]> },
    /// The same, of a way over the ground.
    Way { points: Vec<[f64; 2]> },
}

#[derive(Debug, Serialize)]
struct Heat {
    width: usize,
    height: usize,
    /// One byte a cell in base64, row by row, a row for every step of control time.
    values: String,
}

#[derive(Debug, Serialize)]
struct Character {
    size: f64,
    names: Vec<String>,
    /// The joints that the camera keeps in the picture.
    framed: Vec<usize>,
    limbs: Vec<LimbData>,
    pair: Option<[usize; 2]>,
    track: Track,
}

/// A limb with the names that the page knows.
#[derive(Debug, Serialize)]
struct LimbData {
    from: usize,
    to: usize,
    from_radius: f32,
    to_radius: f32,
    side: &'static str,
}

impl LimbData {
    fn of(limb: &Limb) -> Self {
        let Limb { from, to, from_radius, to_radius, side } = *limb;
        let side = match side {
            Side::Left => "left",
            Side::Right => "right",
            Side::Middle => "middle",
        };
        Self { from, to, from_radius, to_radius, side }
    }
}

impl Payload {
    pub(super) fn of(preview: &Preview<'_>) -> Self {
        let (ControlView::Curve(points) | ControlView::Way(points)) = preview.control;
        let step = points.len().div_ceil(MOST_CONTROL_FRAMES).max(1);
        let rate = if preview.control_rate.is_normal() { preview.control_rate.abs() } else { 1.0 };
        let control_seconds = points.len().saturating_sub(1) as f64 / rate;
        let sample_rate = preview.guide.map_or(rate, |guide| guide.rate);
        let stride = preview.best_source.len().div_ceil(MOST_CONTROL_FRAMES).max(1);
        let mut notes: Vec<String> =
            preview.notes.iter().take(MOST_LINES).map(|note| shorten(note, 2000)).collect();
        let (result, source) = (
            Character::of(preview.result, RESULT_RATE, "result", &mut notes),
            Character::of(preview.source, SOURCE_RATE, "source clip", &mut notes),
        );
        Self {
            title: shorten(preview.title, 200),
            seconds: decimals(control_seconds.max(preview.result.duration()), 6),
            source_seconds: decimals(preview.source.duration(), 6),
            result_rate: decimals(preview.result.frame_rate(), 3),
            result_frames: preview.result.frames(),
            control_rate: decimals(rate / step as f64, 6),
            control: match preview.control {
                ControlView::Curve(_) => Control::Curve { points: normalised(points, step) },
                ControlView::Way(_) => Control::Way { points: normalised(points, step) },
            },
            sample_rate: decimals(sample_rate / stride as f64, 6),
            board: BoardData::of(preview.board),
            guide: preview.guide.map(|guide| GuideData::of(guide, stride)),
            best_source: thinned(preview.best_source, stride, 3),
            confidence: thinned(preview.confidence, stride, 3)
                .iter()
                .map(|value| value.clamp(0.0, 1.0))
                .collect(),
            heat_map: Heat::of(&preview.heat_map),
            result,
            source,
            figures: (preview.figures.iter().take(MOST_LINES))
                .map(|f| [shorten(&f.name, 200), shorten(&f.value, 200), shorten(&f.note, 2000)])
                .collect(),
            notes,
        }
    }
}

impl Character {
    fn of(clip: &Clip, rate: f64, what: &str, notes: &mut Vec<String>) -> Self {
        let body = Body::of(clip, MOST_JOINTS);
        let all = clip.skeleton().len();
        if all > MOST_JOINTS {
            notes.push(format!(
                "The {what} has {all} joints; this page draws the {MOST_JOINTS} that carry the longest chains."
            ));
        }
        let track = Track::of(clip, &body, rate);
        let joints = clip.skeleton().joints();
        let mut framed: Vec<usize> = body.limbs.iter().flat_map(|limb| [limb.from, limb.to]).collect();
        framed.retain(|&joint| body.own.get(joint) == Some(&true));
        framed.sort_unstable();
        framed.dedup();
        Self {
            framed,
            size: f64::from(body.size),
            names: body.joints.iter().map(|&joint| shorten(&joints[joint].name, 64)).collect(),
            limbs: body.limbs.iter().map(LimbData::of).collect(),
            pair: body.pair,
            track,
        }
    }
}

impl Heat {
    /// Cells are bytes of the square root of the weight, since small weights matter to the eye. Full is the 95th
    /// percentile of the largest weight of each row, so that one sharp row does not make the others invisible.
    fn of(map: &HeatMap) -> Self {
        let map = shrunk(map);
        let mut peaks: Vec<f32> =
            map.values.chunks(map.width.max(1)).map(|row| row.iter().copied().fold(0.0, f32::max)).collect();
        peaks.sort_by(f32::total_cmp);
        let full = peaks.get(peaks.len().saturating_sub(1) * 95 / 100).copied().unwrap_or(0.0);
        let full = if full > 0.0 { full } else { 1.0 };
        let bytes: Vec<u8> =
            map.values.iter().map(|value| ((value / full).min(1.0).sqrt() * 255.0).round() as u8).collect();
        Self { width: map.width, height: map.height, values: base64(&bytes) }
    }
}

/// The map with sides of at most [`MOST_HEAT`], cells taking the largest weight that falls into them, and
/// without values that are negative or not finite. Empty when its sides do not fit its values.
fn shrunk(map: &HeatMap) -> HeatMap {
    if map.width.checked_mul(map.height) != Some(map.values.len()) || map.values.is_empty() {
        return HeatMap { width: 0, height: 0, values: Vec::new() };
    }
    let (width, height) = (map.width.min(MOST_HEAT[0]), map.height.min(MOST_HEAT[1]));
    let mut values = vec![0.0_f32; width * height];
    for (row, cells) in map.values.chunks(map.width).enumerate() {
        let start = row * height / map.height * width;
        for (column, &value) in cells.iter().enumerate() {
            let slot = &mut values[start + column * width / map.width];
            *slot = slot.max(if value.is_finite() { value } else { 0.0 });
        }
    }
    HeatMap { width, height, values }
}

/// Every `step`th point, moved and scaled to a bounding box with sides of at most 1. A point that is not finite
/// stays where the one before it was.
pub(crate) fn normalised(points: &[[f64; 2]], step: usize) -> Vec<[f64; 2]> {
    let finite = |point: &&[f64; 2]| point.iter().all(|value| value.is_finite());
    let Some(&first) = points.iter().find(finite) else { return Vec::new() };
    let (mut low, mut high) = (first, first);
    for point in points.iter().filter(finite) {
        for axis in 0..2 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    // Halves, since the distance of two finite numbers may be infinite.
    let side = (high[0] / 2.0 - low[0] / 2.0).max(high[1] / 2.0 - low[1] / 2.0).max(f64::MIN_POSITIVE);
    let mut last = first;
    (points.iter().step_by(step))
        .map(|point| {
            last = if finite(&point) { *point } else { last };
            std::array::from_fn(|axis| decimals((last[axis] / 2.0 - low[axis] / 2.0) / side, 4))
        })
        .collect()
}

fn thinned(values: &[f32], step: usize, places: i32) -> Vec<f64> {
    let values = values.iter().step_by(step).take(MOST_CONTROL_FRAMES);
    values.map(|&value| decimals(f64::from(value), places)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_fits_the_unit_square_whatever_its_size() {
        let points = [[-1e308, 0.0], [f64::NAN, 1.0], [1e308, 5e307]];
        assert_eq!(normalised(&points, 1), [[0.0, 0.0], [0.0, 0.0], [1.0, 0.25]]);
        assert_eq!(normalised(&[[3.0, 3.0]; 4], 2), [[0.0, 0.0]; 2]);
        assert!(normalised(&[[f64::NAN; 2]], 1).is_empty());
    }

    #[test]
    fn a_large_plan_keeps_its_peaks() {
        let mut values = vec![0.0_f32; 3000 * 2];
        values[2999] = 0.5;
        values[3000] = f32::NAN;
        let small = shrunk(&HeatMap { width: 3000, height: 2, values });
        assert_eq!((small.width, small.height), (240, 2));
        assert_eq!(small.values[239], 0.5);
        assert!(small.values.iter().all(|value| value.is_finite()));
        let wrong = shrunk(&HeatMap { width: 3, height: 3, values: vec![1.0; 8] });
        assert_eq!((wrong.width, wrong.height), (0, 0));
    }
}
