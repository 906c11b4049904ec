//! Scenes as they are read from their text and from files of people.

mod builtin;
mod environment;
mod inspect;
mod lights;
mod load;
mod maps;
