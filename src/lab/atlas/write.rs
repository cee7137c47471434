//! The files of an atlas: CSV, JSON, and pictures.

use crate::base::error::{Error, Result};
use crate::io::write_together;
use crate::lab::atlas::picture::{draw_page, draw_study};
use crate::lab::atlas::{Band, Page, PageKind};
use serde_json::{Value, json};
use std::path::Path;

/// Writes `atlas.csv`, `atlas.json` and `atlas_MODEL.png`, or `study.csv`, `study.json` and `study.png`, into
/// a folder, which is made if it is not there. Each is written under another name first, and all are renamed
/// once all are there.
///
/// # Errors
/// When the folder cannot be written.
pub fn write(dir: &Path, kind: PageKind, pages: &[Page], device: &Value) -> Result<()> {
    let name = kind.name();
    let json = serde_json::to_string_pretty(&to_json(kind, pages, device));
    let json = json.map_err(|e| Error::Internal(e.to_string()))? + "\n";
    let mut files = vec![
        (format!("{name}.csv"), to_csv(pages).into_bytes()),
        (format!("{name}.json"), json.into_bytes()),
    ];
    match kind {
        PageKind::Study => files.push((format!("{name}.png"), draw_study(pages)?)),
        PageKind::Atlas => {
            for page in pages {
                files.push((format!("{name}_{}.png", page.subject), draw_page(page)?));
            }
        }
    }
    write_together(dir, &files)
}

/// What the JSON file says. What is infinite is null in it.
pub fn to_json(kind: PageKind, pages: &[Page], device: &Value) -> Value {
    json!({
        "schema": 1,
        "kind": kind.name(),
        "gonio": { "version": env!("CARGO_PKG_VERSION") },
        "device": device,
        "pages": pages,
    })
}

/// A line for each decade, and for each α: there both ends of the range are one.
fn to_csv(pages: &[Page]) -> String {
    let mut csv = String::from(
        "subject,alpha_from,alpha_to,values,non_finite,median,max,median_ulp,max_ulp,reciprocity,unequal,\
         promise,worst_value,worst_reference,worst_eval\n",
    );
    for page in pages {
        for band in page.decades.iter().chain(&page.alphas) {
            csv += &line(&page.subject, band);
        }
    }
    csv
}

fn line(subject: &str, b: &Band) -> String {
    // Names of forms have commas.
    let subject = if subject.contains(',') { format!("\"{subject}\"") } else { subject.into() };
    let some = |x: Option<f64>| x.map(|x| format!("{x:e}")).unwrap_or_default();
    let [from, to] = [0, 1].map(|end| some(b.alpha.map(|range| range[end])));
    let worst = b.worst.as_ref();
    format!(
        "{subject},{from},{to},{},{},{:e},{:e},{:e},{:e},{:e},{},{},{},{},{}\n",
        b.values,
        b.non_finite,
        b.median,
        b.max,
        b.median_ulp,
        b.max_ulp,
        b.reciprocity,
        b.unequal,
        some(b.promise),
        worst.map(|w| format!("{:e}", w.value)).unwrap_or_default(),
        some(worst.map(|w| w.reference)),
        worst.map(|w| w.eval.clone()).unwrap_or_default(),
    )
}
