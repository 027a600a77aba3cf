//! Path data of SVG: the `d` of a path, the `points` of a polyline (SVG 1.1, sections 8.3 and 9.7.1).
//!
//! Read here, in double precision, because an arc of hostile size must not become millions of pieces, and because a
//! mistake should be told instead of cutting the drawing short.

use kurbo::{Arc, PathEl, Point, SvgArc, Vec2};

use crate::limits::MAX_MAGNITUDE;

/// How far the pieces of an arc may leave it, as a part of its radius.
const ARC_TOLERANCE: f64 = 1e-6;

/// Why path data was refused.
#[derive(Debug, PartialEq)]
pub(super) enum Fault {
    /// There are more pieces than a drawing may have points.
    Full,
    /// The problem, with the number of the character where it is.
    Wrong(String),
}

/// The pieces of a path; `room` is how many more the drawing may have.
pub(super) fn parse_path(data: &str, room: &mut usize) -> Result<Vec<PathEl>, Fault> {
    let mut reader = Reader::new(data, room);
    reader.skip_separators();
    let mut command = None;
    while let Some(&next) = reader.rest.first() {
        if next.is_ascii_alphabetic() {
            reader.rest = reader.rest.get(1..).unwrap_or_default();
            command = Some(next);
        } else {
            // Numbers alone repeat the command; after a move they draw lines.
            command = match command {
                Some(b'M') => Some(b'L'),
                Some(b'm') => Some(b'l'),
                Some(b'Z' | b'z') => return Err(reader.wrong("a command is expected after Z")),
                other => other,
            };
        }
        let command = command.ok_or_else(|| reader.wrong("a path begins with M"))?;
        if reader.elements.is_empty() && !matches!(command, b'M' | b'm') {
            return Err(reader.wrong("a path begins with M"));
        }
        reader.draw(command)?;
        reader.skip_separators();
    }
    Ok(reader.elements)
}

/// The lines of a polyline or polygon.
pub(super) fn parse_points(data: &str, closed: bool, room: &mut usize) -> Result<Vec<PathEl>, Fault> {
    let mut reader = Reader::new(data, room);
    reader.skip_separators();
    while !reader.rest.is_empty() {
        reader.draw(if reader.elements.is_empty() { b'M' } else { b'L' })?;
        reader.skip_separators();
    }
    if closed && !reader.elements.is_empty() {
        reader.push(PathEl::ClosePath)?;
    }
    Ok(reader.elements)
}

struct Reader<'a> {
    length: usize,
    rest: &'a [u8],
    room: &'a mut usize,
    elements: Vec<PathEl>,
    /// Where the pen is, and where the subpath began.
    pen: Point,
    start: Point,
    /// The last control point of the last cubic and quadratic piece, which a smooth piece mirrors.
    cubic_control: Option<Point>,
    quad_control: Option<Point>,
}

impl<'a> Reader<'a> {
    fn new(data: &'a str, room: &'a mut usize) -> Self {
        let (length, rest) = (data.len(), data.as_bytes());
        let (pen, start) = (Point::ZERO, Point::ZERO);
        Self { length, rest, room, elements: Vec::new(), pen, start, cubic_control: None, quad_control: None }
    }

    fn draw(&mut self, command: u8) -> Result<(), Fault> {
        let base = if command.is_ascii_lowercase() { self.pen.to_vec2() } else { Vec2::ZERO };
        let (cubic_before, quad_before) = (self.cubic_control.take(), self.quad_control.take());
        match command.to_ascii_uppercase() {
            b'M' => {
                self.start = self.point(base)?;
                self.pen = self.start;
                self.push(PathEl::MoveTo(self.pen))
            }
            b'Z' => {
                self.pen = self.start;
                self.push(PathEl::ClosePath)
            }
            b'L' => {
                let end = self.point(base)?;
                self.line(end)
            }
            b'H' => {
                let end = Point::new(self.number()? + base.x, self.pen.y);
                self.line(end)
            }
            b'V' => {
                let end = Point::new(self.pen.x, self.number()? + base.y);
                self.line(end)
            }
            b'C' => {
                let leave = self.point(base)?;
                self.cubic(leave, base)
            }
            b'S' => {
                let leave = self.mirrored(cubic_before);
                self.cubic(leave, base)
            }
            b'Q' => {
                let control = self.point(base)?;
                self.quadratic(control, base)
            }
            b'T' => {
                let control = self.mirrored(quad_before);
                self.quadratic(control, base)
            }
            b'A' => self.arc(base),
            _ => Err(self.wrong("this letter is no command of a path")),
        }
    }

    fn mirrored(&self, control: Option<Point>) -> Point {
        control.map_or(self.pen, |control| (2.0 * self.pen.to_vec2() - control.to_vec2()).to_point())
    }

    fn line(&mut self, end: Point) -> Result<(), Fault> {
        self.pen = end;
        self.push(PathEl::LineTo(end))
    }

    fn cubic(&mut self, leave: Point, base: Vec2) -> Result<(), Fault> {
        let (arrive, end) = (self.point(base)?, self.point(base)?);
        (self.cubic_control, self.pen) = (Some(arrive), end);
        self.push(PathEl::CurveTo(leave, arrive, end))
    }

    fn quadratic(&mut self, control: Point, base: Vec2) -> Result<(), Fault> {
        let end = self.point(base)?;
        (self.quad_control, self.pen) = (Some(control), end);
        self.push(PathEl::QuadTo(control, end))
    }

    fn arc(&mut self, base: Vec2) -> Result<(), Fault> {
        let radii = Vec2::new(self.number()?, self.number()?);
        let x_rotation = self.number()?.to_radians();
        let (large_arc, sweep) = (self.flag()?, self.flag()?);
        let (from, to) = (self.pen, self.point(base)?);
        let svg_arc = SvgArc { from, to, radii, x_rotation, large_arc, sweep };
        if let Some(arc) = Arc::from_svg_arc(&svg_arc) {
            // Relative to the radius, an arc has at most a dozen pieces.
            let radius = arc.radii.x.abs().max(arc.radii.y.abs());
            let whole = [radius, arc.start_angle, arc.sweep_angle, arc.center.x, arc.center.y]
                .iter()
                .all(|v| v.is_finite());
            if !whole {
                return Err(self.wrong("this arc is too large for its ends"));
            }
            for piece in arc.append_iter((radius * ARC_TOLERANCE).max(f64::MIN_POSITIVE)) {
                self.push(piece)?;
            }
        }
        // Rounding of the last piece, or an arc without radius: a line.
        self.line(to)
    }

    fn push(&mut self, element: PathEl) -> Result<(), Fault> {
        *self.room = self.room.checked_sub(1).ok_or(Fault::Full)?;
        self.elements.push(element);
        Ok(())
    }

    fn point(&mut self, base: Vec2) -> Result<Point, Fault> {
        Ok(Point::new(self.number()? + base.x, self.number()? + base.y))
    }

    fn flag(&mut self) -> Result<bool, Fault> {
        self.skip_separators();
        let (flag, rest) = match self.rest {
            [b'0', rest @ ..] => (false, rest),
            [b'1', rest @ ..] => (true, rest),
            _ => return Err(self.wrong("a flag of an arc, 0 or 1, is expected")),
        };
        self.rest = rest;
        Ok(flag)
    }

    fn number(&mut self) -> Result<f64, Fault> {
        self.skip_separators();
        let (text, rest) = self.rest.split_at_checked(number_length(self.rest)).unwrap_or_default();
        let value = std::str::from_utf8(text).ok().and_then(|text| text.parse::<f64>().ok());
        let value = value.ok_or_else(|| self.wrong("a number is expected"))?;
        if value.abs() > MAX_MAGNITUDE {
            return Err(self.wrong(&format!("this number is too large; at most {MAX_MAGNITUDE:e} is read")));
        }
        self.rest = rest;
        Ok(value)
    }

    fn skip_separators(&mut self) {
        while let [b' ' | b'\t' | b'\n' | b'\r' | b'\x0C' | b',', rest @ ..] = self.rest {
            self.rest = rest;
        }
    }

    fn wrong(&self, problem: &str) -> Fault {
        Fault::Wrong(format!("character {}: {problem}", self.length - self.rest.len() + 1))
    }
}

/// Bytes of the number at the front: sign, digits, fraction, exponent.
fn number_length(bytes: &[u8]) -> usize {
    let at = |index: usize| bytes.get(index).copied().unwrap_or_default();
    let digits = |from: usize| bytes.iter().skip(from).take_while(|byte| byte.is_ascii_digit()).count();
    let sign = |index: usize| usize::from(matches!(at(index), b'+' | b'-'));
    let mut length = sign(0);
    length += digits(length);
    if at(length) == b'.' {
        length += 1 + digits(length + 1);
    }
    if matches!(at(length), b'e' | b'E') {
        let exponent = length + 1 + sign(length + 1);
        // "1em" is a number and a unit.
        if digits(exponent) > 0 {
            length = exponent + digits(exponent);
        }
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::MAX_POINTS;

    fn parse(data: &str) -> Result<Vec<PathEl>, Fault> {
        parse_path(data, &mut MAX_POINTS.clone())
    }

    #[test]
    fn it_reads_what_kurbo_reads() {
        for data in [
            "M10-20.5.5 1e1z",
            "m1,1 2,2-3-3",
            "M0 0h1v2H3V4z m1 1l1 0",
            "M0 0C1 2 3 4 5 6s1 1 2 2S0 0 1 1",
            "M0 0q1 1 2 0t2 0T9 9",
            "M0 0L1 1s1 1 2 2",
            "M0 0l1 1t2 2",
        ] {
            assert_eq!(parse(data).unwrap(), kurbo::BezPath::from_svg(data).unwrap().elements(), "{data}");
        }
    }

    #[test]
    fn an_arc_is_round_and_ends_where_it_should() {
        let half = parse("M0 0a5 5 0 0110 0").unwrap();
        assert_eq!(half.last(), Some(&PathEl::LineTo(Point::new(10.0, 0.0))));
        kurbo::flatten(half, 1e-4, |element| {
            let Some(point) = element.end_point() else { return };
            assert!((point.distance(Point::new(5.0, 0.0)) - 5.0).abs() < 1e-3, "{point:?}");
            assert!(point.y < 1e-9, "clockwise on the page is up: {point:?}");
        });
        for wild in [
            "M0 0A1e15 2e-5 30 1 1 1e15 1e15",
            "M0 0A1e-4 1e14 0 0 0 1e15 0",
            "M0 0A1 1 0 0 0 0 0",
            "M0 0A0 1 0 0 0 5 5",
        ] {
            assert!(parse(wild).unwrap().len() < 20, "{wild}");
        }
    }

    #[test]
    fn mistakes_are_told() {
        for (data, problem) in [
            ("L1 1", "character 2: a path begins with M"),
            ("1 1", "character 1: a path begins with M"),
            ("M1", "character 3: a number is expected"),
            ("M0 0 x", "character 7: this letter is no command"),
            ("M0 0z1 1", "character 6: a command is expected after Z"),
            ("M0 0 A1 1 0 2 0 1 1", "character 13: a flag"),
            ("M0 0 1e200.5 1", "character 6: this number is too large"),
            ("M0 0 é", "character 6: a number is expected"),
        ] {
            let Err(Fault::Wrong(said)) = parse(data) else { panic!("{data}") };
            assert!(said.starts_with(problem), "{data}: {said}");
        }
        assert_eq!(parse_path("M0 0h1h1h1", &mut 3), Err(Fault::Full));
        assert_eq!(parse("").unwrap(), []);
    }

    #[test]
    fn points_make_lines() {
        let triangle = parse_points(" 0,0 1-1,2.5.5 ", true, &mut MAX_POINTS.clone()).unwrap();
        let [a, b, c] = [(0.0, 0.0), (1.0, -1.0), (2.5, 0.5)].map(Point::from);
        assert_eq!(triangle, [PathEl::MoveTo(a), PathEl::LineTo(b), PathEl::LineTo(c), PathEl::ClosePath]);
        assert_eq!(parse_points("", true, &mut MAX_POINTS.clone()).unwrap(), []);
    }
}
