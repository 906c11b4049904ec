//! Frames and what they are made of: pictures against their truth, golden frames, pyramids of peaks, plans.

mod frames;
mod lobes;
mod peak_pyramid;
mod photographs;
mod plan;
mod shadows;
