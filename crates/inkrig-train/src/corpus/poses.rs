//! Which poses of a clip a person would draw.

use inkrig_motion::Features;
use inkrig_motion::humanml::Blocks;

/// Frames to each side that a pose is compared with: a second.
const AROUND: usize = 20;
/// Two poses worth drawing are at least so many frames apart.
const APART: usize = 8;

/// Frames whose pose stands out from those around it most, in order of time: the turning points of a movement, where a kick
/// is highest or an arm farthest out. Rows are those of [`inkrig_motion::humanml::features`]. At least one, unless there is no row.
pub fn key_pose_frames(features: &Features) -> Vec<usize> {
    let frames = features.frames();
    let place = |frame: usize| &features.row(frame)[Blocks::PLACES];
    // How far each pose is from the mean of the second to each side.
    let far: Vec<f32> = (0..frames)
        .map(|frame| {
            let around = frame.saturating_sub(AROUND)..(frame + AROUND + 1).min(frames);
            let count = around.len() as f32;
            let mut mean = vec![0.0; Blocks::PLACES.len()];
            for other in around {
                mean.iter_mut().zip(place(other)).for_each(|(sum, value)| *sum += value / count);
            }
            place(frame).iter().zip(&mean).map(|(value, mean)| (value - mean).powi(2)).sum::<f32>().sqrt()
        })
        .collect();
    let usual = far.iter().sum::<f32>() / frames.max(1) as f32;
    let stands_out = |frame: usize| {
        let around = &far[frame.saturating_sub(APART)..(frame + APART + 1).min(frames)];
        far[frame] >= usual && around.iter().all(|&other| other <= far[frame])
    };
    let mut chosen: Vec<usize> = Vec::new();
    for frame in (0..frames).filter(|&frame| stands_out(frame)) {
        if chosen.last().is_none_or(|&last| frame >= last + APART) {
            chosen.push(frame);
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_motion::humanml::WIDTH;

    #[test]
    fn turning_points_are_chosen() {
        let swing = |frame: usize| (frame as f32 * std::f32::consts::PI / 20.0).sin();
        let mut values = vec![0.0; 100 * WIDTH];
        for (frame, row) in values.chunks_exact_mut(WIDTH).enumerate() {
            row[Blocks::PLACES.start] = swing(frame);
        }
        let chosen = key_pose_frames(&Features::new(values, WIDTH).unwrap());
        assert!(chosen.len() >= 4, "{chosen:?}");
        for frame in [30, 50, 70] {
            assert!(chosen.iter().any(|own| own.abs_diff(frame) <= 1), "{frame}: {chosen:?}");
        }
        let still = key_pose_frames(&Features::new(vec![0.0; 50 * WIDTH], WIDTH).unwrap());
        assert!(!still.is_empty());
    }
}
