//! Values of a scene file with their places, and the accessors for them.
//!
//! Tables whose keys depend on a generator's name are read as [`ArgumentTable`]. [`Arguments`] asks them key by key,
//! then refuses keys that nobody asked for.

mod arguments;

use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;
use std::ops::{Range, RangeInclusive};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::de::{Deserialize, Deserializer, Expected, SeqAccess, Visitor};
use toml::Spanned;

pub(super) use self::arguments::Arguments;

use crate::error::{Fault, SceneError};
use roughxel_utilities::input::without_mark;

/// Most elements of an array in a generator's table.
const MAX_LIST: usize = 64;

/// Array of exactly `N` values. Another length is an error, while serde's arrays take the beginning of a longer one.
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

impl<T, const N: usize> From<Exactly<T, N>> for [T; N] {
    fn from(Exactly(all): Exactly<T, N>) -> Self {
        all
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

impl From<OneOrThree> for [f64; 3] {
    fn from(OneOrThree(three): OneOrThree) -> Self {
        three
    }
}

/// A value in a table whose keys depend on a generator.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Argument {
    Flag(bool),
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
                out.write_str("a number, a text, true or false, or an array of numbers or of texts")
            }

            fn visit_bool<E>(self, value: bool) -> Result<Argument, E> {
                Ok(Argument::Flag(value))
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
                        Argument::Flag(_) | Argument::Numbers(_) | Argument::Texts(_) => {
                            return Err(serde::de::Error::custom("an array holds numbers or texts here"));
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

impl Argument {
    fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            _ => None,
        }
    }
}

/// A table whose keys depend on its contents: a file or a generator with its parameters.
#[derive(Debug, serde::Deserialize)]
#[serde(transparent)]
pub(super) struct ArgumentTable(pub(super) BTreeMap<Spanned<String>, Spanned<Argument>>);

impl ArgumentTable {
    /// True if the table has a key.
    pub(super) fn has(&self, key: &str) -> bool {
        self.0.keys().any(|own| own.get_ref() == key)
    }
}

/// Text of a scene, with the context of its errors.
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

    /// A number of a key, checked by [`Source::in_range`]; `default` if it is missing.
    pub(super) fn number(
        &self,
        key: &str,
        value: &Option<Spanned<f64>>,
        default: f64,
        range: RangeInclusive<f64>,
    ) -> Result<f64, SceneError> {
        value.as_ref().map_or(Ok(default), |value| self.in_range(key, *value.get_ref(), value.span(), range))
    }

    /// Checks each number by [`Source::in_range`].
    pub(super) fn all_in_range<const N: usize>(
        &self,
        key: &str,
        values: &Spanned<impl Copy + Into<[f64; N]>>,
        range: RangeInclusive<f64>,
    ) -> Result<[f64; N], SceneError> {
        let all = (*values.get_ref()).into();
        for value in all {
            self.in_range(key, value, values.span(), range.clone())?;
        }
        Ok(all)
    }

    /// Numbers of a key, checked by [`Source::all_in_range`]; `default` if it is missing.
    pub(super) fn numbers<const N: usize>(
        &self,
        key: &str,
        values: &Option<Spanned<impl Copy + Into<[f64; N]>>>,
        default: [f64; N],
        range: RangeInclusive<f64>,
    ) -> Result<[f64; N], SceneError> {
        values.as_ref().map_or(Ok(default), |values| self.all_in_range(key, values, range))
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
