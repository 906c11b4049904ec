//! S97's highlight as Appendix A prints it, in float64, for comparison only: no datapath has it (errata 6 to 8).

use roughxel_core::block::Block;
use roughxel_core::datapath::Surface;
use roughxel_core::fx::Fx;
use roughxel_core::ports::{BlockVector, Port, SurfaceIn, SurfaceInput};
use roughxel_core::setup::{real_offset, real_vector};
use roughxel_reference::highlight::{half, printed_cos2};
use roughxel_reference::linear::{Vector3, dot, norm, scaled};
use roughxel_shader::Channel;

/// The share of a light, with the exponent m. It is 0 below the surface and where the formula is 0/0: at n = h, and everywhere on
/// a smooth surface.
pub(super) fn light(surface: &Surface<i32>, input: &SurfaceInput<i32>, light: &BlockVector, m: f64) -> Channel {
    let ports = SurfaceIn::from_wires(input);
    let light = real_vector(light).to_array();
    let normal = direction(&surface.normal_mod);
    let half = unit(half(light, real_vector(&ports.view).to_array()));
    if dot(&direction(&surface.normal), &light) <= 0.0 || dot(&normal, &half) <= 0.0 {
        return Fx::zero();
    }
    let difference: Vector3 = core::array::from_fn(|i| normal[i] - half[i]);
    let [e1, e2] = [&surface.frame.e1, &surface.frame.e2].map(direction);
    let cos2 = printed_cos2(ports.roughness.map(real_offset), [dot(&difference, &e1), dot(&difference, &e2)]);
    let share = libm::pow(cos2, 0.5 * m);
    // NaN becomes no light.
    Fx::from_raw((share.clamp(0.0, 1.0) * f64::from(1 << 24)).round() as i32)
}

fn direction(block: &Block<i32, 3>) -> Vector3 {
    unit(block.m.map(|m| f64::from(m.raw())))
}

fn unit(a: Vector3) -> Vector3 {
    let length = norm(&a);
    if length > 0.0 { scaled(1.0 / length, a) } else { a }
}
