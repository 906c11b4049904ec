// @NAME@
//
// What came in DEPTH enables ago, in a memory that is written in turn. A device with small memories needs a few lookup tables for it. With BLOCK it is
// in a block memory: the next place is read while one is written.

`default_nettype none

module @NAME@ #(
  parameter WIDTH = 1,
  parameter DEPTH = 2,
  parameter PLACES = 1,
  parameter BLOCK = 0
) (
  input  wire clk,
  input  wire rst,
  input  wire enable,
  input  wire [WIDTH-1:0] in,
  output wire [WIDTH-1:0] out
);

  reg [PLACES-1:0] place;
  localparam LAST = DEPTH - 1;
  wire [PLACES-1:0] next = place == LAST[PLACES-1:0] ? {PLACES{1'b0}} : place + {{(PLACES-1){1'b0}}, 1'b1};
  always @(posedge clk)
    if (rst) place <= {PLACES{1'b0}};
    else if (enable) place <= next;

  generate
    if (BLOCK != 0) begin : block
      (* ram_style = "block" *) reg [WIDTH-1:0] memory [0:DEPTH-1];
      reg [WIDTH-1:0] read;
      assign out = read;
      always @(posedge clk)
        if (enable) begin
          memory[place] <= in;
          read <= memory[next];
        end
    end else begin : tables
      reg [WIDTH-1:0] memory [0:DEPTH-1];
      assign out = memory[place];
      always @(posedge clk) if (enable) memory[place] <= in;
    end
  endgenerate

endmodule

`default_nettype wire
