//! The device path: uploads a plan's rule sets, and records or runs the kernels that evaluate it.
//!
//! [`Baker`] works on a device that the caller owns and records into the caller's encoder; the
//! headless bake is the same recording, split into submissions and read back.

pub(crate) mod baker;
#[cfg(feature = "lab")]
mod benchmark;
pub(crate) mod device;
pub(crate) mod dispatch;
pub(crate) mod driver_probe;
pub(crate) mod loop_limit;
mod points;
pub(crate) mod readback;
mod texture;

pub use baker::{Baker, Prepared, Recorded};
#[cfg(feature = "lab")]
pub(crate) use benchmark::{Rates, WarmTable};
pub use device::{Adapter, Device, DeviceChoice, INSTALL, adapters};
pub use driver_probe::{ASKED_TURNS, Canary};
pub(crate) use points::PointKernels;
pub use texture::TextureFormat;
