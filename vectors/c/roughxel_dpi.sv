// roughxel_dpi: the scalar datapaths of roughxel as functions of SystemVerilog, by DPI-C from the C library.
//
// `roughxel vectors c` writes this file; roughxel.h beside it says what every number is, vectors/README.md how the library is built
// and linked. Structures of the header are arrays of int here, their members places with names. Every function returns OK or an
// error: its kind in the lowest ERROR_BITS bits, above them the place of the number that is wrong. With an error what it would have
// written means nothing.

package roughxel_dpi;

  // Of this package; roughxel_version() is that of the library.
  localparam int VERSION = 1;

  localparam int OK = 0;  // done
  localparam int ERROR_NULL = 1;  // a pointer is null
  localparam int ERROR_PROFILE = 2;  // no profile has that name: there are narrow, paper, compact, standard, precise
  localparam int ERROR_KNOB = 3;  // a knob is out of its range
  localparam int ERROR_EFFECTS = 4;  // an effect is unknown, or two kinds of one effect are on
  localparam int ERROR_INPUT = 5;  // an input is out of the range of its field
  localparam int ERROR_BITS = 8;

  // Effects that are on, a sum of:
  localparam int unsigned BUMP = 1;  // bump: reflection and highlight
  localparam int unsigned ROUGHNESS = 2;  // anisotropic roughness: reflection and highlight
  localparam int unsigned ROUGHNESS_ISO = 4;  // isotropic roughness, which reads roughness_1 alone
  localparam int unsigned CURVATURE = 8;  // curvature: reflection
  localparam int unsigned FOOTPRINT = 16;  // footprint on a face: reflection
  localparam int unsigned FOOTPRINT_SPHERE = 32;  // footprint on the sphere, for wide lobes
  localparam int unsigned HORIZON = 64;  // correlated horizons: peak
  localparam int unsigned HORIZON_PRODUCT = 128;  // horizons as a product of shares
  localparam int unsigned FRAME_NATURAL = 256;  // frame of p_u and p_v instead of the main direction
  localparam int unsigned FRAME_NATURAL_NORMALISED = 512;  // the same, lengths dropped

  typedef enum int {
    KNOB_FRACTION_BITS,  // 12 to 28
    KNOB_RECIPROCAL_SEED_BITS,  // 6 to 10
    KNOB_RECIPROCAL_STEPS,  // 0 to 2
    KNOB_INVERSE_ROOT_SEED_BITS,  // 6 to 10
    KNOB_INVERSE_ROOT_STEPS,  // 0 to 2
    KNOB_DIRECTION,  // 0 exact, or steps of a table: 2 to 64, an even number
    KNOB_MAX_PROBES,  // 1 to 16
    KNOB_PROBE_RULE,  // 0 power_of_two, 1 ceiling
    KNOB_PROBE_WEIGHTS,  // 0 box, 1 gaussian
    KNOB_LOD_BITS,  // 2 to 12
    KNOB_WEIGHT_BITS,  // 2 to 10
    KNOB_ROUGHNESS,  // 0 none, 1 isotropic, 2 anisotropic
    KNOB_ROUGHNESS_BITS  // 4 to 16
  } knob_e;
  localparam int PROFILE = 13;
  typedef int profile_t [PROFILE];

  typedef enum int {
    REFLECTION_IN_NORMAL_X,  // I2Fp, -2 to below 2
    REFLECTION_IN_NORMAL_Y,  // I2Fp, -2 to below 2
    REFLECTION_IN_NORMAL_Z,  // I2Fp, -2 to below 2
    REFLECTION_IN_NORMAL_E,  // I16, -32768 to 32767
    REFLECTION_IN_VIEW_X,  // I2Fp, -2 to below 2
    REFLECTION_IN_VIEW_Y,  // I2Fp, -2 to below 2
    REFLECTION_IN_VIEW_Z,  // I2Fp, -2 to below 2
    REFLECTION_IN_VIEW_E,  // I16, -32768 to 32767
    REFLECTION_IN_FRAME_VECTORS_0_X,  // I2Fp, -2 to below 2
    REFLECTION_IN_FRAME_VECTORS_0_Y,  // I2Fp, -2 to below 2
    REFLECTION_IN_FRAME_VECTORS_0_Z,  // I2Fp, -2 to below 2
    REFLECTION_IN_FRAME_VECTORS_0_E,  // I16, -32768 to 32767
    REFLECTION_IN_FRAME_VECTORS_1_X,  // I2Fp, -2 to below 2
    REFLECTION_IN_FRAME_VECTORS_1_Y,  // I2Fp, -2 to below 2
    REFLECTION_IN_FRAME_VECTORS_1_Z,  // I2Fp, -2 to below 2
    REFLECTION_IN_FRAME_VECTORS_1_E,  // I16, -32768 to 32767
    REFLECTION_IN_OFFSET_1,  // I4F(p-2), -8 to below 8
    REFLECTION_IN_OFFSET_2,  // I4F(p-2), -8 to below 8
    REFLECTION_IN_ROUGHNESS_1,  // I4F(p-2), -8 to below 8
    REFLECTION_IN_ROUGHNESS_2,  // I4F(p-2), -8 to below 8
    REFLECTION_IN_ROUGHNESS_3,  // I4F(p-2), -8 to below 8
    REFLECTION_IN_DVIEW_0_X,  // I2Fp, -2 to below 2
    REFLECTION_IN_DVIEW_0_Y,  // I2Fp, -2 to below 2
    REFLECTION_IN_DVIEW_0_Z,  // I2Fp, -2 to below 2
    REFLECTION_IN_DVIEW_0_E,  // I16, -32768 to 32767
    REFLECTION_IN_DVIEW_1_X,  // I2Fp, -2 to below 2
    REFLECTION_IN_DVIEW_1_Y,  // I2Fp, -2 to below 2
    REFLECTION_IN_DVIEW_1_Z,  // I2Fp, -2 to below 2
    REFLECTION_IN_DVIEW_1_E,  // I16, -32768 to 32767
    REFLECTION_IN_DNORMAL_0_X,  // I2Fp, -2 to below 2
    REFLECTION_IN_DNORMAL_0_Y,  // I2Fp, -2 to below 2
    REFLECTION_IN_DNORMAL_0_Z,  // I2Fp, -2 to below 2
    REFLECTION_IN_DNORMAL_0_E,  // I16, -32768 to 32767
    REFLECTION_IN_DNORMAL_1_X,  // I2Fp, -2 to below 2
    REFLECTION_IN_DNORMAL_1_Y,  // I2Fp, -2 to below 2
    REFLECTION_IN_DNORMAL_1_Z,  // I2Fp, -2 to below 2
    REFLECTION_IN_DNORMAL_1_E,  // I16, -32768 to 32767
    REFLECTION_IN_EDGE_TEXELS  // U16, 0 to 65535
  } reflection_in_e;
  localparam int REFLECTION_IN = 38;
  typedef int reflection_in_t [REFLECTION_IN];

  typedef enum int {
    REFLECTION_OUT_FRAME_0_X,  // I2Fp, -2 to below 2
    REFLECTION_OUT_FRAME_0_Y,  // I2Fp, -2 to below 2
    REFLECTION_OUT_FRAME_0_Z,  // I2Fp, -2 to below 2
    REFLECTION_OUT_FRAME_0_E,  // I16, -32768 to 32767
    REFLECTION_OUT_FRAME_1_X,  // I2Fp, -2 to below 2
    REFLECTION_OUT_FRAME_1_Y,  // I2Fp, -2 to below 2
    REFLECTION_OUT_FRAME_1_Z,  // I2Fp, -2 to below 2
    REFLECTION_OUT_FRAME_1_E,  // I16, -32768 to 32767
    REFLECTION_OUT_NORMAL_MOD_X,  // I2Fp, -2 to below 2
    REFLECTION_OUT_NORMAL_MOD_Y,  // I2Fp, -2 to below 2
    REFLECTION_OUT_NORMAL_MOD_Z,  // I2Fp, -2 to below 2
    REFLECTION_OUT_NORMAL_MOD_E,  // I16, -32768 to 32767
    REFLECTION_OUT_REFLECTED_X,  // I2Fp, -2 to below 2
    REFLECTION_OUT_REFLECTED_Y,  // I2Fp, -2 to below 2
    REFLECTION_OUT_REFLECTED_Z,  // I2Fp, -2 to below 2
    REFLECTION_OUT_REFLECTED_E,  // I16, -32768 to 32767
    REFLECTION_OUT_COLUMNS_0_S,  // I2Fp, -2 to below 2
    REFLECTION_OUT_COLUMNS_0_T,  // I2Fp, -2 to below 2
    REFLECTION_OUT_COLUMNS_0_E,  // I16, -32768 to 32767
    REFLECTION_OUT_COLUMNS_1_S,  // I2Fp, -2 to below 2
    REFLECTION_OUT_COLUMNS_1_T,  // I2Fp, -2 to below 2
    REFLECTION_OUT_COLUMNS_1_E,  // I16, -32768 to 32767
    REFLECTION_OUT_COLUMNS_2_S,  // I2Fp, -2 to below 2
    REFLECTION_OUT_COLUMNS_2_T,  // I2Fp, -2 to below 2
    REFLECTION_OUT_COLUMNS_2_E,  // I16, -32768 to 32767
    REFLECTION_OUT_COLUMNS_3_S,  // I2Fp, -2 to below 2
    REFLECTION_OUT_COLUMNS_3_T,  // I2Fp, -2 to below 2
    REFLECTION_OUT_COLUMNS_3_E,  // I16, -32768 to 32767
    REFLECTION_OUT_COVARIANCE_A,  // I2Fp, -2 to below 2
    REFLECTION_OUT_COVARIANCE_B,  // I2Fp, -2 to below 2
    REFLECTION_OUT_COVARIANCE_C,  // I2Fp, -2 to below 2
    REFLECTION_OUT_COVARIANCE_E,  // I16, -32768 to 32767
    REFLECTION_OUT_DETERMINANT_M,  // I2Fp, -2 to below 2
    REFLECTION_OUT_DETERMINANT_E,  // I16, -32768 to 32767
    REFLECTION_OUT_MAJOR_M,  // I2Fp, -2 to below 2
    REFLECTION_OUT_MAJOR_E,  // I16, -32768 to 32767
    REFLECTION_OUT_MINOR_M,  // I2Fp, -2 to below 2
    REFLECTION_OUT_MINOR_E,  // I16, -32768 to 32767
    REFLECTION_OUT_DIRECTION_S,  // I2Fp, -1 to 1
    REFLECTION_OUT_DIRECTION_T,  // I2Fp, -1 to 1
    REFLECTION_OUT_FACE,  // U3, 0 to 5
    REFLECTION_OUT_ST_S,  // I2Fp, -1 to 1
    REFLECTION_OUT_ST_T,  // I2Fp, -1 to 1
    REFLECTION_OUT_PROBES,  // U5, 1 to 16
    REFLECTION_OUT_STEP_S,  // I4F28, -7 to 7
    REFLECTION_OUT_STEP_T,  // I4F28, -7 to 7
    REFLECTION_OUT_LOD,  // U4Fl, 0 to 14
    REFLECTION_OUT_SWEEP_0_0,  // I2Fp, -1 to 1
    REFLECTION_OUT_SWEEP_0_1,  // I2Fp, -1 to 1
    REFLECTION_OUT_SWEEP_0_2,  // I2Fp, -1 to 1
    REFLECTION_OUT_SWEEP_1_0,  // I2Fp, -1 to 1
    REFLECTION_OUT_SWEEP_1_1,  // I2Fp, -1 to 1
    REFLECTION_OUT_SWEEP_1_2,  // I2Fp, -1 to 1
    REFLECTION_OUT_SWEEP_2_0,  // I2Fp, -1 to 1
    REFLECTION_OUT_SWEEP_2_1,  // I2Fp, -1 to 1
    REFLECTION_OUT_SWEEP_2_2,  // I2Fp, -1 to 1
    REFLECTION_OUT_SHARE,  // U1F16, 0 to 1
    REFLECTION_OUT_LEVEL,  // I16F16, -20000 to 20000
    REFLECTION_OUT_STATUS  // U8, 0 to 255
  } reflection_out_e;
  localparam int REFLECTION_OUT = 59;
  typedef int reflection_out_t [REFLECTION_OUT];

  typedef enum int {
    HIGHLIGHT_IN_NORMAL_X,  // I2Fp, -2 to below 2
    HIGHLIGHT_IN_NORMAL_Y,  // I2Fp, -2 to below 2
    HIGHLIGHT_IN_NORMAL_Z,  // I2Fp, -2 to below 2
    HIGHLIGHT_IN_NORMAL_E,  // I16, -32768 to 32767
    HIGHLIGHT_IN_VIEW_X,  // I2Fp, -2 to below 2
    HIGHLIGHT_IN_VIEW_Y,  // I2Fp, -2 to below 2
    HIGHLIGHT_IN_VIEW_Z,  // I2Fp, -2 to below 2
    HIGHLIGHT_IN_VIEW_E,  // I16, -32768 to 32767, never read
    HIGHLIGHT_IN_FRAME_VECTORS_0_X,  // I2Fp, -2 to below 2
    HIGHLIGHT_IN_FRAME_VECTORS_0_Y,  // I2Fp, -2 to below 2
    HIGHLIGHT_IN_FRAME_VECTORS_0_Z,  // I2Fp, -2 to below 2
    HIGHLIGHT_IN_FRAME_VECTORS_0_E,  // I16, -32768 to 32767
    HIGHLIGHT_IN_FRAME_VECTORS_1_X,  // I2Fp, -2 to below 2
    HIGHLIGHT_IN_FRAME_VECTORS_1_Y,  // I2Fp, -2 to below 2
    HIGHLIGHT_IN_FRAME_VECTORS_1_Z,  // I2Fp, -2 to below 2
    HIGHLIGHT_IN_FRAME_VECTORS_1_E,  // I16, -32768 to 32767
    HIGHLIGHT_IN_OFFSET_1,  // I4F(p-2), -8 to below 8
    HIGHLIGHT_IN_OFFSET_2,  // I4F(p-2), -8 to below 8
    HIGHLIGHT_IN_ROUGHNESS_1,  // I4F(p-2), -8 to below 8
    HIGHLIGHT_IN_ROUGHNESS_2,  // I4F(p-2), -8 to below 8
    HIGHLIGHT_IN_ROUGHNESS_3,  // I4F(p-2), -8 to below 8
    HIGHLIGHT_IN_LIGHT_X,  // I2Fp, -2 to below 2
    HIGHLIGHT_IN_LIGHT_Y,  // I2Fp, -2 to below 2
    HIGHLIGHT_IN_LIGHT_Z,  // I2Fp, -2 to below 2
    HIGHLIGHT_IN_LIGHT_E,  // I16, -32768 to 32767, never read
    HIGHLIGHT_IN_SHININESS_EXPONENT,  // I16F16, -32768 to below 32768
    HIGHLIGHT_IN_SHININESS_ROOT  // I8F24, -128 to below 128
  } highlight_in_e;
  localparam int HIGHLIGHT_IN = 27;
  typedef int highlight_in_t [HIGHLIGHT_IN];

  typedef enum int {
    HIGHLIGHT_OUT_FRAME_0_X,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_FRAME_0_Y,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_FRAME_0_Z,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_FRAME_0_E,  // I16, -32768 to 32767
    HIGHLIGHT_OUT_FRAME_1_X,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_FRAME_1_Y,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_FRAME_1_Z,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_FRAME_1_E,  // I16, -32768 to 32767
    HIGHLIGHT_OUT_NORMAL_MOD_X,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_NORMAL_MOD_Y,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_NORMAL_MOD_Z,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_NORMAL_MOD_E,  // I16, -32768 to 32767
    HIGHLIGHT_OUT_ROUGH_1_X,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_ROUGH_1_Y,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_ROUGH_1_Z,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_ROUGH_1_E,  // I16, -32768 to 32767
    HIGHLIGHT_OUT_ROUGH_2_X,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_ROUGH_2_Y,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_ROUGH_2_Z,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_ROUGH_2_E,  // I16, -32768 to 32767
    HIGHLIGHT_OUT_HALF_X,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_HALF_Y,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_HALF_Z,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_HALF_E,  // I16, -32768 to 32767
    HIGHLIGHT_OUT_SPREAD_1_X,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_SPREAD_1_Y,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_SPREAD_1_Z,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_SPREAD_1_E,  // I16, -32768 to 32767
    HIGHLIGHT_OUT_SPREAD_2_X,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_SPREAD_2_Y,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_SPREAD_2_Z,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_SPREAD_2_E,  // I16, -32768 to 32767
    HIGHLIGHT_OUT_AMPLITUDE_M,  // I2Fp, -2 to below 2
    HIGHLIGHT_OUT_AMPLITUDE_E,  // I16, -32768 to 32767
    HIGHLIGHT_OUT_F,  // U1F24, 0 to 1
    HIGHLIGHT_OUT_STATUS  // U12, 0 to 4095
  } highlight_out_e;
  localparam int HIGHLIGHT_OUT = 36;
  typedef int highlight_out_t [HIGHLIGHT_OUT];

  typedef enum int {
    PEAK_IN_NORMAL_X,  // I2Fp, -2 to below 2
    PEAK_IN_NORMAL_Y,  // I2Fp, -2 to below 2
    PEAK_IN_NORMAL_Z,  // I2Fp, -2 to below 2
    PEAK_IN_NORMAL_E,  // I16, -32768 to 32767
    PEAK_IN_VIEW_X,  // I2Fp, -2 to below 2
    PEAK_IN_VIEW_Y,  // I2Fp, -2 to below 2
    PEAK_IN_VIEW_Z,  // I2Fp, -2 to below 2
    PEAK_IN_VIEW_E,  // I16, -32768 to 32767
    PEAK_IN_FRAME_VECTORS_0_X,  // I2Fp, -2 to below 2
    PEAK_IN_FRAME_VECTORS_0_Y,  // I2Fp, -2 to below 2
    PEAK_IN_FRAME_VECTORS_0_Z,  // I2Fp, -2 to below 2
    PEAK_IN_FRAME_VECTORS_0_E,  // I16, -32768 to 32767
    PEAK_IN_FRAME_VECTORS_1_X,  // I2Fp, -2 to below 2
    PEAK_IN_FRAME_VECTORS_1_Y,  // I2Fp, -2 to below 2
    PEAK_IN_FRAME_VECTORS_1_Z,  // I2Fp, -2 to below 2
    PEAK_IN_FRAME_VECTORS_1_E,  // I16, -32768 to 32767
    PEAK_IN_OFFSET_1,  // I4F(p-2), -8 to below 8, never read
    PEAK_IN_OFFSET_2,  // I4F(p-2), -8 to below 8, never read
    PEAK_IN_ROUGHNESS_1,  // I4F(p-2), -8 to below 8, never read
    PEAK_IN_ROUGHNESS_2,  // I4F(p-2), -8 to below 8, never read
    PEAK_IN_ROUGHNESS_3,  // I4F(p-2), -8 to below 8, never read
    PEAK_IN_LIGHT_X,  // I2Fp, -2 to below 2
    PEAK_IN_LIGHT_Y,  // I2Fp, -2 to below 2
    PEAK_IN_LIGHT_Z,  // I2Fp, -2 to below 2
    PEAK_IN_LIGHT_E,  // I16, -32768 to 32767
    PEAK_IN_PEAK_NORMAL_X,  // I1F15, -1 to below 1
    PEAK_IN_PEAK_NORMAL_Y,  // I1F15, -1 to below 1
    PEAK_IN_PEAK_NORMAL_Z,  // I1F15, -1 to below 1
    PEAK_IN_PEAK_AMPLITUDE,  // U16, 0 to 65535
    PEAK_IN_PEAK_EXPONENT,  // U16, 0 to 65535
    PEAK_IN_HORIZON_LOW_0,  // I4F12, -8 to below 8
    PEAK_IN_HORIZON_LOW_1,  // I4F12, -8 to below 8
    PEAK_IN_HORIZON_LOW_2,  // I4F12, -8 to below 8
    PEAK_IN_HORIZON_LOW_3,  // I4F12, -8 to below 8
    PEAK_IN_HORIZON_INVERSE_WIDTH_0,  // U16, 0 to 65535
    PEAK_IN_HORIZON_INVERSE_WIDTH_1,  // U16, 0 to 65535
    PEAK_IN_HORIZON_INVERSE_WIDTH_2,  // U16, 0 to 65535
    PEAK_IN_HORIZON_INVERSE_WIDTH_3,  // U16, 0 to 65535
    PEAK_IN_WEIGHT  // I16F16, -32768 to below 32768
  } peak_in_e;
  localparam int PEAK_IN = 39;
  typedef int peak_in_t [PEAK_IN];

  typedef enum int {
    PEAK_OUT_FRAME_0_X,  // I2Fp, -2 to below 2
    PEAK_OUT_FRAME_0_Y,  // I2Fp, -2 to below 2
    PEAK_OUT_FRAME_0_Z,  // I2Fp, -2 to below 2
    PEAK_OUT_FRAME_0_E,  // I16, -32768 to 32767
    PEAK_OUT_FRAME_1_X,  // I2Fp, -2 to below 2
    PEAK_OUT_FRAME_1_Y,  // I2Fp, -2 to below 2
    PEAK_OUT_FRAME_1_Z,  // I2Fp, -2 to below 2
    PEAK_OUT_FRAME_1_E,  // I16, -32768 to 32767
    PEAK_OUT_HALF_X,  // I2Fp, -2 to below 2
    PEAK_OUT_HALF_Y,  // I2Fp, -2 to below 2
    PEAK_OUT_HALF_Z,  // I2Fp, -2 to below 2
    PEAK_OUT_HALF_E,  // I16, -32768 to 32767
    PEAK_OUT_LOCAL_HALF_X,  // I2Fp, -1 to 1
    PEAK_OUT_LOCAL_HALF_Y,  // I2Fp, -1 to 1
    PEAK_OUT_LOCAL_HALF_Z,  // I2Fp, -1 to 1
    PEAK_OUT_LOCAL_LIGHT_X,  // I2Fp, -2 to below 2
    PEAK_OUT_LOCAL_LIGHT_Y,  // I2Fp, -2 to below 2
    PEAK_OUT_LOCAL_LIGHT_Z,  // I2Fp, -2 to below 2
    PEAK_OUT_LOCAL_LIGHT_E,  // I16, -32768 to 32767
    PEAK_OUT_LOCAL_EYE_X,  // I2Fp, -2 to below 2
    PEAK_OUT_LOCAL_EYE_Y,  // I2Fp, -2 to below 2
    PEAK_OUT_LOCAL_EYE_Z,  // I2Fp, -2 to below 2
    PEAK_OUT_LOCAL_EYE_E,  // I16, -32768 to 32767
    PEAK_OUT_SLOPES_0_0,  // I5F(p-4), -8 to 8
    PEAK_OUT_SLOPES_0_1,  // I5F(p-4), -8 to 8
    PEAK_OUT_SLOPES_1_0,  // I5F(p-4), -8 to 8
    PEAK_OUT_SLOPES_1_1,  // I5F(p-4), -8 to 8
    PEAK_OUT_VISIBILITY,  // U1F16, 0 to 1
    PEAK_OUT_PEAK,  // U6F24, 0 to below 64
    PEAK_OUT_STATUS  // U14, 0 to 16383
  } peak_out_e;
  localparam int PEAK_OUT = 30;
  typedef int peak_out_t [PEAK_OUT];

  import "DPI-C" function int roughxel_version();
  import "DPI-C" function string roughxel_error_text(input int error);
  import "DPI-C" function int roughxel_profile_named(input string name, output int profile [PROFILE]);

  import "DPI-C" function int roughxel_reflection(input int profile [PROFILE], input int unsigned effects,
    input int inputs [REFLECTION_IN], output int outputs [REFLECTION_OUT]);
  import "DPI-C" function int roughxel_reflection_input_range(input int profile [PROFILE],
    output int low [REFLECTION_IN], output int high [REFLECTION_IN]);

  import "DPI-C" function int roughxel_highlight(input int profile [PROFILE], input int unsigned effects,
    input int inputs [HIGHLIGHT_IN], output int outputs [HIGHLIGHT_OUT]);
  import "DPI-C" function int roughxel_highlight_input_range(input int profile [PROFILE],
    output int low [HIGHLIGHT_IN], output int high [HIGHLIGHT_IN]);

  import "DPI-C" function int roughxel_peak(input int profile [PROFILE], input int unsigned effects,
    input int inputs [PEAK_IN], output int outputs [PEAK_OUT]);
  import "DPI-C" function int roughxel_peak_input_range(input int profile [PROFILE],
    output int low [PEAK_IN], output int high [PEAK_IN]);

  // The next number of a sequence that every simulator draws alike; from any state but 0.
  function automatic int unsigned next_random(input int unsigned state);
    next_random = state ^ (state << 13);
    next_random = next_random ^ (next_random >> 17);
    next_random = next_random ^ (next_random << 5);
  endfunction

  // A number within a range, made of two random ones: an end or 0, anything, or mostly anything of any number of bits.
  function automatic int random_within(input int low, input int high, input int unsigned value, input int unsigned shape);
    longint unsigned count;
    longint number;
    count = 64'(longint'(high) - longint'(low) + 1);
    number = longint'(low) + longint'({32'd0, value} % count);
    if (shape[2:0] == 0) begin
      case (shape[4:3])
        0: number = longint'(low);
        1: number = longint'(high);
        2: number = 0;
        default: number = 1;
      endcase
    end else if (shape[2:0] > 2) number = number >>> shape[9:5];
    if (number < longint'(low)) number = longint'(low);
    if (number > longint'(high)) number = longint'(high);
    random_within = int'(number);
  endfunction

endpackage
