//! Waves, labels and tables of every kind: what is written reads back, and what is sampled keeps its bounds.

// Helpers and property tests may stop a test as well as test functions may.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use inkrig_sketch::{LabelLength, Labels, Table, Wave, read_table};
use proptest::prelude::*;

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![-10.0..10.0_f64, (-20..20).prop_map(f64::from), -1e15..1e15_f64, -1e-9..1e-9_f64]
}

fn speed() -> impl Strategy<Value = String> {
    prop_oneof![
        (0.01..9.0_f64).prop_map(|f| format!("{f}Hz")),
        (0.2..20.0_f64).prop_map(|p| format!("{p} s"))
    ]
}

fn range() -> impl Strategy<Value = String> {
    prop_oneof![
        number().prop_map(|a| format!("{a}")),
        (number(), number()).prop_map(|(a, b)| format!("{a}..{b}"))
    ]
}

/// Texts after the whole grammar.
fn any_wave() -> impl Strategy<Value = String> {
    let frequency = prop_oneof![
        speed(),
        (speed(), speed()).prop_map(|(a, b)| format!("{a}..{b}")),
        (0.01..9.0_f64, speed()).prop_map(|(a, b)| format!("{a} .. {b}")),
    ];
    let shape = prop_oneof![
        Just("sine(@)".to_owned()),
        Just("triangle(@)".to_owned()),
        Just("saw(@)".to_owned()),
        (0.01..0.99_f64).prop_map(|duty| format!("square(@, duty={duty})")),
        (0..=1_000_000_000_000_000_u64).prop_map(|seed| format!("noise(@, {seed})")),
    ];
    let oscillator = (shape, frequency, prop::option::of(range()), prop::option::of(range()), -1.0..1.0_f64)
        .prop_map(|(shape, frequency, amplitude, centre, phase)| {
            let mut arguments = format!("{frequency}, phase={phase}");
            arguments += &amplitude.map_or(String::new(), |range| format!(",amplitude={range}"));
            arguments += &centre.map_or(String::new(), |range| format!(", centre = {range}"));
            match shape.split_once(", ") {
                Some((head, seed)) if head.starts_with("noise") => {
                    format!("{}, seed={seed}", head.replace("@", &arguments))
                }
                _ => shape.replace("@", &arguments),
            }
        });
    let atom = prop_oneof![
        number().prop_map(|value| format!("{value}")),
        number().prop_map(|value| format!("constant({value:e})")),
        range().prop_map(|range| format!("ramp({range})")),
        Just("t".to_owned()),
        Just("square".to_owned()),
        oscillator,
    ];
    let expression = atom.prop_recursive(4, 24, 3, |inner| {
        prop_oneof![
            (inner.clone(), inner.clone(), "[-+*]").prop_map(|(a, b, sign)| format!("{a} {sign} {b}")),
            (inner.clone(), inner.clone(), "[-+*]").prop_map(|(a, b, sign)| format!("({a}){sign}-({b})")),
            inner.clone().prop_map(|a| format!("--(-{a})")),
            (inner, prop::collection::vec(number(), 2..5), 0.1..9.0_f64).prop_map(|(a, centres, every)| {
                let centres: Vec<String> = centres.iter().map(f64::to_string).collect();
                format!("alternate({a}, centres={}, every={every}s)", centres.join("|"))
            }),
        ]
    });
    (prop::collection::vec((expression.clone(), 0.1..9.0_f64), 0..4), expression).prop_map(
        |(segments, last)| {
            let mut text: String =
                segments.iter().map(|(text, length)| format!("{text} for {length}s; ")).collect();
            text += &last;
            text
        },
    )
}

fn any_labels() -> impl Strategy<Value = Labels> {
    let name = prop_oneof!["[A-D]", "[^\"]{1,8}", "\\PC{1,4}", "[\" :a]{1,6}"];
    let length = prop_oneof![
        (1..100_usize).prop_map(LabelLength::Frames),
        (0.1..9.0_f64).prop_map(LabelLength::Seconds)
    ];
    prop::collection::vec((name, length), 2..20)
        .prop_filter_map("two different names", |segments| Labels::new(segments).ok())
}

fn any_table() -> impl Strategy<Value = Table> {
    (1..6_usize, 2..30_usize, any::<bool>()).prop_flat_map(|(width, rows, timed)| {
        let row = (prop::collection::vec(-1e6..1e6_f64, width), 0.0..2.0_f64);
        prop::collection::vec(row, rows).prop_filter_map("rows that differ", move |rows| {
            let mut text: String = if timed { "time".to_owned() } else { "c".to_owned() };
            let columns = if timed { width } else { width - 1 };
            text += &(0..columns).map(|column| format!(",c{column}")).collect::<String>();
            let mut clock = 5.0;
            for (values, step) in &rows {
                clock += step;
                let values: Vec<String> = values.iter().map(f64::to_string).collect();
                let start = if timed { format!("{clock},") } else { String::new() };
                text += &format!("\n{start}{}", values.join(","));
            }
            read_table(text.as_bytes()).ok()
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_wave_reads_back_from_its_own_text(text in any_wave()) {
        let wave: Wave = text.parse().unwrap();
        let shown = wave.to_string();
        prop_assert_eq!(shown.parse::<Wave>().unwrap(), wave.clone(), "{}", shown);
        let (frames, rate) = (40, 30.0);
        if let Ok(values) = wave.sample(rate, frames) {
            prop_assert_eq!(values.len(), frames);
            prop_assert!(values.iter().all(|value| value.is_finite()));
            prop_assert_eq!(shown.parse::<Wave>().unwrap().sample(rate, frames).unwrap(), values);
        }
    }

    #[test]
    fn oscillators_stay_within_their_amplitude(
        shape in "sine|triangle|square|saw|noise",
        (from, to) in (0.01..14.9_f64, 0.01..14.9_f64),
        (small, large) in (-5.0..5.0_f64, -5.0..5.0_f64),
        (low, high) in (-9.0..9.0_f64, -9.0..9.0_f64),
        phase in -1.0..1.0_f64,
        frames in 100..900_usize,
    ) {
        let text = format!("{shape}({from}Hz..{to}Hz, amplitude={small}..{large}, centre={low}..{high}, phase={phase})");
        let values = text.parse::<Wave>().unwrap().sample(30.0, frames).unwrap();
        for (frame, value) in values.iter().enumerate() {
            let part = frame as f64 / frames as f64;
            let (amplitude, centre) = (small + (large - small) * part, low + (high - low) * part);
            prop_assert!((value - centre).abs() <= amplitude.abs() + 1e-12, "frame {}: {} around {}", frame, value, centre);
        }
    }

    #[test]
    fn labels_read_back_from_their_own_text(labels in any_labels()) {
        let shown = labels.to_string();
        prop_assert_eq!(shown.parse::<Labels>().unwrap(), labels, "{}", shown);
    }

    #[test]
    fn one_hot_rows_sum_to_one_and_stretching_keeps_proportions(labels in any_labels(), frames in 1..5000_usize) {
        for frames in [None, Some(frames)] {
            let Ok(control) = labels.to_one_hot(30.0, frames) else {
                prop_assert!(frames.is_some_and(|frames| frames < labels.frame_count(30.0)));
                continue;
            };
            let width = labels.names().len();
            prop_assert_eq!(&control.names, labels.names());
            prop_assert_eq!(control.frame_count(), frames.unwrap_or(labels.frame_count(30.0)));
            for row in control.values.chunks(width) {
                prop_assert_eq!(row.iter().sum::<f32>(), 1.0);
                prop_assert_eq!(row.iter().filter(|&&cell| cell == 1.0).count(), 1);
            }
            let seconds = |length| match length {
                LabelLength::Frames(frames) => frames as f64 / 30.0,
                LabelLength::Seconds(seconds) => seconds,
            };
            let total: f64 = labels.segments().map(|(_, length)| seconds(length)).sum();
            for (column, name) in control.names.iter().enumerate() {
                let got = control.values.iter().skip(column).step_by(width).sum::<f32>();
                let own: Vec<f64> =
                    labels.segments().filter(|(other, _)| other == name).map(|(_, length)| seconds(length)).collect();
                let share = own.iter().sum::<f64>() / total;
                let want = share * control.frame_count() as f64;
                prop_assert!((f64::from(got) - want).abs() <= own.len() as f64 + 0.5, "{:?}: {} for {}", name, got, want);
            }
        }
    }

    #[test]
    fn tables_keep_their_ends_and_bounds(table in any_table(), frames in 2..200_usize) {
        let width = table.width();
        let rows = table.resample(frames).unwrap();
        prop_assert_eq!(rows.len(), frames * width);
        prop_assert_eq!(&rows[..width], &table.values()[..width]);
        prop_assert_eq!(&rows[rows.len() - width..], &table.values()[table.values().len() - width..]);
        for column in 0..width {
            let given = || table.values().iter().skip(column).step_by(width);
            let (low, high) = (given().copied().fold(f64::MAX, f64::min), given().copied().fold(f64::MIN, f64::max));
            let slack = 1e-9 * (high - low);
            prop_assert!(rows.iter().skip(column).step_by(width).all(|v| (low - slack..=high + slack).contains(v)));
        }
        if table.seconds().is_none() {
            prop_assert_eq!(table.resample(table.row_count()).unwrap(), table.values());
        }
    }
}
