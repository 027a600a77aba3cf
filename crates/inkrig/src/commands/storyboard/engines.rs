//! `--engine`: by the model, by the user's clips, or by both.

use super::examples::by_example;
use super::onto::Character;
use super::record::EngineRecord;
use super::{Asked, Made, Workshop, shown};
use crate::cli::{BlendArg, EngineArg, StepsArg, StoryboardArgs};
use crate::console::Console;
use crate::error::CliError;
use inkrig_storyboard::{Library, Retrieved};
use std::time::Instant;

/// What was made, and what is known of how.
pub(super) struct Engines {
    pub(super) made: Made,
    /// Where each frame is from, where examples took part.
    pub(super) retrieved: Vec<Retrieved>,
    /// All engines, where several made it.
    pub(super) compared: Vec<EngineRecord>,
}

/// Says early what cannot be.
///
/// # Errors
/// When options do not go together.
pub(super) fn check(args: &StoryboardArgs) -> Result<(), CliError> {
    let of_sampling = [
        (args.steps.is_some(), "--steps"),
        (args.candidates.is_some(), "--candidates"),
        (args.text_weight.is_some(), "--text-weight"),
        (args.guide_every.is_some(), "--guide-every"),
        (args.blend == BlendArg::Model, "--blend model"),
    ];
    let given = of_sampling.into_iter().find_map(|(given, flag)| given.then_some(flag));
    if let (EngineArg::Example, Some(flag), true) = (args.engine, given, args.examples.is_some()) {
        return Err(CliError::NoEffect { flag, with: "--engine example" });
    }
    match (args.engine, &args.examples, args.steps) {
        (EngineArg::Learned, Some(_), _) => {
            Err(CliError::NoEffect { flag: "--examples", with: "--engine learned" })
        }
        (EngineArg::Example | EngineArg::Both, None, _) => Err(CliError::NoExamples),
        // Few steps begin with noise.
        (EngineArg::Both, _, Some(steps)) if steps != StepsArg::Ddim => {
            Err(CliError::NoEffect { flag: "--engine both", with: "--steps 1, 2 or 4" })
        }
        _ => Ok(()),
    }
}

/// Makes a person's animation: from the library's clips, if there is one; of motions that land on the character, if there is one.
///
/// # Errors
/// As [`Workshop::make_on`].
pub(super) fn made(
    engine: EngineArg,
    workshop: &Workshop<'_>,
    asked: &[Asked<'_>],
    (library, character): (Option<&Library>, Option<&Character>),
    console: &Console,
) -> Result<Engines, CliError> {
    let mut watch = shown(console, asked.len());
    let Some(library) = library else {
        let made = workshop.make_on(character, asked, &[], &mut watch)?;
        return Ok(Engines { made, retrieved: Vec::new(), compared: Vec::new() });
    };
    let begun = Instant::now();
    let stage = console.stage("looking through the examples");
    let (example, retrieved) = by_example(asked, library, workshop)?;
    drop(stage);
    let by_example = begun.elapsed().as_secs_f64();
    if engine == EngineArg::Example {
        return Ok(Engines { made: example, retrieved, compared: Vec::new() });
    }
    let begun = Instant::now();
    let both = workshop.make_on(character, asked, &example.clips, &mut watch)?;
    let by_both = by_example + begun.elapsed().as_secs_f64();
    let begun = Instant::now();
    let alone = workshop.make_on(character, asked, &[], &mut watch)?;
    let compared = vec![
        EngineRecord::of(EngineArg::Learned, begun.elapsed().as_secs_f64(), &alone),
        EngineRecord::of(EngineArg::Example, by_example, &example),
        EngineRecord::of(EngineArg::Both, by_both, &both),
    ];
    Ok(Engines { made: both, retrieved, compared })
}
