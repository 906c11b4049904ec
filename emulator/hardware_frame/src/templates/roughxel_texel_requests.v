// roughxel_texel_requests
//
// Asks for the texels of a bilinear sample as tiles of 4 x 4 texels. Tiles are numbered by level, face, row and column. Two neighbours in a row of a
// tile are one request. At a corner of the cube three texels stand for one: that of the face, then those across both edges.

`default_nettype none

module roughxel_texel_requests #(
  parameter TILE_BITS = 28,
  parameter ROW_BITS = 2,                 // of the tile's row and column, lowest bits that are part of its set
  parameter COLUMN_BITS = 3
) (
  input  wire clk,
  input  wire rst,
  input  wire in_valid,
  output wire in_ready,
  input  wire [375:0] in_texels,          // four times: corner, then row, column, face across t, across s, and of the texel itself
  input  wire [12:0] in_across,           // tiles along an edge of the level
  input  wire [TILE_BITS-1:0] in_start,   // first tile of the level
  input  wire in_odd,                     // lowest bit of the level
  output reg  out_valid,
  input  wire out_ready,
  output reg  [TILE_BITS-1:0] out_tile,
  output reg  [ROW_BITS+COLUMN_BITS:0] out_set,
  output reg  [3:0] out_place,
  output reg  out_pair
);

  reg busy;
  reg [375:0] texels;
  reg [12:0] across;
  reg [TILE_BITS-1:0] start;
  reg odd;
  reg [1:0] number, part;

  wire [93:0] texel = texels[94*number +: 94];
  wire [30:0] one = part == 2'd0 ? texel[30:0] : part == 2'd1 ? texel[61:31] : texel[92:62];
  wire [2:0] face = one[2:0];
  wire [13:0] column = one[16:3];
  wire [13:0] row = one[30:17];
  wire [11:0] tile_column = column[13:2];
  wire [11:0] tile_row = row[13:2];

  // The right neighbour, of which the first and the third texel have one.
  wire [31:0] right = number[1] ? {texels[375], texels[312:282]} : {texels[187], texels[124:94]};
  wire pair = ~number[0] & ~texel[93] & right == {1'b0, row, column + 14'd1, face} & column[1:0] != 2'd3;

  wire step = busy & (~out_valid | out_ready);
  wire whole = ~texel[93] | part == 2'd2;
  wire done = step & whole & number[1] & (pair | number[0]);
  assign in_ready = ~busy | done;

  wire [15:0] rows = {13'd0, face} * {3'd0, across} + {4'd0, tile_row};
  wire [TILE_BITS-1:0] tiles = {{TILE_BITS-16{1'b0}}, rows} * {{TILE_BITS-13{1'b0}}, across};
  always @(posedge clk) begin
    if (in_valid & in_ready) begin
      texels <= in_texels;
      across <= in_across;
      start <= in_start;
      odd <= in_odd;
    end
    if (step) begin
      out_tile <= start + tiles + {{TILE_BITS-12{1'b0}}, tile_column};
      out_set <= {odd ^ face[0], tile_row[ROW_BITS-1:0], tile_column[COLUMN_BITS-1:0]};
      out_place <= {row[1:0], column[1:0]};
      out_pair <= pair;
    end
    if (rst) begin
      busy <= 1'b0;
      out_valid <= 1'b0;
      number <= 2'd0;
      part <= 2'd0;
    end else begin
      if (in_ready) busy <= in_valid;
      if (step) out_valid <= 1'b1;
      else if (out_ready) out_valid <= 1'b0;
      if (step) part <= whole ? 2'd0 : part + 2'd1;
      if (step & whole) number <= number + (pair ? 2'd2 : 2'd1);
    end
  end

endmodule

`default_nettype wire
