//! Datapath tests: its arithmetic and its stages against the float64 reference, the properties of any fragment, and the same bits in every backend.

mod accuracy;
mod arithmetic;
mod batches;
mod design_lanes;
mod elementary;
mod filter;
mod float_datapath;
mod hard_cases;
mod highlight;
mod horizon;
mod lane_frames;
mod lane_words;
mod lanes;
mod lemmas;
mod lit_lanes;
mod lit_peak;
mod moments;
mod peaks;
mod probe_count;
mod properties;
mod backends;
mod scanline;
mod seam;
mod small;
mod sphere;
mod tile;
