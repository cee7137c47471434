//! A small table for targets that order, flip, combine and round it.

use super::*;
use crate::base::precision::Precision;
use crate::io::Provenance;
use crate::io::format::NPY;
use crate::table::axis::{Mapping, Positions};
use crate::table::quantity::BRDF;
use std::collections::{BTreeMap, BTreeSet};

const SHAPE: [usize; 3] = [2, 3, 2];
const VARIABLES: [Variable; 3] = [Variable::ThetaI, Variable::ThetaE, Variable::DeltaPhi];

/// The value at (i, j, k) of a channel: its indices are its digits.
fn value([i, j, k]: [usize; 3], channel: usize) -> f64 {
    (1000 * (i + 1) + 100 * (j + 1) + 10 * (k + 1) + channel + 1) as f64
}

/// A table over 2 × 3 × 2 samples with the channels A and B.
fn table() -> Table {
    let axes = VARIABLES.iter().zip(SHAPE).map(|(&variable, count)| Axis::natural(variable, count).unwrap());
    let mut values = Vec::new();
    for i in 0..SHAPE[0] {
        for j in 0..SHAPE[1] {
            for k in 0..SHAPE[2] {
                values.extend([0, 1].map(|channel| value([i, j, k], channel) as f32));
            }
        }
    }
    Table {
        name: "small".into(),
        quantity: &BRDF,
        subject: "ggx".into(),
        parameters: BTreeMap::new(),
        axes: axes.collect(),
        channels: vec!["A".into(), "B".into()],
        values: values.into(),
        rule: "pointwise".into(),
        storage: Storage::F32,
        bilinear: None,
        precision: Precision::F32,
        error: TableError {
            measured_max: Some(1e-6),
            worst: BTreeMap::from([("theta_i".into(), 0.0), ("channel".into(), 1.0)]),
            ..TableError::unmeasured(ErrorKind::Absolute, None, Some(1e-5))
        },
        seconds: 0.0,
    }
}

const fn axis(variable: Variable, flipped: bool) -> TargetAxis {
    TargetAxis { variable, flipped }
}

const fn copy(name: &'static str, terms: &'static [(&'static str, f64)]) -> TargetChannel {
    TargetChannel { name, terms, constant: 0.0 }
}

fn refusal(target: &Target) -> String {
    target.apply(table()).unwrap_err().to_string()
}

#[test]
fn the_identity_hands_on_the_table_itself() {
    let table = table();
    for target in TARGETS.iter().filter(|target| target.is_identity()) {
        assert_eq!(target.apply(table.clone()).unwrap(), table);
    }
    assert_eq!(IDENTITY.formats(&[&NPY]), [&NPY]);
}

/// Axes (δφ, θi, θe), θi flipped.
#[test]
fn axes_are_ordered_and_flipped() {
    const AXES: &[TargetAxis] =
        &[axis(Variable::DeltaPhi, false), axis(Variable::ThetaI, true), axis(Variable::ThetaE, false)];
    let table = table();
    let image = Target { axes: Some(AXES), ..IDENTITY }.apply(table.clone()).unwrap();
    assert_eq!(image.shape(), [2, 2, 3]);
    for k in 0..2 {
        for i in 0..2 {
            for j in 0..3 {
                let texel = (k * 2 + i) * 3 + j;
                assert_eq!(image.texel(texel), [0, 1].map(|c| value([1 - i, j, k], c)), "{k} {i} {j}");
            }
        }
    }
    let theta_i: Vec<_> = table.axes[0].values().iter().rev().copied().collect();
    assert_eq!(image.axes[1].values(), theta_i);
    assert_eq!(image.axes[2], table.axes[1]);
    assert_eq!(image.error, table.error, "the same values have the same error");
}

/// RGBA of B, A + B, a constant and half of A less one.
#[test]
fn channels_are_combined() {
    const CHANNELS: &[TargetChannel] = &[
        copy("R", &[("B", 1.0)]),
        copy("G", &[("A", 1.0), ("B", 1.0)]),
        TargetChannel { name: "B", terms: &[], constant: 0.25 },
        TargetChannel { name: "A", terms: &[("A", 0.5)], constant: -1.0 },
    ];
    let table = table();
    let image = Target { channels: Some(CHANNELS), ..IDENTITY }.apply(table.clone()).unwrap();
    assert_eq!(image.channels, ["R", "G", "B", "A"]);
    for texel in 0..12 {
        let (a, b) = (table.value(texel, 0), table.value(texel, 1));
        assert_eq!(image.texel(texel), [b, a + b, 0.25, 0.5 * a - 1.0]);
    }
    let error = &image.error;
    assert!(error.measured_max.is_none() && error.worst.is_empty(), "nothing was compared: {error:?}");
    let rounding = Storage::F32.rounding(ErrorKind::Absolute);
    assert_eq!(error.estimate, Some(2.0 * 1e-5 + rounding), "A + B may be off by both errors");
}

#[test]
fn the_worst_channel_moves_with_its_channel() {
    const SWAPPED: &[TargetChannel] = &[copy("x", &[("B", 1.0)]), copy("y", &[("A", 1.0)])];
    let table = table();
    let image = Target { channels: Some(SWAPPED), ..IDENTITY }.apply(table.clone()).unwrap();
    assert_eq!(image.texel(0), [value([0; 3], 1), value([0; 3], 0)]);
    assert_eq!((image.error.worst["channel"], image.error.measured_max), (0.0, Some(1e-6)));
}

#[test]
fn values_are_rounded_to_the_storage_or_refused() {
    let halves = Target { storage: Some(Storage::F16), ..IDENTITY };
    let table = table();
    let image = halves.apply(table.clone()).unwrap();
    for texel in 0..12 {
        assert_eq!(image.value(texel, 1), Storage::F16.round(table.value(texel, 1)));
    }
    assert_eq!((image.storage, image.error.measured_max), (Storage::F16, None));
    let why = refusal(&Target { storage: Some(Storage::Unorm16), name: "engine", ..IDENTITY });
    assert!(why.contains("small") && why.contains("engine") && why.contains("outside [0, 1]"), "{why}");
}

/// No two of 48 orders and flips and two channel orders give the same file.
#[test]
fn a_wrong_order_is_told_apart() {
    const CHANNELS: [&[TargetChannel]; 2] = [
        &[copy("A", &[("A", 1.0)]), copy("B", &[("B", 1.0)])],
        &[copy("A", &[("B", 1.0)]), copy("B", &[("A", 1.0)])],
    ];
    let mut files = BTreeSet::new();
    let mut count = 0;
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        for flips in 0..8 {
            let axes: Vec<_> = order.iter().map(|&k| axis(VARIABLES[k], flips >> k & 1 == 1)).collect();
            for channels in CHANNELS {
                let target = Target { axes: Some(axes.clone().leak()), channels: Some(channels), ..IDENTITY };
                let image = target.apply(table()).unwrap();
                files.insert(NPY.encode(&image, &Provenance::new()).unwrap());
                count += 1;
            }
        }
    }
    assert_eq!((files.len(), count), (96, 96));
}

#[test]
fn targets_that_do_not_fit_are_refused() {
    const FEW: &[TargetAxis] = &[axis(Variable::ThetaI, false), axis(Variable::ThetaE, false)];
    const TWICE: &[TargetAxis] =
        &[axis(Variable::ThetaI, false), axis(Variable::ThetaI, true), axis(Variable::ThetaE, false)];
    const OTHER: &[TargetAxis] =
        &[axis(Variable::Roughness, false), axis(Variable::ThetaE, false), axis(Variable::ThetaI, false)];
    for axes in [FEW, TWICE, OTHER, &[]] {
        let why = refusal(&Target { name: "engine", axes: Some(axes), ..IDENTITY });
        assert!(why.contains("engine") && why.contains("(theta_i, theta_e, delta_phi)"), "{why}");
    }
    const CLOTH: &[TargetChannel] = &[copy("B", &[("cloth", 1.0)])];
    let why = refusal(&Target { name: "engine", channels: Some(CLOTH), ..IDENTITY });
    assert!(why.contains("cloth") && why.contains("A, B"), "{why}");
}

/// A flipped axis says so: its range and its values run the same way.
#[test]
fn a_flipped_axis_keeps_its_description() {
    let linear = Axis::natural(Variable::Mu, 4).unwrap().reversed();
    assert_eq!(linear.range(), [1.0, 0.0]);
    for (k, value) in linear.values().iter().enumerate() {
        assert!((value - (1.0 - (k as f64 + 0.5) / 4.0)).abs() < 1e-15);
    }
    let root = Axis::new(Variable::Mu, 3, [0.0, 1.0], Positions::Nodes, Mapping::Sqrt).unwrap().reversed();
    assert_eq!((root.mapping(), root.positions()), (Mapping::Linear, Positions::Values));
    assert_eq!(root.values(), [1.0, 0.25, 0.0]);
}
