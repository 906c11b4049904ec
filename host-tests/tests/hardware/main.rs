//! The recorded datapath: the proof of its ranges, and the Verilog made of it.

mod proof;
mod rtl;
