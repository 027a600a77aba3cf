//! Drawing over the map of a clip, and the other solution.

use crate::paint::{Area, BLUE, Fallible, Figures, GREY, LIGHT, ORANGE, Page, RED, mixed};
use crate::yardstick::{Yardstick, points};
use crate::{drawing, run_with};
use inkrig::align::{Control, CurveOptions, Moments, MotionMap, Norm, Options, candidates, keys_on_map};
use inkrig::motion::{Clip, Takes};
use inkrig::sketch::Curve;
use std::path::Path;

/// The map, a line drawn from pose to pose, and the moments that are used, tied to where the line was: without the map's
/// keys and with them. Below, the poses that the line passes; what is shown there without the keys; and with them.
pub(crate) fn on_map(folder: &Path, person: &Clip) -> Fallible<()> {
    let takes = Takes::from(person.clone());
    let moments = Moments::of(&takes, &Options::default())?;
    let found = candidates(&moments, 8)?;
    let map = MotionMap::of(&moments)?;
    let stops: Vec<usize> = [6, 7, 5, 1, 4, 2].map(|index| found[index].moment.frame).to_vec();
    let corners: Option<Vec<[f64; 2]>> = stops.iter().map(|&frame| map.place_of(frame)).collect();
    let line = tour(&corners.ok_or("a pose is not on the map")?);
    let options = CurveOptions { samples: Some(line.len()), ..CurveOptions::default() };
    let control = Control::from_curve(&Curve::new(line.clone())?, &options)?;
    let at: Vec<usize> = (0..stops.len()).map(|stop| stop * 50 + 15).collect();
    let plain = Options::default();
    let keyed =
        Options { keys: keys_on_map(&map, &found), control_norm: Norm::Learned, ..Options::default() };
    let mut page = Page::new(800, 660)?;
    let mut clips = Vec::new();
    for (column, (what, options)) in
        [("over the map, no keys", plain), ("over the map", keyed)].into_iter().enumerate()
    {
        let result = run_with(what, person, &control, &options)?;
        let area =
            Area::even([column as f32 * 400.0, 0.0], [400.0, 290.0], map.frames.iter().map(|f| f.place));
        for frame in &map.frames {
            page.dot(&area, frame.place, 3.0, LIGHT);
        }
        let mut total = 0.0;
        for (sample, (point, used)) in line.iter().zip(&result.used).enumerate() {
            let place = map.place_of(used.frame).ok_or("a moment is not on the map")?;
            total += (place[0] - point[0]).hypot(place[1] - point[1]);
            if sample % 3 == 0 {
                page.line(&area, &[*point, place], 1.0, mixed(RED, 0.45));
            }
        }
        page.line(&area, &line, 5.0, ORANGE);
        for used in &result.used {
            page.dot(&area, map.place_of(used.frame).ok_or("a moment is not on the map")?, 3.0, BLUE);
        }
        println!("    from the line: {:.2}", total / line.len() as f64);
        clips.push(result.clip);
    }
    let mut poses: Vec<(&Clip, usize)> = stops.iter().map(|&frame| (person, frame)).collect();
    for clip in &clips {
        poses.extend(at.iter().map(|&frame| (clip, frame)));
    }
    let figures = Figures::of(&poses, [84, 116])?;
    let place = |index: usize| [150.0 + (index % 6) as f32 * 84.0, 300.0 + (index / 6) as f32 * 120.0];
    page.figures(&figures, &(0..18).map(|index| (index, place(index))).collect::<Vec<_>>())?;
    for (row, ink) in [(0, ORANGE), (1, GREY), (2, BLUE)] {
        page.fill([136.0, place(6 * row)[1]], [8.0, 116.0], ink);
    }
    page.save(folder, "on-map")
}

/// Thirty frames at every stop, twenty to the next.
fn tour(stops: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut line = Vec::new();
    for (index, &stop) in stops.iter().enumerate() {
        let next = stops[(index + 1).min(stops.len() - 1)];
        line.extend((0..50).map(|step| {
            let part = (f64::from(step) - 30.0).max(0.0) / 20.0;
            [0, 1].map(|axis: usize| stop[axis] * (1.0 - part) + next[axis] * part)
        }));
    }
    line
}

/// The drawing, as red as the motion there is near to the pose on the right; the poses second by second: the first solution
/// and the mirrored one.
pub(crate) fn mirrored(folder: &Path, person: &Clip) -> Fallible<()> {
    let spiral = drawing("spiral")?;
    let first = run_with("first solution", person, &spiral, &Options::default())?;
    let other = run_with("mirrored", person, &spiral, &Options { mirror: true, ..Options::default() })?;
    println!("    symmetry {:.2}", first.report.mirror_symmetry);
    let frame = first.used[225].frame;
    let mut page = Page::new(880, 490)?;
    let seconds = |clip| (0..10).map(move |second| (clip, second * 30));
    let mut poses: Vec<(&Clip, usize)> = [&first.clip, &other.clip].into_iter().flat_map(seconds).collect();
    poses.push((person, frame));
    let figures = Figures::of(&poses, [88, 132])?;
    let place = |index: usize| [(index % 10) as f32 * 88.0, 216.0 + (index / 10) as f32 * 138.0];
    let mut places: Vec<(usize, [f32; 2])> = (0..20).map(|index| (index, place(index))).collect();
    places.push((20, [396.0, 40.0]));
    page.figures(&figures, &places)?;
    let yardstick = Yardstick::of(person);
    let line = points(&spiral);
    for (result, left, ink, row) in [(&first, 80.0, GREY, 0), (&other, 500.0, BLUE, 10)] {
        let area = Area::even([left, 0.0], [300.0, 210.0], line.iter().copied());
        page.heat_line(&area, &line, &yardstick.distances(&result.clip, frame), 7.0);
        page.fill([left, 4.0], [8.0, 202.0], ink);
        page.fill(place(row), [6.0, 132.0], ink);
    }
    page.save(folder, "mirror")
}
