//! Drawings as files: what is written reads back, what programs export is read, what is hostile is refused with a message
//! that says what, where and what to do.

// Helpers and property tests may stop a test as well as test functions may.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use inkrig_sketch::limits::{MAX_POINTS, MAX_SVG_ELEMENT_ATTRIBUTES};
use inkrig_sketch::{
    Curve, Ends, Format, Origin, SketchError, Timing, read_curve, resample, shapes, smooth, to_csv, to_json,
    to_svg,
};
use proptest::prelude::*;

fn json(text: &str) -> Result<Curve, SketchError> {
    read_curve(text.as_bytes(), Format::Json)
}

fn csv(text: &str) -> Result<Curve, SketchError> {
    read_curve(text.as_bytes(), Format::Csv)
}

fn svg(body: &str) -> Result<Curve, SketchError> {
    let text = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink' viewBox='0 0 100 100'>\n{body}</svg>"
    );
    read_curve(text.as_bytes(), Format::Svg)
}

fn messages(cases: &[(&str, &str)], read: impl Fn(&str) -> Result<Curve, SketchError>) {
    for (text, expected) in cases {
        let shown: String = text.chars().take(200).collect();
        let message = read(text).expect_err(&shown).to_string();
        assert!(message.contains(expected), "{shown}\n  said:     {message}\n  expected: {expected}");
    }
}

#[test]
fn json_mistakes_are_located() {
    messages(
        &[
            ("", "JSON, line 1, column 0, at point 0: EOF"),
            ("[]", "holds no point"),
            ("{\"points\": []}", "holds no point"),
            ("{\"strokes\": [[], []]}", "holds no point"),
            ("{\"pints\": [[0,0]]}", "neither \"points\" nor \"strokes\""),
            ("{\"points\": [[0,0]], \"strokes\": []}", "more than one of points and strokes"),
            ("\"drawing\"", "expected [[x, y], ...]"),
            ("[[0,0],\n[1]]", "line 2, column 3, at point 1: a point needs two numbers"),
            ("[[0,0],[1,2,3,4]]", "at most three numbers"),
            (
                "[[0,0],\n [1,\"2\"]]",
                "line 2, column 7, at point 1: invalid type: string \"2\", expected a number",
            ),
            ("[[[0,0],[1,1]]]", "several strokes are written {\"strokes\""),
            ("[{\"x\":1}]", "needs the numbers x and y"),
            ("[[0,0],[1,1e999]]", "at point 1: number out of range"),
            ("[[0,0],[1,1e30]]", "y is 1e30; a finite number of at most 1e15"),
            ("[[0,NaN]]", "line 1, column 5"),
            ("[[0,0,1],[1,1]]", "at point 1: has no time t, but earlier points have one"),
            ("[[0,0],[1,1,1]]", "at point 1: has a time t, but earlier points have none"),
            ("[[0,0,1],[1,1,0.5]]", "time goes back from 1 s to 0.5 s"),
            ("[{\"x\":0,\"y\":0,\"pressure\":-1}]", "pressure is -1"),
            ("[[0,0],[1,1]] [", "trailing characters"),
        ],
        json,
    );
}

#[test]
fn csv_mistakes_are_located() {
    messages(
        &[
            ("", "holds no point"),
            ("# only a comment\n", "holds no point"),
            ("x,y\n", "holds no point"),
            ("a,b\n1,2\n", "CSV, line 1, column 1: the header names no columns x and y"),
            ("x,y,x\n", "CSV, line 1, column 3: a second column is named \"x\""),
            ("0,0\n# note\n1,one\n", "CSV, line 3, column 2: y is \"one\", not a finite number"),
            ("0,0\n1\n", "CSV, line 2, column 2: y is missing"),
            ("0,0\n,1\n", "CSV, line 2, column 1: x is missing"),
            ("1,5;2\n2,0;3\n", "write decimals with a point"),
            ("1 2\n3 4\n", "separate numbers with comma"),
            ("0,0\n1,NaN\n", "line 2, column 2: y is \"NaN\""),
            ("0,0\n1,inf\n", "line 2, column 2: y is \"inf\""),
            ("0,0\n1,1e300\n", "line 2, column 1: y is 1e300"),
            ("0,0,1\n1,0\n", "line 2, column 1: has no time t"),
            ("0,0,1\n\n1,0,0\n", "line 3, column 1: time goes back from 1 s to 0 s"),
        ],
        csv,
    );
}

#[test]
fn svg_mistakes_are_located() {
    messages(
        &[
            ("", "shows no path or shape"),
            ("<path d='M0 0 L1 1'/><oops>", "SVG, line 2, column"),
            ("<text>hello</text>", "turn text into paths"),
            (
                "<path d='M0 0 LNaN 1'/>",
                "SVG, line 2, column 1: d of <path>, character 7: a number is expected",
            ),
            ("<path d='M0 0 L1e999 1'/>", "character 7: this number is too large"),
            ("<path d='M0 0 L1e30 1'/>", "character 7: this number is too large; at most 1e15"),
            (
                "<path d='M0 0 L1 1'/>\n <path d='M0 0 L'/>",
                "SVG, line 3, column 2: d of <path>, character 7: a number is",
            ),
            ("<circle r='1e20'/>", "r is 1e20; at most 1e9 or 100% is read"),
            ("<rect width='1000%' height='1'/>", "width is 1000%"),
            ("<path d='M1 1'/>", "shows no path or shape"),
            (
                "<polyline points='0,0 1,-1e17'/>",
                "points of <polyline>, character 7: this number is too large",
            ),
        ],
        svg,
    );
    let read = |text: &str| read_curve(text.as_bytes(), Format::Svg);
    messages(
        &[
            ("", "SVG, line 1"),
            ("<html><path d='M0 0 L1 1'/></html>", "the root element is <html>, not <svg>"),
            ("<svg xmlns='http://www.w3.org/2000/svg' width='0' height='10'/>", "is not positive"),
        ],
        read,
    );
}

#[test]
fn files_beyond_the_limits_are_refused() {
    let points = "[0,0],".repeat(MAX_POINTS);
    assert_eq!(json(&format!("[{points}[1,1]]")), Err(SketchError::TooManyPoints));
    assert_eq!(csv(&"0,0\n".repeat(MAX_POINTS + 1)), Err(SketchError::TooManyPoints));
    assert_eq!(csv(&",".repeat(60 << 20)), Err(SketchError::TooManyPoints));
    assert_eq!(svg(&format!("<path d='M0 0{}'/>", "h1".repeat(MAX_POINTS))), Err(SketchError::TooManyPoints));
    assert!(matches!(json(&"[".repeat(1 << 20)), Err(SketchError::Json { .. })));
    assert!(matches!(json(&format!("{{\"a\":{}", "[".repeat(1 << 20))), Err(SketchError::Json { .. })));
}

#[test]
fn compressed_svg_is_refused() {
    let message = read_curve(b"\x1F\x8B\x08\0\0\0\0\0", Format::Svg).unwrap_err().to_string();
    assert!(message.contains("compressed") && message.contains("gunzip"), "{message}");
}

#[test]
fn svg_bombs_are_refused() {
    // Each level shows the one below ten times.
    let mut doubling = String::from("<g id='g0'><path d='M0 0 L1 1'/></g>");
    for level in 1..20 {
        let uses = format!("<use href='#g{}'/>", level - 1).repeat(10);
        doubling += &format!("<g id='g{level}'>{uses}</g>");
    }
    let paths =
        format!("<path id='p' d='M0 0{}'/>{}", " 1 1".repeat(100_000), "<use href='#p'/>".repeat(100));
    let chain: String =
        (0..200).map(|level| format!("<g id='c{level}'><use href='#c{}'/></g>", level + 1)).collect();
    let attributes = format!("<g {}/>", "a='' ".repeat(200)).repeat(6000);
    let prefix = |level: usize| (0..200).map(|i| format!(" xmlns:p{level}_{i}='u'")).collect::<String>();
    let prefixes: String = (0..60).map(|level| format!("<g{}>", prefix(level))).collect();
    let rules = ".a{fill:none}".repeat(5000) + "</style>" + &"<path d='M0 0 L1 1'/>".repeat(5000);
    messages(
        &[
            (&doubling, "too many elements, each <use> expanded; at most 50000"),
            (&paths, "too many bytes of attributes"),
            (&chain, "nested too deeply"),
            (&("<g>".repeat(200) + &"</g>".repeat(200)), "nested too deeply"),
            (&("<g>".repeat(75_000) + &"</g>".repeat(75_000)), "nested too deeply"),
            (&"<g/>".repeat(500_000), "too many elements"),
            (
                &format!(
                    "<g {}/>",
                    (0..=MAX_SVG_ELEMENT_ATTRIBUTES).map(|i| format!("a{i}='' ")).collect::<String>()
                ),
                "too many attributes",
            ),
            (&attributes, "too many attributes; at most 1000000"),
            (&"<".repeat(1 << 20), "too many elements"),
            (&"=".repeat(2 << 20), "too many attributes"),
            (&prefixes, "too many declarations of name spaces"),
            (&format!("<style>{rules}"), "too many style rules"),
            ("<use id='a' href='#a'/>", "contains itself through <use>"),
            (
                "<g id='a'>\n<use href='#b'/></g>\n<g id='b'><use xlink:href='#a'/></g>",
                "<g> contains itself through <use>",
            ),
        ],
        svg,
    );
}

#[test]
fn xml_entity_bombs_are_refused() {
    let document = |declarations: &str, body: &str| {
        format!("<!DOCTYPE svg [{declarations}]>\n<svg xmlns='http://www.w3.org/2000/svg'>{body}</svg>")
    };
    let nested = document(
        "<!ENTITY a 'M0 0 L1 1'><!ENTITY b '&a;&a;&a;&a;&a;&a;'>\n<!ENTITY c '&b;&b;&b;&b;&b;'>",
        "<path d='&c;'/>",
    );
    let markup = document("<!ENTITY a \"<path d='M0 0 L1 1'/>\">", "&a;&a;");
    let wide = document(&format!("<!ENTITY a '{}'>", "1 ".repeat(50_000)), &"<path d='M&a;'/>".repeat(1000));
    let many = document(
        &(0..10_000).map(|i| format!("<!ENTITY a{i} ''>")).collect::<String>(),
        &format!("<path d='{}'/>", "&a9999;".repeat(10_000)),
    );
    let looping = document("<!ENTITY a '&a;'>", "<path d='&a;'/>");
    messages(
        &[
            (&nested, "an entity holds markup or other entities"),
            (&markup, "an entity holds markup or other entities"),
            (&wide, "the entities expand to too many bytes"),
            (&many, "too many references times entities"),
            (&looping, "an entity holds markup or other entities"),
        ],
        |text| read_curve(text.as_bytes(), Format::Svg),
    );
    let external = document("<!ENTITY a SYSTEM 'file:///etc/passwd'>", "<path d='&a;'/>");
    assert!(read_curve(external.as_bytes(), Format::Svg).is_err());
}

#[test]
fn what_could_make_a_renderer_loop_is_left_out() {
    // Three patterns, clip paths, masks, filters and markers, each in a ring: none is needed to know what was drawn.
    let mut body = String::new();
    for (this, next) in [(0, 1), (1, 2), (2, 0)] {
        body += &format!(
            "<pattern id='p{this}' width='1' height='1'><rect width='9' height='9' fill='url(#p{next})'/></pattern>\
             <clipPath id='c{this}' clip-path='url(#c{next})'><rect width='9' height='9'/></clipPath>\
             <mask id='m{this}' mask='url(#m{next})'><rect width='9' height='9'/></mask>\
             <filter id='f{this}'><feImage href='#f{next}'/></filter>\
             <marker id='k{this}'><path d='M0 0 L1 1 L2 0' marker-mid='url(#k{next})'/></marker>"
        );
    }
    body += "<path d='M0 0 L1 1 L2 0' fill='url(#p0)' clip-path='url(#c0)' mask='url(#m0)' filter='url(#f0)' \
             style='marker:url(#k0)' stroke='url(#nothing)'/>";
    assert_eq!(svg(&body).unwrap().points(), [[0.0, 0.0], [1.0, -1.0], [2.0, 0.0]]);
}

#[test]
fn nothing_outside_the_file_is_read() {
    let folder = std::env::temp_dir().join(format!("inkrig-sketch-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let secret = folder.join("secret.svg");
    std::fs::write(&secret, "<svg xmlns='http://www.w3.org/2000/svg'><path id='x' d='M0 0 L9 9'/></svg>")
        .unwrap();
    let address = secret.display();
    for reference in [
        format!("{address}"),
        format!("file://{address}"),
        format!("../../{address}"),
        format!("{address}#x"),
    ] {
        for element in ["image width='10' height='10'", "use", "feImage"] {
            let body = format!("<{element} href='{reference}'/><{element} xlink:href='{reference}'/>");
            assert_eq!(svg(&body), Err(SketchError::NothingVisible), "{body}");
        }
    }
    let embedded = "<image width='9' height='9' href=\"data:image/svg+xml,&lt;svg xmlns='http://www.w3.org/2000/svg'>\
                    &lt;path d='M0 0 L9 9'/>&lt;/svg>\"/>";
    assert_eq!(svg(embedded), Err(SketchError::NothingVisible));
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn what_drawing_programs_export_is_read() {
    // As Illustrator writes: entities for name spaces, a switch, style classes, a clip path that shows a shape of defs.
    let illustrator = r##"<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd" [
  <!ENTITY ns_svg "http://www.w3.org/2000/svg">
  <!ENTITY ns_xlink "http://www.w3.org/1999/xlink">
]>
<svg version="1.1" xmlns="&ns_svg;" xmlns:xlink="&ns_xlink;" width="100px" height="100px" viewBox="0 0 100 100">
<style type="text/css">.st0{fill:none;stroke:#000000;stroke-miterlimit:10;} .st1{display:none;}</style>
<switch><foreignObject requiredExtensions="&ns_svg;ai" width="1" height="1"/><g>
  <defs><rect id="SVGID_1_" width="50" height="50"/></defs>
  <clipPath id="SVGID_2_"><use xlink:href="#SVGID_1_"/></clipPath>
  <path class="st0" d="M10,10h20v20"/>
  <path class="st1" d="M0,0h90v90"/>
  <path fill="none" d="M0 0h100v100H0z"/>
  <use xlink:href="#SVGID_1_" style="clip-path:url(#SVGID_2_)" x="5" y="5"/>
</g></switch></svg>"##;
    let curve = read_curve(illustrator.as_bytes(), Format::Svg).unwrap();
    let strokes: Vec<_> = curve.strokes().map(<[_]>::to_vec).collect();
    assert_eq!(strokes.len(), 2, "what is hidden or unpainted is not read");
    assert_eq!(strokes[0], [[10.0, -10.0], [30.0, -10.0], [30.0, -30.0]]);
    assert_eq!(strokes[1][0], [5.0, -5.0]);
    assert_eq!(strokes[1].first(), strokes[1].last());

    // As Inkscape writes: millimetres, layers, other name spaces, style attributes.
    let inkscape = r#"<svg width="210mm" height="297mm" viewBox="0 0 210 297" xmlns="http://www.w3.org/2000/svg"
  xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" xmlns:sodipodi="http://sodipodi.net/DTD/sodipodi-0.dtd">
 <sodipodi:namedview id="base" pagecolor="ffffff"/><metadata id="m7"/>
 <g inkscape:label="Layer 1" inkscape:groupmode="layer" id="layer1" transform="translate(1,0)">
  <path style="fill:none;stroke:#000;stroke-width:0.26px;stroke-dasharray:1e-9" d="m 0,0 c 10,-10 20,10 30,0" inkscape:connector-curvature="0" />
  <path style="opacity:0;stroke:#000" d="M0 0 L50 50"/>
  <g visibility="hidden"><circle r="9"/></g>
 </g></svg>"#;
    let curve = read_curve(inkscape.as_bytes(), Format::Svg).unwrap();
    assert_eq!((curve.stroke_count(), curve.origin()), (1, Origin::Outline));
    let scale = 96.0 / 25.4;
    let (first, last) = (curve.points()[0], curve.points()[curve.point_count() - 1]);
    assert!((first[0] - scale).abs() < 1e-3 && (last[0] - 31.0 * scale).abs() < 1e-3, "{first:?} {last:?}");
}

#[test]
fn flattening_follows_the_curve_whatever_the_size() {
    for scale in [1e-6, 1.0, 1e6] {
        let circle = format!("<g transform='scale({scale})'><circle cx='5' cy='5' r='3'/></g>");
        let curve = svg(&circle).unwrap();
        assert!((40..400).contains(&curve.point_count()), "{}", curve.point_count());
        assert!(curve.is_closed());
        let roundness = curve.points().iter().map(|p| (p[0] / scale - 5.0).hypot(p[1] / scale + 5.0));
        assert!(roundness.clone().all(|r| (r - 3.0).abs() < 3e-3), "{:?}", roundness.collect::<Vec<_>>());
        let length = std::f64::consts::TAU * 3.0 * scale;
        assert!((curve.length() / length - 1.0).abs() < 1e-3);
    }
}

#[test]
fn a_drawing_becomes_a_control() {
    let drawn = shapes::growing_circles(5, 300).unwrap();
    let curve = read_curve(to_svg(&drawn).as_bytes(), Format::Svg).unwrap();
    let frames = resample(&curve, 150, Timing::automatic(&curve, 150)).unwrap();
    let steps: Vec<f64> = frames.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).collect();
    let mean = steps.iter().sum::<f64>() / steps.len() as f64;
    assert!(steps.iter().all(|step| (step / mean - 1.0).abs() < 0.1), "constant speed");
    let control = smooth(&frames, 2.0, Ends::Open).unwrap();
    assert_eq!(control.len(), 150);
    assert!((control[0][0] - frames[0][0]).abs() < 1e-9);
}

fn any_curve() -> impl Strategy<Value = Curve> {
    let number = prop_oneof![-1e3..1e3_f64, -1e15..1e15_f64, Just(0.0), -1e-9..1e-9_f64];
    let stroke = prop::collection::vec([number.clone(), number], 1..20);
    (
        prop::collection::vec(stroke, 1..5),
        any::<bool>(),
        any::<bool>(),
        prop::collection::vec(0.0..2.0_f64, 100),
    )
        .prop_map(|(strokes, timed, pressed, steps)| {
            let mut curve = Curve::from_strokes(strokes).unwrap();
            let count = curve.point_count();
            if timed {
                let sum = |time: &mut f64, step: &f64| {
                    *time += step;
                    Some(*time)
                };
                let seconds = std::iter::once(0.0).chain(steps.iter().scan(0.0, sum)).take(count).collect();
                curve = curve.with_seconds(seconds).unwrap();
            }
            if pressed {
                curve = curve.with_pressure(steps.iter().copied().take(count).collect()).unwrap();
            }
            curve
        })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn json_reads_back_exactly(curve in any_curve()) {
        prop_assert_eq!(json(&to_json(&curve)).unwrap(), curve);
    }

    #[test]
    fn csv_reads_back_exactly_but_for_strokes(curve in any_curve()) {
        let read = csv(&to_csv(&curve)).unwrap();
        prop_assert_eq!(read.points(), curve.points());
        prop_assert_eq!(read.seconds(), curve.seconds());
        prop_assert_eq!(read.pressure(), curve.pressure());
    }

    #[test]
    fn svg_reads_back_in_shape(curve in any_curve()) {
        prop_assume!(curve.moves());
        let read = read_curve(to_svg(&curve).as_bytes(), Format::Svg).unwrap();
        let shape = |curve: &Curve| {
            let (bounds, points) = (curve.bounds(), curve.points().to_vec());
            let [width, height] = bounds.size();
            let longer = width.max(height);
            points.into_iter().map(move |p| [0, 1].map(|axis| (p[axis] - bounds.min[axis]) / longer)).collect::<Vec<_>>()
        };
        // A stroke of one point is written as a line without length, hence without repeats.
        let (mut read, mut drawn) = (shape(&read), shape(&curve));
        let same = |a: &mut [f64; 2], b: &mut [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-6;
        read.dedup_by(same);
        drawn.dedup_by(same);
        prop_assert_eq!(read.len(), drawn.len());
        for (a, b) in read.iter().zip(&drawn) {
            prop_assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-5, "{a:?} {b:?}");
        }
    }

    #[test]
    fn frames_stay_within_the_drawing(curve in any_curve(), frames in 1_usize..200, sigma in 0.0..20.0_f64) {
        prop_assume!(curve.moves());
        let timing = Timing::automatic(&curve, frames);
        let samples = resample(&curve, frames, timing).unwrap();
        prop_assert_eq!(samples.len(), frames);
        prop_assert_eq!(samples[0], curve.points()[0]);
        let bounds = curve.bounds();
        let slack = bounds.diagonal() * 1e-9;
        for point in &samples {
            for (value, (min, max)) in point.iter().zip(bounds.min.iter().zip(bounds.max)) {
                prop_assert!(*value >= min - slack && *value <= max + slack);
            }
        }
        for ends in [Ends::Open, Ends::Cyclic] {
            let smoothed = smooth(&samples, sigma, ends).unwrap();
            prop_assert_eq!(smoothed.len(), frames);
            prop_assert!(smoothed.iter().flatten().all(|value| value.is_finite()));
        }
    }
}
