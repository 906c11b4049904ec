// roughxel_ring
//
// What came in DEPTH enables ago, in a memory that is written in turn. A device with small memories needs a few lookup tables for it.

`default_nettype none

module roughxel_ring #(
  parameter WIDTH = 1,
  parameter DEPTH = 2,
  parameter PLACES = 1
) (
  input  wire clk,
  input  wire rst,
  input  wire enable,
  input  wire [WIDTH-1:0] in,
  output wire [WIDTH-1:0] out
);

  reg [WIDTH-1:0] memory [0:DEPTH-1];
  reg [PLACES-1:0] place;
  localparam LAST = DEPTH - 1;
  assign out = memory[place];

  always @(posedge clk) if (enable) memory[place] <= in;
  always @(posedge clk)
    if (rst) place <= {PLACES{1'b0}};
    else if (enable) place <= place == LAST[PLACES-1:0] ? {PLACES{1'b0}} : place + {{(PLACES-1){1'b0}}, 1'b1};

endmodule

`default_nettype wire
