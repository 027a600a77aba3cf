//! inkrig-sketch
