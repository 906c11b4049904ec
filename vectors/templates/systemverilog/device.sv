// @NAME@_device: what the bench drives. @PURPOSE@
//
// Inputs are taken where in_valid and in_ready are high at a rising edge, outputs where out_valid and out_ready are: one output
// an input, in the same order, after any number of cycles. rst is high for the first edges.
// `inputs` and `outputs` are packed structures of @NAME@_pkg; a field has the format beside it: I signed, U unsigned, bits
// before the point (the sign among them) and, after F, those behind it. Taps are what a stage hands on; with --outputs-only
// nothing compares them.

module @NAME@_device
  import @NAME@_pkg::*;
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

@BODY@

endmodule
