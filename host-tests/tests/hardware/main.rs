//! Hardware tests: the proof of the recorded datapath's ranges, the Verilog generated from it, and the folder of vectors on its own.

mod benches;
mod broken;
mod c_library;
mod check;
mod coverage;
mod declarations;
mod floorplan;
mod folded;
mod folder;
mod frame;
mod outputs;
mod proof;
mod rtl;
mod shell;
mod shrink;
mod stages;
mod statements;
mod targets;
