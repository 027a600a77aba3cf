//! Draws the picture of docs/ground-paths.png: the samples on their own way (grey) and along a given path (light),
//! seen from above, with the feet that stand (dots): `cargo run --release -p inkrig --example ground_paths -- FILE.png`.

#![allow(clippy::print_stdout, reason = "an example prints its figures")]

use inkrig::formats::{ImportOptions, read_bvh};
use inkrig::motion::glam::{DVec2, Vec2};
use inkrig::motion::ground::{
    Contacts, GroundPath, PathOptions, Route, Trajectory, TravelOptions, follow_path,
};
use inkrig::motion::{Clip, kinematics};
use std::error::Error;
use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Stroke, Transform};

const CELL: f32 = 380.0;
const MARGIN: f32 = 30.0;

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("give the file to write, a .png")?;
    let heart = inkrig::sketch::read_curve(
        inkrig::samples::find("heart").ok_or("no heart")?.bytes,
        inkrig::sketch::Format::Json,
    )?;
    let heart: Vec<DVec2> = heart.points().iter().map(|[x, y]| DVec2::new(*x, -*y)).collect();
    let steps = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.5], [4.0, 1.5], [4.0, 0.0], [6.0, 0.0]].map(DVec2::from);
    let routes = [
        ("person", Route::Straight),
        ("person", Route::Path(GroundPath::new(&heart, true)?)),
        ("quadruped", Route::Path(GroundPath::new(&steps, false)?)),
        ("snake", Route::Arc(4.0)),
    ];
    let mut picture = Pixmap::new(CELL as u32 * routes.len() as u32, CELL as u32).ok_or("no memory")?;
    picture.fill(Color::WHITE);
    for (index, (name, route)) in routes.iter().enumerate() {
        let clip =
            read_bvh(inkrig::samples::find(name).ok_or("no such sample")?.bytes, &ImportOptions::default())?
                .clip;
        let result = follow_path(&clip, route, &PathOptions::default())?;
        println!(
            "{name}: {:.2} m, {:.3} m away from the path in the mean, {:.3} m at most",
            result.travelled_metres, result.mean_distance, result.max_distance
        );
        draw(&mut picture, index as f32 * CELL, &clip, route, &result.clip, result.metres_per_unit);
    }
    std::fs::write(&file, picture.encode_png()?)?;
    Ok(())
}

fn draw(picture: &mut Pixmap, left: f32, before: &Clip, route: &Route, after: &Clip, scale: f64) {
    let options = TravelOptions::default();
    let (own, new) = (Trajectory::of(before, &options), Trajectory::of(after, &options));
    let given: Vec<DVec2> = match route {
        Route::Path(path) => {
            let points = path.points();
            points.iter().map(|point| (*point - points[0]) * scale + own.path[0]).collect()
        }
        _ => new.path.clone(),
    };
    let all: Vec<DVec2> = [&own.places, &new.places, &given].into_iter().flatten().copied().collect();
    let low = all.iter().copied().fold(DVec2::MAX, DVec2::min);
    let high = all.iter().copied().fold(DVec2::MIN, DVec2::max);
    let zoom = f64::from(CELL - 2.0 * MARGIN) / (high - low).max_element();
    let middle = 0.5 * (low + high);
    let on_page =
        |point: DVec2| ((point - middle) * zoom).as_vec2() + Vec2::new(left + 0.5 * CELL, 0.5 * CELL);
    let mut line = |points: &[DVec2], width: f32, [r, g, b]: [u8; 3]| {
        let mut builder = PathBuilder::new();
        for (index, point) in points.iter().enumerate() {
            let place = on_page(*point);
            if index == 0 { builder.move_to(place.x, place.y) } else { builder.line_to(place.x, place.y) }
        }
        let mut paint = Paint::default();
        paint.set_color_rgba8(r, g, b, 255);
        let stroke =
            Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
        if let Some(path) = builder.finish() {
            picture.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
        }
    };
    line(&given, 14.0, [250, 214, 165]);
    line(&own.places, 2.0, [170, 170, 170]);
    line(&new.places, 2.5, [30, 80, 160]);
    for (clip, colour, radius) in [(before, [170, 170, 170], 2.5), (after, [200, 60, 40], 3.0)] {
        let positions = kinematics::positions(clip);
        for (joint, first, last) in Contacts::of(before).spans {
            let foot = positions.frame((first + last) / 2)[joint];
            let place = on_page(DVec2::new(f64::from(foot.x), f64::from(foot.z)));
            let mut paint = Paint::default();
            paint.set_color_rgba8(colour[0], colour[1], colour[2], 255);
            if let Some(dot) = PathBuilder::from_circle(place.x, place.y, radius) {
                picture.fill_path(&dot, &paint, FillRule::Winding, Transform::identity(), None);
            }
        }
    }
}
