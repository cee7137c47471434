//! Promises of an error's estimate: it bounds the true error of every table, whatever its parts, parameters, quantity,
//! axes, size, tolerance and storage are, by the default check, by the plan alone (`--check 0`) and as an embedder records it.
//!
//! The truth is the reference at full accuracy, at some texels of each table. `GONIO_CASE` repeats the one case of its number,
//! and `GONIO_CASES` says how many are tried.

use crate::common::*;
use gonio::backend::gpu::{Baker, Recorded};
use gonio::bake::{Evaluator, Unobserved};
use gonio::base::precision::Precision;
use gonio::base::timings::Timings;
use gonio::check::{Check, reference};
use gonio::model::{Integral, MICROFACETS, MODELS, Model};
use gonio::plan::TablePlan;
use gonio::table::axis::{Axis, Mapping, Positions, Variable};
use gonio::table::quantity::{BRDF, Quantity, RHO_DH, RHO_HH, SPLIT_SUM};
use gonio::table::storage::Storage;
use gonio::wgpu;
use rayon::prelude::*;

/// The seed of all cases; a case's number is added to it.
const SEED: u64 = 14;

/// Some texels of each table are compared, of one with a costly reference fewer.
const TEXELS: usize = 12;

/// A plan of random parts, parameters, axes, tolerance and storage; `None` where they do not fit each other, as where a lobe has
/// no integral.
fn plan(random: &mut fastrand::Rng) -> Option<TablePlan> {
    let made = random.f64() < 0.8;
    let model: &'static Model = match made {
        true => random.choice(MICROFACETS.iter())?,
        false => random.choice(MODELS)?,
    };
    let quantities: [(&'static Quantity, f64); 4] =
        [(&BRDF, 0.2), (&SPLIT_SUM, 0.35), (&RHO_DH, 0.3), (&RHO_HH, 0.15)];
    let mut share = random.f64();
    let (quantity, _) = quantities.into_iter().find(|(_, weight)| {
        share -= weight;
        share < 0.0
    })?;
    // The reference of an anisotropic mean integrates over four angles, for minutes: `anisotropy.rs` has such means.
    if quantity == &RHO_HH && model.is_anisotropic() {
        return None;
    }
    let is_large = random.f64() < 0.2;
    let variables = match model.is_anisotropic() {
        true => quantity.anisotropic_variables,
        false => quantity.variables,
    };
    let axis = |random: &mut fastrand::Rng, variable: Variable, least: f64| {
        let count = match (is_large, quantity == &BRDF) {
            (true, false) => random.usize(96..200),
            (_, true) => random.usize(1..6),
            _ => random.usize(1..20),
        };
        let [low, high] = variable.natural_range();
        let low = low.max(least);
        // Whole ranges, narrow ones, and ends close to an extreme.
        let end = |random: &mut fastrand::Rng| match random.u8(0..4) {
            0 => low,
            1 => high,
            2 => low + (high - low) * 2f64.powf(-12.0 * random.f64()),
            _ => low + (high - low) * random.f64(),
        };
        let (a, b) = (end(random), end(random));
        let range = [a.min(b), a.max(b)];
        let positions = *random.choice(&[Positions::Nodes, Positions::Centers])?;
        let mapping = *random.choice(&[Mapping::Linear, Mapping::Sqrt])?;
        Axis::new(variable, count, range, positions, mapping).ok()
    };
    let least = if quantity == &BRDF { 1e-3 } else { 0.0 };
    let roughness = model.shape.map(|_| axis(random, Variable::Roughness, least));
    let axes: Option<Vec<_>> =
        roughness.into_iter().chain(variables.iter().map(|&variable| axis(random, variable, 0.0))).collect();
    let parameters: Vec<_> = model
        .parameters
        .iter()
        .filter_map(|p| {
            let [low, high] = p.range.map(|end| end.clamp(-1e3, 1e3));
            let value = match random.u8(0..4) {
                0 => return None,
                1 => low + (high - low) * random.f64().powi(4),
                _ => low + (high - low) * random.f64(),
            };
            Some((p.name.to_string(), value))
        })
        .collect();
    let tolerance = 10f64.powf(-1.0 - 8.0 * random.f64());
    let storage = match random.u8(0..8) {
        0 if tolerance > 2.5e-4 => Storage::F16,
        _ => Storage::F32,
    };
    let plan = TablePlan::basis("case", quantity, model, None, axes?).ok()?;
    plan.with_parameters(&parameters).ok()?.with_tolerance(tolerance).ok()?.with_storage(storage).ok()
}

/// The error that the reference may have of its own.
fn reference_error(plan: &TablePlan) -> f64 {
    let model = plan.lobes()[0].model();
    match model.integral {
        _ if plan.quantity() == &BRDF => 1e-12,
        Integral::Slopes(_) => 1e-11,
        _ => 1e-9,
    }
}

/// The case of a number: the words of each way that breaks its estimate.
fn broken(number: u64, baker: &(Baker, wgpu::Device, wgpu::Queue)) -> Option<Vec<String>> {
    let mut random = fastrand::Rng::with_seed(SEED.wrapping_add(number.wrapping_mul(0x9e37_79b9_7f4a_7c15)));
    let plan = plan(&mut random)?;
    let model = plan.lobes()[0].model();
    let costly = model.is_anisotropic() || !model.has_counts();
    let count = match (plan.quantity() == &RHO_HH, costly) {
        (true, true) => 1,
        (true, false) => 4,
        (false, true) => 6,
        (false, false) => TEXELS,
    };
    let mut texels: Vec<_> = (0..count).map(|_| random.usize(0..plan.texels())).collect();
    texels.extend((plan.quantity() != &RHO_HH).then_some([0, plan.texels() - 1]).into_iter().flatten());
    let truth: Vec<_> = texels.par_iter().map(|&texel| (texel, reference(&plan, texel))).collect();
    let mut broken = Vec::new();
    let mut compare =
        |way: &str, estimate: Option<f64>, floor: Option<f64>, value: &dyn Fn(usize, usize) -> f64| {
            let Some(estimate) = estimate else { return };
            let mut worst = (0.0, String::new());
            for (texel, truth) in &truth {
                for (channel, truth) in truth.iter().enumerate() {
                    let error = (value(*texel, channel) - truth).abs();
                    let error = floor.map_or(error, |floor| error / truth.abs().max(floor));
                    // NaN is the worst.
                    if error > worst.0 || error.is_nan() {
                        worst = (error, format!("{} for {truth} at texel {texel}", value(*texel, channel)));
                    }
                }
            }
            let (error, place) = worst;
            if error > estimate + reference_error(&plan) || error.is_nan() {
                broken.push(format!("{way}: {error:.3e} where {estimate:.3e} is estimated, {place}"));
            }
        };
    for evaluator in evaluators() {
        for check in [Check::Sample(0), Check::Sample(1)] {
            let way = format!(
                "{check:?} on {}",
                if matches!(evaluator, Evaluator::Cpu) { "the CPU" } else { "the device" }
            );
            match evaluator.bake(&plan, check, &mut Timings::default(), &Unobserved) {
                Ok(table) => {
                    compare(&way, table.error.estimate, table.error.floor, &|t, c| table.value(t, c));
                }
                Err(why) => {
                    compare(&format!("{way}, {why}"), Some(-1.0), None, &|_, _| f64::NAN);
                }
            }
        }
    }
    let (baker, device, queue) = baker;
    if plan.storage() == Storage::F32 {
        let mut encoder = device.create_command_encoder(&Default::default());
        match baker.record(&mut encoder, &plan) {
            Ok(Recorded { buffer, width, row, channels, .. }) => {
                let copy = device.create_buffer(&wgpu::BufferDescriptor {
                    label: None,
                    size: buffer.size(),
                    usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                    mapped_at_creation: false,
                });
                encoder.copy_buffer_to_buffer(&buffer, 0, &copy, 0, buffer.size());
                queue.submit([encoder.finish()]);
                copy.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
                device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
                let bytes = copy.get_mapped_range(..).unwrap().to_vec();
                let value = |texel: usize, channel: usize| {
                    let place = ((texel / width * row + texel % width) * channels + channel) * 4;
                    f64::from(f32::from_le_bytes(bytes[place..place + 4].try_into().unwrap()))
                };
                let table =
                    Evaluator::Cpu.bake(&plan, Check::Sample(0), &mut Timings::default(), &Unobserved);
                let floor = table.ok().and_then(|table| table.error.floor);
                compare("an embedder", Some(plan.tolerance()), floor, &value);
            }
            // A refusal is no error that is too small.
            Err(why) => assert!(
                plan.precision() == Precision::F64
                    || plan.quantity() == &BRDF
                    || format!("{why}").contains("loop"),
                "{why}"
            ),
        }
    }
    let what = format!("{number}: {plan} {:?}, {}", plan.parameters(), plan.precision().name());
    println!("{what}{}", if broken.is_empty() { "" } else { " BROKEN" });
    broken.iter().for_each(|way| println!("    {way}"));
    Some(broken.into_iter().map(|way| format!("{what}: {way}")).collect())
}

#[test]
#[ignore = "a thousand tables against the reference at full accuracy take half an hour"]
fn the_estimate_bounds_the_error_of_a_thousand_tables() {
    let number = |name: &str| std::env::var(name).ok().map(|text| text.parse::<u64>().unwrap());
    let (device, queue) = engine(wgpu::Limits::default()).unwrap();
    let baker = (Baker::new(&device, &queue), device, queue);
    if let Some(case) = number("GONIO_CASE") {
        let broken = broken(case, &baker).unwrap_or_default();
        assert!(broken.is_empty(), "{broken:#?}");
        return;
    }
    let from = number("GONIO_FROM").unwrap_or(0);
    let count = number("GONIO_CASES").unwrap_or(1000);
    println!("seed {SEED}");
    let cases = (from..).filter_map(|number| broken(number, &baker)).take(count as usize);
    let broken: Vec<_> = cases.flatten().collect();
    assert!(broken.is_empty(), "{} broken: {broken:#?}", broken.len());
}
