//! Targets: how the reader of a table, such as an engine, wants its axes, channels, storage and container. A target is a
//! file here and a line of the registry.

use crate::base::error::{Error, Result};
use crate::io::format::Format;
use crate::table::axis::{Axis, Variable};
use crate::table::storage::{Storage, Stored};
use crate::table::{ErrorKind, Table, TableError, Values, indices};

/// What a reader wants of a table. [`apply`](Self::apply) makes the table that it reads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// The name on the command line and in manifests.
    pub name: &'static str,
    /// One line for people.
    pub summary: &'static str,
    /// The axes, slowest first; `None` leaves them as they are.
    pub axes: Option<&'static [TargetAxis]>,
    /// The channels in order; `None` leaves them as they are.
    pub channels: Option<&'static [TargetChannel]>,
    /// The format of the values; `None` leaves them as they are.
    pub storage: Option<Storage>,
    /// The only file format that it reads; `None` lets the user choose.
    pub container: Option<&'static Format>,
}

/// An axis as a target has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TargetAxis {
    /// The variable of the table's axis.
    pub variable: Variable,
    /// Whether it runs from the largest value to the smallest.
    pub flipped: bool,
}

/// A channel as a target has it: constant + Σ factor · channel. Its constant alone fills a channel that the target has
/// and the table has not, such as alpha.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TargetChannel {
    /// Its name.
    pub name: &'static str,
    /// The table's channels that it sums, each times a factor.
    pub terms: &'static [(&'static str, f64)],
    /// What is added to them.
    pub constant: f64,
}

/// Declares the modules of the targets and [`TARGETS`] from one list.
macro_rules! targets {
    ($($module:ident::$name:ident,)*) => {
        $(mod $module; pub use $module::$name;)*

        /// The registry.
        pub static TARGETS: &[&Target] = &[$(&$name),*];
    };
}

targets! {
    identity::IDENTITY,
}

impl Target {
    /// Whether it takes tables as they are.
    pub fn is_identity(&self) -> bool {
        self.axes.is_none() && self.channels.is_none() && self.storage.is_none()
    }

    /// The formats of its files: its container, or those that are asked for.
    pub fn formats(&self, wanted: &[&'static Format]) -> Vec<&'static Format> {
        self.container.map_or_else(|| wanted.to_vec(), |container| vec![container])
    }

    /// The table that the target reads: the same values in its order, combined to its channels and rounded to its
    /// storage. What is known of the table's error stays where it still holds.
    ///
    /// # Errors
    /// When the table has other axes than the target, lacks a channel of it, or has values beyond its storage.
    pub fn apply(&self, table: Table) -> Result<Table> {
        if self.is_identity() {
            return Ok(table);
        }
        let axes = self.axis_order(&table)?;
        let channels = self.channel_terms(&table)?;
        let storage = self.storage.unwrap_or(table.storage);

        let values = values(&table, &axes, &channels);
        let refuse = |why| Error::input(format!("table {}: target {}: {why}", table.name, self.name));
        let Stored { values, underflows, rounding } =
            match storage == table.storage && channels_are_copies(&channels) {
                true => Stored {
                    values,
                    underflows: table.error.underflows.unwrap_or(0),
                    rounding: table.error.rounding.unwrap_or(0.0),
                },
                false => storage.store(values, table.error.kind).map_err(refuse)?,
            };
        let keeps_values = storage == table.storage && channels_are_a_permutation(&channels, &table);
        let mut error = match keeps_values {
            true => permuted(&table.error, &channels),
            false => bounded(&table.error, &channels, rounding),
        };
        error.underflows = (storage == Storage::F16).then_some(underflows);
        error.rounding = (storage.bytes() < Storage::F32.bytes()).then_some(rounding);
        Ok(Table {
            axes: axes.iter().map(|&(k, flipped)| oriented(&table.axes[k], flipped)).collect(),
            channels: channels.iter().map(|channel| channel.name.clone()).collect(),
            values,
            storage,
            bilinear: table.bilinear.filter(|_| keeps_values),
            error,
            ..table
        })
    }

    /// The table's axis of each of the target's, and whether it is flipped.
    fn axis_order(&self, table: &Table) -> Result<Vec<(usize, bool)>> {
        let Some(wanted) = self.axes else {
            return Ok((0..table.axes.len()).map(|k| (k, false)).collect());
        };
        let find = |axis: &TargetAxis| {
            let k = table.axes.iter().position(|given| given.variable() == axis.variable)?;
            Some((k, axis.flipped))
        };
        let order: Option<Vec<_>> = wanted.iter().map(find).collect();
        // As many axes as the table has, and each of them once.
        let is_whole = |order: &Vec<(usize, bool)>| {
            order.len() == table.axes.len() && (0..order.len()).all(|k| order.iter().any(|&(j, _)| j == k))
        };
        order.filter(is_whole).ok_or_else(|| {
            let names = |variables: &mut dyn Iterator<Item = Variable>| {
                variables.map(Variable::name).collect::<Vec<_>>().join(", ")
            };
            Error::input(format!(
                "table {}: target {} takes tables over ({}), and this one is over ({}); bake it over these axes",
                table.name,
                self.name,
                names(&mut wanted.iter().map(|axis| axis.variable)),
                names(&mut table.axes.iter().map(Axis::variable)),
            ))
        })
    }

    /// The target's channels as sums of the table's.
    fn channel_terms(&self, table: &Table) -> Result<Vec<ChannelSum>> {
        let Some(wanted) = self.channels else {
            let copies = table.channels.iter().enumerate();
            return Ok(copies
                .map(|(c, name)| ChannelSum { name: name.clone(), terms: vec![(c, 1.0)], constant: 0.0 })
                .collect());
        };
        let find = |&(name, factor): &(&str, f64)| {
            let c = table.channels.iter().position(|channel| channel == name).ok_or_else(|| {
                let given = table.channels.join(", ");
                Error::input(format!(
                    "table {}: target {} takes a channel {name}, and there are {given}; bake a table that has it",
                    table.name, self.name
                ))
            })?;
            Ok((c, factor))
        };
        let sums = wanted.iter().map(|channel| {
            let terms = channel.terms.iter().map(find).collect::<Result<_>>()?;
            Ok(ChannelSum { name: channel.name.into(), terms, constant: channel.constant })
        });
        sums.collect()
    }
}

/// A channel as a sum of a table's channels, by their numbers.
struct ChannelSum {
    name: String,
    terms: Vec<(usize, f64)>,
    constant: f64,
}

impl ChannelSum {
    fn value(&self, channel: impl Fn(usize) -> f64) -> f64 {
        match self.copied() {
            Some(c) => channel(c),
            None => self.terms.iter().fold(self.constant, |sum, &(c, factor)| sum + factor * channel(c)),
        }
    }

    /// The one channel that it is, if it is no more than that.
    fn copied(&self) -> Option<usize> {
        match self.terms[..] {
            [(c, 1.0)] if self.constant == 0.0 => Some(c),
            _ => None,
        }
    }
}

/// The values in the order of `axes`, combined to `channels`.
fn values(table: &Table, axes: &[(usize, bool)], channels: &[ChannelSum]) -> Values {
    let shape: Vec<_> = axes.iter().map(|&(k, _)| table.axes[k].len()).collect();
    let mut values = Vec::with_capacity(table.texels() * channels.len());
    for texel in 0..table.texels() {
        let mut source = vec![0; axes.len()];
        for (&(k, flipped), index) in axes.iter().zip(indices(&shape, texel)) {
            source[k] = if flipped { table.axes[k].len() - 1 - index } else { index };
        }
        let source = source.iter().zip(&table.axes).fold(0, |flat, (index, axis)| flat * axis.len() + index);
        values.extend(channels.iter().map(|channel| channel.value(|c| table.value(source, c))));
    }
    match &table.values {
        Values::F32(_) => Values::F32(values.into_iter().map(|value| value as f32).collect()),
        Values::F64(_) => Values::F64(values),
    }
}

/// Whether each value is one of the table's, so that nothing is rounded again.
fn channels_are_copies(channels: &[ChannelSum]) -> bool {
    channels.iter().all(|channel| channel.copied().is_some())
}

/// Whether they are the table's channels, each once, in some order.
fn channels_are_a_permutation(channels: &[ChannelSum], table: &Table) -> bool {
    let count = table.channels.len();
    channels.len() == count && (0..count).all(|c| channels.iter().any(|channel| channel.copied() == Some(c)))
}

/// An axis as it is, or from its largest value to its smallest.
fn oriented(axis: &Axis, flipped: bool) -> Axis {
    if flipped { axis.reversed() } else { axis.clone() }
}

/// The error of a table whose channels are in another order.
fn permuted(error: &TableError, channels: &[ChannelSum]) -> TableError {
    let mut error = error.clone();
    let moved = |old: f64| channels.iter().position(|channel| channel.copied() == Some(old as usize));
    if let Some(channel) = error.worst.get_mut("channel")
        && let Some(new) = moved(*channel)
    {
        *channel = new as f64;
    }
    error
}

/// What bounds the error of sums of channels that are rounded again: |Σ f x − Σ f x̃| ≤ Σ |f| · max |x − x̃|, and the
/// rounding. Relative errors of sums have no such bound, as their terms may cancel.
fn bounded(error: &TableError, channels: &[ChannelSum], rounding: f64) -> TableError {
    let factors = |channel: &ChannelSum| channel.terms.iter().map(|(_, factor)| factor.abs()).sum::<f64>();
    let largest = channels.iter().map(factors).fold(0.0, f64::max);
    let known = error.estimate.into_iter().chain(error.measured_max).reduce(f64::max);
    let bound = known.map(|known| largest * known + rounding);
    TableError::unmeasured(error.kind, error.floor, bound.filter(|_| error.kind == ErrorKind::Absolute))
}

#[cfg(test)]
mod tests;
