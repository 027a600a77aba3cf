//! No bytes whatever make a reader panic. Runs a bounded number of random inputs under `cargo test`, and as long as wanted
//! under `cargo bolero test`.

use bolero::check;
use inkrig_sketch::{Format, Timing, read_curve, resample};

const ITERATIONS: usize = 4000;

/// Reads in every format, and brings what was read to frames.
fn read_all(bytes: &[u8]) {
    for format in [Format::Json, Format::Csv, Format::Svg, Format::sniff(bytes)] {
        if let Ok(curve) = read_curve(bytes, format) {
            let _ = resample(&curve, 24, Timing::automatic(&curve, 24));
        }
    }
}

/// Joins pieces that the bytes choose, so that random input gets past the first characters.
fn assemble(pieces: &[&str], bytes: &[u8]) -> String {
    bytes.iter().filter_map(|&byte| pieces.get(usize::from(byte) % pieces.len())).copied().collect()
}

#[test]
fn any_bytes() {
    check!().with_iterations(ITERATIONS).with_max_len(512).for_each(|bytes: &[u8]| read_all(bytes));
}

#[test]
fn json_pieces() {
    const PIECES: &[&str] = &[
        "[",
        "]",
        "{",
        "}",
        ",",
        ",",
        ":",
        "0",
        "1.5",
        "-2e3",
        "1e999",
        "null",
        "true",
        "\"x\":1",
        "\"y\":2",
        "\"t\":3",
        "\"pressure\":1",
        "\"points\":",
        "\"strokes\":",
        "[0,0]",
        "[1,2,3]",
        "\"",
        "\\u0000",
        "[[0,0],",
        "é",
    ];
    check!().with_iterations(ITERATIONS).with_max_len(96).for_each(|bytes: &[u8]| {
        read_all(assemble(PIECES, bytes).as_bytes());
        read_all(format!("[[0,0],[1,1]{}", assemble(PIECES, bytes)).as_bytes());
    });
}

#[test]
fn csv_pieces() {
    const PIECES: &[&str] = &[
        ",", ",", ";", "\t", "\n", "\n", "\r\n", "\r", "#", "\"", "x", "y", "t", "time", "pressure", "0",
        "1.5", "-2e3", "NaN", "inf", "1e999", " ", "\u{feff}", "é", "\0",
    ];
    check!().with_iterations(ITERATIONS).with_max_len(96).for_each(|bytes: &[u8]| {
        read_all(assemble(PIECES, bytes).as_bytes());
        read_all(format!("x,y,t\n0,0,0\n{}", assemble(PIECES, bytes)).as_bytes());
    });
}

#[test]
fn svg_elements() {
    const PIECES: &[&str] = &[
        "<g>",
        "<g id='a'>",
        "<g transform='scale(1e30)'>",
        "<g transform='scale(0)'>",
        "<g opacity='0'>",
        "</g>",
        "</g>",
        "<switch>",
        "</switch>",
        "<symbol id='b' viewBox='0 0 1 1e-30'>",
        "</symbol>",
        "<defs>",
        "</defs>",
        "<svg width='1e9' height='0'>",
        "<svg viewBox='0 0 -1 5'>",
        "</svg>",
        "<use href='#a'/>",
        "<use href='#b' width='1e30'/>",
        "<path d='M0 0L1 1'/>",
        "<path stroke='red' stroke-width='1e30' d='M1e15 0C1 1 -1e15 3 4 1e15z'/>",
        "<path id='p' stroke='red' transform='skewX(89.999) scale(1e-30 1e30)' d='M0 0C1 1 2 2 0 0'/>",
        "<rect width='1e38' height='1e38' rx='1e-38'/>",
        "<circle r='1e-44' cx='3e38'/>",
        "<ellipse rx='50%' ry='1em'/>",
        "<line x2='1' stroke='red'/>",
        "<polygon points='0 0 1 1 1'/>",
        "<polyline points='1e38 1e38 -1e38 0'/>",
        "<style>path{display:none}</style>",
        "<style>.a{fill:none} #p{stroke:url(#x)} @</style>",
        "<a>",
        "</a>",
        "<clipPath id='c'>",
        "</clipPath>",
        "<text>x</text>",
        "text",
        "&lt;",
        "&a;",
        "<!-- -->",
        "<![CDATA[x]]>",
        "<?a?>",
        "<b:c/>",
        "<path d='M0 0A1 1 0 01 5 5A1e-9 1e9 30 1 1 -5-5S1 2 3 4T5 6Q1 1 2 2' style='stroke:#000;stroke-linejoin:round'/>",
        "<g style='font-size:1e38em;transform:rotate(1e38)'>",
        "<g style='stroke:#123;fill:inherit;stroke-width:inherit'>",
    ];
    check!().with_iterations(ITERATIONS).with_max_len(64).for_each(|bytes: &[u8]| {
        let body = assemble(PIECES, bytes);
        let root =
            if bytes.len().is_multiple_of(2) { "viewBox='0 0 10 10'" } else { "width='1e9' height='1e-9'" };
        // Open elements are closed, so that more documents are well formed.
        let mut open = Vec::new();
        for tag in body.split('<').skip(1) {
            let name: String =
                tag.trim_start_matches('/').chars().take_while(char::is_ascii_alphabetic).collect();
            if tag.starts_with('/') {
                if open.last() == Some(&name) {
                    open.pop();
                }
            } else if !tag.contains("/>") && !name.is_empty() {
                open.push(name);
            }
        }
        let close: String = open.iter().rev().map(|name| format!("</{name}>")).collect();
        read_all(format!("<svg xmlns='http://www.w3.org/2000/svg' {root}>{body}{close}</svg>").as_bytes());
    });
}

#[test]
fn svg_path_data() {
    const PIECES: &[&str] = &[
        "M",
        "m",
        "L",
        "l",
        "H",
        "h",
        "V",
        "v",
        "C",
        "c",
        "S",
        "s",
        "Q",
        "q",
        "T",
        "t",
        "A",
        "a",
        "Z",
        "z",
        "0",
        "1",
        "2",
        "-3.5",
        ".5.5",
        "1e14",
        "-1e-14",
        "1e15",
        "9",
        " ",
        ",",
        "-",
        "0 0 1 1 ",
        "1 1 0 0 1 ",
        "1e",
        "+",
        "\n",
    ];
    check!().with_iterations(ITERATIONS).with_max_len(128).for_each(|bytes: &[u8]| {
        let data = assemble(PIECES, bytes);
        let text = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 10 10' stroke='red'><path d='M0 0 1 1{data}'/>\
             <path transform='{data}' d='{data}'/><polyline points='{data}'/></svg>"
        );
        read_all(text.as_bytes());
    });
}
