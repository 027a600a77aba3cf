//! The same storyboards drawn in other ways.

use crate::support::{MODEL, generated, poses, understood};
use inkrig_sketch::storyboard::{Frame, read_storyboard, read_storyboard_svg};
use inkrig_storyboard::{Exact, Picture, animation, misses, storyboard_of_picture};

#[test]
fn the_svg_says_the_same_as_the_json() {
    for sample in inkrig_samples::storyboards() {
        let board = read_storyboard(sample.bytes).unwrap();
        let svg = inkrig_samples::make::storyboards::to_svg(&board);
        let read = read_storyboard_svg(svg.as_bytes()).unwrap();
        assert_eq!(read.title, board.title);
        for (own, other) in board.frames.iter().zip(&read.frames) {
            assert_eq!((&own.word, own.body.len()), (&other.word, other.body.len()), "{}", sample.name);
            let counts =
                |frame: &Frame| [frame.trajectories.len(), frame.speed_lines.len(), frame.scene.len()];
            assert_eq!(counts(own), counts(other), "{}", sample.name);
        }
        assert_eq!(board.frames.len(), read.frames.len());
    }
}

#[test]
fn a_painted_page_becomes_a_motion_too() {
    let model = &*MODEL;
    for sample in inkrig_samples::storyboards() {
        let board = read_storyboard(sample.bytes).unwrap();
        let page = inkrig_samples::make::storyboards::Page::of(&board);
        let (width, height, pixels) = (page.width, page.height, page.colours());
        let picture = Picture { width, height, pixels: &pixels };
        let painted = storyboard_of_picture(&picture).unwrap();
        assert_eq!(painted.frames.len(), board.frames.len(), "{}", sample.name);
        let mut clips = Vec::new();
        for (at, (own, drawn)) in painted.frames.iter().zip(&board.frames).enumerate() {
            assert_eq!(own.trajectories.len(), drawn.trajectories.len(), "{} {at}", sample.name);
            assert_eq!(own.scene.is_empty(), drawn.scene.is_empty(), "{} {at}", sample.name);
            // A page has no pen's time and no words; the words are typed.
            let typed = Frame { word: drawn.word.clone(), ..own.clone() };
            let read = understood(&typed).unwrap_or_else(|said| panic!("{} {at}: {said}", sample.name));
            clips.push(generated(&read, at + 1, &model.sampling, true));
        }
        let made = animation(&clips, None, &model.body, &Exact::Soft).unwrap();
        let off = misses(&poses(&made.clip), &made.goals.concat());
        println!("{}.png: {} frames, off the lines {off:.3?} m", sample.name, made.clip.frames());
        assert!(off[0] < 0.12, "{}: {off:?}", sample.name);
    }
}

/// As cameras save pictures: one colour for four pixels, and noise.
#[test]
fn coarse_colours_and_noise_change_no_stroke() {
    for sample in inkrig_samples::storyboards() {
        let board = read_storyboard(sample.bytes).unwrap();
        let page = inkrig_samples::make::storyboards::Page::of(&board);
        let (width, height, plain) = (page.width, page.height, page.colours());
        let start = |x: usize, y: usize| 3 * (y.min(height - 1) * width + x.min(width - 1));
        let bright = |at: usize| plain[at..at + 3].iter().map(|part| f32::from(*part)).sum::<f32>() / 3.0;
        let mut pixels = plain.clone();
        let mut state = 7_u32;
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let (left, top) = (x / 2 * 2, y / 2 * 2);
            let four =
                [start(left, top), start(left + 1, top), start(left, top + 1), start(left + 1, top + 1)];
            for part in 0..3 {
                let beside =
                    four.iter().map(|at| f32::from(plain[at + part]) - bright(*at)).sum::<f32>() / 4.0;
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let noise = (state >> 24) as f32 / 255.0 * 16.0 - 8.0;
                pixels[start(x, y) + part] = (bright(start(x, y)) + beside + noise).clamp(0.0, 255.0) as u8;
            }
        }
        let read = storyboard_of_picture(&Picture { width, height, pixels: &pixels }).unwrap();
        assert_eq!(read.frames.len(), board.frames.len(), "{}", sample.name);
        let clean = storyboard_of_picture(&Picture { width, height, pixels: &plain }).unwrap();
        let length = |frame: &Frame| -> f64 {
            let lines = frame.trajectories.iter().map(|way| &way.points.points);
            let pairs = lines.flat_map(|line| line.windows(2));
            pairs.map(|pair| (pair[0][0] - pair[1][0]).hypot(pair[0][1] - pair[1][1])).sum()
        };
        for ((own, drawn), clean) in read.frames.iter().zip(&board.frames).zip(&clean.frames) {
            // Cut or not, all of the line is there, and no more.
            let (own_length, clean) = (length(own), length(clean));
            assert!((own_length - clean).abs() <= 0.1 * clean, "{}: {own_length} of {clean}", sample.name);
            println!("{}: {own_length:.1} of {clean:.1}", sample.name);
            println!(
                "{}: ways {} of {}, strokes of the body {}, of the scene {} of {}",
                sample.name,
                own.trajectories.len(),
                drawn.trajectories.len(),
                own.body.len(),
                own.scene.len(),
                drawn.scene.len()
            );
            // The kick's way goes back over its own line beside dashes: coarse colours cut it where they meet.
            let cut = usize::from(sample.name == "kick");
            let ways = own.trajectories.len();
            assert!(
                (drawn.trajectories.len()..=drawn.trajectories.len() + cut).contains(&ways),
                "{}",
                sample.name
            );
            assert_eq!(own.scene.is_empty(), drawn.scene.is_empty(), "{}", sample.name);
        }
    }
}
