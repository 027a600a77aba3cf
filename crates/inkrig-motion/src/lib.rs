//! inkrig-motion
