// @NAME@
//
// Signed product with a rank of registers before and one after it, where the DSP blocks of most devices have theirs.

`default_nettype none

@KEEP@module @NAME@ #(
  parameter A = 18,
  parameter B = 18
) (
  input  wire clk,
  input  wire enable,
  input  wire signed [A-1:0] a,
  input  wire signed [B-1:0] b,
  output reg  signed [A+B-1:0] product
);

  reg signed [A-1:0] a_taken;
  reg signed [B-1:0] b_taken;

  always @(posedge clk)
    if (enable) begin
      a_taken <= a;
      b_taken <= b;
      product <= a_taken * b_taken;
    end

endmodule

`default_nettype wire
