//! Registers the models of an embedder.

use super::{Kernel, compose, validate};
use crate::base::error::{Error, Result};
use crate::base::precision::Precision;
use crate::model::{self, Model, ModelBuilder};

/// Registers an embedder's model by its name, so that recipes, plans and checks find it as any other: see
/// `examples/custom.rs`.
///
/// # Errors
/// When a model of this name is known, something of the model is missing, or its shader is not valid.
pub fn register(model: ModelBuilder) -> Result<&'static Model> {
    let model = model.build()?;
    if model::find(model.name).is_ok() {
        return Err(Error::input(format!(
            "there is a model \"{}\" already; give yours another name",
            model.name
        )));
    }
    if !model.is_delta() {
        let source = compose(Kernel::Points, Some(model), 1, Precision::F32);
        let why = |e| Error::input(format!("the shader of \"{}\" does not fit: {e}", model.name));
        validate(&source, Precision::F32).map_err(why)?;
    }
    model::add_registered(model);
    Ok(model)
}
