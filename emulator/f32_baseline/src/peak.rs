//! One light on one peak of a surface in `f32`, without its horizon.

use glam::Vec3;
use roughxel_core::ports::PeakIn;
use roughxel_core::setup::{RealPeak, real_peak, real_vector};

use crate::formulas::{Formulas, Frame};
use crate::math::Math;

/// Inputs of one light on one peak in real units; the fields are those of [`PeakIn`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LitPeak {
    /// n.
    pub normal: Vec3,
    /// v, from the surface to the eye.
    pub view: Vec3,
    /// h, the main direction.
    pub main_direction: Vec3,
    /// l, from the surface to the light.
    pub light: Vec3,
    /// N of the peak in the tangent basis of the surface, of unit length but for its storage.
    pub peak: Vec3,
    /// a.
    pub amplitude: f32,
    /// n of the peak.
    pub exponent: f32,
}

impl From<&PeakIn> for LitPeak {
    /// Rounds the numbers of the ports to `f32`.
    fn from(ports: &PeakIn) -> Self {
        let RealPeak { normal: peak, amplitude, exponent } = real_peak(&ports.peak);
        Self {
            normal: real_vector(&ports.surface.normal).as_vec3(),
            view: real_vector(&ports.surface.view).as_vec3(),
            main_direction: real_vector(&ports.surface.frame_vectors[0]).as_vec3(),
            light: real_vector(&ports.light).as_vec3(),
            peak: peak.as_vec3(),
            amplitude: amplitude as f32,
            exponent: exponent as f32,
        }
    }
}

impl LitPeak {
    /// Tangent basis, half vector, its place in that basis, a·max(0, N·H)ⁿ; 0 if the light is on the horizon of n or below it.
    pub fn shine<M: Math, F: Formulas>(&self) -> f32 {
        let &Self { normal, view, main_direction, light, peak, amplitude, exponent } = self;
        if light.dot(normal) <= 0.0 {
            return 0.0;
        }
        let Frame { e1, e2, .. } = F::frame::<M>(normal, main_direction);
        let half = light * M::inverse_sqrt(light.dot(light)) + view * M::inverse_sqrt(view.dot(view));
        let local = Vec3::new(half.dot(e1), half.dot(e2), half.dot(normal));
        amplitude * F::cosine_power::<M>(peak, local * M::inverse_sqrt(local.dot(local)), exponent)
    }
}
