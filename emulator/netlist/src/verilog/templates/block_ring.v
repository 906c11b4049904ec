// roughxel_block_ring
//
// What came in DEPTH enables ago, in a block memory that is written in turn. The next place is read while one is written.

`default_nettype none

module roughxel_block_ring #(
  parameter WIDTH = 1,
  parameter DEPTH = 2,
  parameter PLACES = 1
) (
  input  wire clk,
  input  wire rst,
  input  wire enable,
  input  wire [WIDTH-1:0] in,
  output reg  [WIDTH-1:0] out
);

  (* ram_style = "block" *) reg [WIDTH-1:0] memory [0:DEPTH-1];
  reg [PLACES-1:0] place;
  localparam LAST = DEPTH - 1;
  wire [PLACES-1:0] next = place == LAST[PLACES-1:0] ? {PLACES{1'b0}} : place + {{(PLACES-1){1'b0}}, 1'b1};

  always @(posedge clk)
    if (enable) begin
      memory[place] <= in;
      out <= memory[next];
    end
  always @(posedge clk)
    if (rst) place <= {PLACES{1'b0}};
    else if (enable) place <= next;

endmodule

`default_nettype wire
