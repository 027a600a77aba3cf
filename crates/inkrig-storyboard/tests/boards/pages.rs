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
