//! Where nodes are while a clip plays.

use super::{axes::Axes, bones::Bones, damaged, span::Span, stacks::Stack};
use crate::{
    Finding, FormatError,
    figure::{Figure, Placed, Stage, rotation_of},
    finding::shown,
    lexer::LARGEST_NUMBER,
};
use inkrig_motion::{
    Clip,
    glam::{DAffine3, DQuat, DVec3},
};
use ufbx::{InheritMode, Transform};

/// Places the nodes of the figure's chain, each in its parent as its mode of inheriting scales says; those that are `bound`
/// to a place of the file's world, there.
pub(super) fn place(
    bones: &Bones<'_>,
    figure: &Figure,
    locals: &[Transform],
    bound: Option<&[Option<DAffine3>]>,
    origin: Placed,
    placed: &mut [Placed],
) {
    let still = Inherited { unscaled: origin.world, scale: DVec3::ONE };
    let mut inherited = vec![still; placed.len()];
    for &node in &figure.chain {
        let (Some(local), Some(file)) = (locals.get(node), bones.nodes.get(node)) else { continue };
        let parent = bones.parents.get(node).copied().flatten();
        let above = parent.and_then(|parent| placed.get(parent)).copied().unwrap_or(origin);
        let from = parent.and_then(|parent| inherited.get(parent)).copied().unwrap_or(still);
        let (mut translation, rotation, mut scale) =
            (vector(local.translation), quaternion(local), vector(local.scale));
        let mut parent_world = above.world;
        if file.inherit_mode != InheritMode::Normal {
            let scales = bones.scale_nodes.get(node).copied().flatten();
            scale *= scales.and_then(|node| inherited.get(node)).map_or(DVec3::ONE, |from| from.scale);
            translation *= from.scale;
            parent_world = from.unscaled;
        }
        let world = parent_world * DAffine3::from_scale_rotation_translation(scale, rotation, translation);
        let unscaled = parent_world * DAffine3::from_rotation_translation(rotation, translation);
        let turned = (above.turned * rotation).normalize();
        let held = bound.and_then(|bound| bound.get(node).copied().flatten());
        let (world, unscaled, turned) = match held.map(|held| origin.world * held) {
            // What hangs on it and is bound nowhere takes no notice of its scale.
            Some(world) => (world, world, rotation_of(world.matrix3).unwrap_or(turned)),
            None => (world, unscaled, turned),
        };
        if let (Some(slot), Some(passed)) = (placed.get_mut(node), inherited.get_mut(node)) {
            *slot = Placed { world, turned };
            *passed = Inherited { unscaled, scale };
        }
    }
}

/// What children take over that do not inherit scales in the usual way.
#[derive(Debug, Clone, Copy)]
struct Inherited {
    /// World from node without the node's own scale.
    unscaled: DAffine3,
    scale: DVec3,
}

/// Plays a stack over a skeleton.
pub(super) struct Player<'p, 's> {
    bones: &'p Bones<'s>,
    stage: &'p Stage<'p>,
    origin: Placed,
    stack: &'p Stack<'s>,
    span: Span,
    locals: Vec<Transform>,
    /// Moving nodes of the figure's chain.
    moving: Vec<usize>,
}

impl<'p, 's> Player<'p, 's> {
    pub(super) fn new(
        bones: &'p Bones<'s>,
        stage: &'p Stage<'p>,
        axes: &Axes,
        stack: &'p Stack<'s>,
        span: Span,
    ) -> Self {
        let mut moving: Vec<usize> = stage.figure.chain.clone();
        moving.retain(|node| stack.moving.binary_search(node).is_ok());
        Self { bones, stage, origin: axes.origin(), stack, span, locals: bones.locals.clone(), moving }
    }

    /// The whole clip of `frames` frames.
    pub(super) fn clip(&mut self, frames: usize, findings: &mut Vec<Finding>) -> Result<Clip, FormatError> {
        let (stage, rate) = (self.stage, self.span.rate);
        let mut scaled = 0.0_f64;
        let clip = stage.clip(frames, rate, &mut |frame, placed| {
            self.go_to(frame)?;
            scaled = scaled.max(self.largest_scaling());
            place(self.bones, stage.figure, &self.locals, None, self.origin, placed);
            Ok(())
        })?;
        if scaled > 1e-3 {
            let message = "joints change their size in the clip; their places are kept, their sizes are not";
            findings.push(Finding::warning("fbx-scale", message.into()));
        }
        Ok(clip)
    }

    fn go_to(&mut self, frame: usize) -> Result<(), FormatError> {
        let (time, animation) = (self.span.time(frame), self.stack.stack.anim.as_ref());
        for &place in &self.moving {
            let (Some(node), Some(slot)) = (self.bones.nodes.get(place), self.locals.get_mut(place)) else {
                continue;
            };
            *slot = node.evaluate_transform(animation, time);
            if !usable(slot) {
                return Err(no_place(self.bones.name(place), &format!("in frame {}", frame + 1)));
            }
        }
        Ok(())
    }

    /// How far any node's scale is from that of its rest, by ratio.
    fn largest_scaling(&self) -> f64 {
        let scales = self.stack.scaling.iter().filter_map(|&node| {
            let (now, rest) = (self.locals.get(node)?.scale, self.bones.locals.get(node)?.scale);
            let (now, rest) = (vector(now), vector(rest));
            Some((now - rest).abs().max_element() / rest.abs().max_element().max(1e-9))
        });
        scales.fold(0.0, f64::max)
    }
}

/// Refuses a rest pose that cannot be reckoned with.
pub(super) fn check_rest(bones: &Bones<'_>, figure: &Figure) -> Result<(), FormatError> {
    let bad = figure.chain.iter().find(|&&node| bones.locals.get(node).is_some_and(|local| !usable(local)));
    bad.map_or(Ok(()), |&node| Err(no_place(bones.name(node), "at rest")))
}

fn no_place(name: &str, when: &str) -> FormatError {
    let part = format!("node `{}`", shown(name));
    let what = format!("its place {when} has a number that is none or too large");
    damaged("fbx-number", part, what, "the file is damaged; export it again")
}

fn usable(local: &Transform) -> bool {
    let lengths = [vector(local.translation), vector(local.scale)];
    let rotation = quaternion(local);
    lengths.iter().all(|vector| vector.abs().max_element() <= LARGEST_NUMBER && vector.is_finite())
        && rotation.is_finite()
        && rotation.length_squared() > 0.5
}

fn vector(v: ufbx::Vec3) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}

fn quaternion(local: &Transform) -> DQuat {
    let ufbx::Quat { x, y, z, w } = local.rotation;
    DQuat::from_xyzw(x, y, z, w).normalize()
}
