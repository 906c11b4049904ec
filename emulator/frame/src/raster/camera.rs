//! The pinhole camera: frame constants, homogeneous screen coordinates, and the view vector of any sample.
//!
//! The ray through the screen point (x, y) in pixels is x′·right + y′·down + z₀·forward with x′ = x − width/2,
//! y′ = y − height/2, z₀ the focal length in pixels. v = −ray points from the surface to the eye (W97 eq. 7), so
//! ∂v/∂x = −right and ∂v/∂y = −down per pixel: the minus that W97 lacks after eq. 7 (erratum 11).

use glam::{DVec2, DVec3};
use roughxel_core::ports::BlockVector;
use roughxel_shader::{AttributeRows, BlockRows, Derivatives};

use super::blocks::{Positions, block, block_rows, derivatives, port};
use super::{MAX_EDGE_PX, RasterError, SUBPIXELS};
use roughxel_scene::Camera;
use roughxel_utilities::limits::MAX_FRAME_PIXELS;

/// Camera of one frame, ready for the rasteriser.
#[derive(Clone, Debug)]
pub struct Projection {
    width: u32,
    height: u32,
    near: f64,
    focal_px: f64,
    eye: DVec3,
    right: DVec3,
    down: DVec3,
    forward: DVec3,
    /// v by component: constant, per sub-pixel x, per sub-pixel y.
    view: [[f64; 3]; 3],
    dview: [BlockVector; 2],
}

impl Projection {
    /// Distance of the near plane as a share of the distance from eye to target.
    pub const NEAR_SHARE: f64 = 1.0 / 4096.0;

    /// Frame constants of a camera.
    ///
    /// Errors: a frame of no or too many pixels, an angle of view outside (0°, 180°), numbers that are not finite, eye and
    /// target in one place, up along the line of sight.
    pub fn new(camera: &Camera) -> Result<Self, RasterError> {
        let (width, height) = (camera.width, camera.height);
        let edge = 1..=MAX_EDGE_PX;
        let is_too_large = u64::from(width) * u64::from(height) > MAX_FRAME_PIXELS;
        if !edge.contains(&width) || !edge.contains(&height) || is_too_large {
            let limits = format!("of 1 to {MAX_EDGE_PX} and at most {MAX_FRAME_PIXELS} pixels");
            let remedy = format!("give a width and a height {limits}");
            return Err(RasterError::OutOfRange(format!("camera: a frame of {width}×{height} pixels; {remedy}")));
        }
        let fov_y_degrees = camera.fov_y_degrees;
        let half_angle = DVec2::from_angle(fov_y_degrees * (core::f64::consts::PI / 360.0));
        let focal_px = 0.5 * f64::from(height) * half_angle.x / half_angle.y;
        // The upper bound keeps z₀ within the range in which one pixel still changes the mantissas of v.
        if !(fov_y_degrees > 0.0 && fov_y_degrees < 180.0 && focal_px > 0.0 && focal_px < 1e9) {
            let remedy = "give more than 0 and less than 180";
            return Err(RasterError::OutOfRange(format!("camera: an angle of view of {fov_y_degrees}°; {remedy}")));
        }
        let no_view = |problem| {
            let remedy = "eye and target must be finite and distinct, and up must not lie along the line of sight";
            RasterError::OutOfRange(format!("camera: {problem}; {remedy}"))
        };
        let (forward, distance) = unit(camera.target - camera.eye)
            .ok_or_else(|| no_view("eye and target are the same point or not finite"))?;
        let across = unit(camera.up).and_then(|(up_hint, _)| unit(forward.cross(up_hint)));
        let (right, _) = across
            .filter(|(_, sine)| *sine >= 1e-9)
            .ok_or_else(|| no_view("up is zero, not finite or along the line of sight"))?;
        let down = forward.cross(right);

        // v(x, y) in pixels over sub-pixel positions.
        let corner = 0.5 * (f64::from(width) * right + f64::from(height) * down) - focal_px * forward;
        let per_subpixel = 1.0 / f64::from(SUBPIXELS);
        let view = [0, 1, 2].map(|i| [corner[i], -right[i] * per_subpixel, -down[i] * per_subpixel]);
        Ok(Self {
            width,
            height,
            near: distance * Self::NEAR_SHARE,
            focal_px,
            eye: camera.eye,
            right,
            down,
            forward,
            view,
            dview: [-right, -down].map(|v| port(block(v.to_array(), 0))),
        })
    }

    /// Width of the frame in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height of the frame in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Distance of the near plane from the eye along the line of sight, in world units: 1/4096 of the distance from
    /// eye to target.
    pub fn near(&self) -> f64 {
        self.near
    }

    /// View vector v = −ray of a sample, in pixels of the picture plane, so |v| ≥ z₀; world space.
    ///
    /// The position is in sub-pixels of 1/256 px and is moved to the nearest one inside the frame. −v is the direction of the
    /// line of sight, which the background needs. Rounding: to nearest, after an error below 2⁻⁵⁰ of the largest |v|.
    pub fn ray_view(&self, x_subpx: i32, y_subpx: i32) -> BlockVector {
        port(block(self.view_at(x_subpx, y_subpx), 0))
    }

    /// The rays of samples, in lanes, as normals and views of mirrors whose back faces the camera: r = 2d⟨d·d⟩ − d|d|² = d|d|².
    #[inline(always)]
    pub fn mirror_rays(&self, positions: &Positions, rows: &mut AttributeRows) {
        rows.normal = self.ray_views(positions);
        for mantissa in rows.normal.mantissa.as_flattened_mut() {
            *mantissa = -*mantissa;
        }
        rows.view = rows.normal;
    }

    /// View vectors of samples in lanes; see [`Self::ray_view`].
    #[inline(always)]
    pub(super) fn ray_views(&self, positions: &Positions) -> BlockRows<3> {
        block_rows(0, |lane| self.view_at(positions[0][lane], positions[1][lane]))
    }

    #[inline(always)]
    fn view_at(&self, x_subpx: i32, y_subpx: i32) -> [f64; 3] {
        let x = f64::from(x_subpx.max(0).min(self.width as i32 * SUBPIXELS));
        let y = f64::from(y_subpx.max(0).min(self.height as i32 * SUBPIXELS));
        let [a, b, c] = &self.view;
        let component = |plane: &[f64; 3]| plane[0] + plane[1] * x + plane[2] * y;
        [component(a), component(b), component(c)]
    }

    /// ∂v/∂x and ∂v/∂y per pixel (y down), in the units of [`Projection::ray_view`]: two orthogonal unit vectors.
    pub fn dview(&self) -> [BlockVector; 2] {
        self.dview
    }

    /// ∂v and no ∂n: a footprint as wide as the pixel.
    pub fn mirror_derivatives(&self) -> Derivatives<i32> {
        derivatives(self.dview, [BlockVector::default(); 2])
    }

    /// Homogeneous screen coordinates (x·w, y·w, w) of a world position: x and y in pixels, w the distance along
    /// the line of sight in world units, negative behind the eye.
    pub(super) fn homogeneous(&self, position: DVec3) -> DVec3 {
        let offset = position - self.eye;
        let w = offset.dot(self.forward);
        DVec3::new(
            self.focal_px * offset.dot(self.right) + 0.5 * f64::from(self.width) * w,
            self.focal_px * offset.dot(self.down) + 0.5 * f64::from(self.height) * w,
            w,
        )
    }
}

/// Unit vector and length; `None` for a vector of zero length or one that is not finite.
pub(super) fn unit(vector: DVec3) -> Option<(DVec3, f64)> {
    // Scaling by the largest component first keeps tiny and huge vectors in the range of float64.
    let largest = vector.abs().max_element();
    let scaled = vector / largest;
    let length = scaled.length();
    (largest > 0.0 && vector.is_finite() && length.is_finite()).then(|| (scaled / length, length * largest))
}
