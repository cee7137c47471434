//! The canary: what a driver does to shaders and WGSL leaves open, found by one small dispatch.

use crate::backend::gpu::baker::Step;
use crate::backend::gpu::device::Device;
use crate::base::error::{Error, Result};
use crate::base::precision::Precision;
use crate::shader::Kernel;
use bytemuck::{Pod, Zeroable};

/// What a driver does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Canary {
    /// Turns of loops after which it stops an invocation's, and says nothing; none where all [`ASKED_TURNS`] ran.
    pub loop_turns: Option<u32>,
    /// It rounds a·b + c once, not twice.
    pub contracts: bool,
    /// `fma` rounds once.
    pub fused_fma: bool,
    /// It takes (a + b) − b for a.
    pub reassociates: bool,
    /// Denormals are 0 to it, as operands or as results.
    pub flushes_denormals: bool,
    /// x ≠ x is true of NaN.
    pub tells_nan: bool,
}

/// Turns of a loop that the canary asks for: no table that is believed takes more.
pub const ASKED_TURNS: u32 = 1 << 20;

impl Canary {
    /// Turns that are known to run: of all loops of an invocation, inner and outer ones together.
    pub fn known_turns(&self) -> u32 {
        self.loop_turns.unwrap_or(ASKED_TURNS)
    }
}

/// `Given` of `shaders/probe/canary.wgsl`.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Given {
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

/// `Found` of `shaders/probe/canary.wgsl`: the bits of its results.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Found {
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
const GIVEN: Given = Given {
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

/// Exact, denormals included.
const fn power_of_2(exponent: i32) -> f32 {
    f32::from_bits(if exponent < -126 { 1 << (exponent + 149) } else { ((exponent + 127) as u32) << 23 })
}

impl Device {
    /// What its driver does. It is asked once, and only by who needs it: that takes as long as a small table.
    ///
    /// # Errors
    /// When the device fails, or computes what no arithmetic would.
    pub fn canary(&self) -> Result<Canary> {
        if let Some(canary) = self.canary.get() {
            return Ok(*canary);
        }
        let canary = self.guarded(|| self.ask())?.judge().map_err(|what| {
            Error::Device(format!("{}: this driver cannot be trusted: {what}; take another", self.name()))
        })?;
        Ok(*self.canary.get_or_init(|| canary))
    }

    /// Turns of loops that its driver is known to run.
    pub(crate) fn known_turns(&self) -> Result<u32> {
        Ok(self.canary()?.known_turns())
    }

    fn ask(&self) -> Result<Found> {
        let pipeline = self.baker.pipeline(Kernel::Canary, None, 0, Precision::F32)?;
        let given = self.baker.init(bytemuck::bytes_of(&GIVEN), wgpu::BufferUsages::STORAGE);
        let output = self.baker.output(size_of::<Found>());
        let staging = self.staging(output.size());
        let bind_group = self.baker.bind(&pipeline, [&output, &given].map(wgpu::Buffer::as_entire_binding));
        let mut encoder = self.baker.device.create_command_encoder(&Default::default());
        Step { pipeline, bind_group, workgroups: [1, 1], evaluations: 0 }.encode(&mut encoder);
        let flight = self.send(encoder, &output, &staging, output.size());
        self.arrive(&flight)?;
        let mut found = Found::zeroed();
        self.land(&staging, flight, &mut |bytes| found = bytemuck::pod_read_unaligned(bytes))?;
        Ok(found)
    }
}

impl Found {
    /// What it says of the driver: of each result all that it may be is known, to the bit.
    fn judge(&self) -> Result<Canary, String> {
        let is = |what: &str, bits: u32, no: f32, yes: f32| {
            let found = f32::from_bits(bits);
            match (bits == no.to_bits(), bits == yes.to_bits()) {
                (true, _) => Ok(false),
                (_, true) => Ok(true),
                _ => Err(format!("{what} gave {found:e}, and may be {no:e} or {yes:e}")),
            }
        };
        let Given { small, denormal, scale, tiny, .. } = GIVEN;
        let dropped = power_of_2(-24);
        let normal = denormal * scale;
        Ok(Canary {
            loop_turns: self.loop_turns()?,
            contracts: is("a·b + c", self.product_and_sum, 0.0, dropped)?,
            fused_fma: is("fma", self.fma, 0.0, dropped)?,
            reassociates: is("(a + b) − b", self.sum_and_difference, 0.0, small)?,
            flushes_denormals: is("the product of a denormal", self.from_denormal, normal, 0.0)?
                | is("a denormal product", self.to_denormal, tiny * tiny, 0.0)?,
            tells_nan: self.nan_differs == 1,
        })
    }

    /// Of all invocations the fewest turns, if that is fewer than asked for.
    fn loop_turns(&self) -> Result<Option<u32>, String> {
        let mut made = (0, 0);
        for &[turns, state] in &self.turns {
            if made.0 != turns {
                made = (turns, generated(turns));
            }
            if turns == 0 || turns > ASKED_TURNS || state != made.1 {
                return Err(format!(
                    "a loop of {ASKED_TURNS} turns says that it took {turns}, and made {state}"
                ));
            }
        }
        let fewest = self.turns.iter().map(|[turns, _]| *turns).min();
        Ok(fewest.filter(|&turns| turns < ASKED_TURNS))
    }
}

/// What so many turns of the shader's loop make.
fn generated(turns: u32) -> u32 {
    (0..turns).fold(0, |state: u32, _| state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a driver without oddities finds.
    fn plain() -> Found {
        Found {
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
        let Given { x, minus_x2, small, large, denormal, scale, tiny, .. } = GIVEN;
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
        let contracts = Found { product_and_sum: power_of_2(-24).to_bits(), ..plain() };
        assert_eq!(contracts.judge(), Ok(Canary { contracts: true, ..plain_canary }));
        let reassociates = Found { sum_and_difference: power_of_2(-30).to_bits(), ..plain() };
        assert_eq!(reassociates.judge(), Ok(Canary { reassociates: true, ..plain_canary }));
        for flushes in [Found { from_denormal: 0, ..plain() }, Found { to_denormal: 0, ..plain() }] {
            assert_eq!(flushes.judge(), Ok(Canary { flushes_denormals: true, ..plain_canary }));
        }
        let mut stops = plain();
        stops.turns[63] = [65_535, generated(65_535)];
        assert_eq!(stops.judge(), Ok(Canary { loop_turns: Some(65_535), ..plain_canary }));
        stops.turns[63][0] += 1;
        assert!(stops.judge().unwrap_err().contains("says that it took 65536"));
        assert!(Found { fma: 1.0f32.to_bits(), ..plain() }.judge().unwrap_err().contains("fma gave 1e0"));
        assert!(Found::zeroed().judge().is_err(), "nothing ran");
    }
}
