//! Where a finished motion goes, and which joint carries it there.

use crate::StudioError;
use crate::document::{GroundPath as Drawn, RootMode, Settings};
use inkrig_formats::SourceInfo;
use inkrig_motion::Clip;
use inkrig_motion::glam::DVec2;
use inkrig_motion::ground::{
    GroundPath, PathOptions, Route, TravelOptions, add_root_bone, empty_root_bone, fold_root_bone,
    follow_path, in_place,
};

/// Does what the settings say; `written_as` learns of joints that come and go. Of a preview only what leaves the skeleton as
/// it is. Beside the motion stands what a person should know.
///
/// # Errors
/// When the motion does not travel although it shall follow a path.
pub(crate) fn over_ground(
    clip: Clip,
    settings: &Settings,
    written_as: Option<&mut SourceInfo>,
) -> Result<(Clip, Vec<String>), StudioError> {
    let travel = TravelOptions { cyclic: settings.cyclic, ..TravelOptions::default() };
    let mut notes = Vec::new();
    let clip = match &settings.path {
        None => clip,
        Some(path) => {
            let metres_per_unit = match path {
                Drawn::Drawn { metres_per_unit, .. } => *metres_per_unit,
                _ => None,
            };
            let options = PathOptions { travel, metres_per_unit, corner_metres: None };
            let followed = follow_path(&clip, &route(path)?, &options)?;
            notes.push(format!(
                "Over the ground: {:.2} m along a path of {:.2} m, {:.2} m away from it at most.",
                followed.travelled_metres, followed.path_metres, followed.max_distance
            ));
            followed.clip
        }
    };
    let clip = match (settings.root, written_as) {
        (RootMode::InPlace, _) => in_place(&clip, &travel)?,
        (RootMode::Bone, Some(written_as)) => {
            let done = add_root_bone(&clip, &travel)?;
            written_as.follow(done.skeleton);
            done.clip
        }
        (RootMode::Hips, Some(written_as)) => {
            // The skin of the character's own file lists its bones.
            let done =
                if written_as.original.is_some() { empty_root_bone(&clip)? } else { fold_root_bone(&clip)? };
            written_as.follow(done.skeleton);
            done.clip
        }
        _ => clip,
    };
    Ok((clip, notes))
}

fn route(path: &Drawn) -> Result<Route, StudioError> {
    let angle = |degrees: f64| {
        let good = degrees.is_finite() && degrees.abs() <= 36_000.0;
        if good {
            Ok(degrees.to_radians())
        } else {
            Err(StudioError::invalid("a path turns by at most 36000 degrees"))
        }
    };
    Ok(match path {
        Drawn::Straight => Route::Straight,
        Drawn::Arc { degrees } => Route::Arc(angle(*degrees)?),
        Drawn::Bend { degrees } => Route::Bend(angle(*degrees)?),
        Drawn::Drawn { points, closed, .. } => {
            let points: Vec<DVec2> = points.iter().map(|[x, y]| DVec2::new(*x, -*y)).collect();
            Route::Path(GroundPath::new(&points, *closed)?)
        }
    })
}
