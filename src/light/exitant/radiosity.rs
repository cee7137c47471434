//! Radiosity M = ∫ Le cos θe dωe.

use crate::bake::{Evaluator, Observer, Unobserved};
use crate::base::angles::Angles;
use crate::base::error::{Error, Result};
use crate::base::timings::Timings;
use crate::check::Check;
use crate::light::exitant::{Integrated, View, refine};
use crate::light::{Frame, Light};
use crate::plan::TablePlan;
use crate::scene::Scene;
use crate::table::axis::{Axis, Mapping, Positions, Variable};
use crate::table::quantity::{RHO_DH, RHO_HH};
use std::f64::consts::{FRAC_PI_2, PI};

/// M = ∫ Le cos θe dωe of a material under a light, of each frame: by Fubini ∫ ρ_dh(ωi) L cos θi dωi. The tolerance is
/// relative to M.
///
/// # Errors
/// When the material varies or tells azimuths from each other, its integrals have no bound, or the device fails.
pub fn radiosity(
    evaluator: &Evaluator,
    (scene, material): (&Scene, &str),
    light: &Light,
    frames: &[Frame],
    tolerance: f64,
    observer: &dyn Observer,
) -> Result<Vec<Integrated>> {
    if scene.material(material)?.is_anisotropic() {
        return Err(Error::input(format!(
            "{material}: anisotropic materials have no radiosity here; give equal α"
        )));
    }
    if let Light::Constant(radiance) = light {
        // ∫ ρ_dh cos θ dω = π ρ_hh.
        let rho = mean_albedo(evaluator, scene, material)?;
        let value = std::array::from_fn(|c| PI * radiance.rgb()[c] * rho[c]);
        return Ok(vec![Integrated { value, error: 0.0 }; frames.len()]);
    }
    let albedo = SampledAlbedo::new(evaluator, scene, material)?;
    let mut f = |angles: &[Angles], values: &mut Vec<f32>| {
        values.clear();
        values.extend(angles.iter().flat_map(|angles| albedo.at(angles.theta_i).map(|rho| rho as f32)));
        Ok(())
    };
    let views: Vec<_> = frames.iter().map(|&frame| View { frame, theta_e: 0.0, phi_e: 0.0 }).collect();
    refine::integrate(&mut f, 1.0, light, &views, tolerance, observer)
}

/// ρ_dh of a material over θ, R, G, B; between its samples it is interpolated.
struct SampledAlbedo {
    values: Vec<[f64; 3]>,
}

impl SampledAlbedo {
    /// Samples over θ in even steps: between them ρ is off by their square, 1e-7 over α², and less than that of f32.
    const SAMPLES: usize = 4097;

    fn new(evaluator: &Evaluator, scene: &Scene, material: &str) -> Result<Self> {
        let axis =
            Axis::new(Variable::ThetaI, Self::SAMPLES, [0.0, FRAC_PI_2], Positions::Nodes, Mapping::Linear)?;
        let plan =
            TablePlan::material(material, &RHO_DH, scene, material, vec![axis])?.with_tolerance(1e-6)?;
        let table = evaluator.bake(&plan, Check::Sample(0), &mut Timings::default(), &Unobserved)?;
        let values = (0..table.texels()).map(|k| std::array::from_fn(|c| table.value(k, c))).collect();
        Ok(Self { values })
    }

    fn at(&self, theta: f64) -> [f64; 3] {
        let last = self.values.len() - 1;
        let place = (theta / FRAC_PI_2).clamp(0.0, 1.0) * last as f64;
        let k = (place as usize).min(last - 1);
        let [a, b] = [self.values[k], self.values[k + 1]];
        std::array::from_fn(|c| a[c] + (b[c] - a[c]) * (place - k as f64))
    }
}

/// ρ_hh, R, G, B.
fn mean_albedo(evaluator: &Evaluator, scene: &Scene, material: &str) -> Result<[f64; 3]> {
    let plan = TablePlan::material(material, &RHO_HH, scene, material, Vec::new())?.with_tolerance(1e-7)?;
    let table = evaluator.bake(&plan, Check::Sample(0), &mut Timings::default(), &Unobserved)?;
    Ok(std::array::from_fn(|c| table.value(0, c)))
}
