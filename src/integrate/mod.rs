//! Integration rules on the host: nodes and weights in f64, for the device and for the CPU path.

pub(crate) mod albedo_curve;
pub(crate) mod chebyshev;
pub(crate) mod evaluate;
pub(crate) mod fresnel_series;
pub(crate) mod listed_rule;
pub(crate) mod product_rule;
pub(crate) mod rule_set;
pub(crate) mod sample_rule;
pub(crate) mod scale;
pub(crate) mod slope_rule;
