//! The preview page and the contact sheet, from outside.
#![allow(clippy::unwrap_used, reason = "what a test builds is known to be right")]

#[path = "support/walker.rs"]
mod walker;

use inkrig::{
    preview::{ControlView, Figure, Guide, HeatMap, Part, Preview, Spot, render},
    sheet::{MOST_PIXELS, SheetError, SheetOptions, contact_sheet},
};
use inkrig_motion::{
    Clip, Joint, Skeleton, TranslationTrack,
    glam::{Quat, Vec3},
};
use std::sync::Arc;

const HOSTILE: &str = "</script><script>alert(1)</script><!-- {{script}} & \u{2028}";

struct Parts {
    clip: Clip,
    curve: Vec<[f64; 2]>,
    best: Vec<f32>,
    confidence: Vec<f32>,
    heat: HeatMap,
}

impl Parts {
    fn of(clip: Clip) -> Self {
        let frames = clip.frames();
        let curve = (0..frames).map(|i| [(i as f64 * 0.1).cos(), (i as f64 * 0.13).sin()]).collect();
        let best = (0..frames).map(|i| i as f32 / 30.0).collect();
        let heat = HeatMap { width: 8, height: 4, values: (0..32).map(|i| i as f32 / 32.0).collect() };
        Self { clip, curve, best, confidence: vec![0.5; frames], heat }
    }

    fn preview<'a>(&'a self, title: &'a str, figures: &'a [Figure], notes: &'a [String]) -> Preview<'a> {
        Preview {
            title,
            result: &self.clip,
            source: &self.clip,
            control: ControlView::Curve(&self.curve),
            control_rate: 30.0,
            heat_map: self.heat.clone(),
            best_source: &self.best,
            confidence: &self.confidence,
            guide: None,
            board: &[],
            figures,
            notes,
        }
    }

    fn page(&self) -> String {
        render(&self.preview("walk", &[], &[]))
    }
}

/// The data block, un-escaped by the JSON reader.
fn data(page: &str) -> serde_json::Value {
    let (_, rest) = page.split_once("id=\"data\">").unwrap();
    let (json, _) = rest.split_once("</script>").unwrap();
    serde_json::from_str(json).unwrap()
}

fn one_joint(places: Vec<Vec3>) -> Clip {
    let skeleton = Arc::new(Skeleton::new(vec![Joint::new("dot", None, Vec3::ZERO)]).unwrap());
    let rotations = vec![Quat::IDENTITY; places.len()];
    Clip::new(skeleton, 30.0, rotations, vec![TranslationTrack { joint: 0, values: places }]).unwrap()
}

/// Numbers of a base64 text, four bytes each.
fn floats(text: &str) -> Vec<f32> {
    const ALPHABET: &str = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digits = text.trim_end_matches('=').chars().map(|c| ALPHABET.find(c).unwrap() as u32);
    let (mut bytes, mut bits, mut held) = (Vec::new(), 0_u32, 0);
    for digit in digits {
        (bits, held) = (bits << 6 | digit, held + 6);
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
        }
    }
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}

#[test]
fn text_from_outside_stays_text() {
    let parts = Parts::of(walker::walk_named(5, |name| format!("{HOSTILE}{name}")));
    let figure = Figure { name: HOSTILE.into(), value: HOSTILE.into(), note: HOSTILE.into() };
    let page = render(&parts.preview(HOSTILE, &[figure], &[HOSTILE.to_owned()]));
    assert!(!page.contains("alert(1)</script>") && !page.contains("<script>alert"), "markup got through");
    let plain = Parts::of(walker::walk(5)).page();
    for tag in ["<script", "</script", "<!--"] {
        assert_eq!(page.matches(tag).count(), plain.matches(tag).count(), "{tag}");
    }
    let data = data(&page);
    assert_eq!(data["title"], HOSTILE);
    assert_eq!(data["notes"][0], HOSTILE);
    assert_eq!(data["figures"][0][2], HOSTILE);
    assert_eq!(data["result"]["names"][0], format!("{HOSTILE}Hips"));
}

#[test]
fn nothing_is_loaded_from_elsewhere() {
    let page = Parts::of(walker::walk(5)).page();
    for address in ["http://", "https://", "src=", "@import", "url(", "fetch(", "import("] {
        assert!(!page.contains(address), "{address}");
    }
    assert!(page.contains("default-src 'none'") && page.contains("script-src 'sha256-"));
    assert!(!page.contains("unsafe-inline") && !page.contains("{{"));
    assert!(!page.contains("innerHTML") && !page.contains(" style=\""), "the policy forbids it");
}

#[test]
fn a_page_is_small_and_the_same_again() {
    let mut parts = Parts::of(walker::walk(600));
    parts.heat = HeatMap { width: 600, height: 600, values: vec![0.5; 360_000] };
    let page = parts.page();
    assert!(page.len() < 500_000, "{} bytes", page.len());
    assert_eq!(page, parts.page());
}

#[test]
fn places_are_sent_to_a_fraction_of_a_millimetre() {
    let parts = Parts::of(walker::walk(40));
    let data = data(&parts.page());
    let track = &data["result"]["track"];
    assert_eq!((track["frames"].as_u64(), track["joints"].as_u64()), (Some(40), Some(24)));
    assert!(track["scale"].as_f64().unwrap() < 1e-4);
    let origins = floats(track["origins"].as_str().unwrap());
    let hips = parts.clip.track(0).unwrap();
    assert!((origins[3 * 39 + 2] - (hips[39].z - hips[0].z)).abs() < 1e-5);
    assert!((0.8..1.1).contains(&origins[1]), "height above the ground: {}", origins[1]);
}

#[test]
fn many_joints_and_frames_are_thinned_and_said() {
    let mut joints = vec![Joint::new("root", None, Vec3::ZERO)];
    joints.extend((1..3000_usize).map(|i| Joint::new(format!("j{i}"), Some(i - 1), Vec3::Y * 0.01)));
    let skeleton = Arc::new(Skeleton::new(joints).unwrap());
    let frames = 1500;
    let clip = Clip::new(skeleton, 240.0, vec![Quat::IDENTITY; 3000 * frames], vec![]).unwrap();
    let mut parts = Parts::of(clip);
    parts.heat = HeatMap { width: 3000, height: 2000, values: vec![0.1; 6_000_000] };
    let page = parts.page();
    let data = data(&page);
    assert_eq!(data["result"]["names"].as_array().unwrap().len(), 512);
    assert_eq!(data["result"]["track"]["rate"], 60.0);
    assert_eq!(data["heatMap"]["width"], 240);
    assert!(data["notes"][0].as_str().unwrap().contains("3000 joints"));
    assert!(page.len() < 8_000_000, "{} bytes", page.len());
}

#[test]
fn odd_input_gives_finite_numbers() {
    let huge = vec![Vec3::splat(3e38), Vec3::splat(-3e38), Vec3::ZERO];
    for clip in [one_joint(vec![Vec3::ZERO]), one_joint(huge), walker::walk(1)] {
        let mut parts = Parts::of(clip);
        parts.curve = vec![[f64::NAN, 1.0], [f64::INFINITY, f64::MAX], [f64::MIN, 0.0]];
        parts.best = vec![f32::NAN, f32::INFINITY, -1.0];
        parts.confidence = vec![f32::NAN, 7.0, -7.0];
        parts.heat.values[3] = f32::NAN;
        parts.heat.values[4] = f32::INFINITY;
        let preview = Preview { control_rate: f64::NAN, ..parts.preview("odd", &[], &[]) };
        let page = render(&preview);
        let data = data(&page);
        let text = data.to_string();
        let absent = [&data["result"]["pair"], &data["source"]["pair"], &data["guide"]];
        let absent = absent.iter().filter(|value| value.is_null()).count();
        assert_eq!(text.matches("null").count(), absent, "{text}");
        assert!(!text.contains("NaN") && !text.contains("inf"));
        let origins = floats(data["result"]["track"]["origins"].as_str().unwrap());
        assert!(!origins.is_empty() && origins.iter().all(|value| value.is_finite()));
        assert_eq!(data["confidence"], serde_json::json!([0.0, 1.0, 0.0]));
    }
}

#[test]
fn nothing_at_all_to_show_still_gives_a_page() {
    let mut parts = Parts::of(one_joint(vec![Vec3::ZERO]));
    (parts.curve, parts.best, parts.confidence, parts.heat) = (vec![], vec![], vec![], HeatMap::default());
    let data = data(&parts.page());
    assert_eq!(data["seconds"], 0.0);
    assert_eq!(data["control"]["points"].as_array().unwrap().len(), 0);
}

fn decode(png: &[u8]) -> tiny_skia::Pixmap {
    tiny_skia::Pixmap::decode_png(png).unwrap()
}

/// How many pixels of a cell are clearly blue (left limbs) and clearly red (right limbs).
fn sides(picture: &tiny_skia::Pixmap, corner: [u32; 2], cell: [u32; 2]) -> [usize; 2] {
    let (mut blue, mut red) = (0, 0);
    for y in corner[1]..corner[1] + cell[1] {
        for x in corner[0]..corner[0] + cell[0] {
            let pixel = picture.pixel(x, y).unwrap();
            let (r, b) = (i32::from(pixel.red()), i32::from(pixel.blue()));
            blue += usize::from(b - r > 60);
            red += usize::from(r - b > 60);
        }
    }
    [blue, red]
}

#[test]
fn a_sheet_has_a_pose_in_every_cell() {
    let clip = walker::walk(120);
    let options = SheetOptions { poses: 8, columns: 4, cell: [100, 120], ..SheetOptions::default() };
    let png = contact_sheet(&clip, &options).unwrap();
    assert_eq!(png, contact_sheet(&clip, &options).unwrap(), "the same input gives the same bytes");
    let picture = decode(&png);
    assert_eq!((picture.width(), picture.height()), (400, 240));
    for index in 0..8 {
        let corner = [index % 4 * 100, index / 4 * 120];
        let [blue, red] = sides(&picture, corner, [100, 120]);
        assert!(blue > 30 && red > 30, "cell {index}: {blue} blue and {red} red pixels");
    }
}

#[test]
fn a_sheet_follows_a_character_that_runs_away() {
    let mut places = walker::walk(60).track(0).unwrap().to_vec();
    for (frame, place) in places.iter_mut().enumerate() {
        place.x += 1000.0 * frame as f32;
    }
    let walk = walker::walk(60);
    let rotations = (0..60).flat_map(|frame| walk.rotations(frame).to_vec()).collect();
    let tracks = vec![TranslationTrack { joint: 0, values: places }];
    let far = Clip::new(walk.skeleton().clone(), 30.0, rotations, tracks).unwrap();
    let options = SheetOptions { poses: 2, columns: 2, cell: [100, 120], ..SheetOptions::default() };
    let picture = decode(&contact_sheet(&far, &options).unwrap());
    let [blue, red] = sides(&picture, [100, 0], [100, 120]);
    assert!(blue > 30 && red > 30, "{blue} blue and {red} red pixels");
}

#[test]
fn a_short_clip_shows_each_frame_once() {
    let picture = decode(&contact_sheet(&walker::walk(1), &SheetOptions::default()).unwrap());
    assert_eq!((picture.width(), picture.height()), (240, 280));
    let dot =
        decode(&contact_sheet(&one_joint(vec![Vec3::splat(3e38); 3]), &SheetOptions::default()).unwrap());
    assert_eq!((dot.width(), dot.height()), (720, 280));
}

#[test]
fn markers_are_drawn() {
    let clip = walker::walk(10);
    let curve = [[0.0, 0.0], [f64::NAN, 0.0], [1.0, 2.0]];
    let options = SheetOptions { poses: 2, ..SheetOptions::default() };
    let with = contact_sheet(&clip, &SheetOptions { markers: Some(&curve), ..options }).unwrap();
    assert_ne!(with, contact_sheet(&clip, &options).unwrap());
}

#[test]
fn sheets_have_limits() {
    let clip = walker::walk(100);
    let options = SheetOptions { poses: 100, columns: 10, cell: [4096, 4096], ..SheetOptions::default() };
    let error = contact_sheet(&clip, &options).unwrap_err();
    assert_eq!(error, SheetError::TooLarge { width: 40_960, height: 40_960, limit: MOST_PIXELS });
    for wrong in [
        SheetOptions { poses: 0, ..SheetOptions::default() },
        SheetOptions { columns: 0, ..SheetOptions::default() },
        SheetOptions { cell: [0, 100], ..SheetOptions::default() },
        SheetOptions { cell: [100, u32::MAX], ..SheetOptions::default() },
        SheetOptions { yaw: f32::NAN, ..SheetOptions::default() },
        SheetOptions { pitch: 3.0, ..SheetOptions::default() },
    ] {
        assert!(matches!(contact_sheet(&clip, &wrong), Err(SheetError::Option { .. })), "{wrong:?}");
    }
}

#[test]
fn a_guide_is_sent_and_its_text_stays_text() {
    let parts = Parts::of(walker::walk(60));
    let spot = |frame: usize| Spot {
        frame: 100 + frame,
        seconds: frame as f64 / 30.0,
        place: [frame as f64, f64::NAN],
    };
    let guide = Guide {
        rate: 30.0,
        frames: (100..160).collect(),
        clips: vec![Part { name: HOSTILE.into(), seconds: 0.0 }, Part { name: "run".into(), seconds: 1.0 }],
        map: (0..60).map(spot).collect(),
        stress: 0.25,
        candidates: vec![(spot(7), 0.75), (spot(40), 0.25)],
    };
    let page = render(&Preview { guide: Some(&guide), ..parts.preview("walk", &[], &[]) });
    assert!(!page.contains("alert(1)</script>"), "markup got through");
    let told = &data(&page)["guide"];
    assert_eq!(told["clips"][0][0], HOSTILE.chars().take(64).collect::<String>());
    assert_eq!((&told["frames"][59], &told["candidates"][0][0][0]), (&159.into(), &107.into()));
    assert_eq!(told["map"][3], serde_json::json!([103, 0.1, 3.0, 0.0]), "what is not finite is 0");
    assert_eq!(told["candidates"][1][1], 0.25);
    assert!(data(&parts.page())["guide"].is_null());
    // However long the source is.
    let long = Guide { map: (0..100_000).map(spot).collect(), ..guide };
    let page = render(&Preview { guide: Some(&long), ..parts.preview("walk", &[], &[]) });
    assert!(page.len() < 600_000, "{} bytes", page.len());
}
