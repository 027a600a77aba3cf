//! Poses that shall, must, should not and must not appear.

use crate::paint::{Area, BLACK, BLUE, Fallible, Figures, GREY, LIGHT, ORANGE, Page, RED, mixed};
use crate::yardstick::{Yardstick, points};
use crate::{drawing, run};
use inkrig::align::{Control, ControlKind, Key, Place, Pose};
use inkrig::motion::{Clip, time};
use std::path::Path;
use std::sync::Arc;

/// A place of a drawing that is keyed: the clip, the control, the place and where it is drawn, the pose.
type Row<'a> = (&'a Clip, &'a Control, Place, [f64; 2], Pose, usize);

/// A point of the canvas; a time; a point, with a pose of another clip.
pub(crate) fn soft(folder: &Path, person: &Clip) -> Fallible<()> {
    let spiral = drawing("spiral")?;
    // Only the first fourteen seconds are arranged; the pose comes from what the person does later.
    let first = time::trim(person, 0..420)?;
    let of = |frame| Pose::Of { name: "person.bvh".to_string(), clip: Arc::new(person.clone()), frame };
    let late = foreign(person, 420);
    println!("the pose of another clip: frame {late}");
    let rows: [Row<'_>; 3] = [
        (person, &spiral, Place::Value(vec![0.0, -0.6]), [0.0, -0.6], 317.into(), 317),
        (person, &spiral, Place::Time(5.0), [f64::NAN; 2], 600.into(), 600),
        (&first, &spiral, Place::Value(vec![0.7, 0.0]), [0.7, 0.0], of(late), late),
    ];
    rows_with_and_without(person, &rows)?.save(folder, "soft-keys")
}

/// The same for a value of a wave and for a label.
pub(crate) fn soft_in_time(folder: &Path, person: &Clip) -> Fallible<()> {
    let wave = Control::from_wave(&"sine(0.5Hz) for 8s".parse()?, None, 30.0)?;
    let labels = Control::from_labels(&"A:75 B:75 A:75 C:75".parse()?, None, 30.0)?;
    let rows: [Row<'_>; 2] = [
        (person, &wave, Place::Value(vec![1.0]), [f64::NAN, 1.0], 600.into(), 600),
        (person, &labels, Place::Label("B".to_string()), [f64::NAN; 2], 600.into(), 600),
    ];
    rows_with_and_without(person, &rows)?.save(folder, "soft-keys-in-time")
}

/// The frame from `begin` on that has something like it before `begin`, but is not like most of it.
fn foreign(clip: &Clip, begin: usize) -> usize {
    let yardstick = Yardstick::of(clip);
    let gain = |&frame: &usize| {
        let near = yardstick.distances(clip, frame);
        let least = near.iter().take(begin - 10).copied().fold(f64::MAX, f64::min);
        near.iter().take(begin - 10).sum::<f64>() / begin as f64 - 3.0 * least
    };
    (begin + 10..clip.frames() - 10).max_by(|a, b| gain(a).total_cmp(&gain(b))).unwrap_or(begin)
}

/// For each row the pose; then the control without the key and with it, each point as red as the motion there is near to
/// the pose.
fn rows_with_and_without(person: &Clip, rows: &[Row<'_>]) -> Fallible<Page> {
    let (height, left, width) = (190.0, 130.0, 320.0);
    let mut page = Page::new(770, 190 * rows.len() as u32)?;
    let yardstick = Yardstick::of(person);
    let poses: Vec<(&Clip, usize)> = rows.iter().map(|row| (person, row.5)).collect();
    let figures = Figures::of(&poses, [126, 186])?;
    for (index, (clip, control, place, mark, pose, frame)) in rows.iter().enumerate() {
        let top = index as f32 * height;
        page.figures(&figures, &[(index, [2.0, top + 2.0])])?;
        let line = points(control);
        let mark = match place {
            Place::Time(seconds) => line[(seconds * 30.0) as usize],
            _ => *mark,
        };
        for (column, weight) in [0.0, 1.0].into_iter().enumerate() {
            let key = Key::Soft { place: place.clone(), pose: pose.clone(), weight };
            let result = run(&format!("soft key at {place:?}, weight {weight}"), clip, control, vec![key])?;
            let near = yardstick.distances(&result.clip, *frame);
            let corner = [left + column as f32 * width, top];
            let mut area = Area::even(corner, [width, height], line.iter().copied());
            if control.kind == ControlKind::Curve {
                page.heat_line(&area, &line, &near, 6.0);
                page.ring(&area, mark, 9.0, BLACK);
                continue;
            }
            // Time to the right, whatever its scale.
            let last = line.len() as f64 / 30.0;
            let (low, high) = line.iter().fold((f64::MAX, f64::MIN), |(a, b), p| (a.min(p[1]), b.max(p[1])));
            let rest = 0.35 * (high - low);
            (area.low, area.high) = ([-0.05 * last, low - rest], [1.05 * last, high + rest]);
            if !mark[1].is_nan() {
                page.line(&area, &[[0.0, mark[1]], [last, mark[1]]], 1.5, GREY);
            }
            let wide = if control.kind == ControlKind::Labels { 16.0 } else { 6.0 };
            page.heat_line(&area, &line, &near, wide);
        }
    }
    Ok(page)
}

/// The poses that are asked for; a second by second without them; and with them.
pub(crate) fn hard(folder: &Path, person: &Clip) -> Fallible<()> {
    let spiral = drawing("spiral")?;
    let asked = [(3, 455), (7, 120)];
    let keys = asked.map(|(second, frame)| Key::Hard { seconds: f64::from(second), frame }).to_vec();
    let without = run("without hard keys", person, &spiral, vec![])?.clip;
    let with = run("with hard keys", person, &spiral, keys)?.clip;
    let seconds = |clip| (0..10).map(move |second| (clip, second * 30));
    let poses: Vec<(&Clip, usize)> = asked
        .iter()
        .map(|&(_, frame)| (person, frame))
        .chain(seconds(&without))
        .chain(seconds(&with))
        .collect();
    let cell = [88, 132];
    let figures = Figures::of(&poses, cell)?;
    let place = |column: usize, row: usize| [column as f32 * 88.0, row as f32 * 138.0];
    let mut page = Page::new(880, 408)?;
    let mut places: Vec<(usize, [f32; 2])> =
        asked.iter().enumerate().map(|(index, &(second, _))| (index, place(second as usize, 0))).collect();
    places.extend((0..20).map(|index| (index + 2, place(index % 10, 1 + index / 10))));
    page.figures(&figures, &places)?;
    for (second, _) in asked {
        for row in [0, 2] {
            page.frame(place(second as usize, row), [88.0, 132.0], ORANGE);
        }
    }
    page.save(folder, "hard-keys")
}

/// The pose; how far every moment of three results is from it; and the three moments that are nearest.
pub(crate) fn keep_away(folder: &Path, person: &Clip) -> Fallible<()> {
    let spiral = drawing("spiral")?;
    let without = run("nothing kept away from", person, &spiral, vec![])?;
    let frame = without.used[150].frame;
    println!("the pose: frame {frame}");
    let pose = || Pose::Frame(frame);
    let avoid =
        run("--avoid", person, &spiral, vec![Key::Avoid { pose: pose(), distance: 1.0, weight: 1.0 }])?;
    let never = run("--never", person, &spiral, vec![Key::Never { pose: pose(), radius: 0.6 }])?;
    let yardstick = Yardstick::of(person);
    let results = [(&without.clip, GREY), (&never.clip, RED), (&avoid.clip, BLUE)];
    let lines = results.map(|(clip, _)| yardstick.distances(clip, frame));
    let nearest = lines
        .each_ref()
        .map(|line| line.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(at, _)| at));
    let mut poses = vec![(person, frame)];
    poses.extend(results.iter().zip(nearest).map(|(&(clip, _), at)| (clip, at)));
    let figures = Figures::of(&poses, [130, 190])?;
    let mut page = Page::new(800, 420)?;
    let area = Area { corner: [10.0, 200.0], size: [780.0, 210.0], low: [-2.0, -0.06], high: [302.0, 1.9] };
    for (radius, ink) in [(1.0, BLUE), (0.6, RED)] {
        let ground = mixed(ink, 0.12);
        let (top, below) = (area.pixel([0.0, radius]), area.pixel([300.0, 0.0]));
        page.fill(top, [below[0] - top[0], below[1] - top[1]], ground);
    }
    page.line(&area, &[[0.0, 0.0], [300.0, 0.0]], 1.5, LIGHT);
    for ((line, (_, ink)), at) in lines.iter().zip(results).zip(nearest) {
        let points: Vec<[f64; 2]> = line.iter().enumerate().map(|(at, &value)| [at as f64, value]).collect();
        page.line(&area, &points, 2.5, ink);
        page.dot(&area, [at as f64, line[at]], 6.0, ink);
        println!("    nearest {:.2} at {:.2} s", line[at], at as f64 / 30.0);
    }
    let corners = [10.0, 300.0, 460.0, 620.0].map(|x| [x, 2.0]);
    page.figures(&figures, &corners.into_iter().enumerate().collect::<Vec<_>>())?;
    for (corner, ink) in corners.into_iter().zip([ORANGE, GREY, RED, BLUE]) {
        page.frame(corner, [130.0, 190.0], ink);
    }
    page.save(folder, "keep-away")
}
