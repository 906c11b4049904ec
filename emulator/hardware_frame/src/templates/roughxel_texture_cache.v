// roughxel_texture_cache
//
// Direct-mapped cache of texels. A line is a tile of 4 x 4 texels: a burst of four beats of the memory, a row of the tile each.
// Tags are compared when texels are asked for, and a missing line is asked for at once. Its rows are written when the turn of the request comes,
// up to 2^LOG2_FLIGHT requests later. So the latency of the memory is hidden as long as requests keep coming.

`default_nettype none

module roughxel_texture_cache #(
  parameter TILE_BITS = 28,
  parameter SET_BITS = 6,
  parameter LOG2_FLIGHT = 7
) (
  input  wire clk,
  input  wire rst,
  // a texel is asked for, or two neighbours in a row of a tile: the tile, its set, the place of the texel in the tile
  input  wire in_valid,
  output wire in_ready,
  input  wire [TILE_BITS-1:0] in_tile,
  input  wire [SET_BITS-1:0] in_set,
  input  wire [3:0] in_place,
  input  wire in_pair,
  // texels in the order of their requests
  output wire out_valid,
  input  wire out_ready,
  output wire [47:0] out_texel,
  output wire [47:0] out_next,            // the right neighbour of a pair
  output wire out_pair,
  // bursts
  output wire memory_request,
  input  wire memory_accept,
  output wire [TILE_BITS-1:0] memory_tile,
  input  wire memory_valid,
  output wire memory_ready,
  input  wire [191:0] memory_row          // the left texel in the lowest bits
);

  // ---- tags ----
  reg [TILE_BITS-1:0] tags [0:(1<<SET_BITS)-1];
  reg [(1<<SET_BITS)-1:0] present;
  wire hit = present[in_set] & (tags[in_set] == in_tile);
  wire flight_ready;
  assign memory_request = in_valid & ~hit & flight_ready;
  assign memory_tile = in_tile;
  assign in_ready = flight_ready & (hit | memory_accept);
  wire taken = in_valid & in_ready;
  always @(posedge clk) begin
    if (taken & ~hit) tags[in_set] <= in_tile;
    if (rst) present <= {(1<<SET_BITS){1'b0}};
    else if (taken) present[in_set] <= 1'b1;
  end

  // ---- requests that wait for their turn ----
  wire head_valid, head_hit, head_pair, read;
  wire [SET_BITS-1:0] head_set;
  wire [3:0] head_place;
  roughxel_fifo #(.WIDTH(SET_BITS + 6), .LOG2_DEPTH(LOG2_FLIGHT)) flight (
    .clk(clk), .rst(rst),
    .in_valid(taken), .in_ready(flight_ready), .in({hit, in_set, in_place, in_pair}),
    .out_valid(head_valid), .out_ready(read), .out({head_hit, head_set, head_place, head_pair})
  );

  // ---- rows ----
  reg [191:0] rows [0:(1<<(SET_BITS+2))-1];
  reg filled;
  reg [1:0] beat;
  wire written = memory_valid & memory_ready;
  assign memory_ready = head_valid & ~head_hit & ~filled;
  always @(posedge clk)
    if (written) rows[{head_set, beat}] <= memory_row;
  always @(posedge clk)
    if (rst) begin
      filled <= 1'b0;
      beat <= 2'd0;
    end else begin
      if (written) beat <= beat + 2'd1;
      if (read) filled <= 1'b0;
      else if (written & (&beat)) filled <= 1'b1;
    end

  reg shown, pair;
  reg [1:0] column;
  reg [191:0] row;
  assign read = head_valid & (head_hit | filled) & (~shown | out_ready);
  assign out_valid = shown;
  assign out_pair = pair;
  assign out_texel = row[48*column +: 48];
  // A pair begins in one of the first three columns.
  assign out_next = column == 2'd0 ? row[95:48] : column == 2'd1 ? row[143:96] : row[191:144];
  always @(posedge clk)
    if (read) begin
      row <= rows[{head_set, head_place[3:2]}];
      column <= head_place[1:0];
      pair <= head_pair;
    end
  always @(posedge clk)
    if (rst) shown <= 1'b0;
    else if (read) shown <= 1'b1;
    else if (out_ready) shown <= 1'b0;

endmodule

`default_nettype wire
