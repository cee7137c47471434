//! The text of a shader, whose lines know where they stand in the user's files.

use crate::base::error::Error;
use codespan_reporting::diagnostic::{Diagnostic, Label, LabelStyle};
use codespan_reporting::files::SimpleFiles;
use codespan_reporting::term;
use naga::{Span, WithSpan};
use std::ops::Range;

/// A line, and its place.
#[derive(Debug, Clone)]
pub(super) struct SourceLine {
    /// An index of [`ShaderText::files`].
    pub file: usize,
    /// From 0.
    pub number: usize,
    pub text: String,
}

/// Lines of one or more files, in the order in which they are compiled.
#[derive(Debug, Clone, Default)]
pub(super) struct ShaderText {
    /// Names for messages; the user's file is the first.
    pub files: Vec<String>,
    pub lines: Vec<SourceLine>,
}

impl ShaderText {
    /// What is compiled.
    pub fn joined(&self) -> String {
        let mut text = String::new();
        for line in &self.lines {
            text += &line.text;
            text.push('\n');
        }
        text
    }

    /// The same lines with another text of as many.
    pub fn with_text(&self, text: &str) -> Self {
        let lines = self.lines.iter().zip(text.lines());
        let lines = lines.map(|(line, text)| SourceLine { text: text.into(), ..*line }).collect();
        Self { files: self.files.clone(), lines }
    }

    /// `file:line`, of an offset into the joined text.
    pub fn place(&self, offset: usize) -> String {
        let (line, _) = self.line(offset);
        line.map_or(self.files[0].clone(), |line| format!("{}:{}", self.files[line.file], line.number + 1))
    }

    /// The index of the file that an offset lies in.
    pub fn file(&self, offset: usize) -> Option<usize> {
        self.line(offset).0.map(|line| line.file)
    }

    fn line(&self, offset: usize) -> (Option<&SourceLine>, usize) {
        let mut start = 0;
        for line in &self.lines {
            let end = start + line.text.len() + 1;
            if offset < end {
                return (Some(line), offset - start);
            }
            start = end;
        }
        (None, 0)
    }

    /// An error of what the text says, with its lines. Places are ranges of the joined text.
    pub fn error(&self, what: &str, places: Vec<(Range<usize>, String)>, notes: Vec<String>) -> Error {
        // Each file with the lines that are compiled, at their numbers.
        let mut texts = vec![Vec::<&str>::new(); self.files.len()];
        for line in &self.lines {
            let text = &mut texts[line.file];
            text.resize(text.len().max(line.number + 1), "");
            text[line.number] = &line.text;
        }
        let mut files = SimpleFiles::new();
        let mut ids = Vec::new();
        for (name, text) in self.files.iter().zip(&texts) {
            ids.push(files.add(name.clone(), text.join("\n")));
        }
        let label = |(k, (range, words)): (usize, (Range<usize>, String))| {
            let (line, column) = self.line(range.start);
            let line = line?;
            let before: usize = texts[line.file][..line.number].iter().map(|text| text.len() + 1).sum();
            let start = before + column;
            let end = (start + range.len()).min(before + line.text.len()).max(start);
            let style = if k == 0 { LabelStyle::Primary } else { LabelStyle::Secondary };
            Some(Label::new(style, ids[line.file], start..end).with_message(words))
        };
        let diagnostic = Diagnostic::error()
            .with_message(what)
            .with_labels(places.into_iter().enumerate().filter_map(label).collect())
            .with_notes(notes);
        match term::emit_into_string(&term::Config::default(), &files, &diagnostic) {
            Ok(out) => Error::input(format!("{} is not valid:\n{}", self.files[0], out.trim_end())),
            Err(_) => Error::input(format!("{} is not valid: {what}", self.files[0])),
        }
    }

    /// An error of naga's WGSL front end.
    pub fn parse_error(&self, error: &naga::front::wgsl::ParseError) -> Error {
        let labels = error.labels().filter_map(|(span, words)| Some((span.to_range()?, words.to_owned())));
        self.error(
            error.message(),
            labels.collect(),
            error.notes().map(|note| format!("note: {note}")).collect(),
        )
    }

    /// An error of naga's validator, with its causes.
    pub fn validation_error<E: std::error::Error>(&self, error: &WithSpan<E>) -> Error {
        let place = |(span, words): &(Span, String)| Some((span.to_range()?, words.clone()));
        let mut places: Vec<_> = error.spans().filter_map(place).collect();
        // The narrowest says where; the widest is the whole function.
        places.sort_by_key(|(range, _)| range.len());
        let mut causes = Vec::new();
        let mut cause = error.as_inner().source();
        while let Some(error) = cause {
            causes.push(error.to_string());
            cause = error.source();
        }
        self.error(&error.as_inner().to_string(), places, causes)
    }
}
