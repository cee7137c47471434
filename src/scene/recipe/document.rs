//! A TOML document that knows its lines: every value is read with its place, so that every error can
//! name the file, the line, the key and the words that are valid there.

use crate::base::error::{Error, Result};
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The text of a recipe and its name.
pub struct Document<'a> {
    path: &'a Path,
    text: &'a str,
    /// Where its lines end.
    ends: Vec<usize>,
}

impl<'a> Document<'a> {
    pub fn new(path: &'a Path, bytes: &'a [u8]) -> Result<Self> {
        let text = std::str::from_utf8(bytes).map_err(|e| {
            let line = 1 + bytes.iter().take(e.valid_up_to()).filter(|&&b| b == b'\n').count();
            Error::input(format!("{}: line {line}: not UTF-8; save the recipe as UTF-8 text", path.display()))
        })?;
        let ends = text.match_indices('\n').map(|(at, _)| at).collect();
        Ok(Self { path, text, ends })
    }

    pub fn parse(&self) -> Result<Spanned<DeTable<'a>>> {
        DeTable::parse(self.text).map_err(|e| {
            let message = e.message().split('\n').collect::<Vec<_>>().join(", ");
            self.refuse(e.span().map_or(self.text.len(), |span| span.start), &message)
        })
    }

    pub fn root(&'a self, table: &'a Spanned<DeTable<'a>>) -> TableFields<'a> {
        TableFields { document: self, at: table.span().start, name: "the recipe", table: table.get_ref() }
    }

    /// "recipe.toml: line 7"
    fn place(&self, at: usize) -> String {
        let line = 1 + self.ends.partition_point(|&end| end < at);
        format!("{}: line {line}", self.path.display())
    }

    fn refuse(&self, at: usize, message: &str) -> Error {
        Error::input(message).at(self.place(at))
    }
}

/// A value with its key and its place.
#[derive(Clone, Copy)]
pub struct Item<'a> {
    document: &'a Document<'a>,
    at: usize,
    name: &'a str,
    value: &'a DeValue<'a>,
}

impl<'a> Item<'a> {
    /// The key; of an element, its list's.
    pub fn name(&self) -> &'a str {
        self.name
    }

    /// "recipe.toml: line 7"
    pub fn place(&self) -> String {
        self.document.place(self.at)
    }

    /// The error that says what is wrong with this value.
    pub fn refuse(&self, message: &str) -> Error {
        self.document.refuse(self.at, &format!("{}: {message}", self.name))
    }

    pub fn is_array(&self) -> bool {
        self.value.is_array()
    }

    pub fn is_table(&self) -> bool {
        self.value.is_table()
    }

    pub fn number(&self) -> Result<f64> {
        let number = match self.value {
            DeValue::Float(x) => x.as_str().parse().ok(),
            DeValue::Integer(n) if n.radix() == 10 => n.as_str().parse().ok(),
            _ => None,
        };
        number.ok_or_else(|| self.wants("a number"))
    }

    pub fn number_in(&self, [min, max]: [f64; 2]) -> Result<f64> {
        let number = self.number()?;
        if !(min..=max).contains(&number) {
            return Err(self.refuse(&format!("{number} is outside [{min}, {max}]")));
        }
        Ok(number)
    }

    /// A whole number from 1 to `max`.
    pub fn count(&self, max: usize) -> Result<usize> {
        let DeValue::Integer(n) = self.value else { return Err(self.wants("a whole number")) };
        match usize::from_str_radix(n.as_str(), n.radix()) {
            Ok(count) if (1..=max).contains(&count) => Ok(count),
            _ => Err(self.refuse(&format!("{n} is not a count from 1 to {max}"))),
        }
    }

    pub fn text(&self) -> Result<&'a str> {
        self.value.as_str().ok_or_else(|| self.wants("a text in quotes"))
    }

    /// What the value, one of these words, stands for.
    pub fn one_of<T>(&self, valid: impl IntoIterator<Item = (&'a str, T)>) -> Result<T> {
        let given = self.text()?;
        let (words, found) = choose(valid, given);
        found.ok_or_else(|| self.refuse(&format!("{given:?} is unknown; valid: {words}")))
    }

    /// What the key, one of these words, stands for.
    pub fn key_one_of<T>(&self, valid: impl IntoIterator<Item = (&'a str, T)>) -> Result<T> {
        let (words, found) = choose(valid, self.name);
        found.ok_or_else(|| self.refuse(&format!("unknown here; valid: {words}")))
    }

    /// The elements of a list.
    pub fn items(&self) -> Result<Vec<Self>> {
        let list = self.value.as_array().ok_or_else(|| self.wants("a list"))?;
        Ok(list.iter().map(|v| Self { at: v.span().start, value: v.get_ref(), ..*self }).collect())
    }

    /// The entries of a table whose keys are the user's, in the order of the file.
    pub fn entries(&self) -> Result<Vec<Self>> {
        let fields = self.any_table()?;
        let mut entries: Vec<_> = fields.entries().collect();
        entries.sort_by_key(|entry| entry.at);
        Ok(entries)
    }

    /// A table with no other keys than these.
    pub fn table(&self, keys: &[&str]) -> Result<TableFields<'a>> {
        self.any_table()?.only(keys)
    }

    /// A table whose keys are yet to be checked.
    pub fn any_table(&self) -> Result<TableFields<'a>> {
        let table = self.value.as_table().ok_or_else(|| self.wants("a table { … }"))?;
        Ok(TableFields { document: self.document, at: self.at, name: self.name, table })
    }

    fn wants(&self, what: &str) -> Error {
        self.refuse(&format!("give {what}, not this {}", self.value.type_str()))
    }
}

/// A table of the recipe.
pub struct TableFields<'a> {
    document: &'a Document<'a>,
    at: usize,
    name: &'a str,
    table: &'a DeTable<'a>,
}

impl<'a> TableFields<'a> {
    /// Refuses the first key that is not one of these.
    pub fn only(self, keys: &[&str]) -> Result<Self> {
        let unknown = self.entries().filter(|entry| !keys.contains(&entry.name)).min_by_key(|entry| entry.at);
        match unknown {
            Some(entry) => Err(entry.refuse(&format!("unknown key; valid here: {}", keys.join(", ")))),
            None => Ok(self),
        }
    }

    pub fn get(&self, key: &str) -> Option<Item<'a>> {
        self.entries().find(|entry| entry.name == key)
    }

    pub fn require(&self, key: &str) -> Result<Item<'a>> {
        self.get(key).ok_or_else(|| self.refuse(&format!("{key} is missing; give {key} = …")))
    }

    pub fn refuse(&self, message: &str) -> Error {
        self.document.refuse(self.at, &format!("{}: {message}", self.name))
    }

    fn entries(&self) -> impl Iterator<Item = Item<'a>> + use<'a> {
        let document = self.document;
        self.table.iter().map(move |(key, value)| Item {
            document,
            at: key.span().start,
            name: key.get_ref(),
            value: value.get_ref(),
        })
    }
}

/// The valid words in a row, and what the given one stands for.
fn choose<'a, T>(valid: impl IntoIterator<Item = (&'a str, T)>, given: &str) -> (String, Option<T>) {
    let mut words = Vec::new();
    let mut found = None;
    for (word, value) in valid {
        words.push(word);
        if word == given {
            found = Some(value);
        }
    }
    let words = if words.is_empty() { "none, for there are none".to_owned() } else { words.join(", ") };
    (words, found)
}
