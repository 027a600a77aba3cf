//! `--root` and `--path`: what is done to a finished motion before it is written.

use crate::cli::{RootArgs, RootMode};
use crate::error::CliError;
use crate::load;
use crate::printable::{counted, fixed, json_path};
use inkrig_formats::SourceInfo;
use inkrig_motion::glam::DVec2;
use inkrig_motion::ground::{
    Contacts, Followed, GroundPath, PathOptions, Route, SkeletonChange, Slide, Trajectory, TravelOptions,
    add_root_bone, empty_root_bone, fold_root_bone, follow_path, in_place,
};
use inkrig_motion::{Clip, MotionError};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What was asked for, understood before any work.
#[derive(Debug)]
pub(crate) struct OverGround {
    mode: RootMode,
    route: Option<Route>,
    /// The file of the path.
    file: Option<PathBuf>,
    metres_per_unit: Option<f64>,
    sway: f64,
}

/// What was done; the names are stable.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct OverGroundRecord {
    mode: &'static str,
    /// The joint that carries the travel.
    joint: String,
    /// Whether the skeleton got a joint more or has one less.
    skeleton: &'static str,
    /// How far the motion goes without its sway, metres; before it was put in place.
    travelled_metres: f64,
    path: Option<PathRecord>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct PathRecord {
    route: String,
    metres_per_unit: f64,
    length_metres: f64,
    travelled_metres: f64,
    mean_distance_metres: f64,
    max_distance_metres: f64,
    /// Of standing feet; `null` where none stand.
    slide_before: Option<SlideRecord>,
    slide_after: Option<SlideRecord>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct SlideRecord {
    contacts: usize,
    mean_step_mm: f64,
    p95_step_mm: f64,
    mean_drift_mm: f64,
    max_drift_mm: f64,
}

impl OverGround {
    /// Reads the arguments and the path's file.
    ///
    /// # Errors
    /// When the file cannot be read or is no path, or a shape is not understood.
    pub(crate) fn of(args: &RootArgs) -> Result<Self, CliError> {
        let file = args.file();
        let route = match (&args.path, &file) {
            (None, _) => None,
            (Some(_), Some(file)) => Some(drawing(file)?),
            (Some(shape), None) => Some(named(shape)?),
        };
        if args.path_scale.is_some() && file.is_none() {
            return Err(CliError::NoEffect { flag: "--path-scale", with: "a --path that is no drawing" });
        }
        Ok(Self { mode: args.root, route, file, metres_per_unit: args.path_scale, sway: args.sway })
    }

    /// Does it. `source` says how the motion will be written, and learns of joints that come and go.
    /// `cyclic`: the motion is a loop.
    ///
    /// # Errors
    /// When the motion does not travel although it shall follow a path.
    pub(crate) fn apply(
        &self,
        clip: Clip,
        source: &mut SourceInfo,
        cyclic: bool,
    ) -> Result<(Clip, OverGroundRecord), CliError> {
        let travel = TravelOptions { smoothing_seconds: self.sway, cyclic };
        let (clip, path) = match &self.route {
            None => (clip, None),
            Some(route) => {
                let options =
                    PathOptions { travel, metres_per_unit: self.metres_per_unit, corner_metres: None };
                let followed = follow_path(&clip, route, &options).map_err(|error| self.about(error))?;
                let path = self.path_record(&clip, &followed);
                (followed.clip, Some(path))
            }
        };
        let travelled_metres = Trajectory::of(&clip, &travel).length();
        let mut change = SkeletonChange::Kept(None);
        let clip = match self.mode {
            RootMode::Travel => clip,
            RootMode::InPlace => in_place(&clip, &travel)?,
            RootMode::Bone | RootMode::Hips => {
                let done = if self.mode == RootMode::Bone {
                    add_root_bone(&clip, &travel)?
                } else if source.original.is_some() {
                    // The skin of the character's own file lists its bones.
                    empty_root_bone(&clip)?
                } else {
                    fold_root_bone(&clip)?
                };
                change = done.skeleton;
                done.clip
            }
        };
        source.follow(change);
        let skeleton = match change {
            SkeletonChange::Kept(_) => "kept",
            SkeletonChange::Inserted(_) => "a joint more",
            SkeletonChange::Removed(_) => "a joint less",
        };
        let joint = match change {
            SkeletonChange::Inserted(joint) | SkeletonChange::Kept(Some(joint))
                if self.mode == RootMode::Bone =>
            {
                joint
            }
            _ => clip.travel_joint(),
        };
        let joint = clip.skeleton().joints().get(joint).map(|joint| joint.name.clone()).unwrap_or_default();
        let mode = match self.mode {
            RootMode::Travel => "travel",
            RootMode::InPlace => "in-place",
            RootMode::Bone => "bone",
            RootMode::Hips => "hips",
        };
        Ok((clip, OverGroundRecord { mode, joint, skeleton, travelled_metres, path }))
    }

    fn path_record(&self, before: &Clip, followed: &Followed) -> PathRecord {
        let contacts = Contacts::of(before);
        let route = match (&self.file, &self.route) {
            (Some(file), _) => json_path(file),
            (None, Some(Route::Arc(angle))) => format!("arc:{}", fixed(angle.to_degrees(), 1)),
            (None, Some(Route::Bend(angle))) => format!("bend:{}", fixed(angle.to_degrees(), 1)),
            (None, _) => "straight".to_string(),
        };
        PathRecord {
            route,
            metres_per_unit: followed.metres_per_unit,
            length_metres: followed.path_metres,
            travelled_metres: followed.travelled_metres,
            mean_distance_metres: followed.mean_distance,
            max_distance_metres: followed.max_distance,
            slide_before: contacts.slide(before).map(SlideRecord::from),
            slide_after: contacts.slide(&followed.clip).map(SlideRecord::from),
        }
    }

    /// A path that cannot be used is named by its file.
    fn about(&self, error: MotionError) -> CliError {
        match (&self.file, error) {
            (Some(path), cause @ MotionError::Path { .. }) => CliError::Clip { path: path.clone(), cause },
            (_, other) => other.into(),
        }
    }
}

impl OverGroundRecord {
    /// What people are told; nothing where nothing was done.
    pub(crate) fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if let Some(path) = &self.path {
            let metres = |length: f64| fixed(length, 2);
            let ends = if path.length_metres > 1.01 * path.travelled_metres {
                ", as far as it travels"
            } else if path.length_metres < 0.99 * path.travelled_metres {
                ", and goes on beyond its end"
            } else {
                ""
            };
            notes.push(format!(
                "over the ground: {} m along a path of {} m{ends}; {} m away from it in the mean, {} m at most",
                metres(path.travelled_metres),
                metres(path.length_metres),
                metres(path.mean_distance_metres),
                metres(path.max_distance_metres)
            ));
            if let (Some(before), Some(after)) = (&path.slide_before, &path.slide_after) {
                notes.push(format!(
                    "standing feet ({}) slide {} mm a frame, {} mm while they stand; {} and {} mm before the path",
                    counted(after.contacts, "contact"),
                    fixed(after.mean_step_mm, 1),
                    fixed(after.mean_drift_mm, 0),
                    fixed(before.mean_step_mm, 1),
                    fixed(before.mean_drift_mm, 0)
                ));
            }
        }
        let metres = fixed(self.travelled_metres, 2);
        match self.mode {
            "in-place" => notes.push(format!("in place: {metres} m of travel taken away")),
            "bone" => notes.push(format!("the root bone `{}` carries {metres} m of travel", self.joint)),
            "hips" => notes.push(format!("`{}` carries {metres} m of travel", self.joint)),
            _ => {}
        }
        notes
    }
}

impl From<Slide> for SlideRecord {
    fn from(slide: Slide) -> Self {
        let Slide { contacts, mean_step_mm, p95_step_mm, mean_drift_mm, max_drift_mm } = slide;
        Self { contacts, mean_step_mm, p95_step_mm, mean_drift_mm, max_drift_mm }
    }
}

/// A drawing is seen from above with z towards the viewer: x stays, y up the page is -z.
fn drawing(file: &Path) -> Result<Route, CliError> {
    let curve = load::curve(file)?;
    let points: Vec<DVec2> = curve.points().iter().map(|[x, y]| DVec2::new(*x, -*y)).collect();
    let path = GroundPath::new(&points, curve.is_closed())
        .map_err(|cause| CliError::Clip { path: file.to_path_buf(), cause })?;
    Ok(Route::Path(path))
}

fn named(shape: &str) -> Result<Route, CliError> {
    let degrees = |text: &str| {
        let number: Option<f64> = text.trim().parse().ok();
        number.filter(|degrees| degrees.abs() <= 36_000.0).map(f64::to_radians)
    };
    let route = match shape.split_once(':') {
        None => Some(Route::Straight),
        Some(("arc", angle)) => degrees(angle).map(Route::Arc),
        Some((_, angle)) => degrees(angle).map(Route::Bend),
    };
    route.ok_or_else(|| CliError::Shape { text: shape.to_string() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_read() {
        assert_eq!(named("straight").unwrap(), Route::Straight);
        assert_eq!(named("arc:180").unwrap(), Route::Arc(std::f64::consts::PI));
        assert_eq!(named("bend:-90").unwrap(), Route::Bend(-std::f64::consts::FRAC_PI_2));
        for bad in ["arc:", "arc:x", "arc:nan", "bend:inf", "arc:1e9"] {
            let error = named(bad).unwrap_err().to_string();
            assert!(error.contains(bad), "{error}");
        }
    }
}
