//! Visible paths of a parsed SVG as polylines.

use kurbo::{PathEl, Point};
use usvg::tiny_skia_path::{self, PathSegment};
use usvg::{Group, Node, Transform};

use crate::builder::{CurveBuilder, Sample};
use crate::{Curve, Origin, SketchError, measure::Bounds};

/// How far a polyline may leave its curve, as a part of the drawing's diagonal.
const TOLERANCE: f64 = 1e-4;

/// All visible paths in document order, flattened, y up.
pub(super) fn flatten(root: &Group) -> Result<Curve, SketchError> {
    let mut paths = Vec::new();
    collect(root, &mut paths);
    let corners = paths.iter().flat_map(|path| path.elements().flat_map(control_points));
    let Some(bounds) = Bounds::around(corners.map(|point| [point.x, point.y])) else {
        return Err(SketchError::NothingVisible);
    };
    let tolerance = (bounds.diagonal() * TOLERANCE).max(f64::MIN_POSITIVE);
    let mut pen = Pen::default();
    for path in &paths {
        let mut from = None;
        for element in path.elements() {
            let end = element.end_point();
            pen.draw(from, element, tolerance)?;
            from = end.or(pen.start);
        }
    }
    pen.builder.finish(Origin::Outline)
}

struct Path<'a> {
    data: &'a tiny_skia_path::Path,
    page_from_local: Transform,
}

impl Path<'_> {
    /// The path on the page, with y up.
    fn elements(&self) -> impl Iterator<Item = PathEl> + '_ {
        let Transform { sx, kx, ky, sy, tx, ty } = self.page_from_local;
        let [sx, kx, ky, sy, tx, ty] = [sx, kx, ky, sy, tx, ty].map(f64::from);
        let place = move |point: tiny_skia_path::Point| {
            let (x, y) = (f64::from(point.x), f64::from(point.y));
            Point::new(sx * x + kx * y + tx, -(ky * x + sy * y + ty))
        };
        self.data.segments().map(move |segment| match segment {
            PathSegment::MoveTo(end) => PathEl::MoveTo(place(end)),
            PathSegment::LineTo(end) => PathEl::LineTo(place(end)),
            PathSegment::QuadTo(control, end) => PathEl::QuadTo(place(control), place(end)),
            PathSegment::CubicTo(leave, arrive, end) => {
                PathEl::CurveTo(place(leave), place(arrive), place(end))
            }
            PathSegment::Close => PathEl::ClosePath,
        })
    }
}

/// Depth is bounded: the drawing was measured before it was parsed.
fn collect<'a>(group: &'a Group, paths: &mut Vec<Path<'a>>) {
    if group.opacity().get() == 0.0 {
        return;
    }
    for node in group.children() {
        match node {
            Node::Group(group) => collect(group, paths),
            Node::Path(path) if is_seen(path) => {
                paths.push(Path { data: path.data(), page_from_local: path.abs_transform() });
            }
            _ => {}
        }
    }
}

fn is_seen(path: &usvg::Path) -> bool {
    let opacities = [path.fill().map(usvg::Fill::opacity), path.stroke().map(usvg::Stroke::opacity)];
    path.is_visible() && opacities.into_iter().flatten().any(|opacity| opacity.get() > 0.0)
}

fn control_points(element: PathEl) -> impl Iterator<Item = Point> {
    let points = match element {
        PathEl::MoveTo(a) | PathEl::LineTo(a) => [Some(a), None, None],
        PathEl::QuadTo(a, b) => [Some(a), Some(b), None],
        PathEl::CurveTo(a, b, c) => [Some(a), Some(b), Some(c)],
        PathEl::ClosePath => [None; 3],
    };
    points.into_iter().flatten()
}

#[derive(Default)]
struct Pen {
    builder: CurveBuilder,
    /// Where the current subpath began.
    start: Option<Point>,
}

impl Pen {
    /// Draws one element from a point. One at a time, so that the limit of points stops the flattening.
    fn draw(&mut self, from: Option<Point>, element: PathEl, tolerance: f64) -> Result<(), SketchError> {
        match element {
            PathEl::MoveTo(point) => {
                self.start = Some(point);
                self.builder.begin_stroke();
                self.push(point)
            }
            PathEl::LineTo(point) => self.push(point),
            PathEl::ClosePath => self.start.map_or(Ok(()), |start| self.push(start)),
            PathEl::QuadTo(..) | PathEl::CurveTo(..) => {
                let mut result = Ok(());
                kurbo::flatten(from.map(PathEl::MoveTo).into_iter().chain([element]), tolerance, |line| {
                    if let (PathEl::LineTo(point), true) = (line, result.is_ok()) {
                        result = self.push(point);
                    }
                });
                result
            }
        }
    }

    fn push(&mut self, point: Point) -> Result<(), SketchError> {
        let sample = Sample { point: [point.x, point.y], seconds: None, pressure: None };
        self.builder.push(sample).map_err(SketchError::from)
    }
}
