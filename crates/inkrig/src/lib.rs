//! inkrig
