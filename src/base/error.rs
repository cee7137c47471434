//! The one error type. Every message names the file or input, the place in it, and the remedy.

use std::path::{Path, PathBuf};

/// An error, sorted by who can mend it; the command's exit code follows the sort.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The input is not usable: a scene, a recipe, a parameter, an axis.
    #[error("{0}")]
    Input(String),

    /// A file or folder could not be read or written.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The action that failed: "read", "write", "create the folder".
        action: &'static str,
        /// The operating system's reason.
        source: std::io::Error,
    },

    /// No adapter fits, or the device failed while it worked.
    #[error("{0}")]
    Device(String),

    /// A table misses its tolerance, or a promise of a model does not hold.
    #[error("{0}")]
    Promise(String),

    /// The user asked to stop.
    #[error("interrupted; the files on disk are as they were")]
    Interrupted,

    /// A fault of ours, not of the input.
    #[error("internal error: {0}; please report it")]
    Internal(String),
}

/// The crate's result.
pub type Result<T, E = Error> = std::result::Result<T, E>;

impl Error {
    /// Makes an [`Error::Input`] with a message.
    pub fn input(message: impl Into<String>) -> Self {
        Self::Input(message.into())
    }

    /// Turns an [`std::io::Error`] into one that names the path: `.map_err(Error::io("read", path))`.
    pub fn io(action: &'static str, path: impl AsRef<Path>) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.as_ref().to_owned();
        move |source| Self::Io { path, action, source }
    }

    /// Puts the place in front of an input error: `scene.gltf: materials[2]: roughness …`.
    pub fn at(self, place: impl std::fmt::Display) -> Self {
        match self {
            Self::Input(message) => Self::Input(format!("{place}: {message}")),
            other => other,
        }
    }
}
