//! The device side: composing the shaders that a plan needs, and recording their work.
//!
//! [`Baker`] works on a device that the caller owns and records into the caller's encoder; the
//! headless bake is the same recording, split into submissions and read back.

mod baker;
mod canary;
mod compose;
mod device;
mod evaluate;
mod light;
mod loops;
mod measure;
mod points;
mod stage;
mod texture;
mod user_shader;

pub use baker::{Baker, Prepared, Recorded};
pub use canary::{ASKED_TURNS, Canary};
pub use compose::{Kernel, compose, validate};
pub use device::{Adapter, Device, DeviceChoice, INSTALL, adapters};
pub(crate) use measure::{Rates, Warm};
pub(crate) use points::Points;
pub use texture::TextureFormat;
pub use user_shader::{UserFunction, UserShader, directions};
