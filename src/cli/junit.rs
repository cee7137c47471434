//! JUnit XML, which CI services show: a test suite a subject, a test case a promise.
//!
//! There is no standard; this is what Jenkins, GitLab and GitHub's actions read alike.

use crate::error::{Error, Result};
use crate::promises::{Report, Verdict};
use quick_xml::Writer;
use quick_xml::events::BytesText;
use std::io;
use std::path::Path;

/// Writes a report, all of it or nothing.
pub fn write(path: &Path, report: &Report, seconds: f64) -> Result<()> {
    let text = xml(report, seconds).map_err(|e| Error::Internal(format!("JUnit: {e}")))?;
    let partial = path.with_added_extension("partial");
    std::fs::write(&partial, text).map_err(Error::io("write", path))?;
    std::fs::rename(&partial, path).map_err(Error::io("write", path))
}

fn xml(report: &Report, seconds: f64) -> io::Result<Vec<u8>> {
    let broken = report.findings.iter().filter(|f| f.verdict == Verdict::Broken).count().to_string();
    let (tests, time) = (report.findings.len().to_string(), format!("{seconds:.3}"));
    let totals = [("tests", tests.as_str()), ("failures", &broken), ("errors", "0"), ("time", &time)];
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
    writer.write_event(quick_xml::events::Event::Decl(quick_xml::events::BytesDecl::new(
        "1.0",
        Some("UTF-8"),
        None,
    )))?;
    let suites = writer.create_element("testsuites").with_attributes(totals);
    suites.write_inner_content(|writer| {
        let suite = writer
            .create_element("testsuite")
            .with_attribute(("name", report.subject.as_str()))
            .with_attributes(totals);
        suite.write_inner_content(|writer| {
            for finding in &report.findings {
                let case = [("classname", report.subject.as_str()), ("name", finding.property)];
                let mut said = finding.said.clone();
                if let Some(note) = &finding.note {
                    said += &format!("; {note}");
                }
                let mut details = said.clone();
                if let Some(input) = &finding.input {
                    details += &format!("\nworst input: {input}");
                }
                let case = writer.create_element("testcase").with_attributes(case);
                case.write_inner_content(|writer| {
                    match finding.verdict {
                        Verdict::Broken => writer
                            .create_element("failure")
                            .with_attributes([("type", finding.property), ("message", said.as_str())])
                            .write_text_content(BytesText::new(&details))?,
                        _ => writer
                            .create_element("system-out")
                            .write_text_content(BytesText::new(&details))?,
                    };
                    Ok(())
                })?;
            }
            Ok(())
        })?;
        Ok(())
    })?;
    let mut text = writer.into_inner();
    text.push(b'\n');
    Ok(text)
}
