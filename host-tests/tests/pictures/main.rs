//! Picture tests: pictures against their truth, golden frames, pyramids of peaks, plans.

mod as_files_mean;
mod frames;
mod lobes;
mod meshes;
mod peak_pyramid;
mod plan;
mod real_scenes;
mod reflections;
mod shadows;
