//! A storyboard as a painted page: a box for each frame, colours that say what lines are, and no words.

use inkrig_sketch::storyboard::{Frame, Kind, Storyboard, Stroke};

/// Red, green and blue of paper, and of each kind of line.
pub const COLOURS: [[u8; 3]; 6] =
    [[255, 255, 255], [26, 26, 30], [0, 160, 190], [240, 140, 0], [184, 184, 180], [150, 60, 190]];
/// Pixels of a panel, and of the paper around it.
const PANEL: [usize; 2] = [340, 320];
const GAP: usize = 16;
/// Pixels of a panel's box, of the pen, and of paper inside of a box.
const BOX: usize = 4;
const PEN: f64 = 4.5;
const MARGIN: f64 = 34.0;
/// Panels of a row.
const ROW: usize = 3;

/// Pixels as numbers of [`COLOURS`], rows from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Page {
    /// Pixels of a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width * height` of them.
    pub pixels: Vec<u8>,
}

impl Page {
    /// Paints a storyboard.
    pub fn of(board: &Storyboard) -> Self {
        let count = board.frames.len().max(1);
        let (columns, rows) = (count.min(ROW), count.div_ceil(ROW));
        let (width, height) = (GAP + columns * (PANEL[0] + GAP), GAP + rows * (PANEL[1] + GAP));
        let mut page = Self { width, height, pixels: vec![0; width * height] };
        for (at, frame) in board.frames.iter().enumerate() {
            page.panel(frame, [GAP + at % ROW * (PANEL[0] + GAP), GAP + at / ROW * (PANEL[1] + GAP)]);
        }
        page
    }

    /// Red, green and blue of all pixels.
    pub fn colours(&self) -> Vec<u8> {
        self.pixels
            .iter()
            .flat_map(|pixel| COLOURS.get(usize::from(*pixel)).copied().unwrap_or_default())
            .collect()
    }

    fn panel(&mut self, frame: &Frame, [left, top]: [usize; 2]) {
        for y in 0..PANEL[1] {
            for x in 0..PANEL[0] {
                let edge = x.min(y).min(PANEL[0] - 1 - x).min(PANEL[1] - 1 - y);
                if edge < BOX {
                    self.dot(left + x, top + y, number(Kind::Body));
                }
            }
        }
        let points = || frame.strokes().chain(&frame.scene).flat_map(|stroke| &stroke.points);
        let bound = |axis: usize| {
            points().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
                (low.min(point[axis]), high.max(point[axis]))
            })
        };
        let ((west, east), (south, north)) = (bound(0), bound(1));
        let room = PANEL.map(|size| size as f64 - 2.0 * MARGIN);
        let scale = (room[0] / (east - west).max(1.0)).min(room[1] / (north - south).max(1.0));
        let place = |[x, y]: [f64; 2]| {
            let (across, down) = (scale * (x - 0.5 * (west + east)), scale * (0.5 * (south + north) - y));
            [left as f64 + 0.5 * PANEL[0] as f64 + across, top as f64 + 0.5 * PANEL[1] as f64 + down]
        };
        let ways = frame.trajectories.iter().map(|way| &way.points);
        // Trajectories over all else: they are one line each.
        let lines: [(Kind, Vec<&Stroke>); 4] = [
            (Kind::Scene, frame.scene.iter().collect()),
            (Kind::Body, frame.body.iter().collect()),
            (Kind::Speed, frame.speed_lines.iter().collect()),
            (Kind::Trajectory, ways.collect()),
        ];
        for (kind, strokes) in lines {
            for stroke in strokes {
                for pair in stroke.points.windows(2) {
                    self.line(place(pair[0]), place(pair[1]), number(kind));
                }
            }
        }
    }

    fn line(&mut self, a: [f64; 2], b: [f64; 2], colour: u8) {
        let reach = 0.5 * PEN;
        let low = [0, 1].map(|axis| (a[axis].min(b[axis]) - reach).floor().max(0.0) as usize);
        let high = [0, 1].map(|axis| (a[axis].max(b[axis]) + reach).ceil().max(0.0) as usize);
        let (along, square) = ([b[0] - a[0], b[1] - a[1]], (b[0] - a[0]).powi(2) + (b[1] - a[1]).powi(2));
        for y in low[1]..=high[1] {
            for x in low[0]..=high[0] {
                let to = [x as f64 - a[0], y as f64 - a[1]];
                let share = ((to[0] * along[0] + to[1] * along[1]) / square.max(1e-9)).clamp(0.0, 1.0);
                if (to[0] - share * along[0]).hypot(to[1] - share * along[1]) < reach {
                    self.dot(x, y, colour);
                }
            }
        }
    }

    fn dot(&mut self, x: usize, y: usize, colour: u8) {
        if x < self.width
            && let Some(pixel) = self.pixels.get_mut(y * self.width + x)
        {
            *pixel = colour;
        }
    }

    /// The page as PNG: four bits a pixel, packed by runs alone.
    pub fn png(&self) -> Vec<u8> {
        let mut rows = Vec::new();
        for row in self.pixels.chunks(self.width) {
            rows.push(0);
            rows.extend(row.chunks(2).map(|pair| pair[0] << 4 | pair.get(1).copied().unwrap_or(0)));
        }
        let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
        let size = |number: usize| (number as u32).to_be_bytes();
        // Four bits, colours of a table.
        let header = [&size(self.width)[..], &size(self.height), &[4, 3, 0, 0, 0]].concat();
        chunk(&mut file, *b"IHDR", &header);
        chunk(&mut file, *b"PLTE", &COLOURS.concat());
        chunk(&mut file, *b"IDAT", &packed(&rows));
        chunk(&mut file, *b"IEND", &[]);
        file
    }
}

/// Which of [`COLOURS`] a kind of line has.
fn number(kind: Kind) -> u8 {
    match kind {
        Kind::Body => 1,
        Kind::Trajectory => 2,
        Kind::Speed => 3,
        Kind::Scene => 4,
        Kind::Lettering => 5,
    }
}

fn chunk(file: &mut Vec<u8>, name: [u8; 4], data: &[u8]) {
    file.extend((data.len() as u32).to_be_bytes());
    let body = [&name[..], data].concat();
    let crc = !body.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| crc >> 1 ^ (0xedb8_8320 & (crc & 1).wrapping_neg()))
    });
    file.extend(body);
    file.extend(crc.to_be_bytes());
}

/// As zlib has it (RFC 1950, 1951): one block of fixed codes, in which a byte that goes on is a match with the byte before it.
fn packed(data: &[u8]) -> Vec<u8> {
    let mut bits = Bits { out: vec![0x78, 0x01], held: 0, count: 0 };
    bits.put(0b011, 3);
    let mut at = 0;
    while let Some(&byte) = data.get(at) {
        bits.literal(u32::from(byte));
        at += 1;
        let mut run = data[at..].iter().take_while(|next| **next == byte).count();
        while run >= 3 {
            // The longest match is of 258 bytes; those of 3 to 10 need no bits more than their code.
            let length = if run >= 258 { 258 } else { run.min(10) };
            bits.literal(if length == 258 { 285 } else { 254 + length as u32 });
            bits.put(0, 5);
            at += length;
            run -= length;
        }
    }
    bits.literal(256);
    bits.put(0, 7);
    let (mut a, mut b) = (1_u32, 0_u32);
    for byte in data {
        a = (a + u32::from(*byte)) % 65_521;
        b = (b + a) % 65_521;
    }
    bits.out.extend((b << 16 | a).to_be_bytes());
    bits.out
}

/// Bits, the lowest of a byte first.
struct Bits {
    out: Vec<u8>,
    held: u32,
    count: u32,
}

impl Bits {
    fn put(&mut self, value: u32, bits: u32) {
        self.held |= value << self.count;
        self.count += bits;
        while self.count >= 8 {
            self.out.push(self.held as u8);
            self.held >>= 8;
            self.count -= 8;
        }
    }

    /// A literal or a length by the fixed codes, whose first bit is their highest.
    fn literal(&mut self, symbol: u32) {
        let (code, bits) = match symbol {
            0..144 => (0x30 + symbol, 8),
            144..256 => (0x190 + symbol - 144, 9),
            256..280 => (symbol - 256, 7),
            _ => (0xc0 + symbol - 280, 8),
        };
        (0..bits).rev().for_each(|bit| self.put(code >> bit & 1, 1));
    }
}
