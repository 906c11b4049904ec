//! The recorded datapath: the proof of its ranges, and the Verilog made of it; and the folder of vectors on its own.

mod benches;
mod broken;
mod c_library;
mod folder;
mod grade;
mod judge;
mod minimise;
mod proof;
mod rtl;
mod stages;
