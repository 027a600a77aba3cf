//! Visible paths of a parsed SVG as polylines.

use std::borrow::Cow;

use kurbo::{Affine, PathEl, Point};
use usvg::tiny_skia_path::{self, PathSegment, PathVerb};
use usvg::{Group, Node, Paint, PaintOrder, ShapeRendering, Transform};

use crate::builder::{CurveBuilder, Sample};
use crate::{Curve, Origin, SketchError, measure::Bounds};

/// How far a polyline may leave its curve, as a part of the drawing's diagonal.
const TOLERANCE: f64 = 1e-4;

/// All visible paths in document order, flattened, y up, and the tag of each stroke. `paths` is the path data that placeholders
/// stand for.
pub(super) fn flatten(root: &Group, paths: &[Vec<PathEl>]) -> Result<(Curve, Vec<u32>), SketchError> {
    let mut seen = Vec::new();
    collect(root, paths, &mut seen);
    let corners = seen.iter().flat_map(|path| path.elements().flat_map(control_points));
    let Some(bounds) = Bounds::around(corners.map(|point| [point.x, point.y])) else {
        return Err(SketchError::NothingVisible);
    };
    let tolerance = (bounds.diagonal() * TOLERANCE).max(f64::MIN_POSITIVE);
    let mut pen = Pen::default();
    for path in &seen {
        pen.tag = path.tag;
        for element in path.elements() {
            pen.draw(element, tolerance)?;
        }
    }
    let curve = pen.builder.finish(Origin::Outline).map_err(|_| SketchError::NothingVisible)?;
    Ok((curve, pen.tags))
}

struct Path<'a> {
    data: Cow<'a, [PathEl]>,
    /// From the path's own space to the page with y up.
    page_from_local: Affine,
    tag: u32,
}

impl Path<'_> {
    fn elements(&self) -> impl Iterator<Item = PathEl> + '_ {
        self.data.iter().map(|element| self.page_from_local * *element)
    }
}

/// Depth is bounded: the drawing was measured before it was parsed.
fn collect<'a>(group: &Group, paths: &'a [Vec<PathEl>], seen: &mut Vec<Path<'a>>) {
    if group.opacity().get() == 0.0 {
        return;
    }
    for node in group.children() {
        match node {
            Node::Group(group) => collect(group, paths, seen),
            Node::Path(path) if is_seen(path) => {
                let Transform { sx, kx, ky, sy, tx, ty } = path.abs_transform();
                let page_from_local = Affine::FLIP_Y * Affine::new([sx, ky, kx, sy, tx, ty].map(f64::from));
                seen.push(Path { data: outline(path.data(), paths), page_from_local, tag: tag(path) });
            }
            _ => {}
        }
    }
}

/// Paint travels in these two properties: see `style`.
fn is_seen(path: &usvg::Path) -> bool {
    let filled = path.paint_order() == PaintOrder::FillAndStroke
        && path.fill().is_some_and(|fill| fill.opacity().get() > 0.0);
    path.is_visible() && (filled || path.rendering_mode() == ShapeRendering::CrispEdges)
}

/// Tags travel as colours: see `clean`.
fn tag(path: &usvg::Path) -> u32 {
    match path.fill().map(usvg::Fill::paint) {
        Some(Paint::Color(colour)) => u32::from_be_bytes([0, colour.red, colour.green, colour.blue]),
        _ => 0,
    }
}

/// The path data that a placeholder stands for, or the outline of a shape.
fn outline<'a>(data: &tiny_skia_path::Path, paths: &'a [Vec<PathEl>]) -> Cow<'a, [PathEl]> {
    if let ([PathVerb::Move, PathVerb::Line, PathVerb::Line], Some(point)) =
        (data.verbs(), data.points().first())
    {
        return paths.get(point.x as usize).map(Vec::as_slice).unwrap_or_default().into();
    }
    let place = |point: tiny_skia_path::Point| Point::new(point.x.into(), point.y.into());
    let elements = data.segments().map(|segment| match segment {
        PathSegment::MoveTo(end) => PathEl::MoveTo(place(end)),
        PathSegment::LineTo(end) => PathEl::LineTo(place(end)),
        PathSegment::QuadTo(control, end) => PathEl::QuadTo(place(control), place(end)),
        PathSegment::CubicTo(leave, arrive, end) => PathEl::CurveTo(place(leave), place(arrive), place(end)),
        PathSegment::Close => PathEl::ClosePath,
    });
    elements.collect()
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
    /// Where the current subpath began, and where the pen is.
    start: Point,
    at: Point,
    /// The pen was moved and has not drawn yet: a move alone draws nothing.
    lifted: bool,
    /// Of the path that is drawn, and of every stroke so far.
    tag: u32,
    tags: Vec<u32>,
}

impl Pen {
    /// Draws one element. One at a time, so that the limit of points stops the flattening.
    fn draw(&mut self, element: PathEl, tolerance: f64) -> Result<(), SketchError> {
        if let PathEl::MoveTo(point) = element {
            (self.start, self.at, self.lifted) = (point, point, true);
            return Ok(());
        }
        if std::mem::take(&mut self.lifted) {
            self.builder.begin_stroke();
            self.tags.push(self.tag);
            self.push(self.start)?;
        }
        match element {
            PathEl::MoveTo(_) => Ok(()),
            PathEl::LineTo(point) => self.push(point),
            PathEl::ClosePath => self.push(self.start),
            PathEl::QuadTo(..) | PathEl::CurveTo(..) => {
                let mut result = Ok(());
                kurbo::flatten([PathEl::MoveTo(self.at), element], tolerance, |line| {
                    if let (PathEl::LineTo(point), true) = (line, result.is_ok()) {
                        result = self.push(point);
                    }
                });
                result
            }
        }
    }

    fn push(&mut self, point: Point) -> Result<(), SketchError> {
        self.at = point;
        let sample = Sample { point: [point.x, point.y], seconds: None, pressure: None };
        self.builder.push(sample).map_err(SketchError::from)
    }
}
