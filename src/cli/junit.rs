//! JUnit XML for CI services: one test suite for each subject, one test case for each promise.
//!
//! There is no standard; this is what Jenkins, GitLab and GitHub's actions read alike.

use crate::base::error::{Error, Result};
use crate::base::words::printable;
use crate::cli::check::Checked;
use crate::io::Outputs;
use crate::verify::{Finding, Verdict};
use quick_xml::Writer;
use quick_xml::events::BytesText;
use std::io;
use std::path::Path;

/// Stages the reports.
pub fn write(path: &Path, all: &[Checked], outputs: &mut Outputs) -> Result<()> {
    outputs.add(path, xml(all).map_err(|e| Error::Internal(format!("JUnit: {e}")))?)
}

/// Counts tests, failures and seconds, for the attributes of one suite or of all.
fn totals<'a>(all: impl Iterator<Item = &'a Checked> + Clone) -> [(&'static str, String); 4] {
    let findings = all.clone().flat_map(|checked| &checked.report.findings);
    let count = |verdict| findings.clone().filter(|finding| finding.verdict == verdict).count().to_string();
    let (broken, unchecked) = (count(Verdict::Broken), count(Verdict::Unchecked));
    let seconds: f64 = all.map(|checked| checked.seconds).sum();
    [
        ("tests", findings.count().to_string()),
        ("failures", broken),
        ("errors", unchecked),
        ("time", format!("{seconds:.3}")),
    ]
}

fn xml(all: &[Checked]) -> io::Result<Vec<u8>> {
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
    writer.write_event(quick_xml::events::Event::Decl(quick_xml::events::BytesDecl::new(
        "1.0",
        Some("UTF-8"),
        None,
    )))?;
    let sums = totals(all.iter());
    let suites = sums.iter().fold(writer.create_element("testsuites"), |e, (key, value)| {
        e.with_attribute((*key, value.as_str()))
    });
    suites.write_inner_content(|writer| all.iter().try_for_each(|checked| suite(writer, checked)))?;
    let mut text = writer.into_inner();
    text.push(b'\n');
    Ok(text)
}

/// Writes the test suite of a subject.
fn suite(writer: &mut Writer<Vec<u8>>, checked: &Checked) -> io::Result<()> {
    let report = &checked.report;
    let name = printable(&report.subject);
    let suite = writer.create_element("testsuite").with_attribute(("name", name.as_ref()));
    let sums = totals(std::iter::once(checked));
    let suite = sums.iter().fold(suite, |e, (key, value)| e.with_attribute((*key, value.as_str())));
    suite.write_inner_content(|writer| {
        for (finding, input) in report.findings.iter().zip(&checked.inputs) {
            case(writer, &name, finding, input.as_deref())?;
        }
        if !report.notes.is_empty() {
            let notes = report.notes.join("\n");
            writer.create_element("system-out").write_text_content(BytesText::new(&printable(&notes)))?;
        }
        Ok(())
    })?;
    Ok(())
}

/// Writes the test case of a promise.
fn case(
    writer: &mut Writer<Vec<u8>>,
    subject: &str,
    finding: &Finding,
    input: Option<&str>,
) -> io::Result<()> {
    let mut said = finding.said.clone();
    if let Some(note) = &finding.note {
        said += &format!("; {note}");
    }
    let mut details = said.clone();
    if let Some(input) = input {
        details += &format!("\nworst input: {input}");
    }
    let [said, details] = [&said, &details].map(|text| printable(text));
    let case = [("classname", subject), ("name", finding.property)];
    let case = writer.create_element("testcase").with_attributes(case);
    case.write_inner_content(|writer| {
        let element = match finding.verdict {
            Verdict::Broken => Some("failure"),
            Verdict::Unchecked => Some("error"),
            Verdict::Kept | Verdict::Declared => None,
        };
        match element {
            Some(element) => writer
                .create_element(element)
                .with_attributes([("type", finding.property), ("message", said.as_ref())])
                .write_text_content(BytesText::new(&details))?,
            None => writer.create_element("system-out").write_text_content(BytesText::new(&details))?,
        };
        Ok(())
    })?;
    Ok(())
}
