//! No bytes whatever make the reader of storyboards panic or run away. Runs a bounded number of random inputs under
//! `cargo test`, and as long as wanted under `cargo bolero test`.

use std::time::{Duration, Instant};

use bolero::check;
use inkrig_sketch::storyboard::{Storyboard, read_storyboard, read_storyboard_svg, write_storyboard};

const ITERATIONS: usize = 4000;
/// What one input of at most some kilobytes may take: far above what it does take, far below a search that runs away.
const PATIENCE: Duration = Duration::from_secs(5);

/// What is read can be written, and is read back as the same.
fn read(bytes: &[u8]) {
    let start = Instant::now();
    let again = |board: Storyboard| {
        let again = write_storyboard(&board).map(|text| read_storyboard(text.as_bytes()));
        assert_eq!(again, Ok(Ok(board)));
    };
    read_storyboard(bytes).into_iter().for_each(again);
    read_storyboard_svg(bytes).into_iter().for_each(again);
    assert!(start.elapsed() < PATIENCE, "{:?}", start.elapsed());
}

#[test]
fn fuzz_storyboard_bytes() {
    check!().with_iterations(ITERATIONS).for_each(read);
}

/// Parts of real storyboards in any order, which come much further than random bytes.
#[test]
fn fuzz_storyboard_parts() {
    const PARTS: [&str; 25] = [
        r#"{"inkrig_storyboard": 1, "frames": [{"#,
        r#""body": ["#,
        r#""scene": ["#,
        r#""trajectories": [{"points": "#,
        r#""speed_lines": ["#,
        r#""lettering": ["#,
        r#""pins": [{"joint": "head", "at": "#,
        r#""camera": {"pitch_degrees": "#,
        r#""word": "kick""#,
        r#""path": "continue""#,
        r#""seconds": "#,
        r#""figure": "end""#,
        "[[0, 0], [1, 1]]",
        "[[0, 0, 0], [1, 1, 1]]",
        "[[0, 0, 0, 1], [1, 1, 0, 1]]",
        "[1, 2]",
        "1",
        "-1e300",
        "1e-300",
        "]",
        "}",
        "}]",
        ", ",
        "{",
        "}]}",
    ];
    check!().with_type::<Vec<u8>>().with_iterations(ITERATIONS).for_each(|choices: &Vec<u8>| {
        let parts =
            choices.iter().take(200).filter_map(|choice| PARTS.get(usize::from(*choice) % PARTS.len()));
        let text: String = parts.copied().collect();
        read(text.as_bytes());
        // The same inside of a storyboard that is well-formed up to there.
        read(format!("{}\"body\": [{text}]}}]}}", PARTS[0]).as_bytes());
    });
}

/// Parts of drawings, in any order.
#[test]
fn fuzz_storyboard_svg() {
    const PARTS: [&str; 16] = [
        "<g id='frame 1'>",
        "<g id='panel'>",
        "<g id='body' stroke='red'>",
        "<g style='stroke:#0ff;fill:none'>",
        "</g>",
        "<path d='M0 0L9 9M1 2h3z' class='a'/>",
        "<path d='M0 0c1 2 3 4 5 6' stroke='#f80'/>",
        "<circle r='4' stroke='rgb(0 0 200%)'/>",
        "<rect id='r' width='1' height='2' stroke='#12345'/>",
        "<use href='#r' stroke='magenta'/>",
        "<text id='note'>a &amp; b</text>",
        "<text>kick <tspan>high</tspan></text>",
        "<style>.a{stroke:#00f !important}",
        "</style>",
        "<title>t</title>",
        "<",
    ];
    check!().with_type::<Vec<u8>>().with_iterations(ITERATIONS).for_each(|choices: &Vec<u8>| {
        let parts =
            choices.iter().take(60).filter_map(|choice| PARTS.get(usize::from(*choice) % PARTS.len()));
        let inside: String = parts.copied().collect();
        read(format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'>{inside}</svg>").as_bytes());
    });
}
