// @NAME@
//
// What came in CYCLES cycles with enable high ago.

`default_nettype none

module @NAME@ #(
  parameter WIDTH = 1,
  parameter CYCLES = 1
) (
  input  wire clk,
  input  wire enable,
  input  wire [WIDTH-1:0] in,
  output wire [WIDTH-1:0] out
);

  reg [WIDTH*CYCLES-1:0] line;
  assign out = line[WIDTH*CYCLES-1 -: WIDTH];

  generate
    if (CYCLES == 1) begin : single
      always @(posedge clk) if (enable) line <= in;
    end else begin : several
      always @(posedge clk) if (enable) line <= {line[WIDTH*(CYCLES-1)-1:0], in};
    end
  endgenerate

endmodule

`default_nettype wire
