//! # roughxel-utilities
//!
//! What knows nothing of the datapath: files that are read ([`input`]) and those that appear whole ([`output`]), check values ([`crc`]), seeded
//! random numbers ([`random`]), powers of two with the same bits everywhere ([`mod@exp2`]), words that somebody may have meant ([`spelling`]),
//! bounds of what is read and drawn ([`limits`]).

pub mod crc;
pub mod exp2;
pub mod input;
pub mod limits;
pub mod output;
pub mod random;
pub mod spelling;
