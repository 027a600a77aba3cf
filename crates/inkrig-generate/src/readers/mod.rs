//! Readers of what was drawn: the joints of a stick figure, and an action's word.

pub mod file;
pub mod graph;
pub mod ink;
pub mod network;
pub mod sketch;
pub mod word;
