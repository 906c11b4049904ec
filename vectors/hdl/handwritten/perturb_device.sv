// The hand-written perturb as the device of a bench of that stage alone. In the folder of the bench that
//   roughxel vectors export random --stage perturb -o sets
//   roughxel vectors bench sets/random_perturb_standard.json --device blank -o benches
// make it takes the place of random_perturb_standard_device.sv; perturb.v and normalise.v stand in its rtl.
// The names of the fields are those of the profile standard.
module random_perturb_standard_device
  import random_perturb_standard_pkg::*;
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

  wire [3*(P+2)-1:0] mod_m;
  wire signed [EW-1:0] mod_e;
  wire mod_zero;

  perturb #(.P(P), .EW(EW)) dut (
    .n_m({inputs.enter_normal_m_2_i2f20, inputs.enter_normal_m_1_i2f20, inputs.enter_normal_m_0_i2f20}),
    .n_e(EW'($signed(inputs.enter_normal_e_i16f0))),
    .b1(inputs.enter_offset_0_i4f18),
    .b2(inputs.enter_offset_1_i4f18),
    .t1_m({inputs.frame_e1_m_2_i2f20, inputs.frame_e1_m_1_i2f20, inputs.frame_e1_m_0_i2f20}),
    .t1_e(EW'($signed(inputs.frame_e1_e_i18f0))),
    .t2_m({inputs.frame_e2_m_2_i2f20, inputs.frame_e2_m_1_i2f20, inputs.frame_e2_m_0_i2f20}),
    .t2_e(EW'($signed(inputs.frame_e2_e_i17f0))),
    .mod_m(mod_m), .mod_e(mod_e), .mod_zero(mod_zero)
  );

  assign outputs.m_0_i2f20 = mod_m[0 +: P+2];
  assign outputs.m_1_i2f20 = mod_m[P+2 +: P+2];
  assign outputs.m_2_i2f20 = mod_m[2*(P+2) +: P+2];
  assign outputs.e_i18f0   = mod_e[17:0];

endmodule
