//! Helpers of several test programs.
#![allow(dead_code, reason = "no program uses all of it")]

pub mod bsdfs;
pub mod malformed;
pub mod scenes;
pub mod snippets;
pub mod stats;
pub mod stops;
