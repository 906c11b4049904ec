//! Tables whose keys depend on their contents: values by key, and the keys that nobody asked for.

use std::cell::RefCell;
use std::fmt;
use std::ops::{Range, RangeInclusive};

use roughxel_utilities::suggestions::did_you_mean;
use toml::Spanned;

use super::{Argument, ArgumentTable, Source};
use crate::error::SceneError;

/// A value of a table with its place; `None` if the key is missing.
pub(crate) type Found<T> = Result<Option<(T, Range<usize>)>, SceneError>;

/// One table of arguments being read: every key is asked for by name, then [`Arguments::finish`] refuses the rest.
#[derive(Debug)]
pub(crate) struct Arguments<'a> {
    source: &'a Source,
    table: &'a ArgumentTable,
    span: Range<usize>,
    /// Keys asked for so far with their defaults, for messages and for the test of the documentation.
    asked: RefCell<Vec<(&'static str, String)>>,
}

impl<'a> Arguments<'a> {
    pub(crate) fn new(source: &'a Source, table: &'a Spanned<ArgumentTable>) -> Self {
        Self { source, table: table.get_ref(), span: table.span(), asked: RefCell::default() }
    }

    /// Place of the table.
    pub(crate) fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// Keys asked for so far, with their defaults as text.
    #[cfg(test)]
    pub(crate) fn asked(&self) -> Vec<(&'static str, String)> {
        self.asked.borrow().clone()
    }

    fn find(&self, key: &'static str, default: impl fmt::Display) -> Option<&'a Spanned<Argument>> {
        self.asked.borrow_mut().push((key, default.to_string()));
        self.table.0.iter().find(|(name, _)| name.get_ref() == key).map(|(_, value)| value)
    }

    /// A value converted by `as_wanted`, with its place; `None` if the key is missing.
    fn found<T>(
        &self,
        key: &'static str,
        default: impl fmt::Display,
        wanted: &str,
        as_wanted: impl Fn(&'a Argument) -> Option<T>,
    ) -> Found<T> {
        let Some(value) = self.find(key, default) else { return Ok(None) };
        let found = as_wanted(value.get_ref()).ok_or_else(|| {
            self.error_at(value.span(), format!("`{key}` has the wrong type"), format!("give {wanted}"))
        });
        Ok(Some((found?, value.span())))
    }

    /// A number in `range`, if the key is there.
    pub(crate) fn optional_number(
        &self,
        key: &'static str,
        range: RangeInclusive<f64>,
    ) -> Result<Option<f64>, SceneError> {
        self.number_at(key, "–", range)
    }

    /// A number in `range`.
    pub(crate) fn number(
        &self,
        key: &'static str,
        default: f64,
        range: RangeInclusive<f64>,
    ) -> Result<f64, SceneError> {
        Ok(self.number_at(key, default, range)?.unwrap_or(default))
    }

    fn number_at(
        &self,
        key: &'static str,
        default: impl fmt::Display,
        range: RangeInclusive<f64>,
    ) -> Result<Option<f64>, SceneError> {
        let found = self.found(key, default, "a number", Argument::number)?;
        found.map(|(number, span)| self.source.in_range(key, number, span, range)).transpose()
    }

    /// A whole number in `range`.
    pub(crate) fn whole(&self, key: &'static str, default: u32, range: RangeInclusive<u32>) -> Result<u32, SceneError> {
        let whole = |value: &Argument| value.number().filter(|number| number.fract() == 0.0);
        match self.found(key, default, "a whole number", whole)? {
            None => Ok(default),
            // `as` saturates; a saturated number is outside every range used here.
            Some((number, span)) => self.source.whole_in_range(key, number as i64, span, range),
        }
    }

    /// A linear colour, each channel from 0 to `brightest`.
    pub(crate) fn colour(&self, key: &'static str, default: [f32; 3], brightest: f64) -> Result<[f32; 3], SceneError> {
        let found = self.numbers_at(key, default, "three numbers: red, green, blue", 0.0..=brightest)?;
        Ok(found.map_or(default, |(colour, _)| colour.map(|channel| channel as f32)))
    }

    /// `N` numbers in `range`.
    pub(crate) fn numbers<const N: usize>(
        &self,
        key: &'static str,
        default: [f64; N],
        range: RangeInclusive<f64>,
    ) -> Result<[f64; N], SceneError> {
        let found = self.numbers_at(key, default, &format!("an array of {N} numbers"), range)?;
        Ok(found.map_or(default, |(numbers, _)| numbers))
    }

    fn numbers_at<const N: usize>(
        &self,
        key: &'static str,
        default: [impl fmt::Display; N],
        wanted: &str,
        range: RangeInclusive<f64>,
    ) -> Found<[f64; N]> {
        let default = format!("[{}]", default.map(|number| number.to_string()).join(", "));
        let numbers = |value: &Argument| match value {
            Argument::Numbers(numbers) => <[f64; N]>::try_from(numbers.as_slice()).ok(),
            _ => None,
        };
        let Some((numbers, span)) = self.found(key, default, wanted, numbers)? else { return Ok(None) };
        for number in numbers {
            self.source.in_range(key, number, span.clone(), range.clone())?;
        }
        Ok(Some((numbers, span)))
    }

    /// `true` or `false` with its place, if the key is there.
    pub(crate) fn flag(&self, key: &'static str, default: impl fmt::Display) -> Found<bool> {
        self.found(key, default, "true or false", |value| match value {
            Argument::Flag(flag) => Some(*flag),
            _ => None,
        })
    }

    /// One of several words, if the key is there; `None` for a missing key.
    pub(crate) fn word<T: Copy>(&self, key: &'static str, words: &[(&str, T)]) -> Result<Option<T>, SceneError> {
        let Some((text, span)) = self.text(key)? else { return Ok(None) };
        if let Some((_, meant)) = words.iter().find(|(word, _)| *word == text) {
            return Ok(Some(*meant));
        }
        let names = || words.iter().map(|(word, _)| *word);
        let known: Vec<_> = names().map(|word| format!("\"{word}\"")).collect();
        let help = format!("{}choose {}", did_you_mean(text, names()), known.join(" or "));
        Err(self.error_at(span, format!("`{key}` is \"{text}\""), help))
    }

    /// Two rising numbers in `range` that are 1 to `widest` apart, if the key is there.
    pub(crate) fn interval(
        &self,
        key: &'static str,
        default: [f64; 2],
        widest: f64,
        range: RangeInclusive<f64>,
    ) -> Result<Option<[f64; 2]>, SceneError> {
        let Some(([from, to], span)) = self.numbers_at(key, default, "an array of two numbers", range)? else {
            return Ok(None);
        };
        if !(1.0..=widest).contains(&(to - from)) {
            let help = format!("choose two numbers, the second 1 to {widest} above the first");
            return Err(self.error_at(span, format!("`{key}` is [{from}, {to}]"), help));
        }
        Ok(Some([from, to]))
    }

    /// A text with its place, if the key is there.
    pub(crate) fn text(&self, key: &'static str) -> Found<&'a str> {
        self.found(key, "–", "a text in quotes", |value| match value {
            Argument::Text(text) => Some(text.as_str()),
            _ => None,
        })
    }

    /// An array of texts with its place, if the key is there.
    pub(crate) fn texts(&self, key: &'static str) -> Found<&'a [String]> {
        self.found(key, "–", "an array of texts in quotes", |value| match value {
            Argument::Texts(texts) => Some(texts.as_slice()),
            _ => None,
        })
    }

    /// An error at this table.
    pub(crate) fn error(&self, message: impl Into<String>, help: impl Into<String>) -> SceneError {
        self.source.value_error(self.span(), message, help)
    }

    /// An error at `span`.
    pub(crate) fn error_at(
        &self,
        span: Range<usize>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> SceneError {
        self.source.value_error(span, message, help)
    }

    /// Refuses the keys that nobody asked for.
    pub(crate) fn finish(&self) -> Result<(), SceneError> {
        let asked = self.asked.borrow();
        for name in self.table.0.keys() {
            if !asked.iter().any(|(key, _)| key == name.get_ref()) {
                let meant = did_you_mean(name.get_ref(), asked.iter().map(|(key, _)| *key));
                let known: Vec<_> = asked.iter().map(|(key, _)| format!("`{key}`")).collect();
                return Err(self.source.value_error(
                    name.span(),
                    format!("unknown key `{}`", name.get_ref()),
                    format!("{meant}known here: {}", known.join(", ")),
                ));
            }
        }
        Ok(())
    }

    /// Fingerprint that is equal for tables of equal meaning at any place: the key of the cache of maps.
    pub(crate) fn fingerprint(&self) -> String {
        let pairs: Vec<_> = self.table.0.iter().map(|(key, value)| (key.get_ref(), value.get_ref())).collect();
        format!("{pairs:?}")
    }
}
