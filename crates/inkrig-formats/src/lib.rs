//! inkrig-formats
