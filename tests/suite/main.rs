//! The suite: one file a promise. One program, as the device is one for all of them, and linking is not for each.

mod common;

mod anisotropy;
mod api;
mod atlas;
mod canary;
mod check;
mod check_targets;
mod classics;
#[cfg(feature = "cli")]
mod cli;
mod compensation;
mod diffuse;
#[cfg(feature = "scene")]
mod disney;
mod embed;
#[cfg(feature = "cli")]
mod eval;
#[cfg(feature = "scene")]
mod extensions;
#[cfg(feature = "files")]
mod files;
mod fresnel;
mod furnace;
mod hostile;
mod integrals;
mod layers;
mod light;
#[cfg(feature = "cli")]
mod maps;
mod mirror_limit;
mod ndfs;
#[cfg(feature = "cli")]
mod outputs;
mod parts;
mod plans;
#[cfg(feature = "cli")]
mod plot;
mod portable;
mod promises;
mod radiometry;
mod restricted;
#[cfg(feature = "scene")]
mod scenes;
mod shaders;
#[cfg(feature = "cli")]
mod storage;
mod stream;
#[cfg(feature = "cli")]
mod supply_chain;
#[cfg(feature = "scene")]
mod textures;
mod thin_film;
mod thousand;
mod trade;
mod truth;
mod values;
