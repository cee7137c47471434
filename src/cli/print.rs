//! What the command prints. Text of others, such as the name of a material, cannot act on a terminal: only our styles can.

use crate::base::error::{Error, Result};
use crate::base::words::printable;
use anstyle::{AnsiColor, Style};
use std::fmt;
use std::io::{ErrorKind, Write};

/// The style of the text up to its alternate form: `{HEADING}device{HEADING:#}`. It stands in text as a character for private
/// use, and becomes the terminal's sequence when the text is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Paint(char);

/// Bold red.
pub const ERROR: Paint = Paint('\u{f8d1}');
/// Bold yellow.
pub const WARNING: Paint = Paint('\u{f8d2}');
/// Bold green.
pub const GOOD: Paint = Paint('\u{f8d3}');
/// Bold.
pub const HEADING: Paint = Paint('\u{f8d4}');
/// The end of a style.
const END: char = '\u{f8d0}';

impl fmt::Display for Paint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", if f.alternate() { END } else { self.0 })
    }
}

/// Escapes text and puts the styles into it.
fn painted(text: &str) -> String {
    let bold = Style::new().bold();
    let mut painted = printable(text).into_owned();
    for (Paint(mark), style) in [
        (ERROR, AnsiColor::Red.on_default().bold()),
        (WARNING, AnsiColor::Yellow.on_default().bold()),
        (GOOD, AnsiColor::Green.on_default().bold()),
        (HEADING, bold),
    ] {
        painted = painted.replace(mark, &style.render().to_string());
    }
    painted.replace(END, &bold.render_reset().to_string())
}

/// Prints a line on stderr. A closed stderr is no error: there is nobody left to tell.
pub fn tell(text: &str) {
    let _ = writeln!(anstream::stderr(), "{}", painted(text));
}

pub fn warn(message: &str) {
    tell(&format!("{WARNING}warning:{WARNING:#} {message}"));
}

pub fn fail(error: &Error) {
    tell(&format!("{ERROR}error:{ERROR:#} {error}"));
}

/// Prints a message on stdout, or on stderr if stdout carries JSON.
pub fn print_beside(json: bool, text: &str) -> Result<()> {
    if json {
        tell(text);
        return Ok(());
    }
    print(text)
}

/// Prints a line on stdout.
pub fn print(text: &str) -> Result<()> {
    write_line(&painted(text))
}

/// Prints a value as JSON on stdout.
pub fn print_json(value: &impl serde::Serialize) -> Result<()> {
    let text = serde_json::to_string_pretty(value).map_err(|e| Error::Internal(e.to_string()))?;
    // JSON itself leaves these as they are.
    let acts = |c: char| c.is_control() && c != '\n';
    let escape = |c: char| if acts(c) { format!("\\u{:04x}", u32::from(c)) } else { c.to_string() };
    write_line(&if text.contains(acts) { text.chars().map(escape).collect() } else { text })
}

/// A reader that closes the pipe early, as `head` does, is no error.
fn write_line(text: &str) -> Result<()> {
    match writeln!(anstream::stdout(), "{text}") {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Error::io("write", "stdout")(error)),
        _ => Ok(()),
    }
}
