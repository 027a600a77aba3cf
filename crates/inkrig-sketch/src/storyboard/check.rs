//! What a storyboard holds to, and what is said of one that does not.

use super::{Frame, Storyboard, Stroke};
use crate::SketchError;
use crate::builder::{check_pressure, check_time};
use crate::limits::{
    MAX_MAGNITUDE, MAX_STORYBOARD_FRAMES, MAX_STORYBOARD_NUMBER, MAX_STORYBOARD_PIN_PAGES,
    MAX_STORYBOARD_POINTS, MAX_STORYBOARD_SECONDS, MAX_STORYBOARD_TAKES, MAX_STORYBOARD_TEXT,
    MIN_STORYBOARD_SECONDS,
};

impl Storyboard {
    /// Whether it can be used: numbers finite and in their ranges, lists within the limits, times that do not go back.
    ///
    /// # Errors
    /// [`SketchError::Storyboard`] with the first that is wrong: where, what, and what to do.
    pub fn check(&self) -> Result<(), SketchError> {
        let wrong =
            |place: &str, problem: String| Err(SketchError::Storyboard { place: place.into(), problem });
        if self.frames.is_empty() {
            return wrong("frames", "there is no frame. Draw at least one".into());
        }
        if self.frames.len() > MAX_STORYBOARD_FRAMES {
            let problem = format!(
                "there are {}; at most {MAX_STORYBOARD_FRAMES} are read. Split it",
                self.frames.len()
            );
            return wrong("frames", problem);
        }
        text("title", &self.title)?;
        let mut points = 0;
        for (number, frame) in self.frames.iter().enumerate() {
            frame.check(number + 1, &mut points)?;
        }
        Ok(())
    }
}

impl Frame {
    /// As [`Storyboard::check`], of the frame with this number; points are added up.
    fn check(&self, number: usize, points: &mut usize) -> Result<(), SketchError> {
        let wrong = |place: &str, problem: String| {
            Err(SketchError::Storyboard { place: format!("frame {number}, {place}"), problem })
        };
        for (name, value) in [("word", &self.word), ("notes", &self.notes)] {
            text(&format!("frame {number}, {name}"), value)?;
        }
        if let Some(seconds) = self.seconds
            && !(MIN_STORYBOARD_SECONDS..=MAX_STORYBOARD_SECONDS).contains(&seconds)
        {
            let range = format!("{MIN_STORYBOARD_SECONDS} to {MAX_STORYBOARD_SECONDS}");
            return wrong("seconds", format!("{seconds} is not {range}"));
        }
        if self.take >= MAX_STORYBOARD_TAKES {
            let most = MAX_STORYBOARD_TAKES - 1;
            return wrong("take", format!("{} is not 0 (the best) to {most}", self.take));
        }
        if self.number.is_some_and(|number| !(1..=MAX_STORYBOARD_NUMBER).contains(&number)) {
            let problem = format!("{} is not 1 to {MAX_STORYBOARD_NUMBER}", self.number.unwrap_or_default());
            return wrong("number", problem);
        }
        let camera = self.camera;
        if !(-90.0..=90.0).contains(&camera.pitch_degrees) || !(-180.0..=180.0).contains(&camera.yaw_degrees)
        {
            let (pitch, yaw) = (camera.pitch_degrees, camera.yaw_degrees);
            let problem = format!(
                "pitch {pitch} and yaw {yaw} are no view. Give a pitch of -90 to 90 degrees and a yaw of -180 to 180"
            );
            return wrong("camera", problem);
        }
        let ways: Vec<&Stroke> = self.trajectories.iter().map(|way| &way.points).collect();
        let kinds: [(&str, Vec<&Stroke>); 5] = [
            ("body", self.body.iter().collect()),
            ("trajectory", ways),
            ("speed line", self.speed_lines.iter().collect()),
            ("scene", self.scene.iter().collect()),
            ("lettering", self.lettering.iter().collect()),
        ];
        for (kind, strokes) in kinds {
            for (at, stroke) in strokes.into_iter().enumerate() {
                *points += stroke.points.len();
                if *points > MAX_STORYBOARD_POINTS {
                    let problem =
                        format!("here the storyboard passes {MAX_STORYBOARD_POINTS} points. Draw it simpler");
                    return wrong(kind, problem);
                }
                if let Err((point, problem)) = stroke.check() {
                    return wrong(&format!("{kind} {}, point {point}", at + 1), problem);
                }
            }
        }
        let page = if self.pins.is_empty() { None } else { self.page() };
        for pin in &self.pins {
            text(&format!("frame {number}, pin"), &pin.joint)?;
            if let Some(number) = pin.at.iter().find(|number| !is_place(**number)) {
                return wrong(&format!("pin of {}", pin.joint), format!("{number} is no place"));
            }
            if let Some((pages, size)) = page.and_then(|page| off_page(page, pin.at)) {
                let problem = format!(
                    "{:?} is {pages:.0} times as far off the drawing as it is large ({size:.0}); at most {MAX_STORYBOARD_PIN_PAGES} \
                     times are read. Pin it on the drawing, in the same units as its lines",
                    pin.at
                );
                return wrong(&format!("pin of {}", pin.joint), problem);
            }
        }
        for joint in self.trajectories.iter().filter_map(|way| way.joint.as_ref()) {
            text(&format!("frame {number}, trajectory's joint"), joint)?;
        }
        self.check_space(number)
    }
}

impl Frame {
    /// The smallest and the largest coordinates of what is drawn; none where nothing is.
    fn page(&self) -> Option<[[f64; 2]; 2]> {
        let points = self.strokes().chain(&self.scene).flat_map(|stroke| &stroke.points);
        points.fold(None, |page, &[x, y]| {
            let [[left, low], [right, high]] = page.unwrap_or([[x, y]; 2]);
            Some([[left.min(x), low.min(y)], [right.max(x), high.max(y)]])
        })
    }
}

/// How far a place is off a page, in longer sides of it, and that side; none where it is near enough, or the page is a point.
fn off_page([[left, low], [right, high]]: [[f64; 2]; 2], [x, y]: [f64; 2]) -> Option<(f64, f64)> {
    let beyond = |least: f64, at: f64, most: f64| (least - at).max(at - most).max(0.0);
    let size = (right - left).max(high - low);
    let pages = beyond(left, x, right).max(beyond(low, y, high)) / size;
    (size > 0.0 && pages > MAX_STORYBOARD_PIN_PAGES).then_some((pages, size))
}

impl Stroke {
    /// The first point that is wrong, and why.
    fn check(&self) -> Result<(), (usize, String)> {
        if self.points.is_empty() {
            return Err((0, "the stroke has no point. Leave it out".into()));
        }
        for (at, point) in self.points.iter().enumerate() {
            if let Some(number) = point.iter().find(|number| !is_place(**number)) {
                let problem = format!("{number} is no coordinate. At most {MAX_MAGNITUDE:e} is read");
                return Err((at, problem));
            }
        }
        for (list, what) in [(&self.seconds, "times"), (&self.pressure, "pressures")] {
            if let Some(list) = list
                && list.len() != self.points.len()
            {
                let (points, values) = (self.points.len(), list.len());
                return Err((0, format!("{points} points, but {values} {what}. Give one for each, or none")));
            }
        }
        if self.pressure.is_some() && self.seconds.is_none() {
            return Err((0, "there is pressure without time. Give both, or time alone".into()));
        }
        let mut before = None;
        for (at, &time) in self.seconds.iter().flatten().enumerate() {
            check_time(time, before).map_err(|problem| (at, problem))?;
            before = Some(time);
        }
        for (at, &pressure) in self.pressure.iter().flatten().enumerate() {
            check_pressure(pressure).map_err(|problem| (at, problem))?;
        }
        Ok(())
    }
}

fn is_place(number: f64) -> bool {
    number.abs() <= MAX_MAGNITUDE
}

pub(super) fn text(place: &str, value: &str) -> Result<(), SketchError> {
    if value.len() <= MAX_STORYBOARD_TEXT {
        return Ok(());
    }
    let problem =
        format!("{} bytes of text; at most {MAX_STORYBOARD_TEXT} are read. Shorten it", value.len());
    Err(SketchError::Storyboard { place: place.into(), problem })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::storyboard::Pin;

    #[test]
    fn a_pin_far_off_the_drawing_is_no_place() {
        let board = |x: f64| {
            let pins = vec![Pin { joint: "right_wrist".into(), at: [x, 2.0] }];
            let body = vec![Stroke::new(vec![[0.0, 0.0], [50.0, 100.0]])];
            Storyboard { frames: vec![Frame { body, pins, ..Frame::default() }], ..Storyboard::default() }
        };
        assert!(board(1000.0).check().is_ok() && board(-1900.0).check().is_ok());
        let said = board(1e6).check().unwrap_err().to_string();
        assert!(said.contains("pin of right_wrist") && said.contains("10000 times as far off"), "{said}");
        assert!(board(-2100.0).check().is_err());
        let mut alone = board(1e6);
        alone.frames[0].body.clear();
        assert!(alone.check().is_ok(), "without a drawing any unit may be meant");
    }
}
