//! The driver probe (canary): one small dispatch finds how the driver does what WGSL leaves open.

use crate::backend::gpu::baker::DispatchStep;
use crate::backend::gpu::device::Device;
use crate::base::error::{Error, Result};
use crate::base::precision::Precision;
use crate::shader::Kernel;
use bytemuck::{Pod, Zeroable};

/// The behaviour of a driver that WGSL leaves open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Canary {
    /// The number of turns after which it silently stops an invocation's loops; `None` where all [`ASKED_TURNS`] ran.
    pub loop_turns: Option<u32>,
    /// Whether it rounds a·b + c once, not twice.
    pub contracts: bool,
    /// Whether `fma` rounds once.
    pub fused_fma: bool,
    /// Whether it takes (a + b) − b for a.
    pub reassociates: bool,
    /// Whether it takes denormal operands or results for 0.
    pub flushes_denormals: bool,
    /// Whether x ≠ x is true of NaN.
    pub tells_nan: bool,
}

/// The number of turns of the probe's loop. A table whose loops take more is refused.
pub const ASKED_TURNS: u32 = 1 << 20;

impl Canary {
    /// The number of turns that are known to run, of all loops of an invocation together.
    pub fn known_turns(&self) -> u32 {
        self.loop_turns.unwrap_or(ASKED_TURNS)
    }
}

/// The inputs of the probe: `Given` of `shaders/probe/canary.wgsl`.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct ProbeInputs {
    turns: u32,
    x: f32,
    minus_x2: f32,
    small: f32,
    large: f32,
    denormal: f32,
    scale: f32,
    tiny: f32,
    nan: f32,
}

/// The bits of the probe's results: `Found` of `shaders/probe/canary.wgsl`.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct ProbeResults {
    product_and_sum: u32,
    fma: u32,
    sum_and_difference: u32,
    from_denormal: u32,
    to_denormal: u32,
    nan_differs: u32,
    turns: [[u32; 2]; INVOCATIONS],
}

const INVOCATIONS: usize = 64;

/// x = 1 + 2⁻¹² has x² = 1 + 2⁻¹¹ + 2⁻²⁴, a tie that rounds to 1 + 2⁻¹¹.
const PROBE_INPUTS: ProbeInputs = ProbeInputs {
    turns: ASKED_TURNS,
    x: 1.0 + power_of_2(-12),
    minus_x2: -1.0 - power_of_2(-11),
    small: power_of_2(-30),
    large: 1.0,
    denormal: power_of_2(-130),
    scale: power_of_2(30),
    tiny: power_of_2(-65),
    nan: f32::NAN,
};

/// The exact power of 2, denormal or not.
const fn power_of_2(exponent: i32) -> f32 {
    f32::from_bits(if exponent < -126 { 1 << (exponent + 149) } else { ((exponent + 127) as u32) << 23 })
}

impl Device {
    /// Probes the driver, once for each device and only when a caller needs it: the probe takes as long as a small table.
    ///
    /// # Errors
    /// When the device fails, or computes what no arithmetic would.
    pub fn canary(&self) -> Result<Canary> {
        if let Some(canary) = self.canary.get() {
            return Ok(*canary);
        }
        let canary = self.guarded(|| self.run_probe())?.judge().map_err(|why| {
            Error::Device(format!("{}: this driver cannot be trusted: {why}; take another", self.name()))
        })?;
        Ok(*self.canary.get_or_init(|| canary))
    }

    /// The number of turns of loops that the driver is known to run.
    pub(crate) fn known_turns(&self) -> Result<u32> {
        Ok(self.canary()?.known_turns())
    }

    /// Runs the probe.
    fn run_probe(&self) -> Result<ProbeResults> {
        let pipeline = self.baker.pipeline(Kernel::Canary, None, 0, Precision::F32)?;
        let given = self.baker.init(bytemuck::bytes_of(&PROBE_INPUTS), wgpu::BufferUsages::STORAGE);
        let output = self.baker.output(size_of::<ProbeResults>());
        let staging = self.staging(output.size());
        let bind_group = self.baker.bind(&pipeline, [&output, &given].map(wgpu::Buffer::as_entire_binding));
        let mut encoder = self.baker.device.create_command_encoder(&Default::default());
        DispatchStep { pipeline, bind_group, workgroups: [1, 1], evaluations: 0 }.encode(&mut encoder);
        let flight = self.send(encoder, &output, &staging, output.size());
        self.arrive(&flight)?;
        let mut found = ProbeResults::zeroed();
        self.land(&staging, flight, &mut |bytes| found = bytemuck::pod_read_unaligned(bytes))?;
        Ok(found)
    }
}

impl ProbeResults {
    /// Reads the driver's behaviour from the results. Each result may have two values, known to the bit.
    fn judge(&self) -> Result<Canary, String> {
        let answer = |expression: &str, bits: u32, no: f32, yes: f32| {
            let found = f32::from_bits(bits);
            match (bits == no.to_bits(), bits == yes.to_bits()) {
                (true, _) => Ok(false),
                (_, true) => Ok(true),
                _ => Err(format!("{expression} gave {found:e}, and may be {no:e} or {yes:e}")),
            }
        };
        let ProbeInputs { small, denormal, scale, tiny, .. } = PROBE_INPUTS;
        let dropped = power_of_2(-24);
        let normal = denormal * scale;
        Ok(Canary {
            loop_turns: self.loop_turns()?,
            contracts: answer("a·b + c", self.product_and_sum, 0.0, dropped)?,
            fused_fma: answer("fma", self.fma, 0.0, dropped)?,
            reassociates: answer("(a + b) − b", self.sum_and_difference, 0.0, small)?,
            flushes_denormals: answer("the product of a denormal", self.from_denormal, normal, 0.0)?
                | answer("a denormal product", self.to_denormal, tiny * tiny, 0.0)?,
            tells_nan: self.nan_differs == 1,
        })
    }

    /// The fewest turns of all invocations, if they are fewer than [`ASKED_TURNS`].
    fn loop_turns(&self) -> Result<Option<u32>, String> {
        let mut last = (0, 0);
        for &[turns, state] in &self.turns {
            if last.0 != turns {
                last = (turns, generated(turns));
            }
            if turns == 0 || turns > ASKED_TURNS || state != last.1 {
                return Err(format!(
                    "a loop of {ASKED_TURNS} turns says that it took {turns}, and made {state}"
                ));
            }
        }
        let fewest = self.turns.iter().map(|[turns, _]| *turns).min();
        Ok(fewest.filter(|&turns| turns < ASKED_TURNS))
    }
}

/// The state that a number of turns of the shader's loop generates.
fn generated(turns: u32) -> u32 {
    (0..turns).fold(0, |state: u32, _| state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The results of a driver without oddities.
    fn plain() -> ProbeResults {
        ProbeResults {
            product_and_sum: 0,
            fma: power_of_2(-24).to_bits(),
            sum_and_difference: 0,
            from_denormal: power_of_2(-100).to_bits(),
            to_denormal: power_of_2(-130).to_bits(),
            nan_differs: 1,
            turns: [[ASKED_TURNS, generated(ASKED_TURNS)]; INVOCATIONS],
        }
    }

    /// The inputs tell what they are meant to tell: in this processor's arithmetic, which is IEEE's.
    #[test]
    fn inputs_tell_one_rounding_from_two() {
        let ProbeInputs { x, minus_x2, small, large, denormal, scale, tiny, .. } = PROBE_INPUTS;
        let black_box = std::hint::black_box::<f32>;
        assert_eq!((black_box(x) * x + minus_x2, x.mul_add(x, minus_x2)), (0.0, power_of_2(-24)));
        assert_eq!((black_box(small) + large) - large, 0.0);
        assert!(denormal.is_subnormal() && (denormal * scale).is_normal() && (tiny * tiny).is_subnormal());
        assert_eq!([power_of_2(-130), power_of_2(-24)], [2f64.powi(-130) as f32, 2f64.powi(-24) as f32]);
    }

    #[test]
    fn each_oddity_is_told() {
        let plain_canary = Canary {
            loop_turns: None,
            contracts: false,
            fused_fma: true,
            reassociates: false,
            flushes_denormals: false,
            tells_nan: true,
        };
        assert_eq!(plain().judge(), Ok(plain_canary));
        let contracts = ProbeResults { product_and_sum: power_of_2(-24).to_bits(), ..plain() };
        assert_eq!(contracts.judge(), Ok(Canary { contracts: true, ..plain_canary }));
        let reassociates = ProbeResults { sum_and_difference: power_of_2(-30).to_bits(), ..plain() };
        assert_eq!(reassociates.judge(), Ok(Canary { reassociates: true, ..plain_canary }));
        for flushes in
            [ProbeResults { from_denormal: 0, ..plain() }, ProbeResults { to_denormal: 0, ..plain() }]
        {
            assert_eq!(flushes.judge(), Ok(Canary { flushes_denormals: true, ..plain_canary }));
        }
        let mut stops = plain();
        stops.turns[63] = [65_535, generated(65_535)];
        assert_eq!(stops.judge(), Ok(Canary { loop_turns: Some(65_535), ..plain_canary }));
        stops.turns[63][0] += 1;
        assert!(stops.judge().unwrap_err().contains("says that it took 65536"));
        assert!(
            ProbeResults { fma: 1.0f32.to_bits(), ..plain() }.judge().unwrap_err().contains("fma gave 1e0")
        );
        assert!(ProbeResults::zeroed().judge().is_err(), "nothing ran");
    }
}
