//! Numbers frame by frame.

use crate::kinematics::Positions;
use crate::retarget::Retargeted;
use crate::retarget::plan::Lead;
use glam::Vec3;

/// A bone of the target by its two joints, and degrees over all frames.
type Bone = ([usize; 2], Vec<f64>);

/// What was measured, in the order of the frames; millimetres, degrees.
#[derive(Debug, Clone, Default)]
pub(super) struct Measured {
    /// Of every pair.
    pub(super) positions: Vec<Vec<f64>>,
    /// Of every limb's bone.
    pub(super) directions: Vec<Bone>,
    pub(super) trunk: Vec<f64>,
    pub(super) across: Vec<f64>,
    pub(super) slides: Vec<f64>,
    pub(super) floating: Vec<f64>,
    pub(super) depths: Vec<f64>,
    pub(super) drifts: Vec<f64>,
}

impl Measured {
    /// `a`: the source's places, `b`: the result's.
    pub(super) fn of(moved: &Retargeted, a: &Positions, b: &Positions, frames: usize) -> Self {
        let facts = &moved.facts;
        let scaled =
            |place: Vec3| (place - Vec3::Y * facts.source_ground) * moved.scale + Vec3::Y * moved.ground;
        let millimetres = |metres: f32| 1e3 * f64::from(metres);
        let apart = |own: usize, other: usize| {
            let off = |frame: usize| b.frame(frame)[own].distance(scaled(a.frame(frame)[other]));
            (0..frames).map(|frame| millimetres(off(frame))).collect()
        };
        // One who lies may be in the ground in the source already.
        let lowest = |frame: usize| {
            let own = moved.pairs.iter().map(|pair| b.frame(frame)[pair.0].y);
            let other = moved.pairs.iter().map(|pair| scaled(a.frame(frame)[pair.1]).y);
            let allowed = other.fold(moved.ground, f32::min);
            millimetres((allowed - own.fold(f32::INFINITY, f32::min)).max(0.0))
        };
        let drift = |frame: usize| {
            let own = facts.onto.middle(b.frame(frame));
            let other = scaled(facts.from.middle(a.frame(frame)));
            millimetres((own - other).with_y(0.0).length())
        };
        let degrees = |own: Vec3, other: Vec3| {
            let degrees = own.as_dvec3().angle_between(other.as_dvec3()).to_degrees();
            Some(degrees).filter(|degrees| degrees.is_finite())
        };
        let trunk =
            |frame: usize| degrees(facts.onto.trunk(b.frame(frame))?, facts.from.trunk(a.frame(frame))?);
        let across = |frame: usize| {
            let (own, other) = (facts.onto.across(b.frame(frame)), facts.from.across(a.frame(frame)));
            own.into_iter().zip(other).filter_map(|(own, other)| degrees(own, other)).collect::<Vec<_>>()
        };
        let (slides, floating) = standing(moved, a, b, frames);
        Self {
            positions: moved.pairs.iter().map(|&(own, other)| apart(own, other)).collect(),
            directions: directions(moved, a, b, frames),
            trunk: (0..frames).filter_map(trunk).collect(),
            across: (0..frames).flat_map(across).collect(),
            slides,
            floating,
            // A T-pose at the beginning stands on no ground.
            depths: (facts.standing.rest_pose_frames..frames).map(lowest).collect(),
            drifts: (0..frames).map(drift).collect(),
        }
    }
}

/// Degrees between limbs and those of the source: a person's upper and lower arms and legs, an animal's legs from hip or
/// shoulder to the paw, by a map alone all bones.
fn directions(moved: &Retargeted, a: &Positions, b: &Positions, frames: usize) -> Vec<Bone> {
    limbs(moved)
        .into_iter()
        .map(|(bone, [from, to])| {
            let degrees = (0..frames).map(|frame| {
                let (own, other) = (b.frame(frame), a.frame(frame));
                let bone = (own[bone[1]] - own[bone[0]]).as_dvec3();
                let source = (to.place(other) - from.place(other)).as_dvec3();
                bone.angle_between(source).to_degrees()
            });
            // A bone without length points nowhere.
            (bone, degrees.filter(|degrees| degrees.is_finite()).collect())
        })
        .collect()
}

/// Two joints of the target, and the two places of the source that they point like.
fn limbs(moved: &Retargeted) -> Vec<([usize; 2], [Lead; 2])> {
    let facts = &moved.facts;
    if let Some(body) = facts.onto.humanoid() {
        let arms = body.arms.iter().flatten().flat_map(|arm| [arm.upper, arm.lower]);
        let legs = body.legs.iter().flat_map(|leg| [leg.upper, leg.lower]);
        let limbs: Vec<usize> = arms.chain(legs).collect();
        return facts.bones.iter().filter(|(bone, _)| limbs.contains(&bone[0])).copied().collect();
    }
    if facts.onto.quadruped().is_some() {
        // Bones of other proportions cannot all point alike and reach the ground.
        let pairs = facts.from.legs.iter().zip(&facts.onto.legs);
        let whole = pairs.filter_map(|(own, other)| {
            Some(([other.upper, other.foot?], [Lead::one(own.upper), Lead::one(own.foot?)]))
        });
        return whole.collect();
    }
    facts.bones.clone()
}

/// 0 for an ankle and 1 for a ball, with its joints in source and target.
type Point = (usize, usize, usize);

/// Of feet that stand: steps over the ground of what stands of them, and how high they are above where they should be.
fn standing(moved: &Retargeted, a: &Positions, b: &Positions, frames: usize) -> (Vec<f64>, Vec<f64>) {
    let (mut steps, mut floating) = (Vec::new(), Vec::new());
    let facts = &moved.facts;
    let treadmill = facts.standing.treadmill.unwrap_or(Vec3::ZERO);
    for &(leg, first, last) in &moved.contacts {
        let (Some(own), Some(other)) = (facts.from.legs.get(leg), facts.onto.legs.get(leg)) else { continue };
        let points: Vec<Point> = [(own.foot, other.foot), (own.toes, other.toes)]
            .into_iter()
            .enumerate()
            .filter_map(|(part, (a, b))| Some((part, a?, b?)))
            .collect();
        for frame in first..=last.min(frames.saturating_sub(1)) {
            if frame > first {
                let step = |positions: &Positions, joint: usize| {
                    (positions.frame(frame)[joint] - positions.frame(frame - 1)[joint]).with_y(0.0)
                };
                let ground = treadmill * (1.0 / moved.clip.frame_rate()) as f32;
                let slides = |point: &&Point| (step(a, point.1) - ground).length();
                let stillest = points.iter().min_by(|x, y| slides(x).total_cmp(&slides(y)));
                steps.extend(stillest.map(|point| {
                    // A ground that goes along does so as the source's foot does.
                    let along = if moved.on_the_spot { moved.scale * step(a, point.1) } else { Vec3::ZERO };
                    1e3 * f64::from((step(b, point.2) - along).length())
                }));
            }
            // Above where the foot stands: the lower of ankle and ball.
            let over = |of: &dyn Fn(&Point) -> Option<f32>| {
                points.iter().filter_map(of).fold(f32::INFINITY, f32::min)
            };
            let result = over(&|&(part, _, joint)| {
                Some(b.frame(frame)[joint].y - moved.ground - facts.clearance.get(leg)?[part])
            });
            let source = over(&|&(part, joint, _)| {
                Some(a.frame(frame)[joint].y - facts.standing.low.get(leg)?[part]?)
            });
            let above = f64::from(result - moved.scale * source);
            if above.is_finite() {
                floating.push(1e3 * above.max(0.0));
            }
        }
    }
    (steps, floating)
}
