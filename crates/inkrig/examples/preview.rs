//! Writes a preview page and contact sheets of a small walking figure, to look at while working on them:
//! `cargo run -p inkrig --example preview -- DIR`.

#[path = "../tests/support/walker.rs"]
#[allow(dead_code, missing_docs, clippy::unwrap_used)]
mod walker;

use inkrig::{
    preview::{ControlView, Figure, HeatMap, Preview, render},
    sheet::{SheetOptions, contact_sheet},
};
use inkrig_motion::{Clip, MotionError, VelocityFrame, channels::PoseChannels};
use std::{error::Error, fs, path::Path};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("give the folder to write to")?;
    let folder = Path::new(&folder);
    fs::create_dir_all(folder)?;
    let source = walker::walk(240);
    let frames = 300;
    let places: Vec<f64> = (0..frames).map(source_place).collect();
    let result = rearranged(&source, &places)?;
    let curve = curve(frames);
    let seconds: Vec<f32> = places.iter().map(|place| (place / 30.0) as f32).collect();
    let confidence: Vec<f32> = (0..frames).map(|frame| 0.72 + 0.25 * (frame as f32 * 0.07).sin()).collect();
    let figures = [
        ("Curve fit", "0.031", "Mean distance of the curve's shape to that of the motion used, 0 is exact."),
        ("Source used", "78 %", "Part of the clip that shows up in the result at all."),
        ("Foot sliding", "1.2 cm/s", "Mean speed of feet that should stand still, over all contacts."),
    ];
    let figures = figures.map(|(name, value, note)| Figure {
        name: name.into(),
        value: value.into(),
        note: note.into(),
    });
    let page = render(&Preview {
        title: "walker · spiral.svg",
        result: &result,
        source: &source,
        control: ControlView::Curve(&curve),
        control_rate: 30.0,
        heat_map: plan(&places, 240),
        best_source: &seconds,
        confidence: &confidence,
        guide: None,
        board: &[],
        figures: &figures,
        notes: &["The first 12 frames of the clip are a rest pose and were left out.".to_owned()],
    });
    fs::write(folder.join("preview.html"), page)?;
    let options = SheetOptions { markers: Some(&curve), ..SheetOptions::default() };
    fs::write(folder.join("sheet.png"), contact_sheet(&result, &options)?)?;
    let dark = SheetOptions { dark: true, ..SheetOptions::default() };
    fs::write(folder.join("sheet-dark.png"), contact_sheet(&result, &dark)?)?;
    Ok(())
}

/// The clip's poses at other places in time, its steps over the ground added up anew.
fn rearranged(source: &Clip, places: &[f64]) -> Result<Clip, MotionError> {
    let (layout, rows) = PoseChannels::of(&source.clone().into(), VelocityFrame::Heading);
    let picked = places.iter().flat_map(|&place| rows.row(place.round() as usize).iter().copied());
    layout.to_clip(&picked.collect::<Vec<f32>>(), source.frame_rate())
}

/// Parts of the clip in another order, the last of them slowly backwards.
fn source_place(frame: usize) -> f64 {
    match frame {
        0..110 => 60.0 + frame as f64,
        110..200 => 5.0 + 0.8 * (frame - 110) as f64,
        _ => 235.0 - 0.7 * (frame - 200) as f64,
    }
}

fn curve(frames: usize) -> Vec<[f64; 2]> {
    let turn = |frame: usize| frame as f64 / frames as f64 * 11.0;
    (0..frames)
        .map(|frame| {
            let (angle, radius) = (turn(frame), 1.0 - 0.72 * frame as f64 / frames as f64);
            [1.5 * radius * angle.cos() + 0.1 * (3.0 * angle).sin(), radius * angle.sin()]
        })
        .collect()
}

fn plan(places: &[f64], width: usize) -> HeatMap {
    let mut values = Vec::with_capacity(places.len() * width);
    for (row, place) in places.iter().enumerate() {
        let spread = 3.0 + 2.0 * (row as f64 * 0.05).sin();
        values.extend((0..width).map(|column| {
            let near = ((column as f64 - place) / spread).powi(2);
            let echo = ((column as f64 - place - 60.0) / (2.0 * spread)).powi(2);
            ((-near).exp() + 0.08 * (-echo).exp()) as f32
        }));
    }
    HeatMap { width, height: places.len(), values }
}
