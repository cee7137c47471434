//! Drawing: canvases, colour maps, labels and scales of pictures.

pub(crate) mod canvas;
pub(crate) mod colormap;
#[cfg(feature = "cli")]
pub(crate) mod labels;
pub(crate) mod panel;
#[cfg(feature = "cli")]
pub(crate) mod polar;
pub(crate) mod raster;
pub(crate) mod scale;
pub(crate) mod svg;
