//! The roundest closed line.

/// A head as a circle, pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Head {
    pub middle: [f32; 2],
    pub radius: f32,
    /// Half the width of its line.
    pub line: f32,
}

/// A part of the paper that lines enclose.
#[derive(Debug, Default)]
struct Hole {
    pixels: Vec<usize>,
    border: bool,
}

/// Finds a head: the enclosed paper that is most like a disc, and large rather than small, high rather than low.
pub(super) fn find_head(lines: &[bool], width: usize) -> Option<Head> {
    let height = lines.len() / width;
    let mut best: Option<(f32, Head)> = None;
    for hole in holes(lines, width) {
        let area = hole.pixels.len() as f32;
        let side = width as f32;
        if hole.border || area < 12.0 || area > 0.25 * side * side {
            continue;
        }
        let sum = |along: fn(usize, usize) -> usize| {
            hole.pixels.iter().map(|&at| along(at, width) as f32 + 0.5).sum::<f32>() / area
        };
        let middle = [sum(|at, width| at % width), sum(|at, width| at / width)];
        let radius = (area / std::f32::consts::PI).sqrt();
        // A disc has all of its area within its radius.
        let far = |at: &&usize| {
            let off =
                ((**at % width) as f32 + 0.5 - middle[0]).hypot((**at / width) as f32 + 0.5 - middle[1]);
            off > 1.15 * radius + 0.5
        };
        let outside = hole.pixels.iter().filter(far).count() as f32 / area;
        let round = 1.0 - 3.0 * outside;
        let high = 1.0 - middle[1] / height as f32;
        let score = round + 0.5 * high + 0.25 * (radius / (0.06 * side)).min(1.5);
        if round > 0.45 && best.as_ref().is_none_or(|(most, _)| score > *most) {
            best = Some((score, Head { middle, radius, line: line_width(lines, width, middle, radius) }));
        }
    }
    best.map(|(_, head)| head)
}

/// How far the line reaches beyond the circle, in most directions.
fn line_width(lines: &[bool], width: usize, middle: [f32; 2], radius: f32) -> f32 {
    let mut reaches: Vec<f32> = (0..32)
        .map(|turn| {
            let (sin, cos) = (turn as f32 / 32.0 * std::f32::consts::TAU).sin_cos();
            let line = |off: f32| {
                let (x, y) = (middle[0] + off * cos, middle[1] + off * sin);
                let inside = x >= 0.0 && y >= 0.0 && x < width as f32;
                inside && lines.get(y as usize * width + x as usize).copied().unwrap_or(false)
            };
            let mut last = 0.0;
            for step in 0..24 {
                let off = 0.5 * step as f32;
                if line(radius + off) {
                    last = off;
                } else if last > 0.0 || off > 3.0 {
                    break;
                }
            }
            last
        })
        .collect();
    reaches.sort_by(f32::total_cmp);
    reaches.get(reaches.len() * 2 / 3).copied().unwrap_or(1.0)
}

/// Paper in connected parts (by sides, not corners).
fn holes(lines: &[bool], width: usize) -> Vec<Hole> {
    let height = lines.len() / width;
    let (mut seen, mut holes) = (lines.to_vec(), Vec::new());
    let mut open = Vec::new();
    for start in 0..lines.len() {
        if seen[start] {
            continue;
        }
        let mut hole = Hole::default();
        seen[start] = true;
        open.push(start);
        while let Some(at) = open.pop() {
            hole.pixels.push(at);
            let (x, y) = (at % width, at / width);
            hole.border |= x == 0 || y == 0 || x + 1 == width || y + 1 == height;
            let sides = [
                (x > 0).then(|| at - 1),
                (x + 1 < width).then(|| at + 1),
                (y > 0).then(|| at - width),
                (y + 1 < height).then(|| at + width),
            ];
            for next in sides.into_iter().flatten() {
                if !seen[next] {
                    seen[next] = true;
                    open.push(next);
                }
            }
        }
        holes.push(hole);
    }
    holes
}
