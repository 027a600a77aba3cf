//! inkrig-transport
