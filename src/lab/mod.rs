//! Experiments about the rules and the arithmetic: what f32 loses, and what a tolerance costs.

pub mod atlas;
pub mod tabulate;
pub mod trade;
