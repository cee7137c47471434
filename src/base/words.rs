//! Lists in sentences.

/// Joins words into a list for a sentence: "a, b or c".
pub(crate) fn alternatives<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    let words: Vec<_> = words.into_iter().collect();
    match words.split_last() {
        Some((last, [])) => last.to_string(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_alternative_follows_an_or() {
        assert_eq!(alternatives([]), "");
        assert_eq!(alternatives(["exr"]), "exr");
        assert_eq!(alternatives(["exr", "npy", "png"]), "exr, npy or png");
    }
}
