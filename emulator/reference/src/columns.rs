//! Footprint columns: changes of s, t with v and n_mod (W97 (5)–(11)).
//!
//! dr = [2 n nᵀ − |n|²I]dv + 2[⟨n·v⟩I + n vᵀ − v nᵀ]dn with n = n_mod everywhere (erratum 10); q = (ds_c − s·dm, dt_c − t·dm)/m with the signs of the
//! face.

use super::cube::{Selection, face_components};
use super::linear::{Vector2, Vector3, add_scaled, dot, norm, scaled};

/// One column of the 2×4 matrix Q.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// (ds, dt) on the plane of the face.
    pub q: Vector2,
    /// √(1+s²+t²)·(3|n|²|dv| + 6|n||v||dn|)/m: a bound of |q| as if no terms cancelled, at least |q|.
    ///
    /// Rounding n_mod, r, s or t by a relative ε moves q by a small multiple of ε times this number. So errors of a cancelling footprint are measured
    /// against it.
    pub scale: f64,
}

/// Change of r = 2 n⟨v·n⟩ − v|n|² for small dv and dn, W97 (8) and (9) with n = n_mod.
pub fn reflected_derivative(view: Vector3, normal: Vector3, dview: Vector3, dnormal: Vector3) -> Vector3 {
    let aperture = add_scaled(scaled(2.0 * dot(&normal, &dview), normal), -dot(&normal, &normal), dview);
    let mut curvature = scaled(dot(&normal, &view), dnormal);
    curvature = add_scaled(curvature, dot(&view, &dnormal), normal);
    curvature = add_scaled(curvature, -dot(&normal, &dnormal), view);
    add_scaled(aperture, 2.0, curvature)
}

/// The column q of one pair (dv, dn); zero when r is zero.
///
/// `selection` must be that of the reflected ray of `view` and `normal` = n_mod.
pub fn column(view: Vector3, normal: Vector3, selection: &Selection, dview: Vector3, dnormal: Vector3) -> Column {
    let &Selection { face, s, t, m } = selection;
    if m == 0.0 {
        return Column { q: [0.0; 2], scale: 0.0 };
    }
    let dr = reflected_derivative(view, normal, dview, dnormal);
    let [ds_c, dt_c, dm] = face_components(face, dr);
    let normal_length = norm(&normal);
    let terms = 3.0 * normal_length * normal_length * norm(&dview) + 6.0 * normal_length * norm(&view) * norm(&dnormal);
    Column { q: [(ds_c - s * dm) / m, (dt_c - t * dm) / m], scale: norm(&[1.0, s, t]) * terms / m }
}

#[cfg(test)]
mod tests {
    use super::super::cube;
    use super::super::random::SplitMix64;
    use super::super::reflect::reflect;
    use super::*;

    #[test]
    fn derivative_of_r_agrees_with_central_differences() {
        let mut random = SplitMix64::new(4);
        let step = 1e-5;
        for _ in 0..1000 {
            let [v, n, dv, dn] = [0; 4].map(|_| [0, 1, 2].map(|_| random.uniform(-1.0, 1.0)));
            let moved = |k: f64| reflect(add_scaled(v, k, dv), add_scaled(n, k, dn));
            let difference = scaled(0.5 / step, add_scaled(moved(step), -1.0, moved(-step)));
            let error = add_scaled(difference, -1.0, reflected_derivative(v, n, dv, dn));
            // r is cubic in the step: the truncation error is step²·|dn|²|dv| ≈ 1e-9.
            assert!(norm(&error) < 1e-8);
        }
    }

    #[test]
    fn columns_agree_with_differences_on_every_face() {
        let mut random = SplitMix64::new(6);
        let step = 1e-6;
        let mut seen = [0; 6];
        for _ in 0..4000 {
            let [v, n, dv, dn] = [0; 4].map(|_| [0, 1, 2].map(|_| random.uniform(-1.0, 1.0)));
            let r = reflect(v, n);
            let at = cube::select(r);
            if norm(&v) < 0.2 || norm(&n) < 0.2 {
                continue;
            }
            seen[at.face] += 1;
            let column = column(v, n, &at, dv, dn);
            let moved = |k: f64| {
                let ray = reflect(add_scaled(v, k, dv), add_scaled(n, k, dn));
                let at = cube::project(at.face, ray);
                [at.s, at.t]
            };
            let (plus, minus) = (moved(step), moved(-step));
            for i in 0..2 {
                let difference = (plus[i] - minus[i]) / (2.0 * step);
                assert!((difference - column.q[i]).abs() < 1e-7 * column.scale);
            }
            assert!(norm(&column.q) <= column.scale);
        }
        assert!(seen.iter().all(|&count| count > 300), "{seen:?}");
    }
}
