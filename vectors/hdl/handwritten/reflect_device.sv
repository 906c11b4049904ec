// The hand-written reflect as the device of a bench of that stage alone. In the folder of the bench that
//   roughxel vectors export random --stage reflect -o sets
//   roughxel vectors bench sets/random_reflect_standard.json --device blank -o benches
// make it takes the place of random_reflect_standard_device.sv; reflect.v and normalise.v stand in its rtl.
// The names of the fields are those of the profile standard.
module random_reflect_standard_device
  import random_reflect_standard_pkg::*;
(
  input  logic     clk,
  input  logic     rst,
  input  logic     in_valid,
  output logic     in_ready,
  input  inputs_t  inputs,
  output logic     out_valid,
  input  logic     out_ready,
  output outputs_t outputs
);

  localparam P  = 20;
  localparam EW = 20;

  // No registers: the handshake passes through.
  assign in_ready  = out_ready;
  assign out_valid = in_valid;

  wire [3*(P+2)-1:0] r_m;
  wire [2*(P+2)-1:0] scalars_m;
  wire signed [EW-1:0] r_e, scalars_e;
  wire r_zero, below;

  reflect #(.P(P), .EW(EW)) dut (
    .n_m({inputs.perturb_m_2_i2f20, inputs.perturb_m_1_i2f20, inputs.perturb_m_0_i2f20}),
    .n_e(EW'($signed(inputs.perturb_e_i18f0))),
    .v_m({inputs.enter_view_m_2_i2f20, inputs.enter_view_m_1_i2f20, inputs.enter_view_m_0_i2f20}),
    .v_e(EW'($signed(inputs.enter_view_e_i16f0))),
    .r_m(r_m), .r_e(r_e), .r_zero(r_zero), .scalars_m(scalars_m), .scalars_e(scalars_e), .below(below)
  );

  assign outputs.r_m_0_i2f20       = r_m[0 +: P+2];
  assign outputs.r_m_1_i2f20       = r_m[P+2 +: P+2];
  assign outputs.r_m_2_i2f20       = r_m[2*(P+2) +: P+2];
  assign outputs.r_e_i19f0         = r_e[18:0];
  assign outputs.scalars_m_0_i2f20 = scalars_m[0 +: P+2];
  assign outputs.scalars_m_1_i2f20 = scalars_m[P+2 +: P+2];
  assign outputs.scalars_e_i16f0   = scalars_e[15:0];
  assign outputs.below_flag        = below;

endmodule
