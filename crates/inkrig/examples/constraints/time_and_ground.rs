//! Loops, parts that stay, and what carries the travel.

use crate::paint::{Area, BLUE, Fallible, Figures, GREY, LIGHT, ORANGE, Page};
use crate::{drawing, run, sample};
use inkrig::align::{Control, Key};
use inkrig::motion::glam::Vec3;
use inkrig::motion::ground::{TravelOptions, add_root_bone, in_place, root_bone};
use inkrig::motion::{Clip, kinematics};
use std::path::Path;
use std::sync::Arc;

/// The last and the first poses, every third frame, and the size of every step there: not as a loop, and as one.
pub(crate) fn loops(folder: &Path, person: &Clip) -> Fallible<()> {
    let mut control = Control::from_wave(&"sine(0.5Hz) for 8s".parse()?, None, 30.0)?;
    let open = run("not as a loop", person, &control, vec![])?.clip;
    control.cyclic = true;
    let closed = run("as a loop", person, &control, vec![])?;
    println!("    seam {:?}", closed.report.loop_seam_ratio);
    let closed = closed.clip;
    let frames = [230, 233, 236, 239, 0, 3, 6, 9];
    let mut page = Page::new(880, 430)?;
    let poses: Vec<(&Clip, usize)> =
        [&open, &closed].into_iter().flat_map(|clip| frames.map(|frame| (clip, frame))).collect();
    let figures = Figures::of(&poses, [110, 140])?;
    let place = |index: usize| [(index % 8) as f32 * 110.0, (index / 8) as f32 * 144.0];
    page.figures(&figures, &(0..16).map(|index| (index, place(index))).collect::<Vec<_>>())?;
    for (row, ink) in [(0.0, GREY), (144.0, BLUE)] {
        page.frame([330.0, row], [220.0, 140.0], ink);
    }
    let steps = [&open, &closed].map(steps);
    let most = steps.iter().flatten().copied().fold(0.0, f64::max);
    // The seam lies between the fourth and the fifth pose.
    let area = Area {
        corner: [0.0, 292.0],
        size: [880.0, 134.0],
        low: [-40.0, -0.05 * most],
        high: [40.0, 1.05 * most],
    };
    page.line(&area, &[[-40.0, 0.0], [40.0, 0.0]], 1.5, LIGHT);
    page.line(&area, &[[0.0, 0.0], [0.0, most]], 1.5, LIGHT);
    for (steps, ink) in steps.iter().zip([GREY, BLUE]) {
        let last = steps.len() as isize;
        let points: Vec<[f64; 2]> = (-40..=40)
            .map(|at: isize| [at as f64, steps[(at + last - 1).rem_euclid(last) as usize]])
            .collect();
        page.line(&area, &points, 2.5, ink);
    }
    page.save(folder, "loop")
}

/// Mean speed of the joints from every frame to the next, the last to the first among them; turning and travel aside.
fn steps(clip: &Clip) -> Vec<f64> {
    let joint = clip.travel_joint();
    let positions = kinematics::positions(clip).relative_to(joint);
    let facing = |frame: usize| {
        let ahead = clip.rotations(frame)[joint] * Vec3::Z;
        inkrig::motion::glam::Quat::from_rotation_y(-ahead.x.atan2(ahead.z))
    };
    let step = |a: usize, b: usize| {
        let pairs = positions.frame(a).iter().zip(positions.frame(b));
        pairs.map(|(from, to)| f64::from((facing(a) * *from).distance(facing(b) * *to))).sum::<f64>()
    };
    (0..clip.frames()).map(|frame| step(frame, (frame + 1) % clip.frames())).collect()
}

/// The first result; the second drawing alone; the second drawing with a part of the first result.
pub(crate) fn fixed(folder: &Path, person: &Clip) -> Fallible<()> {
    let earlier = run("spiral", person, &drawing("spiral")?, vec![])?.clip;
    let eight = drawing("eight")?;
    let free = run("eight", person, &eight, vec![])?.clip;
    let key = Key::Fixed { earlier: Arc::new(earlier.clone()), frames: 90..180 };
    let kept = run("eight with a part of the spiral", person, &eight, vec![key])?.clip;
    let frames = |clip| (0..10).map(move |second| (clip, second * 30));
    let poses: Vec<(&Clip, usize)> = [&earlier, &free, &kept].into_iter().flat_map(frames).collect();
    let figures = Figures::of(&poses, [88, 132])?;
    let mut page = Page::new(880, 420)?;
    let place = |index: usize| [(index % 10) as f32 * 88.0, (index / 10) as f32 * 142.0];
    page.figures(&figures, &(0..30).map(|index| (index, place(index))).collect::<Vec<_>>())?;
    for row in [0.0, 284.0] {
        page.frame([264.0, row], [264.0, 132.0], ORANGE);
    }
    page.save(folder, "fixed-part")
}

/// The body seen from above, now and then, with the way of the hips (blue) and of the root bone (orange): as it is, in
/// place, with a root bone.
pub(crate) fn roots(folder: &Path) -> Fallible<()> {
    let result = run("root modes", &sample("quadruped")?, &drawing("eight")?, vec![])?.clip;
    let still = in_place(&result, &TravelOptions::default())?;
    let bone = add_root_bone(&result, &TravelOptions::default())?.clip;
    let mut page = Page::new(900, 300)?;
    let from_above = |place: Vec3| [f64::from(place.x), f64::from(-place.z)];
    let everywhere = kinematics::positions(&result);
    let all = (0..result.frames()).flat_map(|at| everywhere.frame(at)).map(|place| from_above(*place));
    let all: Vec<[f64; 2]> = all.collect();
    for (index, clip) in [&result, &still, &bone].into_iter().enumerate() {
        let mut area = Area::even([index as f32 * 300.0, 0.0], [300.0, 300.0], all.iter().copied());
        let positions = kinematics::positions(clip);
        if index == 1 {
            area.centre(from_above(positions.frame(0)[clip.travel_joint()]));
        }
        let way = |joint: usize| -> Vec<[f64; 2]> {
            (0..clip.frames()).map(|at| from_above(positions.frame(at)[joint])).collect()
        };
        if index > 0 {
            page.line(&area, &[area.low, [area.low[0], area.high[1]]], 1.0, LIGHT);
        }
        let bone = root_bone(clip);
        if let Some(bone) = bone {
            page.line(&area, &way(bone), 8.0, ORANGE);
        }
        for at in (0..clip.frames()).step_by(43) {
            let places = positions.frame(at);
            for (place, joint) in places.iter().zip(clip.skeleton().joints()) {
                if let Some(parent) = joint.parent.filter(|parent| Some(*parent) != bone) {
                    page.line(&area, &[from_above(places[parent]), from_above(*place)], 1.5, GREY);
                }
            }
        }
        let joints = clip.skeleton().joints();
        let hips = bone.and_then(|bone| joints.iter().position(|joint| joint.parent == Some(bone)));
        page.line(&area, &way(hips.unwrap_or(clip.travel_joint())), 2.5, BLUE);
    }
    page.save(folder, "root-modes")
}
