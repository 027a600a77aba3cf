//! No drawing, wave, list of labels or table makes its reader take more than 16 times its bytes and 64 MiB.
#![allow(
    unsafe_code,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "counting what is allocated takes an allocator, which is unsafe by nature; the test prints its table"
)]

use inkrig_sketch::storyboard::{read_storyboard, read_storyboard_svg};
use inkrig_sketch::{Format, read_curve, read_labels, read_table, read_wave};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

struct Counting;

static LIVE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is handed to the system's allocator unchanged; the counters do not touch memory.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let live = LIVE.fetch_add(layout.size(), Relaxed) + layout.size();
        PEAK.fetch_max(live, Relaxed);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        LIVE.fetch_sub(layout.size(), Relaxed);
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn peak(work: impl FnOnce() -> bool) -> (usize, bool) {
    let before = LIVE.load(Relaxed);
    PEAK.store(before, Relaxed);
    let read = work();
    (PEAK.load(Relaxed) - before, read)
}

// The only test of its file: others at the same time would be counted too.
#[test]
fn no_drawing_takes_more_than_its_share() {
    let svg = |inside: &str| format!("<svg xmlns=\"http://www.w3.org/2000/svg\">{inside}</svg>");
    let doubled: String = (0..30)
        .map(|level| {
            let below = format!("<use href=\"#g{}\"/>", level - 1).repeat(2);
            format!("<g id=\"g{level}\">{}</g>", if level == 0 { "<path d=\"M0 0L1 1\"/>" } else { &below })
        })
        .collect();
    // A path in a group in groups of two, which make 8,000 of it out of a kilobyte.
    let halved = doubled.split_inclusive("</g>").take(13).collect::<String>();
    let entities = "<!DOCTYPE svg [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;\">\
        <!ENTITY c \"&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;\"><!ENTITY d \"&c;&c;&c;&c;&c;&c;&c;&c;&c;&c;\">]>";
    let board = |inside: &str| format!("{{\"inkrig_storyboard\": 1, \"frames\": [{inside}]}}");
    let cases = [
        ("storyboard of frames", Format::Json, board(&format!("{}{{}}", "{},".repeat(1 << 15)))),
        (
            "storyboard of strokes",
            Format::Json,
            board(&format!("{{\"body\": [{}[[0,0]]]}}", "[[1,2]],".repeat(1 << 18))),
        ),
        (
            "storyboard of points",
            Format::Json,
            board(&format!("{{\"scene\": [[{}[0,0,0,1]]]}}", "[1,2,0,1],".repeat(1 << 18))),
        ),
        (
            "storyboard of trajectories",
            Format::Json,
            board(&format!(
                "{{\"trajectories\": [{}{{\"points\":[[0,0]]}}]}}",
                "{\"points\":[[1,2]]},".repeat(49_000)
            )),
        ),
        ("CSV of short rows", Format::Csv, "1,2\n".repeat(1 << 18)),
        ("CSV of one long row", Format::Csv, "1,".repeat(1 << 19)),
        ("CSV of quotes", Format::Csv, "\"".repeat(1 << 20)),
        ("CSV of none", Format::Csv, "nan,inf\n".repeat(1 << 16)),
        ("JSON of points", Format::Json, format!("[{}[0,0]]", "[1,2],".repeat(1 << 17))),
        ("JSON of strokes", Format::Json, format!("[{}[[0,0]]]", "[[1,2]],".repeat(1 << 17))),
        ("JSON of empty lists", Format::Json, format!("[{}[]]", "[],".repeat(1 << 18))),
        ("nested JSON", Format::Json, "[".repeat(1 << 20)),
        ("JSON of numbers", Format::Json, format!("[{}0]", "1,".repeat(1 << 19))),
        ("SVG of groups", Format::Svg, svg(&"<g/>".repeat(49_000))),
        ("nested SVG", Format::Svg, format!("<svg>{}", "<g>".repeat(1 << 18))),
        ("SVG of many groups", Format::Svg, svg(&"<g/>".repeat(1 << 20))),
        ("deeply nested SVG", Format::Svg, format!("<svg>{}", "<g>".repeat(1 << 21))),
        ("SVG of one long path", Format::Svg, svg(&format!("<path d=\"M0 0{}\"/>", "h1v1".repeat(1 << 20)))),
        (
            "SVG of many arcs",
            Format::Svg,
            svg(&format!("<path d=\"M0 0{}\"/>", "a9e9 9e9 0 1 1 1 1".repeat(1 << 18))),
        ),
        ("SVG of many paths", Format::Svg, svg(&"<path d=\"M0 0h1\"/>".repeat(49_000))),
        ("SVG of texts", Format::Svg, svg(&"a<g/>".repeat(1 << 19))),
        ("SVG of attributes", Format::Svg, svg(&"<g a=\"\" b=\"\" c=\"\" d=\"\"/>".repeat(1 << 17))),
        ("SVG of uses that make many", Format::Svg, svg(&halved)),
        ("SVG of uses that double", Format::Svg, svg(&doubled)),
        (
            "SVG of entities",
            Format::Svg,
            format!("{entities}<svg><path d=\"{}\"/></svg>", "&d;".repeat(1000)),
        ),
        ("SVG of one path", Format::Svg, svg(&format!("<path d=\"M0 0{}\"/>", "h1v1".repeat(1 << 17)))),
        (
            "SVG of curves",
            Format::Svg,
            svg(&format!("<path d=\"M0 0{}\"/>", "c1 1e9 2 -1e9 3 3".repeat(1 << 14))),
        ),
        (
            "SVG of arcs",
            Format::Svg,
            svg(&format!("<path d=\"M0 0{}\"/>", "a9e9 9e9 0 1 1 1 1".repeat(1 << 14))),
        ),
        ("SVG that uses itself", Format::Svg, svg("<g id=\"a\"><use href=\"#a\"/></g><use href=\"#a\"/>")),
        (
            "SVG of pictures",
            Format::Svg,
            svg("<image href=\"../../x.png\"/><image href=\"file:///dev/zero\"/>"),
        ),
    ];
    println!("{:<28}{:>10}{:>12}{:>8}", "case", "bytes", "peak", "share");
    for (name, format, text) in &cases {
        let bytes = text.as_bytes();
        let readers: [(&str, &dyn Fn() -> bool); 6] = [
            ("storyboard", &|| read_storyboard(bytes).is_ok()),
            ("storyboard as SVG", &|| read_storyboard_svg(bytes).is_ok()),
            ("curve", &|| read_curve(bytes, *format).is_ok()),
            ("wave", &|| read_wave(bytes, *format).is_ok()),
            ("labels", &|| read_labels(bytes, *format).is_ok()),
            ("table", &|| read_table(bytes).is_ok()),
        ];
        for (reader, read) in readers {
            let (peak, read) = peak(read);
            let allowed = 16 * bytes.len() + (64 << 20);
            let share = 100.0 * peak as f64 / allowed as f64;
            println!("{:<28}{:>10}{peak:>12}{share:>7.0}%  {read}", format!("{name}, {reader}"), bytes.len());
            assert!(peak <= allowed, "{name} as {reader}: {peak} bytes for {}", bytes.len());
        }
    }
}
