//! Lists in sentences, and text of others in ours.

use std::borrow::Cow;

/// Joins words into a list for a sentence: "a, b or c".
pub(crate) fn alternatives<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    let words: Vec<_> = words.into_iter().collect();
    match words.split_last() {
        Some((last, [])) => last.to_string(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
        None => String::new(),
    }
}

/// Text that a terminal shows and XML holds: what would act on a terminal, turn the direction of writing, or is no character
/// of XML stands as `\u{…}`. Line ends and tabs stay.
pub(crate) fn printable(text: &str) -> Cow<'_, str> {
    if text.chars().all(is_printable) {
        return text.into();
    }
    let escape = |escaped: String, c: char| match is_printable(c) {
        true => escaped + c.encode_utf8(&mut [0; 4]),
        false => escaped + &c.escape_unicode().to_string(),
    };
    text.chars().fold(String::new(), escape).into()
}

fn is_printable(c: char) -> bool {
    let is_direction =
        matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let is_no_character = u32::from(c) & 0xfffe == 0xfffe || matches!(c, '\u{fdd0}'..='\u{fdef}');
    c == '\n' || c == '\t' || !(c.is_control() || is_direction || is_no_character)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_acts_on_a_terminal_or_breaks_xml_is_escaped() {
        assert_eq!(printable("gold α\n\t木"), "gold α\n\t木");
        assert_eq!(
            printable("a\u{1b}[2Jb\r\u{9b}\u{7f}\u{202e}\u{fffe}\0"),
            r"a\u{1b}[2Jb\u{d}\u{9b}\u{7f}\u{202e}\u{fffe}\u{0}"
        );
    }

    #[test]
    fn the_last_alternative_follows_an_or() {
        assert_eq!(alternatives([]), "");
        assert_eq!(alternatives(["exr"]), "exr");
        assert_eq!(alternatives(["exr", "npy", "png"]), "exr, npy or png");
    }
}
