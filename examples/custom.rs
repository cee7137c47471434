//! A model of your own, registered at run time: the Lommel–Seeliger law of dark planets, f = w / (4π (μi + μe)).
//!
//!     cargo run --release --example custom
//!
//! It takes what every model here takes: a shader, its twin in f64, where it lives, and a reference. From then on
//! recipes, plans, tables and checks know it by its name.

use gonio::backend::gpu::DeviceChoice;
use gonio::bake::{Evaluator, Unobserved};
use gonio::base::quadrature::gauss_legendre;
use gonio::base::timings::Timings;
use gonio::check::{self, Check};
use gonio::model::directions::{Fixed, Map, Sample};
use gonio::model::lobe::Lobe;
use gonio::model::parameters;
use gonio::model::{Integral, Model, ModelBuilder};
use gonio::plan::TablePlan;
use gonio::reference::{Angles, MIN_MU, Reference, Setting};
use gonio::table::axis::{Axis, Variable};
use gonio::table::quantity::RHO_DH;
use gonio::verify;
use gonio::verify::{Sum, VerifyOptions};
use std::f64::consts::PI;

fn lommel_seeliger() -> ModelBuilder {
    Model::builder("lommel-seeliger")
        .describe("dark dust, as of the Moon: f = w/(4π (μi + μe))", "Seeliger 1888; Hapke 2012, eq. 8.35")
        .component("albedo", Some(0.1))
        .shader(
            "custom/lommel_seeliger",
            "fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 { return real2(row, 0.0); }
             fn lobe_row(p: Pair, alpha: real) -> real { return 0.25 * INV_PI / (p.mu_i + p.mu_e); }",
        )
        .twin(|p, _, _| [0.25 / (PI * (p.mu_i + p.mu_e)), 0.0])
        .integral(Integral::Listed(Map { samples, most: |_, _| 2 * NODES, mean: None, limit: |_, _| None }))
        .rho_bound(1.0)
}

/// f turns at μe ≈ μi, however small that is: nodes crowd at the horizon, μe = x⁸.
const NODES: usize = 24;

fn samples(fixed: &Fixed, _: &parameters::Setting, _tolerance: f64) -> Vec<Sample> {
    let nodes = gauss_legendre(NODES);
    let sample = |(x, weight): (f64, f64)| {
        let mu = x.powi(8);
        // 2π μ dμ: f is the same at all azimuths.
        Sample::new(fixed.mu.acos(), mu.acos(), 0.0, 2.0 * PI * mu * 8.0 * x.powi(7) * weight)
    };
    nodes.iter().map(|node| sample((node.x, node.weight))).collect()
}

struct LommelSeeliger;

impl Reference for LommelSeeliger {
    fn brdf(&self, angles: &Angles, _: &Setting) -> Option<[f64; 2]> {
        let [mu_i, mu_e] = [angles.theta_i, angles.theta_e].map(|theta| theta.cos().max(MIN_MU));
        Some([1.0 / (4.0 * PI * (mu_i + mu_e)), 0.0])
    }

    /// ½ ∫ μe/(μi + μe) dμe = ½ (1 − μi ln(1 + 1/μi))
    fn rho_dh(&self, mu: f64, _: &Setting) -> [f64; 2] {
        let mu = mu.max(MIN_MU);
        [0.5 * (1.0 - mu * (1.0 / mu).ln_1p()), 0.0]
    }
}

fn main() -> gonio::Result<()> {
    let model = gonio::shader::register(lommel_seeliger())?;
    check::register_reference(model, &LommelSeeliger)?;
    let (evaluator, line) = Evaluator::choose(&DeviceChoice::Auto)?;
    println!("{line}");

    let axes = vec![Axis::natural(Variable::ThetaI, 64)?];
    let plan = TablePlan::basis("moon", &RHO_DH, model, None, axes)?;
    let table =
        evaluator.bake(&plan.with_tolerance(1e-6)?, Check::All, &mut Timings::default(), &Unobserved)?;
    println!("ρ_dh of 64 θi: {:.1e} off at most", table.error.measured_max.unwrap_or(f64::NAN));

    let mut subject = Sum::model(&evaluator, Lobe::new(model, None, vec![[1.0, 0.0]; 3])?, vec![])?;
    let report = verify::check(
        &mut subject,
        &VerifyOptions { budget: 1_000_000, ..VerifyOptions::default() },
        &Unobserved,
    )?;
    for finding in &report.findings {
        println!("{:14} {:?}: {}", finding.property, finding.verdict, finding.said);
    }
    Ok(())
}
