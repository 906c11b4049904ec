//! Where the values of a scene file stand, and how they are asked for.
//!
//! Tables whose keys depend on a generator's name are read as [`ArgumentTable`] and asked key by key through
//! [`Arguments`], which then refuses what nobody asked for.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;
use std::ops::{Range, RangeInclusive};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::de::{Deserialize, Deserializer, Expected, SeqAccess, Visitor};
use toml::Spanned;

use crate::error::{Fault, SceneError};
use roughxel_utilities::input::without_mark;
use roughxel_utilities::spelling::did_you_mean;

/// Most elements of an array in a generator's table.
const MAX_LIST: usize = 64;

/// `N` values: an array of any other length is an error, while serde's own arrays take what is first of a longer one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Exactly<T, const N: usize>(pub(super) [T; N]);

impl<'de, T: Copy + Default + Deserialize<'de>, const N: usize> Deserialize<'de> for Exactly<T, N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader<T, const N: usize>(PhantomData<T>);
        impl<'de, T: Copy + Default + Deserialize<'de>, const N: usize> Visitor<'de> for Reader<T, N> {
            type Value = Exactly<T, N>;

            fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(out, "an array of {N} numbers")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, items: A) -> Result<Self::Value, A::Error> {
                exactly(items, &self).map(Exactly)
            }
        }
        deserializer.deserialize_seq(Reader(PhantomData))
    }
}

/// The `N` elements of an array.
fn exactly<'de, A: SeqAccess<'de>, T: Copy + Default + Deserialize<'de>, const N: usize>(
    mut items: A,
    expected: &dyn Expected,
) -> Result<[T; N], A::Error> {
    let mut values = [T::default(); N];
    for (index, slot) in values.iter_mut().enumerate() {
        *slot = items.next_element()?.ok_or_else(|| serde::de::Error::invalid_length(index, expected))?;
    }
    match items.next_element::<T>()? {
        None => Ok(values),
        Some(_) => Err(serde::de::Error::invalid_length(N + 1, expected)),
    }
}

/// A number for all three axes or channels, or one for each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OneOrThree(pub(super) [f64; 3]);

impl<'de> Deserialize<'de> for OneOrThree {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl<'de> Visitor<'de> for Reader {
            type Value = OneOrThree;

            fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                out.write_str("a number or an array of three numbers")
            }

            fn visit_f64<E>(self, value: f64) -> Result<OneOrThree, E> {
                Ok(OneOrThree([value; 3]))
            }

            fn visit_i64<E>(self, value: i64) -> Result<OneOrThree, E> {
                Ok(OneOrThree([value as f64; 3]))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, items: A) -> Result<OneOrThree, A::Error> {
                exactly(items, &self).map(OneOrThree)
            }
        }
        deserializer.deserialize_any(Reader)
    }
}

/// A value in a table whose keys depend on a generator.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Argument {
    Number(f64),
    Text(String),
    Numbers(Vec<f64>),
    Texts(Vec<String>),
}

impl<'de> Deserialize<'de> for Argument {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl<'de> Visitor<'de> for Reader {
            type Value = Argument;

            fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                out.write_str("a number, a text, or an array of numbers or of texts")
            }

            fn visit_f64<E>(self, value: f64) -> Result<Argument, E> {
                Ok(Argument::Number(value))
            }

            fn visit_i64<E>(self, value: i64) -> Result<Argument, E> {
                Ok(Argument::Number(value as f64))
            }

            fn visit_str<E>(self, value: &str) -> Result<Argument, E> {
                Ok(Argument::Text(value.to_owned()))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Argument, A::Error> {
                let (mut numbers, mut texts) = (Vec::new(), Vec::new());
                while let Some(item) = items.next_element()? {
                    match item {
                        Argument::Number(number) => numbers.push(number),
                        Argument::Text(text) => texts.push(text),
                        Argument::Numbers(_) | Argument::Texts(_) => {
                            return Err(serde::de::Error::custom("an array inside an array is not known here"));
                        }
                    }
                    if numbers.len() + texts.len() > MAX_LIST {
                        return Err(serde::de::Error::invalid_length(MAX_LIST + 1, &self));
                    }
                }
                match (numbers.is_empty(), texts.is_empty()) {
                    (_, true) => Ok(Argument::Numbers(numbers)),
                    (true, false) => Ok(Argument::Texts(texts)),
                    (false, false) => Err(serde::de::Error::custom("an array mixes numbers and texts")),
                }
            }
        }
        deserializer.deserialize_any(Reader)
    }
}

/// A table whose keys depend on its contents: a file or a generator with its parameters.
#[derive(Debug, serde::Deserialize)]
#[serde(transparent)]
pub(super) struct ArgumentTable(pub(super) BTreeMap<Spanned<String>, Spanned<Argument>>);

/// The text of a scene with what its errors need.
#[derive(Debug)]
pub(super) struct Source {
    pub(super) file: String,
    pub(super) text: Arc<str>,
    pub(super) base_dir: PathBuf,
}

impl Source {
    pub(super) fn new(file: &str, text: &str, base_dir: &Path) -> Self {
        Self { file: file.to_owned(), text: without_mark(text).into(), base_dir: base_dir.to_owned() }
    }

    /// A fault at `span`.
    pub(super) fn fault(&self, span: Range<usize>, message: impl Into<String>, help: impl Into<String>) -> Box<Fault> {
        Box::new(Fault::new(&self.file, &self.text, span, message.into(), help.into()))
    }

    /// [`SceneError::Fault`] at `span`.
    pub(super) fn value_error(
        &self,
        span: Range<usize>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> SceneError {
        SceneError::Fault(self.fault(span, message, help))
    }

    /// Refuses a number outside `range`, NaN and infinities.
    pub(super) fn in_range(
        &self,
        key: &str,
        value: f64,
        span: Range<usize>,
        range: RangeInclusive<f64>,
    ) -> Result<f64, SceneError> {
        if range.contains(&value) {
            return Ok(value);
        }
        let help = format!("choose a number from {} to {}", range.start(), range.end());
        Err(self.value_error(span, format!("`{key}` is {value}, which is out of range"), help))
    }

    /// [`Source::in_range`] for each number.
    pub(super) fn all_in_range<const N: usize>(
        &self,
        key: &str,
        values: &Spanned<Exactly<f64, N>>,
        range: RangeInclusive<f64>,
    ) -> Result<[f64; N], SceneError> {
        let Exactly(all) = *values.get_ref();
        for value in all {
            self.in_range(key, value, values.span(), range.clone())?;
        }
        Ok(all)
    }

    /// [`Source::in_range`] for one number or three; `default` where the key is missing.
    pub(super) fn one_or_three(
        &self,
        key: &str,
        value: &Option<Spanned<OneOrThree>>,
        default: f64,
        range: RangeInclusive<f64>,
    ) -> Result<[f64; 3], SceneError> {
        let Some(value) = value else {
            return Ok([default; 3]);
        };
        let OneOrThree(three) = *value.get_ref();
        for number in three {
            self.in_range(key, number, value.span(), range.clone())?;
        }
        Ok(three)
    }

    /// A whole number in `range`.
    pub(super) fn whole_in_range(
        &self,
        key: &str,
        value: i64,
        span: Range<usize>,
        range: RangeInclusive<u32>,
    ) -> Result<u32, SceneError> {
        match u32::try_from(value) {
            Ok(whole) if range.contains(&whole) => Ok(whole),
            _ => {
                let help = format!("choose a whole number from {} to {}", range.start(), range.end());
                Err(self.value_error(span, format!("`{key}` is {value}, which is out of range"), help))
            }
        }
    }
}

/// A value of a table with the place it stands at; `None` where the key is missing.
type Found<'a, T> = Option<(&'a T, Range<usize>)>;

/// One table of arguments being read: every key is asked for by name, then [`Arguments::finish`] refuses the rest.
#[derive(Debug)]
pub(super) struct Arguments<'a> {
    source: &'a Source,
    table: &'a ArgumentTable,
    span: Range<usize>,
    /// Keys asked for so far with their defaults, for messages and for the test of the documentation.
    asked: RefCell<Vec<(&'static str, String)>>,
}

impl<'a> Arguments<'a> {
    pub(super) fn new(source: &'a Source, table: &'a Spanned<ArgumentTable>) -> Self {
        Self { source, table: table.get_ref(), span: table.span(), asked: RefCell::default() }
    }

    /// Where the table stands.
    pub(super) fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// Keys asked for so far, with their defaults as text.
    #[cfg(test)]
    pub(super) fn asked(&self) -> Vec<(&'static str, String)> {
        self.asked.borrow().clone()
    }

    fn find(&self, key: &'static str, default: impl fmt::Display) -> Option<&'a Spanned<Argument>> {
        self.asked.borrow_mut().push((key, default.to_string()));
        self.table.0.iter().find(|(name, _)| name.get_ref() == key).map(|(_, value)| value)
    }

    fn wrong_type(&self, key: &str, value: &Spanned<Argument>, wanted: &str) -> SceneError {
        self.source.value_error(value.span(), format!("`{key}` has the wrong type"), format!("give {wanted}"))
    }

    /// A number in `range`, where the key is there.
    pub(super) fn optional_number(
        &self,
        key: &'static str,
        range: RangeInclusive<f64>,
    ) -> Result<Option<f64>, SceneError> {
        self.number_at(key, self.find(key, "–"), range)
    }

    /// A number in `range`.
    pub(super) fn number(
        &self,
        key: &'static str,
        default: f64,
        range: RangeInclusive<f64>,
    ) -> Result<f64, SceneError> {
        Ok(self.number_at(key, self.find(key, default), range)?.unwrap_or(default))
    }

    fn number_at(
        &self,
        key: &str,
        found: Option<&Spanned<Argument>>,
        range: RangeInclusive<f64>,
    ) -> Result<Option<f64>, SceneError> {
        match found.map(|value| (value.get_ref(), value)) {
            None => Ok(None),
            Some((Argument::Number(number), value)) => {
                self.source.in_range(key, *number, value.span(), range).map(Some)
            }
            Some((_, value)) => Err(self.wrong_type(key, value, "a number")),
        }
    }

    /// A whole number in `range`.
    pub(super) fn whole(&self, key: &'static str, default: u32, range: RangeInclusive<u32>) -> Result<u32, SceneError> {
        let Some(value) = self.find(key, default) else {
            return Ok(default);
        };
        match value.get_ref() {
            Argument::Number(number) if number.fract() == 0.0 => {
                // `as` saturates, and what saturates is outside every range used here.
                self.source.whole_in_range(key, *number as i64, value.span(), range)
            }
            _ => Err(self.wrong_type(key, value, "a whole number")),
        }
    }

    /// A linear colour, each channel from 0 to `brightest`.
    pub(super) fn colour(&self, key: &'static str, default: [f32; 3], brightest: f64) -> Result<[f32; 3], SceneError> {
        let [red, green, blue] = default;
        let Some(value) = self.find(key, format_args!("[{red}, {green}, {blue}]")) else {
            return Ok(default);
        };
        let mut colour = [0.0; 3];
        match value.get_ref() {
            Argument::Numbers(numbers) if numbers.len() == 3 => {
                for (channel, &number) in colour.iter_mut().zip(numbers) {
                    *channel = self.source.in_range(key, number, value.span(), 0.0..=brightest)? as f32;
                }
                Ok(colour)
            }
            _ => Err(self.wrong_type(key, value, "three numbers: red, green, blue")),
        }
    }

    /// `N` numbers in `range`.
    pub(super) fn numbers<const N: usize>(
        &self,
        key: &'static str,
        default: [f64; N],
        range: RangeInclusive<f64>,
    ) -> Result<[f64; N], SceneError> {
        let Some(value) = self.find(key, format_args!("{default:?}")) else {
            return Ok(default);
        };
        let mut found = [0.0; N];
        match value.get_ref() {
            Argument::Numbers(numbers) if numbers.len() == N => {
                for (slot, &number) in found.iter_mut().zip(numbers) {
                    *slot = self.source.in_range(key, number, value.span(), range.clone())?;
                }
                Ok(found)
            }
            _ => Err(self.wrong_type(key, value, &format!("an array of {N} numbers"))),
        }
    }

    /// A text with the place it stands at, where the key is there.
    pub(super) fn text(&self, key: &'static str) -> Result<Found<'a, str>, SceneError> {
        match self.find(key, "–").map(|value| (value.get_ref(), value)) {
            None => Ok(None),
            Some((Argument::Text(text), value)) => Ok(Some((text, value.span()))),
            Some((_, value)) => Err(self.wrong_type(key, value, "a text in quotes")),
        }
    }

    /// An array of texts with the place it stands at, where the key is there.
    pub(super) fn texts(&self, key: &'static str) -> Result<Found<'a, [String]>, SceneError> {
        match self.find(key, "–").map(|value| (value.get_ref(), value)) {
            None => Ok(None),
            Some((Argument::Texts(texts), value)) => Ok(Some((texts, value.span()))),
            Some((_, value)) => Err(self.wrong_type(key, value, "an array of texts in quotes")),
        }
    }

    /// An error at this table.
    pub(super) fn error(&self, message: impl Into<String>, help: impl Into<String>) -> SceneError {
        self.source.value_error(self.span(), message, help)
    }

    /// An error at `span`.
    pub(super) fn error_at(
        &self,
        span: Range<usize>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> SceneError {
        self.source.value_error(span, message, help)
    }

    /// Refuses the keys nobody asked for.
    pub(super) fn finish(&self) -> Result<(), SceneError> {
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

    /// Equal for tables that mean the same, wherever they stand: the key of the cache of maps.
    pub(super) fn fingerprint(&self) -> String {
        let pairs: Vec<_> = self.table.0.iter().map(|(key, value)| (key.get_ref(), value.get_ref())).collect();
        format!("{pairs:?}")
    }
}
