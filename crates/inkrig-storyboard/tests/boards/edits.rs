//! Joints that are put elsewhere in space after a motion was made.

use crate::support::{MODEL, board, generated, poses, understood};
use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::humanml::{Joints, bone_lengths};
use inkrig_storyboard::{Animation, Exact, Generated, MeetOptions, Source, animation};

/// Clips of a storyboard of several frames.
fn clips() -> Vec<Generated> {
    let frames = board("walk-and-wave").frames;
    let read = frames.iter().map(|frame| understood(frame).unwrap());
    read.enumerate().map(|(at, read)| generated(&read, at + 1, &MODEL.sampling, true)).collect()
}

/// A joint of a clip is put elsewhere by this.
fn edit(clip: &Generated, (frame, joint): (usize, usize), by: Vec3, lock_ends: bool) -> Generated {
    let mut clip = clip.clone();
    let at = clip.motion[frame][joint] + by;
    clip.plan.space.edits.push((frame, joint, at));
    clip.plan.space.lock_ends = lock_ends;
    clip
}

fn made(clips: &[Generated], exact: &Exact) -> Animation {
    animation(clips, None, &MODEL.body, exact).unwrap()
}

fn pin() -> Exact {
    Exact::Pin(MeetOptions::default())
}

/// The largest miss of places in space, metres.
fn missed(animation: &Animation) -> f32 {
    let motion = poses(&animation.clip);
    let edits = animation.goals.iter().flatten().filter(|goal| goal.source == Source::Edit);
    let misses: Vec<f32> = edits.map(|goal| goal.miss(motion[goal.frame][goal.joint]).length()).collect();
    assert!(!misses.is_empty());
    misses.into_iter().fold(0.0, f32::max)
}

/// Mean and largest change of some joints over frames, metres.
fn change(a: &[Joints], b: &[Joints], joints: &[usize], frames: impl Fn(usize) -> bool) -> [f32; 2] {
    let pairs = a.iter().zip(b).enumerate().filter(|(at, _)| frames(*at));
    let all: Vec<f32> =
        pairs.flat_map(|(_, (a, b))| joints.iter().map(|joint| a[*joint].distance(b[*joint]))).collect();
    [all.iter().sum::<f32>() / all.len().max(1) as f32, all.into_iter().fold(0.0, f32::max)]
}

#[test]
fn an_edit_is_met_and_moves_little_else() {
    let clips = clips();
    let all: Vec<usize> = (0..22).collect();
    for exact in [Exact::Off, Exact::Soft, pin()] {
        let before = made(&clips, &exact);
        let old = poses(&before.clip);
        let soft = exact == Exact::Soft;
        for (joint, by, limb) in [
            (21, Vec3::new(0.0, 0.2, 0.15), [17, 19, 21]),
            (20, Vec3::new(0.15, -0.1, 0.1), [16, 18, 20]),
            (11, Vec3::new(0.0, 0.15, 0.1), [5, 8, 11]),
        ]
        .into_iter()
        .take(if soft { 3 } else { 1 })
        {
            for lock in [true, false] {
                let (number, frame) = (1, 20);
                let mut edited = clips.clone();
                edited[number] = edit(&clips[number], (frame, joint), by, lock);
                let after = made(&edited, &exact);
                let new = poses(&after.clip);
                assert!(missed(&after) < 0.002, "{joint}: {}", missed(&after));
                // Other clips stay as they are before they are placed, and where they are.
                for (at, clip) in clips.iter().enumerate().filter(|(at, _)| *at != number) {
                    assert_eq!(after.clips[at], clip.motion);
                }
                let at = after.joined.starts[number] + frame;
                let others: Vec<usize> = all.iter().copied().filter(|joint| !limb.contains(joint)).collect();
                let own = change(&new, &old, &limb, |frame| frame.abs_diff(at) <= 10);
                let other = change(&new, &old, &others, |frame| frame.abs_diff(at) <= 10);
                let far = change(&new, &old, &all, |frame| frame.abs_diff(at) > 10);
                println!(
                    "joint {joint} by {:.2} m, lock {lock}: missed by {:.4} m; mean and largest change: limb {own:.4?}, others {other:.4?}, farther than 10 frames {far:.4?}",
                    by.length(),
                    missed(&after)
                );
                // A standing foot that is put elsewhere makes another stretch stand where nothing holds the ends.
                let most = if joint == 11 && !lock { [0.02, 0.1] } else { [1e-3, 0.06] };
                assert!(own[0] > 2.0 * other[0] && other[0] < 0.05 && far[0] < most[0] && far[1] < most[1]);
                let bones = bone_lengths(&old[0]);
                for pose in &new {
                    let own = bone_lengths(pose);
                    assert!(own.iter().zip(&bones).all(|(a, b)| (a.length() - b.length()).abs() < 1e-3));
                }
            }
        }
    }
}

#[test]
fn later_clips_follow_as_a_whole_or_stay() {
    let clips = clips();
    let before = made(&clips, &Exact::Soft);
    let old = poses(&before.clip);
    let last = clips[0].motion.len() - 1;
    // The whole body goes elsewhere at the end of the first clip.
    for (joint, frame) in [(0, last), (0, last - 4)] {
        let mut edited = clips.clone();
        edited[0] = edit(&clips[0], (frame, joint), Vec3::new(0.3, 0.0, 0.1), false);
        let after = made(&edited, &Exact::Soft);
        assert!(missed(&after) < 0.002);
        assert_eq!(after.clips[1], clips[1].motion);
        let (turn, shift) = after.joined.placements[1];
        let (turned, shifted) = before.joined.placements[1];
        println!(
            "frame {frame}: the next clip is shifted by {} and turned by {:.4}",
            shift - shifted,
            turn.angle_between(turned)
        );
        assert!((shift - shifted).length() > 0.05 && shift.y == 0.0);
        assert!((turn * Vec3::Y - Vec3::Y).length() < 1e-6);
        // Before feet are put on the floor it is the same but for that.
        let (start, other) = (after.joined.starts[1], before.joined.starts[1]);
        let (to, from): (Quat, _) = (turn * turned.inverse(), shifted);
        for frame in 15..clips[1].motion.len() {
            let moved = before.joined.motion[other + frame].map(|place| to * (place - from) + shift);
            let off = change(&[after.joined.motion[start + frame]], &[moved], &[0, 7, 15, 20], |_| true);
            assert!(off[1] < 1e-4, "{frame}: {off:?}");
        }
    }
    let mut edited = clips.clone();
    edited[0] = edit(&clips[0], (last - 4, 0), Vec3::new(0.3, 0.0, 0.1), true);
    let after = made(&edited, &Exact::Soft);
    assert!(missed(&after) < 0.002);
    assert_eq!(after.joined, before.joined);
    let new = poses(&after.clip);
    let inside = 1..last;
    let stays = change(&new, &old, &(0..22).collect::<Vec<_>>(), |frame| !inside.contains(&frame));
    println!("locked: what is not between the ends changes by {stays:?} m");
    assert!(stays[1] < 1e-3, "{stays:?}");
    // The clip itself, too.
    let own = [&after.clips[0][0], &after.clips[0][last]];
    assert_eq!(own, [&clips[0].motion[0], &clips[0].motion[last]]);
    // What is far away is a mistake.
    edited[0] = edit(&clips[0], (10, 21), Vec3::new(0.0, 0.0, 5.0), false);
    let said = animation(&edited, None, &MODEL.body, &Exact::Soft).unwrap_err().to_string();
    assert!(said.contains("the edit of right_wrist at frame 10 is 5.0 m from where it is"), "{said}");
}
