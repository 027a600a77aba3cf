//! inkrig-align
