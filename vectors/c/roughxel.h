/* The scalar datapaths of roughxel: what a device has to compute, to the bit.
 *
 * `roughxel vectors c` writes this file; vectors/README.md says how the library is built, vectors/SPEC.md what it computes.
 *
 * A member of a structure is a field of a vector word, with its name, in its order: the integer that the profile keeps, over
 * 2^fraction bits (vectors/FORMAT.md). Beside each stand its format and its range: I signed, U unsigned, bits before the point,
 * F fraction bits; p is fraction_bits of the profile, l its lod_bits. The value of a mantissa is times 2^e. Inputs that the effects
 * leave out are not read, outcomes that they leave out are constants. What is read has to be in its range all the same: 0 always is.
 *
 * Every function returns ROUGHXEL_OK or an error, and then writes nothing: its kind in the lowest ROUGHXEL_ERROR_BITS bits, and
 * above them the place of the member or knob that is wrong, from 0. No function keeps state, allocates or ends the program; all may
 * be called from any thread. What is written may not overlap what is read. */

#ifndef ROUGHXEL_H
#define ROUGHXEL_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Of this header; roughxel_version() is that of the library. */
#define ROUGHXEL_VERSION 1

#define ROUGHXEL_OK 0 /* done */
#define ROUGHXEL_ERROR_NULL 1 /* a pointer is null */
#define ROUGHXEL_ERROR_PROFILE 2 /* no profile has that name: there are narrow, paper, compact, standard, precise */
#define ROUGHXEL_ERROR_KNOB 3 /* a knob is out of its range */
#define ROUGHXEL_ERROR_EFFECTS 4 /* an effect is unknown, or two kinds of one effect are on */
#define ROUGHXEL_ERROR_INPUT 5 /* an input is out of the range of its field */
#define ROUGHXEL_ERROR_BITS 8
#define ROUGHXEL_ERROR_KIND(error) ((error) & 255)
#define ROUGHXEL_ERROR_PLACE(error) ((error) >> 8)

/* Effects that are on, a sum of: */
#define ROUGHXEL_BUMP 1u /* bump: reflection and highlight */
#define ROUGHXEL_ROUGHNESS 2u /* anisotropic roughness: reflection and highlight */
#define ROUGHXEL_ROUGHNESS_ISO 4u /* isotropic roughness, which reads roughness_1 alone */
#define ROUGHXEL_CURVATURE 8u /* curvature: reflection */
#define ROUGHXEL_FOOTPRINT 16u /* footprint on a face: reflection */
#define ROUGHXEL_FOOTPRINT_SPHERE 32u /* footprint on the sphere, for wide lobes */
#define ROUGHXEL_HORIZON 64u /* correlated horizons: peak */
#define ROUGHXEL_HORIZON_PRODUCT 128u /* horizons as a product of shares */
#define ROUGHXEL_FRAME_NATURAL 256u /* frame of p_u and p_v instead of the main direction */
#define ROUGHXEL_FRAME_NATURAL_NORMALISED 512u /* the same, lengths dropped */

/* The accuracy. */
typedef struct roughxel_profile {
  int32_t fraction_bits; /* 12 to 28 */
  int32_t reciprocal_seed_bits; /* 6 to 10 */
  int32_t reciprocal_steps; /* 0 to 2 */
  int32_t inverse_root_seed_bits; /* 6 to 10 */
  int32_t inverse_root_steps; /* 0 to 2 */
  int32_t direction; /* 0 exact, or steps of a table: 2 to 64, an even number */
  int32_t max_probes; /* 1 to 16 */
  int32_t probe_rule; /* 0 power_of_two, 1 ceiling */
  int32_t probe_weights; /* 0 box, 1 gaussian */
  int32_t lod_bits; /* 2 to 12 */
  int32_t weight_bits; /* 2 to 10 */
  int32_t roughness; /* 0 none, 1 isotropic, 2 anisotropic */
  int32_t roughness_bits; /* 4 to 16 */
} roughxel_profile;

/* What goes into the reflection datapath. */
typedef struct roughxel_reflection_in {
  /* surface normal n, any length [length] */
  int32_t normal_x; /* I2Fp, -2 to below 2 */
  int32_t normal_y; /* I2Fp, -2 to below 2 */
  int32_t normal_z; /* I2Fp, -2 to below 2 */
  int32_t normal_e; /* I16, -32768 to 32767 */
  /* vector v from the surface to the eye, any length [length] */
  int32_t view_x; /* I2Fp, -2 to below 2 */
  int32_t view_y; /* I2Fp, -2 to below 2 */
  int32_t view_z; /* I2Fp, -2 to below 2 */
  int32_t view_e; /* I16, -32768 to 32767 */
  /* frame vectors: the main direction h in slot 0 (system 3), or p_u and p_v (systems 1 and 2) [length] */
  int32_t frame_vectors_0_x; /* I2Fp, -2 to below 2 */
  int32_t frame_vectors_0_y; /* I2Fp, -2 to below 2 */
  int32_t frame_vectors_0_z; /* I2Fp, -2 to below 2 */
  int32_t frame_vectors_0_e; /* I16, -32768 to 32767 */
  int32_t frame_vectors_1_x; /* I2Fp, -2 to below 2 */
  int32_t frame_vectors_1_y; /* I2Fp, -2 to below 2 */
  int32_t frame_vectors_1_z; /* I2Fp, -2 to below 2 */
  int32_t frame_vectors_1_e; /* I16, -32768 to 32767 */
  /* bump offsets b₁, b₂, relative to |n|; fraction_bits − 2 fraction bits are kept [|n|] */
  int32_t offset_1; /* I4F(p-2), -8 to below 8 */
  int32_t offset_2; /* I4F(p-2), -8 to below 8 */
  /* roughness d₁, d₂, d₃ (K = D Dᵀ, D = [[d₁, d₂], [0, d₃]]), relative to |n|; isotropic: I₁ in the first, alone [|n|] */
  int32_t roughness_1; /* I4F(p-2), -8 to below 8 */
  int32_t roughness_2; /* I4F(p-2), -8 to below 8 */
  int32_t roughness_3; /* I4F(p-2), -8 to below 8 */
  /* ∂v/∂x (one pixel to the right) and ∂v/∂y (one pixel down) [length per pixel] */
  int32_t dview_0_x; /* I2Fp, -2 to below 2 */
  int32_t dview_0_y; /* I2Fp, -2 to below 2 */
  int32_t dview_0_z; /* I2Fp, -2 to below 2 */
  int32_t dview_0_e; /* I16, -32768 to 32767 */
  int32_t dview_1_x; /* I2Fp, -2 to below 2 */
  int32_t dview_1_y; /* I2Fp, -2 to below 2 */
  int32_t dview_1_z; /* I2Fp, -2 to below 2 */
  int32_t dview_1_e; /* I16, -32768 to 32767 */
  /* ∂n/∂x and ∂n/∂y, in the units of n [length per pixel] */
  int32_t dnormal_0_x; /* I2Fp, -2 to below 2 */
  int32_t dnormal_0_y; /* I2Fp, -2 to below 2 */
  int32_t dnormal_0_z; /* I2Fp, -2 to below 2 */
  int32_t dnormal_0_e; /* I16, -32768 to 32767 */
  int32_t dnormal_1_x; /* I2Fp, -2 to below 2 */
  int32_t dnormal_1_y; /* I2Fp, -2 to below 2 */
  int32_t dnormal_1_z; /* I2Fp, -2 to below 2 */
  int32_t dnormal_1_e; /* I16, -32768 to 32767 */
  /* edge of a face of the environment at level 0; 0 reads as 1, more than 16384 as 16384 [texels] */
  int32_t edge_texels; /* U16, 0 to 65535 */
} roughxel_reflection_in;
/* X(member) for each, in order. */
#define ROUGHXEL_REFLECTION_IN_MEMBERS(X) \
  X(normal_x) \
  X(normal_y) \
  X(normal_z) \
  X(normal_e) \
  X(view_x) \
  X(view_y) \
  X(view_z) \
  X(view_e) \
  X(frame_vectors_0_x) \
  X(frame_vectors_0_y) \
  X(frame_vectors_0_z) \
  X(frame_vectors_0_e) \
  X(frame_vectors_1_x) \
  X(frame_vectors_1_y) \
  X(frame_vectors_1_z) \
  X(frame_vectors_1_e) \
  X(offset_1) \
  X(offset_2) \
  X(roughness_1) \
  X(roughness_2) \
  X(roughness_3) \
  X(dview_0_x) \
  X(dview_0_y) \
  X(dview_0_z) \
  X(dview_0_e) \
  X(dview_1_x) \
  X(dview_1_y) \
  X(dview_1_z) \
  X(dview_1_e) \
  X(dnormal_0_x) \
  X(dnormal_0_y) \
  X(dnormal_0_z) \
  X(dnormal_0_e) \
  X(dnormal_1_x) \
  X(dnormal_1_y) \
  X(dnormal_1_z) \
  X(dnormal_1_e) \
  X(edge_texels)

/* What comes out of the reflection datapath. */
typedef struct roughxel_reflection_out {
  /* tangents E₁ and E₂, scaled by |n| [length] (tap, stage frame) */
  int32_t frame_0_x; /* I2Fp, -2 to below 2 */
  int32_t frame_0_y; /* I2Fp, -2 to below 2 */
  int32_t frame_0_z; /* I2Fp, -2 to below 2 */
  int32_t frame_0_e; /* I16, -32768 to 32767 */
  int32_t frame_1_x; /* I2Fp, -2 to below 2 */
  int32_t frame_1_y; /* I2Fp, -2 to below 2 */
  int32_t frame_1_z; /* I2Fp, -2 to below 2 */
  int32_t frame_1_e; /* I16, -32768 to 32767 */
  /* perturbed normal n_mod [length] (tap, stage perturb) */
  int32_t normal_mod_x; /* I2Fp, -2 to below 2 */
  int32_t normal_mod_y; /* I2Fp, -2 to below 2 */
  int32_t normal_mod_z; /* I2Fp, -2 to below 2 */
  int32_t normal_mod_e; /* I16, -32768 to 32767 */
  /* reflected vector r = 2 n_mod⟨v·n_mod⟩ − v|n_mod|² [length³] (tap, stage reflect) */
  int32_t reflected_x; /* I2Fp, -2 to below 2 */
  int32_t reflected_y; /* I2Fp, -2 to below 2 */
  int32_t reflected_z; /* I2Fp, -2 to below 2 */
  int32_t reflected_e; /* I16, -32768 to 32767 */
  /* d(s, t) for ∂x, ∂y and the roughness tangents d₁E₁, d₂E₁ + d₃E₂ (isotropic: I₁E₁, I₁E₂) [half faces per pixel; half faces] (tap, stage columns) */
  int32_t columns_0_s; /* I2Fp, -2 to below 2 */
  int32_t columns_0_t; /* I2Fp, -2 to below 2 */
  int32_t columns_0_e; /* I16, -32768 to 32767 */
  int32_t columns_1_s; /* I2Fp, -2 to below 2 */
  int32_t columns_1_t; /* I2Fp, -2 to below 2 */
  int32_t columns_1_e; /* I16, -32768 to 32767 */
  int32_t columns_2_s; /* I2Fp, -2 to below 2 */
  int32_t columns_2_t; /* I2Fp, -2 to below 2 */
  int32_t columns_2_e; /* I16, -32768 to 32767 */
  int32_t columns_3_s; /* I2Fp, -2 to below 2 */
  int32_t columns_3_t; /* I2Fp, -2 to below 2 */
  int32_t columns_3_e; /* I16, -32768 to 32767 */
  /* a, b, c of the covariance K = [[a, b], [b, c]] on the plane of the face [half faces²] (tap, stage ellipse) */
  int32_t covariance_a; /* I2Fp, -2 to below 2 */
  int32_t covariance_b; /* I2Fp, -2 to below 2 */
  int32_t covariance_c; /* I2Fp, -2 to below 2 */
  int32_t covariance_e; /* I16, -32768 to 32767 */
  /* det K [half faces⁴] (tap, stage ellipse) */
  int32_t determinant_m; /* I2Fp, -2 to below 2 */
  int32_t determinant_e; /* I16, -32768 to 32767 */
  /* λ₁, standard deviation along the major axis [half faces] (tap, stage axes) */
  int32_t major_m; /* I2Fp, -2 to below 2 */
  int32_t major_e; /* I16, -32768 to 32767 */
  /* λ₂, standard deviation along the minor axis [half faces] (tap, stage axes) */
  int32_t minor_m; /* I2Fp, -2 to below 2 */
  int32_t minor_e; /* I16, -32768 to 32767 */
  /* unit direction of λ₁ in (s, t) (tap, stage axes) */
  int32_t direction_s; /* I2Fp, -1 to 1 */
  int32_t direction_t; /* I2Fp, -1 to 1 */
  /* face 0 to 5: +x, −x, +y, −y, +z, −z (stage cube_face) */
  int32_t face; /* U3, 0 to 5 */
  /* s (to the right) and t (down) on the face, −1 to 1 [half faces] (stage cube_face) */
  int32_t st_s; /* I2Fp, -1 to 1 */
  int32_t st_t; /* I2Fp, -1 to 1 */
  /* number of probes, 1 to 16 (stage probes) */
  int32_t probes; /* U5, 1 to 16 */
  /* step from one probe to the next, in s and t [half faces] (stage probes); not with footprint-sphere */
  int32_t step_s; /* I4F28, -7 to 7 */
  int32_t step_t; /* I4F28, -7 to 7 */
  /* level of detail, 0 to log₂ of the edge [levels] (stage probes); not with footprint-sphere */
  int32_t lod; /* U4Fl, 0 to 14 */
  /* sweep of a footprint on the sphere, with one exponent: centre, first and second. Probe i looks along centre + x·first + x²·second, where x is place i of N of the normal distribution (stage sweep); only with footprint-sphere */
  int32_t sweep_0_0; /* I2Fp, -1 to 1 */
  int32_t sweep_0_1; /* I2Fp, -1 to 1 */
  int32_t sweep_0_2; /* I2Fp, -1 to 1 */
  int32_t sweep_1_0; /* I2Fp, -1 to 1 */
  int32_t sweep_1_1; /* I2Fp, -1 to 1 */
  int32_t sweep_1_2; /* I2Fp, -1 to 1 */
  int32_t sweep_2_0; /* I2Fp, -1 to 1 */
  int32_t sweep_2_1; /* I2Fp, -1 to 1 */
  int32_t sweep_2_2; /* I2Fp, -1 to 1 */
  /* progress of probe i from its place among N − 1 to its place among N; the middle of the N − 1 places counts twice, or a new one lies there (stage sweep); only with footprint-sphere */
  int32_t share; /* U1F16, 0 to 1 */
  /* level of detail in the middle of a face for a direction of length 1 in units of the sweep; not saturated [levels] (stage sweep); only with footprint-sphere */
  int32_t level; /* I16F16, -20000 to 20000 */
  /* sticky bits: 1 normal_zero, 2 view_zero, 4 frame_pole, 8 view_below_surface, 16 face_tie, 32 footprint_zero, 64 footprint_saturated, 128 probes_capped [bits] (stage status) */
  int32_t status; /* U8, 0 to 255 */
} roughxel_reflection_out;
/* X(member) for each, in order. */
#define ROUGHXEL_REFLECTION_OUT_MEMBERS(X) \
  X(frame_0_x) \
  X(frame_0_y) \
  X(frame_0_z) \
  X(frame_0_e) \
  X(frame_1_x) \
  X(frame_1_y) \
  X(frame_1_z) \
  X(frame_1_e) \
  X(normal_mod_x) \
  X(normal_mod_y) \
  X(normal_mod_z) \
  X(normal_mod_e) \
  X(reflected_x) \
  X(reflected_y) \
  X(reflected_z) \
  X(reflected_e) \
  X(columns_0_s) \
  X(columns_0_t) \
  X(columns_0_e) \
  X(columns_1_s) \
  X(columns_1_t) \
  X(columns_1_e) \
  X(columns_2_s) \
  X(columns_2_t) \
  X(columns_2_e) \
  X(columns_3_s) \
  X(columns_3_t) \
  X(columns_3_e) \
  X(covariance_a) \
  X(covariance_b) \
  X(covariance_c) \
  X(covariance_e) \
  X(determinant_m) \
  X(determinant_e) \
  X(major_m) \
  X(major_e) \
  X(minor_m) \
  X(minor_e) \
  X(direction_s) \
  X(direction_t) \
  X(face) \
  X(st_s) \
  X(st_t) \
  X(probes) \
  X(step_s) \
  X(step_t) \
  X(lod) \
  X(sweep_0_0) \
  X(sweep_0_1) \
  X(sweep_0_2) \
  X(sweep_1_0) \
  X(sweep_1_1) \
  X(sweep_1_2) \
  X(sweep_2_0) \
  X(sweep_2_1) \
  X(sweep_2_2) \
  X(share) \
  X(level) \
  X(status)

/* What goes into the highlight datapath. */
typedef struct roughxel_highlight_in {
  /* surface normal n, any length [length] */
  int32_t normal_x; /* I2Fp, -2 to below 2 */
  int32_t normal_y; /* I2Fp, -2 to below 2 */
  int32_t normal_z; /* I2Fp, -2 to below 2 */
  int32_t normal_e; /* I16, -32768 to 32767 */
  /* vector v from the surface to the eye, any length [length] */
  int32_t view_x; /* I2Fp, -2 to below 2 */
  int32_t view_y; /* I2Fp, -2 to below 2 */
  int32_t view_z; /* I2Fp, -2 to below 2 */
  int32_t view_e; /* I16, -32768 to 32767, never read */
  /* frame vectors: the main direction h in slot 0 (system 3), or p_u and p_v (systems 1 and 2) [length] */
  int32_t frame_vectors_0_x; /* I2Fp, -2 to below 2 */
  int32_t frame_vectors_0_y; /* I2Fp, -2 to below 2 */
  int32_t frame_vectors_0_z; /* I2Fp, -2 to below 2 */
  int32_t frame_vectors_0_e; /* I16, -32768 to 32767 */
  int32_t frame_vectors_1_x; /* I2Fp, -2 to below 2 */
  int32_t frame_vectors_1_y; /* I2Fp, -2 to below 2 */
  int32_t frame_vectors_1_z; /* I2Fp, -2 to below 2 */
  int32_t frame_vectors_1_e; /* I16, -32768 to 32767 */
  /* bump offsets b₁, b₂, relative to |n|; fraction_bits − 2 fraction bits are kept [|n|] */
  int32_t offset_1; /* I4F(p-2), -8 to below 8 */
  int32_t offset_2; /* I4F(p-2), -8 to below 8 */
  /* roughness d₁, d₂, d₃ (K = D Dᵀ, D = [[d₁, d₂], [0, d₃]]), relative to |n|; isotropic: I₁ in the first, alone [|n|] */
  int32_t roughness_1; /* I4F(p-2), -8 to below 8 */
  int32_t roughness_2; /* I4F(p-2), -8 to below 8 */
  int32_t roughness_3; /* I4F(p-2), -8 to below 8 */
  /* vector l from the surface to the light, any length [length] */
  int32_t light_x; /* I2Fp, -2 to below 2 */
  int32_t light_y; /* I2Fp, -2 to below 2 */
  int32_t light_z; /* I2Fp, -2 to below 2 */
  int32_t light_e; /* I16, -32768 to 32767, never read */
  /* exponent m, saturated to 1…8192 */
  int32_t shininess_exponent; /* I16F16, -32768 to below 32768 */
  /* √m, saturated to 1…91 */
  int32_t shininess_root; /* I8F24, -128 to below 128 */
} roughxel_highlight_in;
/* X(member) for each, in order. */
#define ROUGHXEL_HIGHLIGHT_IN_MEMBERS(X) \
  X(normal_x) \
  X(normal_y) \
  X(normal_z) \
  X(normal_e) \
  X(view_x) \
  X(view_y) \
  X(view_z) \
  X(view_e) \
  X(frame_vectors_0_x) \
  X(frame_vectors_0_y) \
  X(frame_vectors_0_z) \
  X(frame_vectors_0_e) \
  X(frame_vectors_1_x) \
  X(frame_vectors_1_y) \
  X(frame_vectors_1_z) \
  X(frame_vectors_1_e) \
  X(offset_1) \
  X(offset_2) \
  X(roughness_1) \
  X(roughness_2) \
  X(roughness_3) \
  X(light_x) \
  X(light_y) \
  X(light_z) \
  X(light_e) \
  X(shininess_exponent) \
  X(shininess_root)

/* What comes out of the highlight datapath. */
typedef struct roughxel_highlight_out {
  /* tangents E₁ and E₂, scaled by |n| [length] (tap, stage frame) */
  int32_t frame_0_x; /* I2Fp, -2 to below 2 */
  int32_t frame_0_y; /* I2Fp, -2 to below 2 */
  int32_t frame_0_z; /* I2Fp, -2 to below 2 */
  int32_t frame_0_e; /* I16, -32768 to 32767 */
  int32_t frame_1_x; /* I2Fp, -2 to below 2 */
  int32_t frame_1_y; /* I2Fp, -2 to below 2 */
  int32_t frame_1_z; /* I2Fp, -2 to below 2 */
  int32_t frame_1_e; /* I16, -32768 to 32767 */
  /* perturbed normal n_mod [length] (tap, stage perturb) */
  int32_t normal_mod_x; /* I2Fp, -2 to below 2 */
  int32_t normal_mod_y; /* I2Fp, -2 to below 2 */
  int32_t normal_mod_z; /* I2Fp, -2 to below 2 */
  int32_t normal_mod_e; /* I16, -32768 to 32767 */
  /* roughness tangents d₁E₁ and d₂E₁ + d₃E₂ (isotropic: I₁E₁, I₁E₂), scaled by |n| [length] (tap, stage roughness) */
  int32_t rough_1_x; /* I2Fp, -2 to below 2 */
  int32_t rough_1_y; /* I2Fp, -2 to below 2 */
  int32_t rough_1_z; /* I2Fp, -2 to below 2 */
  int32_t rough_1_e; /* I16, -32768 to 32767 */
  int32_t rough_2_x; /* I2Fp, -2 to below 2 */
  int32_t rough_2_y; /* I2Fp, -2 to below 2 */
  int32_t rough_2_z; /* I2Fp, -2 to below 2 */
  int32_t rough_2_e; /* I16, -32768 to 32767 */
  /* half vector h = l/|l| + v/|v| (tap, stage half) */
  int32_t half_x; /* I2Fp, -2 to below 2 */
  int32_t half_y; /* I2Fp, -2 to below 2 */
  int32_t half_z; /* I2Fp, -2 to below 2 */
  int32_t half_e; /* I16, -32768 to 32767 */
  /* √m/|n_mod| times rough: relative to |n_mod| and to the base deviation 1/√m (tap, stage highlight) */
  int32_t spread_1_x; /* I2Fp, -2 to below 2 */
  int32_t spread_1_y; /* I2Fp, -2 to below 2 */
  int32_t spread_1_z; /* I2Fp, -2 to below 2 */
  int32_t spread_1_e; /* I16, -32768 to 32767 */
  int32_t spread_2_x; /* I2Fp, -2 to below 2 */
  int32_t spread_2_y; /* I2Fp, -2 to below 2 */
  int32_t spread_2_z; /* I2Fp, -2 to below 2 */
  int32_t spread_2_e; /* I16, -32768 to 32767 */
  /* 1/√det(I + mK) (tap, stage highlight) */
  int32_t amplitude_m; /* I2Fp, -2 to below 2 */
  int32_t amplitude_e; /* I16, -32768 to 32767 */
  /* share of the light that the highlight returns, 0 to 1 (stage highlight) */
  int32_t f; /* U1F24, 0 to 1 */
  /* sticky bits: 1 normal_zero, 2 view_zero, 4 frame_pole, 256 light_zero, 512 half_zero, 1024 light_below_surface, 2048 half_below_surface [bits] (stage status) */
  int32_t status; /* U12, 0 to 4095 */
} roughxel_highlight_out;
/* X(member) for each, in order. */
#define ROUGHXEL_HIGHLIGHT_OUT_MEMBERS(X) \
  X(frame_0_x) \
  X(frame_0_y) \
  X(frame_0_z) \
  X(frame_0_e) \
  X(frame_1_x) \
  X(frame_1_y) \
  X(frame_1_z) \
  X(frame_1_e) \
  X(normal_mod_x) \
  X(normal_mod_y) \
  X(normal_mod_z) \
  X(normal_mod_e) \
  X(rough_1_x) \
  X(rough_1_y) \
  X(rough_1_z) \
  X(rough_1_e) \
  X(rough_2_x) \
  X(rough_2_y) \
  X(rough_2_z) \
  X(rough_2_e) \
  X(half_x) \
  X(half_y) \
  X(half_z) \
  X(half_e) \
  X(spread_1_x) \
  X(spread_1_y) \
  X(spread_1_z) \
  X(spread_1_e) \
  X(spread_2_x) \
  X(spread_2_y) \
  X(spread_2_z) \
  X(spread_2_e) \
  X(amplitude_m) \
  X(amplitude_e) \
  X(f) \
  X(status)

/* What goes into the peak datapath. */
typedef struct roughxel_peak_in {
  /* surface normal n, any length [length] */
  int32_t normal_x; /* I2Fp, -2 to below 2 */
  int32_t normal_y; /* I2Fp, -2 to below 2 */
  int32_t normal_z; /* I2Fp, -2 to below 2 */
  int32_t normal_e; /* I16, -32768 to 32767 */
  /* vector v from the surface to the eye, any length [length] */
  int32_t view_x; /* I2Fp, -2 to below 2 */
  int32_t view_y; /* I2Fp, -2 to below 2 */
  int32_t view_z; /* I2Fp, -2 to below 2 */
  int32_t view_e; /* I16, -32768 to 32767 */
  /* frame vectors: the main direction h in slot 0 (system 3), or p_u and p_v (systems 1 and 2) [length] */
  int32_t frame_vectors_0_x; /* I2Fp, -2 to below 2 */
  int32_t frame_vectors_0_y; /* I2Fp, -2 to below 2 */
  int32_t frame_vectors_0_z; /* I2Fp, -2 to below 2 */
  int32_t frame_vectors_0_e; /* I16, -32768 to 32767 */
  int32_t frame_vectors_1_x; /* I2Fp, -2 to below 2 */
  int32_t frame_vectors_1_y; /* I2Fp, -2 to below 2 */
  int32_t frame_vectors_1_z; /* I2Fp, -2 to below 2 */
  int32_t frame_vectors_1_e; /* I16, -32768 to 32767 */
  /* bump offsets b₁, b₂, relative to |n|; fraction_bits − 2 fraction bits are kept [|n|] */
  int32_t offset_1; /* I4F(p-2), -8 to below 8, never read */
  int32_t offset_2; /* I4F(p-2), -8 to below 8, never read */
  /* roughness d₁, d₂, d₃ (K = D Dᵀ, D = [[d₁, d₂], [0, d₃]]), relative to |n|; isotropic: I₁ in the first, alone [|n|] */
  int32_t roughness_1; /* I4F(p-2), -8 to below 8, never read */
  int32_t roughness_2; /* I4F(p-2), -8 to below 8, never read */
  int32_t roughness_3; /* I4F(p-2), -8 to below 8, never read */
  /* vector l from the surface to the light, any length [length] */
  int32_t light_x; /* I2Fp, -2 to below 2 */
  int32_t light_y; /* I2Fp, -2 to below 2 */
  int32_t light_z; /* I2Fp, -2 to below 2 */
  int32_t light_e; /* I16, -32768 to 32767 */
  /* stored peak: N in the tangent basis of the surface (E₁, E₂, n), of unit length within 2^−15 and in direction within 2^−15.2 rad. At any other length, 1 − |N − H|²/2 replaces the cosine */
  int32_t peak_normal_x; /* I1F15, -1 to below 1 */
  int32_t peak_normal_y; /* I1F15, -1 to below 1 */
  int32_t peak_normal_z; /* I1F15, -1 to below 1 */
  /* stored peak: amplitude a, a code: 0 or from 2^−21 to below 64; within 2^−13 from 2^−9 on, 2^−22 below. Larger ones are saturated: facets of amplitude 15 beyond 76°, which count 1/n_z times [2^−21] */
  int32_t peak_amplitude; /* U16, 0 to 65535 */
  /* stored peak: exponent n, a code: from 1 to 8192 within 2^−13, which changes a power by 2^−14.4 at most. Other codes, 0 to 16 382, are read as they stand [2^−13] */
  int32_t peak_exponent; /* U16, 0 to 65535 */
  /* stored horizon of −x, +x, −y, +y: slope at which the ramp begins, or of the step; within 2^−13, clamped to ±8 */
  int32_t horizon_low_0; /* I4F12, -8 to below 8 */
  int32_t horizon_low_1; /* I4F12, -8 to below 8 */
  int32_t horizon_low_2; /* I4F12, -8 to below 8 */
  int32_t horizon_low_3; /* I4F12, -8 to below 8 */
  /* stored horizon of each side: 1/width of the ramp, a code as of a peak: within 2^−13 from ¼ on (widths up to 4), 2^−15 below; 0 is a step, visible at low and above [2^−14] */
  int32_t horizon_inverse_width_0; /* U16, 0 to 65535 */
  int32_t horizon_inverse_width_1; /* U16, 0 to 65535 */
  int32_t horizon_inverse_width_2; /* U16, 0 to 65535 */
  int32_t horizon_inverse_width_3; /* U16, 0 to 65535 */
  /* share of the fragment that belongs to the peak, saturated to [0, 1] */
  int32_t weight; /* I16F16, -32768 to below 32768 */
} roughxel_peak_in;
/* X(member) for each, in order. */
#define ROUGHXEL_PEAK_IN_MEMBERS(X) \
  X(normal_x) \
  X(normal_y) \
  X(normal_z) \
  X(normal_e) \
  X(view_x) \
  X(view_y) \
  X(view_z) \
  X(view_e) \
  X(frame_vectors_0_x) \
  X(frame_vectors_0_y) \
  X(frame_vectors_0_z) \
  X(frame_vectors_0_e) \
  X(frame_vectors_1_x) \
  X(frame_vectors_1_y) \
  X(frame_vectors_1_z) \
  X(frame_vectors_1_e) \
  X(offset_1) \
  X(offset_2) \
  X(roughness_1) \
  X(roughness_2) \
  X(roughness_3) \
  X(light_x) \
  X(light_y) \
  X(light_z) \
  X(light_e) \
  X(peak_normal_x) \
  X(peak_normal_y) \
  X(peak_normal_z) \
  X(peak_amplitude) \
  X(peak_exponent) \
  X(horizon_low_0) \
  X(horizon_low_1) \
  X(horizon_low_2) \
  X(horizon_low_3) \
  X(horizon_inverse_width_0) \
  X(horizon_inverse_width_1) \
  X(horizon_inverse_width_2) \
  X(horizon_inverse_width_3) \
  X(weight)

/* What comes out of the peak datapath. */
typedef struct roughxel_peak_out {
  /* tangents E₁ and E₂, scaled by |n| [length] (tap, stage frame) */
  int32_t frame_0_x; /* I2Fp, -2 to below 2 */
  int32_t frame_0_y; /* I2Fp, -2 to below 2 */
  int32_t frame_0_z; /* I2Fp, -2 to below 2 */
  int32_t frame_0_e; /* I16, -32768 to 32767 */
  int32_t frame_1_x; /* I2Fp, -2 to below 2 */
  int32_t frame_1_y; /* I2Fp, -2 to below 2 */
  int32_t frame_1_z; /* I2Fp, -2 to below 2 */
  int32_t frame_1_e; /* I16, -32768 to 32767 */
  /* half vector h = l/|l| + v/|v| (tap, stage half) */
  int32_t half_x; /* I2Fp, -2 to below 2 */
  int32_t half_y; /* I2Fp, -2 to below 2 */
  int32_t half_z; /* I2Fp, -2 to below 2 */
  int32_t half_e; /* I16, -32768 to 32767 */
  /* components of h along E₁, E₂ and n, at unit length; zero if h or the tangent basis is zero (tap, stage local) */
  int32_t local_half_x; /* I2Fp, -1 to 1 */
  int32_t local_half_y; /* I2Fp, -1 to 1 */
  int32_t local_half_z; /* I2Fp, -1 to 1 */
  /* components of l along E₁, E₂ and n, at any length [length] (tap, stage local) */
  int32_t local_light_x; /* I2Fp, -2 to below 2 */
  int32_t local_light_y; /* I2Fp, -2 to below 2 */
  int32_t local_light_z; /* I2Fp, -2 to below 2 */
  int32_t local_light_e; /* I16, -32768 to 32767 */
  /* components of v along E₁, E₂ and n, at any length [length] (tap, stage local) */
  int32_t local_eye_x; /* I2Fp, -2 to below 2 */
  int32_t local_eye_y; /* I2Fp, -2 to below 2 */
  int32_t local_eye_z; /* I2Fp, -2 to below 2 */
  int32_t local_eye_e; /* I16, -32768 to 32767 */
  /* slopes z/|x| and z/|y| of l, then of v, clamped to ±8 (tap, stage horizon) */
  int32_t slopes_0_0; /* I5F(p-4), -8 to 8 */
  int32_t slopes_0_1; /* I5F(p-4), -8 to 8 */
  int32_t slopes_1_0; /* I5F(p-4), -8 to 8 */
  int32_t slopes_1_1; /* I5F(p-4), -8 to 8 */
  /* share of the peak's facets that light and eye clear, 0 to 1 (tap, stage horizon) */
  int32_t visibility; /* U1F16, 0 to 1 */
  /* light that the peak returns, 0 to below 64; 0 if the light is on the horizon of n or below it, or if n, v, l, h or the tangent basis is zero (stage peaks) */
  int32_t peak; /* U6F24, 0 to below 64 */
  /* sticky bits: 1 normal_zero, 2 view_zero, 4 frame_pole, 256 light_zero, 512 half_zero, 1024 light_below_surface, 4096 local_zero, 8192 peaks_saturated [bits] (stage status) */
  int32_t status; /* U14, 0 to 16383 */
} roughxel_peak_out;
/* X(member) for each, in order. */
#define ROUGHXEL_PEAK_OUT_MEMBERS(X) \
  X(frame_0_x) \
  X(frame_0_y) \
  X(frame_0_z) \
  X(frame_0_e) \
  X(frame_1_x) \
  X(frame_1_y) \
  X(frame_1_z) \
  X(frame_1_e) \
  X(half_x) \
  X(half_y) \
  X(half_z) \
  X(half_e) \
  X(local_half_x) \
  X(local_half_y) \
  X(local_half_z) \
  X(local_light_x) \
  X(local_light_y) \
  X(local_light_z) \
  X(local_light_e) \
  X(local_eye_x) \
  X(local_eye_y) \
  X(local_eye_z) \
  X(local_eye_e) \
  X(slopes_0_0) \
  X(slopes_0_1) \
  X(slopes_1_0) \
  X(slopes_1_1) \
  X(visibility) \
  X(peak) \
  X(status)

/* ROUGHXEL_VERSION of the library. */
int32_t roughxel_version(void);
/* What an error is: one line, never freed. */
const char *roughxel_error_text(int32_t error);
/* The knobs of the profile narrow, paper, compact, standard or precise. Errors: NULL, PROFILE. */
int32_t roughxel_profile_named(const char *name, roughxel_profile *profile);

/* The reflection datapath. Errors: NULL, KNOB, EFFECTS, INPUT. Effects that it does not have change nothing. */
int32_t roughxel_reflection(const roughxel_profile *profile, uint32_t effects,
                        const roughxel_reflection_in *inputs, roughxel_reflection_out *outputs);
/* The lowest and the highest number of each of its inputs. Errors: NULL, KNOB. */
int32_t roughxel_reflection_input_range(const roughxel_profile *profile,
                                    roughxel_reflection_in *low, roughxel_reflection_in *high);

/* The highlight datapath. Errors: NULL, KNOB, EFFECTS, INPUT. Effects that it does not have change nothing. */
int32_t roughxel_highlight(const roughxel_profile *profile, uint32_t effects,
                        const roughxel_highlight_in *inputs, roughxel_highlight_out *outputs);
/* The lowest and the highest number of each of its inputs. Errors: NULL, KNOB. */
int32_t roughxel_highlight_input_range(const roughxel_profile *profile,
                                    roughxel_highlight_in *low, roughxel_highlight_in *high);

/* The peak datapath. Errors: NULL, KNOB, EFFECTS, INPUT. Effects that it does not have change nothing. */
int32_t roughxel_peak(const roughxel_profile *profile, uint32_t effects,
                        const roughxel_peak_in *inputs, roughxel_peak_out *outputs);
/* The lowest and the highest number of each of its inputs. Errors: NULL, KNOB. */
int32_t roughxel_peak_input_range(const roughxel_profile *profile,
                                    roughxel_peak_in *low, roughxel_peak_in *high);

#ifdef __cplusplus
}
#endif

#endif
