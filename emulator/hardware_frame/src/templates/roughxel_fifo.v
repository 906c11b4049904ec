// roughxel_fifo
//
// Queue of 2^LOG2_DEPTH words. The oldest word is shown as long as it waits.

`default_nettype none

module roughxel_fifo #(
  parameter WIDTH = 8,
  parameter LOG2_DEPTH = 2
) (
  input  wire clk,
  input  wire rst,
  input  wire in_valid,
  output wire in_ready,
  input  wire [WIDTH-1:0] in,
  output wire out_valid,
  input  wire out_ready,
  output wire [WIDTH-1:0] out
);

  reg [WIDTH-1:0] words [0:(1<<LOG2_DEPTH)-1];
  // One bit more than a place: a full queue differs from an empty one.
  reg [LOG2_DEPTH:0] first, next;
  localparam [LOG2_DEPTH:0] ONE = 1;
  assign in_ready = next != {~first[LOG2_DEPTH], first[LOG2_DEPTH-1:0]};
  assign out_valid = next != first;
  assign out = words[first[LOG2_DEPTH-1:0]];

  always @(posedge clk) begin
    if (in_valid & in_ready) words[next[LOG2_DEPTH-1:0]] <= in;
    if (rst) begin
      first <= {LOG2_DEPTH+1{1'b0}};
      next <= {LOG2_DEPTH+1{1'b0}};
    end else begin
      if (in_valid & in_ready) next <= next + ONE;
      if (out_valid & out_ready) first <= first + ONE;
    end
  end

endmodule

`default_nettype wire
