//! Splits shader source into tokens, as far as WGSL and GLSL agree on them.

/// A piece of source: all tokens of a text, joined, are the text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Token<'a> {
    pub kind: TokenKind,
    pub text: &'a str,
    /// The offset of its first byte.
    pub start: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TokenKind {
    /// An identifier or a keyword.
    Name,
    Number,
    /// One character, or `::`.
    Symbol,
    Space,
}

impl Token<'_> {
    pub fn is(&self, text: &str) -> bool {
        self.text == text
    }

    pub fn is_name(&self) -> bool {
        self.kind == TokenKind::Name
    }

    pub fn end(&self) -> usize {
        self.start + self.text.len()
    }
}

/// The tokens of a text without comments.
pub(super) fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut all = Vec::new();
    let mut start = 0;
    while let Some(first) = text[start..].chars().next() {
        let rest = &text[start..];
        let span = |fits: &dyn Fn(char) -> bool| rest.find(|c| !fits(c)).unwrap_or(rest.len());
        let (kind, length) = if first.is_whitespace() {
            (TokenKind::Space, span(&char::is_whitespace))
        } else if is_start(first) {
            (TokenKind::Name, span(&|c| is_start(c) || c.is_numeric()))
        } else if first.is_ascii_digit() {
            (TokenKind::Number, number(rest))
        } else if rest.starts_with("::") {
            (TokenKind::Symbol, 2)
        } else {
            (TokenKind::Symbol, first.len_utf8())
        };
        all.push(Token { kind, text: &rest[..length], start });
        start += length;
    }
    all
}

/// The tokens that are no white space.
pub(super) fn words(text: &str) -> Vec<Token<'_>> {
    tokens(text).into_iter().filter(|token| token.kind != TokenKind::Space).collect()
}

fn is_start(c: char) -> bool {
    c == '_' || c.is_alphabetic()
}

/// The length of a number with its suffix: `1`, `0x1p-3f`, `1.5e+3`.
fn number(text: &str) -> usize {
    let hexadecimal = text.starts_with("0x") || text.starts_with("0X");
    let mut before = '0';
    for (k, c) in text.char_indices() {
        let exponent = if hexadecimal { "pP" } else { "eE" };
        let signed = "+-".contains(c) && exponent.contains(before);
        if !(c.is_ascii_alphanumeric() || c == '.' || signed) {
            return k;
        }
        before = c;
    }
    text.len()
}

/// Replaces comments by spaces, so that what follows stays in its column. Block comments nest in WGSL.
pub(super) fn without_comments(text: &str, nested: bool) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    let blank = |text: &str, out: &mut String| {
        out.extend(text.chars().map(|c| if c == '\n' { '\n' } else { ' ' }));
    };
    while let Some(start) = rest.find('/') {
        let after = &rest[start..];
        let end = if after.starts_with("//") {
            after.find('\n').unwrap_or(after.len())
        } else if after.starts_with("/*") {
            block(after, nested)
        } else {
            out += &rest[..=start];
            rest = &rest[start + 1..];
            continue;
        };
        out += &rest[..start];
        blank(&after[..end], &mut out);
        rest = &after[end..];
    }
    out + rest
}

/// The length of a block comment; an open one takes all.
fn block(text: &str, nested: bool) -> usize {
    let (mut depth, mut at) = (0_usize, 0);
    while let Some(found) = text[at..].find(['/', '*']) {
        at += found;
        match &text.as_bytes()[at..(at + 2).min(text.len())] {
            b"/*" if depth == 0 || nested => {
                depth += 1;
                at += 2;
            }
            b"*/" => {
                depth -= 1;
                at += 2;
                if depth == 0 {
                    return at;
                }
            }
            _ => at += 1,
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_join_to_the_text() {
        let text = "let α=1.5e-3f*0x1p+2; a::b->c.x";
        assert_eq!(tokens(text).iter().map(|token| token.text).collect::<String>(), text);
        let texts: Vec<_> = words(text).iter().map(|token| token.text).collect();
        assert_eq!(
            texts,
            ["let", "α", "=", "1.5e-3f", "*", "0x1p+2", ";", "a", "::", "b", "-", ">", "c", ".", "x"]
        );
    }

    #[test]
    fn comments_become_spaces() {
        assert_eq!(without_comments("a /* b /* c */ d */ e // f\ng", true), "a                   e     \ng");
        assert_eq!(without_comments("a /* /* b */ c / d", false), "a            c / d");
        assert_eq!(without_comments("a /*/ b", false), "a      ");
    }
}
