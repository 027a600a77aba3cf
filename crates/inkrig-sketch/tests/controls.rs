//! Waves, labels and tables: the usual ones are as described, and each mistake gets a message that says where it is, what
//! stands there, what is expected and what to write instead.

// Helpers may stop a test as well as test functions may.
#![allow(clippy::expect_used)]

use std::fmt::Debug;
use std::time::{Duration, Instant};

use inkrig_sketch::limits::MAX_BYTES;
use inkrig_sketch::{
    Format, Labels, MAX_WAVE_DEPTH, MAX_WAVE_PARTS, MAX_WAVE_TEXT, SketchError, Wave, read_labels,
    read_table, read_wave,
};

/// Checks whole messages. A case is a line with the text, where `\n` is a line end and `\s` a space, and a line with what is
/// said about it. Lists that occur often are written as a word in capitals.
fn messages<T: Debug>(cases: &str, read: impl Fn(&str) -> Result<T, SketchError>) {
    const ATOM: &str =
        "a number, t, ( or one of sine, triangle, square, saw, noise, ramp, constant, alternate";
    const SIGN: &str = "a number, a name, .. or one of ( ) , ; = | + - *";
    const LENGTH: &str = "a length in frames, such as 30, or in seconds, such as 1.5s";
    let lines: Vec<&str> = cases.lines().collect();
    assert!(lines.len() >= 2 && lines.len().is_multiple_of(2));
    for case in lines.chunks(2) {
        let text = &*case[0].replace("\\n", "\n").replace("\\s", " ");
        let expected = case[1].strip_prefix("    ").expect("a message is indented");
        let expected = expected.replace("ATOM", ATOM).replace("SIGN", SIGN).replace("LENGTH", LENGTH);
        assert_eq!(read(text).expect_err(text).to_string(), expected, "{text:?}");
    }
}

#[test]
fn mistakes_in_a_wave_are_located() {
    messages(include_str!("controls/wave.txt"), str::parse::<Wave>);
}

#[test]
fn waves_beyond_the_limits_are_refused() {
    let message = |text: &str| text.parse::<Wave>().unwrap_err().to_string();
    let nested = |depth: usize| format!("{}t{}", "(".repeat(depth), ")".repeat(depth));
    assert!(nested(MAX_WAVE_DEPTH).parse::<Wave>().is_ok());
    let expected = "wave, column 33: found `(`, expected at most 32 parentheses in one another. Leave out those that change nothing";
    assert_eq!(message(&nested(MAX_WAVE_DEPTH + 1)), expected);
    assert_eq!(message(&"(".repeat(MAX_WAVE_TEXT)), expected);
    let alternating = "alternate(".repeat(40);
    assert!(
        message(&alternating).starts_with("wave, column 321: found `alternate`, expected at most 32 paren")
    );
    // A parenthesis counts as a part as well.
    let sum = |parts: usize| vec!["t"; parts].join("+");
    assert!(sum(MAX_WAVE_PARTS).parse::<Wave>().is_ok());
    let expected = "wave, column 513: found `t`, expected at most 256 numbers and generators in all. \
                    Give long waves as CSV or JSON samples";
    assert_eq!(message(&sum(MAX_WAVE_PARTS + 1)), expected);
    let centres = format!("alternate(t, centres={}1, every=1s)", "1|".repeat(300));
    assert!(message(&centres).contains("expected at most 256 numbers and generators"));
    let expected = "wave, column 1: found a text of 131073 bytes, expected at most 131072 bytes. \
                    Give long waves as CSV or JSON samples";
    assert_eq!(message(&" ".repeat(MAX_WAVE_TEXT + 1)), expected);
}

#[test]
fn reading_takes_time_in_proportion_to_the_text() {
    let start = Instant::now();
    for piece in [
        "-",
        "(",
        "t ",
        "t for 1s;",
        "1+",
        "\u{2003}",
        "e",
        "1e",
        "1.",
        "sine(",
        "\"\"",
        "a:1 ",
        "\"a:1",
        "é",
    ] {
        let text = piece.repeat(MAX_WAVE_TEXT / piece.len());
        let _ = text.parse::<Wave>();
        let _ = text.parse::<Labels>();
    }
    // Milliseconds; a cost that grows with the square would take minutes.
    assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
}

#[test]
fn mistakes_in_sampling_are_explained() {
    let message = |text: &str, rate, frames| {
        text.parse::<Wave>().unwrap().sample(rate, frames).expect_err(text).to_string()
    };
    for (text, rate, frames, expected) in [
        ("sine(2Hz)", 0.0, 9, "a rate of 0 samples a second was asked for; above 0 to 1000000 are possible"),
        ("sine(2Hz)", 30.0, 0, "0 frames were asked for; 1 to 1000000 are possible"),
        ("sine(2Hz)", 30.0, 10_000_000, "10000000 frames were asked for; 1 to 1000000 are possible"),
        (
            "sine(1Hz) for 3s; sine(4Hz) for 2s",
            30.0,
            151,
            "the wave lasts 5 s, which is 150 frames, but 151 were asked for. \
             Ask for fewer, or leave out the last `for`: that segment then lasts to the end",
        ),
        (
            "sine(2Hz..20Hz)",
            30.0,
            9,
            "the wave reaches 20 Hz, but 30 samples a second show only what is below 15 Hz. Lower the frequency",
        ),
        (
            "1",
            30.0,
            9,
            "the wave does not move: all its 9 samples are the same. Give at least two that differ",
        ),
        (
            "1e10 * t * 1e10",
            1.0,
            9,
            "the wave is 1e20 at frame 1; a finite number of at most 1e15 is expected. Make its factors smaller",
        ),
    ] {
        assert_eq!(message(text, rate, frames), expected, "{text}");
    }
}

#[test]
fn the_waves_of_the_usual_experiments_are_as_described() {
    let sample = |text: &str, frames| text.parse::<Wave>().unwrap().sample(30.0, frames).unwrap();
    // Low to high: the steps between crossings of the centre shrink all the way.
    let rising = sample("sine(0.5Hz..4Hz)", 600);
    let crossings: Vec<usize> = (1..600).filter(|&i| (rising[i - 1] < 0.0) != (rising[i] < 0.0)).collect();
    let gaps: Vec<usize> = crossings.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(gaps.windows(2).all(|pair| pair[1] <= pair[0] + 1), "{gaps:?}");
    assert!(gaps[0] > 5 * gaps[gaps.len() - 1], "{gaps:?}");
    assert!((88..=90).contains(&crossings.len()), "45 periods: {}", crossings.len());
    // Triangle: straight flanks, sharp turns.
    let triangle = sample("triangle(1Hz)", 90);
    let bends = triangle.windows(3).filter(|w| (w[0] - 2.0 * w[1] + w[2]).abs() > 1e-9).count();
    assert!(bends <= 2 * 6, "only around six turns: {bends}");
    // A sine that changes sides.
    let sides = sample("alternate(sine(2Hz, amplitude=0.25), centres=-1|1, every=2s)", 240);
    for (second, values) in sides.chunks(60).enumerate() {
        let mean = values.iter().sum::<f64>() / 60.0;
        let side = if second.is_multiple_of(2) { -1.0 } else { 1.0 };
        assert!((mean - side).abs() < 1e-9, "{second}: {mean}");
    }
    // Piecewise: 3 seconds slow, 2 seconds quick.
    let pieces = sample("sine(1Hz) for 3s; sine(4Hz) for 2s", 150);
    let alone = sample("sine(4Hz)", 60);
    assert!(pieces[90..].iter().zip(alone).all(|(a, b)| (a - b).abs() < 1e-9));
}

#[test]
fn mistakes_in_samples_are_located() {
    messages(include_str!("controls/wave_csv.txt"), |text| read_wave(text.as_bytes(), Format::Csv));
    messages(include_str!("controls/wave_json.txt"), |text| read_wave(text.as_bytes(), Format::Json));
}

#[test]
fn mistakes_in_labels_are_located() {
    messages(include_str!("controls/labels.txt"), str::parse::<Labels>);
    messages(include_str!("controls/labels_csv.txt"), |text| read_labels(text.as_bytes(), Format::Csv));
    messages(include_str!("controls/labels_json.txt"), |text| read_labels(text.as_bytes(), Format::Json));
}

#[test]
fn labels_beyond_the_limits_are_refused() {
    let many: String = (0..257).map(|i| format!("L{i}:3 ")).collect();
    let message = "there are more than 256 different labels. Use fewer, and look for misspelt ones";
    assert_eq!(many.parse::<Labels>().unwrap_err().to_string(), message);
    let rows: String = (0..257).map(|i| format!("L{i}\n")).collect();
    assert_eq!(read_labels(rows.as_bytes(), Format::Csv).unwrap_err().to_string(), message);
    let names: Vec<String> = (0..257).map(|i| format!("\"L{i}\"")).collect();
    let json = format!("[{}]", names.join(","));
    assert_eq!(read_labels(json.as_bytes(), Format::Json).unwrap_err().to_string(), message);
    let message = "there are more than 1000000 segments of labels. Join neighbours, or split the row";
    assert_eq!("A:1 B:1 ".repeat(500_001).parse::<Labels>().unwrap_err().to_string(), message);
    assert_eq!(
        read_labels("A\nB\n".repeat(500_001).as_bytes(), Format::Csv).unwrap_err().to_string(),
        message
    );
    let labels: Labels = "A:1000000 B:1".parse().unwrap();
    assert_eq!(
        labels.to_one_hot(30.0, None).unwrap_err().to_string(),
        "1000001 frames were asked for; 1 to 1000000 are possible"
    );
    let labels: Labels = "A:30 B:1".parse().unwrap();
    assert_eq!(
        labels.to_one_hot(30.0, Some(10)).unwrap_err().to_string(),
        "the label \"B\" gets none of the 10 frames. Ask for more frames, or make its segment longer"
    );
}

#[test]
fn the_row_of_the_usual_experiment_is_as_described() {
    let control = "A:30 B:45 A:30".parse::<Labels>().unwrap().to_one_hot(30.0, None).unwrap();
    assert_eq!(
        (control.names.as_slice(), control.frame_count()),
        (["A", "B"].map(str::to_owned).as_slice(), 105)
    );
    let ones = |from: usize, to: usize, label: usize| {
        (from..to).all(|frame| control.values[2 * frame + label] == 1.0)
    };
    assert!(ones(0, 30, 0) && ones(30, 75, 1) && ones(75, 105, 0));
}

#[test]
fn mistakes_in_tables_are_located() {
    messages(include_str!("controls/table.txt"), |text| read_table(text.as_bytes()));
    let wide = vec!["0"; 300].join(",");
    assert_eq!(
        read_table(wide.as_bytes()).unwrap_err().to_string(),
        "CSV, line 1, column 257: there are 300 columns; at most 256 are read. Leave some out"
    );
}

#[test]
fn files_beyond_the_limits_are_refused() {
    let rows = "0.5\n".repeat(10_000_000);
    let message = "the wave has more than 1000000 rows. Keep every tenth row, or split the file";
    assert_eq!(read_wave(rows.as_bytes(), Format::Csv).unwrap_err().to_string(), message);
    let json = format!("[{}0]", "1,".repeat(10_000_000));
    assert_eq!(read_wave(json.as_bytes(), Format::Json).unwrap_err().to_string(), message);
    let message = "the table has more than 1000000 rows. Keep every tenth row, or split the file";
    assert_eq!(read_table(rows.as_bytes()).unwrap_err().to_string(), message);
    let wide = format!("{}\n", vec!["0"; 256].join(",")).repeat(70_000);
    assert_eq!(
        read_table(wide.as_bytes()).unwrap_err().to_string(),
        "the table holds more than 16000000 numbers, rows times columns. Leave out rows or columns"
    );
    // One row of delimiters is refused before its fields are counted.
    let delimiters = ",".repeat(60 << 20);
    assert_eq!(read_table(delimiters.as_bytes()), Err(SketchError::TooManyValues { what: "table" }));
    let large = vec![b' '; MAX_BYTES + 1];
    for (what, error) in [
        ("wave", read_wave(&large, Format::Csv).unwrap_err()),
        ("labels", read_labels(&large, Format::Json).unwrap_err()),
        ("table", read_table(&large).unwrap_err()),
    ] {
        let message = format!(
            "the file of the {what} has 67108865 bytes; at most 67108864 are read. Leave out rows, or split it"
        );
        assert_eq!(error.to_string(), message);
    }
}

#[test]
fn what_is_no_text_is_refused() {
    let message = "the file of the wave, line 2: this is not UTF-8 text. Save it as CSV or JSON in UTF-8";
    assert_eq!(read_wave(b"0\n\xFF\n", Format::Csv).unwrap_err().to_string(), message);
    let svg = [
        read_wave(b"<svg/>", Format::Svg).map(|_| ()).unwrap_err(),
        read_labels(b"<svg/>", Format::Svg).map(|_| ()).unwrap_err(),
    ];
    assert_eq!(svg[0].to_string(), "a wave is not read from SVG. Give CSV or JSON");
    assert_eq!(svg[1].to_string(), "a row of labels is not read from SVG. Give CSV or JSON");
    assert_eq!(read_table(b"\xEF\xBB\xBF0,1\n1,0\n").unwrap().values(), [0.0, 1.0, 1.0, 0.0]);
}
