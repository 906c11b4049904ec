//! Hardware tests: the proof of the recorded datapath's ranges, the Verilog generated from it, and the folder of vectors on its own.

mod benches;
mod broken;
mod c_library;
mod floorplan;
mod folded;
mod frame;
mod outputs;
mod folder;
mod coverage;
mod check;
mod declarations;
mod shrink;
mod proof;
mod rtl;
mod shell;
mod stages;
mod targets;
