// The hand-written cube_face as the device of a bench of that stage alone. In the folder of the bench that
//   roughxel vectors export random --stage cube_face -o sets
//   roughxel vectors bench sets/random_cube_face_standard.json --device blank -o benches
// make it takes the place of random_cube_face_standard_device.sv; cube_face.v, half_reciprocal.v and
// reciprocal_10.hex (of the folder rom) stand in its rtl.
// The names of the fields are those of the profile standard.
module random_cube_face_standard_device
  import random_cube_face_standard_pkg::*;
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

  wire [2:0] face;
  wire signed [P+1:0] half_inverse;

  cube_face #(.P(P), .K(10), .STEPS(1), .SEEDS("rtl/reciprocal_10.hex")) dut (
    .r_m({inputs.reflect_r_m_2_i2f20, inputs.reflect_r_m_1_i2f20, inputs.reflect_r_m_0_i2f20}),
    .face(face), .s(outputs.st_0_i2f20), .t(outputs.st_1_i2f20), .half_inverse(half_inverse), .tie(outputs.tie_flag)
  );

  // The face in binary is its axis, then its sign.
  assign outputs.select_is_z_flag      = face[2];
  assign outputs.select_is_y_flag      = face[1];
  assign outputs.select_negative_flag  = face[0];
  assign outputs.half_reciprocal_u1f20 = half_inverse[P:0];

endmodule
