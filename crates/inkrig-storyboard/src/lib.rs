//! From a storyboard to one animation (Sketch2Anim, sections 3 and 6).
//!
//! The order of work: [`understand`] makes of a drawn frame what the model is asked for ([`Plan`]), [`Maker::clip`] makes a
//! motion of that, [`animation`] puts the motions end to end and on the floor, and moves the whole until it meets what was drawn.
//!
//! Picture coordinates are metres, x to the right and y up, as [`inkrig_motion::humanml::Camera`] projects the world.

mod animation;
mod attach;
mod calibrate;
mod edited;
mod error;
mod exact;
mod example;
mod figure;
mod generate;
mod ground;
mod joints;
mod page;
mod path;
mod picture;
mod plan;
mod sequence;
mod space;
mod timing;

pub use animation::{Animation, Exact, Kept, animation, check_length};
pub use attach::Way;
pub use error::StoryboardError;
pub use exact::{
    Asked, Constraint, Cuboid, Goal, MeetOptions, Met, Proportioned, Rule, Source, centre_of_mass, meet,
    meet_all, misses, proportion,
};
pub use example::{
    Answer, Creature, CreatureFrame, CreaturePart, CreatureWay, Example, Library, NO_TAKE, Retrieved,
    creature, read_creature,
};
pub use figure::{Alternative, Figure, Found, read_figure};
pub use generate::{Generated, Maker, MakerOptions};
pub use picture::{Picture, storyboard_of_picture};
pub use plan::{KeyJoint, Plan, Understood, understand};
pub use sequence::{Blender, Joined, Transition, sequence};
pub use space::Space;
