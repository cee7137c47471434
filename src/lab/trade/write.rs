//! The files of a trade-off.

use crate::base::error::{Error, Result};
use crate::io::write_together;
use crate::lab::trade::picture::draw;
use crate::lab::trade::{Point, Trade};
use serde_json::{Value, json};
use std::path::Path;

/// Writes `trade.csv`, `trade.json` and `trade.png` into a folder, which is made if it is not there. Each
/// is written under another name first, and all are renamed once all are there.
///
/// # Errors
/// When the folder cannot be written.
pub fn write(dir: &Path, trade: &Trade, device: &Value) -> Result<Value> {
    let json = to_json(trade, device);
    let text = serde_json::to_string_pretty(&json).map_err(|e| Error::Internal(e.to_string()))? + "\n";
    let files = [
        ("trade.csv".to_owned(), to_csv(&trade.points).into_bytes()),
        ("trade.json".to_owned(), text.into_bytes()),
        ("trade.png".to_owned(), draw(trade)?),
    ];
    write_together(dir, &files)?;
    Ok(json)
}

fn to_json(trade: &Trade, device: &Value) -> Value {
    json!({
        "schema": 1,
        "gonio": { "version": env!("CARGO_PKG_VERSION") },
        "device": device,
        "trade": trade,
    })
}

/// One line a point; times in seconds.
fn to_csv(points: &[Point]) -> String {
    let mut csv = String::from(
        "method,setting,precision,storage,bytes,texels,evaluations,runs,seconds,seconds_min,seconds_max,table_seconds,\
         extrapolated,prepare,max_error,rms_error,checked,floor_share,on_front\n",
    );
    for p in points {
        csv += &format!(
            "{},{},{},{},{},{},{},{},{:e},{:e},{:e},{:e},{},{:e},{:e},{:e},{},{},{}\n",
            p.method,
            p.setting,
            p.precision,
            p.storage.name(),
            p.bytes,
            p.texels,
            p.evaluations,
            p.runs,
            p.seconds,
            p.seconds_min,
            p.seconds_max,
            p.table_seconds,
            p.extrapolated,
            p.prepare,
            p.max_error,
            p.rms_error,
            p.checked,
            p.floor_share.map(|share| format!("{share:e}")).unwrap_or_default(),
            p.on_front,
        );
    }
    csv
}
