module roughxel_frame (
  input  wire clk,
  input  wire rst,                              // synchronous
  input  wire level_write,                      // before the first fragment: levels of the environment
  input  wire [3:0] level_number,
  input  wire [14:0] level_edge,                // texels along an edge of a face
  input  wire [27:0] level_start,               // first tile
  input  wire [@CONSTANT_BITS@-1:0] constants,  // @CONSTANTS@
  input  wire in_valid,
  output wire in_ready,
  input  wire [@FRAGMENT_BITS@-1:0] in_fragment,
  output wire memory_request,                   // a burst of a tile
  input  wire memory_accept,
  output wire [27:0] memory_tile,
  input  wire memory_valid,
  output wire memory_ready,
  input  wire [191:0] memory_row,               // a row of the tile, four a burst: left texel and red in the lowest bits
  output wire out_valid,
  input  wire out_ready,
  output wire [25:0] out_pixel,
  output wire [29:0] out_red,                   // linear light in 2^-24
  output wire [29:0] out_green,
  output wire [29:0] out_blue,
  output wire probe_taken,                      // counts: a probe, a sample of a level, a request of the cache
  output wire patch_taken,
  output wire request_taken
);

  wire [3:0] last_level = constants[3:0];
  wire [2:0] exponent = constants[6:4];

@WIRES@
  // ---- fragments: to the reflection, to the blend, to the sum of the pixel ----
  wire plain = in_fragment[32];
  wire own_ready, place_ready, rough_ready, reflect_taken;
  assign in_ready = own_ready & place_ready & (plain | (rough_ready & reflect_in_ready));
  assign reflect_in_valid = in_valid & ~plain & own_ready & place_ready & rough_ready;
  wire taken = in_valid & in_ready;

  wire rough;
  wire own_valid;
  // These queues hold a word whenever the design that they stand beside has an outcome.
  wire unused_rough, unused_place, unused_tag, unused_hold, unused_patch, unused_meta, unused_weight, unused_end;
  // Designs of three channels go the same way.
  wire unused_twins = &{corner_1_in_ready, corner_1_out_valid, corner_2_in_ready, corner_2_out_valid, light_1_in_ready, light_1_out_valid,
    light_2_in_ready, light_2_out_valid, pixel_1_in_ready, pixel_1_out_valid, pixel_2_in_ready, pixel_2_out_valid};
  roughxel_fifo #(.WIDTH(1), .LOG2_DEPTH(5)) roughs (
    .clk(clk), .rst(rst), .in_valid(taken & ~plain), .in_ready(rough_ready), .in(in_fragment[33]),
    .out_valid(unused_rough), .out_ready(reflect_taken), .out(rough)
  );

  wire own_plain, own_taken;
  wire [50:0] own_reflectance;
  wire [89:0] own_surface;
  roughxel_fifo #(.WIDTH(142), .LOG2_DEPTH(6)) owns (
    .clk(clk), .rst(rst), .in_valid(taken), .in_ready(own_ready), .in({plain, in_fragment[174:34]}),
    .out_valid(own_valid), .out_ready(own_taken), .out({own_plain, own_surface, own_reflectance})
  );

  wire place_taken, shared, last_of_pixel;
  wire [3:0] times;
  roughxel_fifo #(.WIDTH(32), .LOG2_DEPTH(7)) places (
    .clk(clk), .rst(rst), .in_valid(taken), .in_ready(place_ready), .in(in_fragment[31:0]),
    .out_valid(unused_place), .out_ready(place_taken), .out({shared, last_of_pixel, times, out_pixel})
  );

  // ---- footprints ----
  wire foot_ready, foot_valid, foot_taken, foot_rough;
  wire [FOOT_BITS-1:0] foot;
  assign reflect_out_ready = foot_ready;
  assign reflect_taken = reflect_out_valid & foot_ready;
  roughxel_fifo #(.WIDTH(FOOT_BITS + 1), .LOG2_DEPTH(2)) footprints (
    .clk(clk), .rst(rst), .in_valid(reflect_out_valid), .in_ready(foot_ready), .in({rough, foot_in}),
    .out_valid(foot_valid), .out_ready(foot_taken), .out({foot_rough, foot})
  );
@FOOT@
  // ---- probes of a footprint ----
  reg [3:0] index;
  wire tag_ready;
  wire probe_last = {1'b0, index} + 5'd1 == foot_count;
  assign probe_in_valid = foot_valid & tag_ready;
  assign probe_taken = probe_in_valid & probe_in_ready;
  assign foot_taken = probe_taken & probe_last;
  always @(posedge clk)
    if (rst) index <= 4'd0;
    else if (probe_taken) index <= probe_last ? 4'd0 : index + 4'd1;

  wire tag_last, tag_rough, probe_done;
  wire [LOD_BITS-1:0] tag_lod;
  roughxel_fifo #(.WIDTH(LOD_BITS + 2), .LOG2_DEPTH(5)) tags (
    .clk(clk), .rst(rst), .in_valid(probe_taken), .in_ready(tag_ready), .in({probe_last, foot_rough, foot_lod}),
    .out_valid(unused_tag), .out_ready(probe_done), .out({tag_last, tag_rough, tag_lod})
  );

  // ---- levels of a probe ----
  wire hold_ready, hold_taken, hold_last;
  wire [16:0] hold_weight;
  wire [2:0] hold_face;
  wire [PLACE_BITS-1:0] hold_place;
  assign levels_in_valid = probe_out_valid & hold_ready;
  assign probe_out_ready = levels_in_ready & hold_ready;
  assign probe_done = probe_out_valid & levels_in_ready & hold_ready;
  roughxel_fifo #(.WIDTH(PLACE_BITS + 21), .LOG2_DEPTH(3)) holds (
    .clk(clk), .rst(rst), .in_valid(probe_done), .in_ready(hold_ready), .in({tag_last, probe_weight, probe_face, probe_place}),
    .out_valid(unused_hold), .out_ready(hold_taken), .out({hold_last, hold_weight, hold_face, hold_place})
  );

  // ---- a sample of the finer level, and one of the coarser level unless its weight is 0 ----
  reg [14:0] edges [0:15];
  reg [27:0] starts [0:15];
  always @(posedge clk)
    if (level_write) begin
      edges[level_number] <= level_edge;
      starts[level_number] <= level_start;
    end

  reg coarse;
  wire patch_ready;
  wire [3:0] coarser = level == last_level ? level : level + 4'd1;
  wire [3:0] patch_level = coarse ? coarser : level;
  wire [14:0] patch_edge = edges[patch_level];
  wire patch_end = coarse | level_weight == {LEVEL_WEIGHT_BITS{1'b0}};
  assign address_in_valid = levels_out_valid & patch_ready;
  assign patch_taken = address_in_valid & address_in_ready;
  assign levels_out_ready = address_in_ready & patch_ready & patch_end;
  assign hold_taken = patch_taken & patch_end;
  always @(posedge clk)
    if (rst) coarse <= 1'b0;
    else if (patch_taken) coarse <= ~patch_end;

  wire [14:0] texels_edge;
  wire [27:0] texels_start;
  wire [2:0] texels_face;
  wire [SAMPLE_BITS-1:0] patch_sample;
  wire texels_odd, texels_taken;
  roughxel_fifo #(.WIDTH(SAMPLE_BITS + 47), .LOG2_DEPTH(3)) patches (
    .clk(clk), .rst(rst), .in_valid(patch_taken), .in_ready(patch_ready),
    .in({patch_edge, starts[patch_level], patch_level[0], hold_face, level_weight, hold_weight, coarse, patch_end, hold_last}),
    .out_valid(unused_patch), .out_ready(texels_taken), .out({texels_edge, texels_start, texels_odd, texels_face, patch_sample})
  );

  // ---- texels of a sample ----
  wire meta_ready, requests_ready, requests_taken, meta_odd;
  wire [12:0] meta_across;
  wire [27:0] meta_start;
  wire [SAMPLE_BITS-1:0] meta_sample;
  wire [PATCH_WEIGHT_BITS-1:0] meta_weights;
  wire [14:0] padded_edge = texels_edge + 15'd3;
  wire unused_edge = &padded_edge[1:0];
  assign texels_in_valid = address_out_valid & meta_ready;
  assign address_out_ready = texels_in_ready & meta_ready;
  assign texels_taken = texels_in_valid & texels_in_ready;
  roughxel_fifo #(.WIDTH(SAMPLE_BITS + PATCH_WEIGHT_BITS + 42), .LOG2_DEPTH(4)) metas (
    .clk(clk), .rst(rst), .in_valid(texels_taken), .in_ready(meta_ready),
    .in({padded_edge[14:2], texels_start, texels_odd, patch_weights, patch_sample}),
    .out_valid(unused_meta), .out_ready(requests_taken), .out({meta_across, meta_start, meta_odd, meta_weights, meta_sample})
  );

  // ---- requests of texels ----
  wire gather_ready, gather_valid, gather_taken;
  assign texels_out_ready = requests_ready & gather_ready;
  assign requests_taken = texels_out_valid & texels_out_ready;
  localparam ROW_BITS = @ROW_BITS@, COLUMN_BITS = @COLUMN_BITS@, SET_BITS = ROW_BITS + COLUMN_BITS + 1;
  wire request_valid, request_ready;
  wire [27:0] request_tile;
  wire [3:0] request_place;
  wire [SET_BITS-1:0] request_set;
  wire request_pair;
  roughxel_texel_requests #(.TILE_BITS(28), .ROW_BITS(ROW_BITS), .COLUMN_BITS(COLUMN_BITS)) requests (
    .clk(clk), .rst(rst), .in_valid(texels_out_valid & gather_ready), .in_ready(requests_ready),
    .in_texels({texel_3, texel_2, texel_1, texel_0}), .in_across(meta_across), .in_start(meta_start), .in_odd(meta_odd),
    .out_valid(request_valid), .out_ready(request_ready), .out_tile(request_tile), .out_place(request_place),
    .out_set(request_set), .out_pair(request_pair)
  );
  assign request_taken = request_valid & request_ready;

  wire cache_valid, cache_ready;
  wire [47:0] cache_texel, cache_next;
  wire cache_pair;
  roughxel_texture_cache #(.TILE_BITS(28), .SET_BITS(SET_BITS), .LOG2_FLIGHT(7)) cache (
    .clk(clk), .rst(rst),
    .in_valid(request_valid), .in_ready(request_ready), .in_tile(request_tile), .in_place(request_place), .in_set(request_set), .in_pair(request_pair),
    .out_valid(cache_valid), .out_ready(cache_ready), .out_texel(cache_texel), .out_next(cache_next), .out_pair(cache_pair),
    .memory_request(memory_request), .memory_accept(memory_accept), .memory_tile(memory_tile),
    .memory_valid(memory_valid), .memory_ready(memory_ready), .memory_row(memory_row)
  );

  // ---- texels that came: eight of a probe, the mean of three at a corner ----
  wire [3:0] corners;
  wire [PATCH_WEIGHT_BITS-1:0] gather_weights;
  wire [LEVEL_WEIGHT_BITS-1:0] gather_level_weight;
  wire [16:0] gather_weight;
  wire gather_coarse, gather_end, gather_last;
  roughxel_fifo #(.WIDTH(SAMPLE_BITS + PATCH_WEIGHT_BITS + 4), .LOG2_DEPTH(5)) gathers (
    .clk(clk), .rst(rst), .in_valid(requests_taken), .in_ready(gather_ready),
    .in({texel_3[93], texel_2[93], texel_1[93], texel_0[93], meta_weights, meta_sample}),
    .out_valid(gather_valid), .out_ready(gather_taken),
    .out({corners, gather_weights, gather_level_weight, gather_weight, gather_coarse, gather_end, gather_last})
  );

  reg [1:0] number, part;
  reg corner_busy, quads_full;
  reg [95:0] parts;
  reg [383:0] quads;
  reg [2*PATCH_WEIGHT_BITS-1:0] quad_weights;
  reg [LEVEL_WEIGHT_BITS-1:0] quad_level_weight;
  reg [16:0] quad_weight;
  reg quad_last;
  wire is_corner = corners[number];
  wire free = gather_valid & ~quads_full & ~corner_busy;
  wire third = is_corner & part == 2'd2;
  assign corner_0_in_valid = free & cache_valid & third;
  assign corner_1_in_valid = corner_0_in_valid;
  assign corner_2_in_valid = corner_0_in_valid;
  assign corner_0_out_ready = corner_busy;
  assign corner_1_out_ready = corner_busy;
  assign corner_2_out_ready = corner_busy;
  assign cache_ready = free & (~third | corner_0_in_ready);
  wire came = cache_valid & cache_ready;
  wire cornered = corner_busy & corner_0_out_valid;
  wire stored = cornered | (came & ~is_corner);
  wire paired = came & cache_pair;
  wire quad_done = stored & number[1] & (number[0] | paired);
  assign gather_taken = quad_done;

  reg job_valid;
  wire job_free;
  always @(posedge clk) begin
    if (stored) quads[48*{gather_coarse, number} +: 48] <= cornered ? {corner_2_texel, corner_1_texel, corner_0_texel} : cache_texel;
    if (paired) quads[48*{gather_coarse, number[1], 1'b1} +: 48] <= cache_next;
    if (came & is_corner & ~part[1]) parts[48*part[0] +: 48] <= cache_texel;
    if (quad_done) begin
      quad_weights[PATCH_WEIGHT_BITS*gather_coarse +: PATCH_WEIGHT_BITS] <= gather_weights;
      quad_level_weight <= gather_level_weight;
      quad_weight <= gather_weight;
      quad_last <= gather_last;
    end
    if (rst) begin
      number <= 2'd0;
      part <= 2'd0;
      corner_busy <= 1'b0;
      quads_full <= 1'b0;
    end else begin
      if (stored) number <= number + (paired ? 2'd2 : 2'd1);
      if (came & is_corner) part <= third ? 2'd0 : part + 2'd1;
      if (came & third) corner_busy <= 1'b1;
      else if (cornered) corner_busy <= 1'b0;
      if (quad_done & gather_end) quads_full <= 1'b1;
      else if (job_free) quads_full <= 1'b0;
    end
  end

  // ---- filter: a channel after the other ----
  reg [383:0] job;
  reg [2*PATCH_WEIGHT_BITS-1:0] job_weights;
  reg [LEVEL_WEIGHT_BITS-1:0] job_level_weight;
  reg [16:0] job_weight;
  reg job_last;
  reg [1:0] channel;
  wire weight_ready;
  assign sample_in_valid = job_valid & weight_ready;
  wire sample_taken = sample_in_valid & sample_in_ready;
  wire job_done = sample_taken & channel == 2'd2;
  assign job_free = ~job_valid | job_done;
  always @(posedge clk) begin
    if (quads_full & job_free) begin
      job <= quads;
      job_weights <= quad_weights;
      job_level_weight <= quad_level_weight;
      job_weight <= quad_weight;
      job_last <= quad_last;
    end
    if (rst) begin
      job_valid <= 1'b0;
      channel <= 2'd0;
    end else begin
      if (job_free) job_valid <= quads_full;
      if (sample_taken) channel <= job_done ? 2'd0 : channel + 2'd1;
    end
  end
@JOB_TEXELS@
  // ---- weighted sums of the probes ----
  wire sample_last, sum_taken;
  wire [16:0] sample_weight;
  roughxel_fifo #(.WIDTH(18), .LOG2_DEPTH(4)) weights (
    .clk(clk), .rst(rst), .in_valid(sample_taken), .in_ready(weight_ready), .in({job_last, job_weight}),
    .out_valid(unused_weight), .out_ready(sum_taken), .out({sample_last, sample_weight})
  );
  reg [1:0] sum_channel, summed_channel;
  reg [2:0] pending;
  reg [3*SUM_BITS-1:0] sums;
  wire end_ready, sum_end, summed;
  wire [SUM_BITS-1:0] sum_so_far = sums[SUM_BITS*sum_channel +: SUM_BITS];
  assign sum_in_valid = sample_out_valid & ~pending[sum_channel] & end_ready;
  assign sample_out_ready = sum_in_ready & ~pending[sum_channel] & end_ready;
  assign sum_taken = sum_in_valid & sum_in_ready;
  roughxel_fifo #(.WIDTH(1), .LOG2_DEPTH(3)) ends (
    .clk(clk), .rst(rst), .in_valid(sum_taken), .in_ready(end_ready), .in(sample_last),
    .out_valid(unused_end), .out_ready(summed), .out(sum_end)
  );
  assign mean_in_valid = sum_out_valid & sum_end;
  assign sum_out_ready = ~sum_end | mean_in_ready;
  assign summed = sum_out_valid & sum_out_ready;
  always @(posedge clk)
    if (rst) begin
      sum_channel <= 2'd0;
      summed_channel <= 2'd0;
      pending <= 3'd0;
      sums <= {3*SUM_BITS{1'b0}};
    end else begin
      if (sum_taken) begin
        sum_channel <= sum_channel == 2'd2 ? 2'd0 : sum_channel + 2'd1;
        pending[sum_channel] <= 1'b1;
      end
      if (summed) begin
        summed_channel <= summed_channel == 2'd2 ? 2'd0 : summed_channel + 2'd1;
        pending[summed_channel] <= 1'b0;
        sums[SUM_BITS*summed_channel +: SUM_BITS] <= sum_end ? {SUM_BITS{1'b0}} : sum_next;
      end
    end

  // ---- means to colours, blended with those of the surfaces ----
  assign colour_in_valid = mean_out_valid;
  assign mean_out_ready = colour_in_ready;
  reg [1:0] blend_channel;
  wire [29:0] surface = own_surface[30*blend_channel +: 30];
  wire [16:0] reflectance = own_plain ? 17'd0 : own_reflectance[17*blend_channel +: 17];
  wire [29:0] reflection = own_plain ? 30'd0 : colour_light;
  assign blend_in_valid = own_valid & (own_plain | colour_out_valid);
  assign colour_out_ready = own_valid & ~own_plain & blend_in_ready;
  wire blend_taken = blend_in_valid & blend_in_ready;
  assign own_taken = blend_taken & blend_channel == 2'd2;
  always @(posedge clk)
    if (rst) blend_channel <= 2'd0;
    else if (blend_taken) blend_channel <= own_taken ? 2'd0 : blend_channel + 2'd1;

  // ---- light of a pixel: the sum of its fragments, each as many times as it counts; then the mean ----
  localparam ADD = 2'd0, ADDED = 2'd1, SHOW = 2'd2, SHOWN = 2'd3;
  reg [1:0] state, blended_channel;
  reg [3:0] added;
  reg full;
  reg [89:0] blended;
  reg [LIGHT_BITS-1:0] light_r, light_g, light_b;
  wire [29:0] blended_r = blended[29:0], blended_g = blended[59:30], blended_b = blended[89:60];
  localparam [LIGHT_BITS-1:0] HALF = 4;
  wire [LIGHT_BITS-1:0] mean_r = shared ? (light_r + HALF) >> 3 : light_r;
  wire [LIGHT_BITS-1:0] mean_g = shared ? (light_g + HALF) >> 3 : light_g;
  wire [LIGHT_BITS-1:0] mean_b = shared ? (light_b + HALF) >> 3 : light_b;
  assign blend_out_ready = ~full;
  assign light_0_in_valid = state == ADD & full;
  assign light_1_in_valid = light_0_in_valid;
  assign light_2_in_valid = light_0_in_valid;
  assign light_0_out_ready = state == ADDED;
  assign light_1_out_ready = light_0_out_ready;
  assign light_2_out_ready = light_0_out_ready;
  assign pixel_0_in_valid = state == SHOW;
  assign pixel_1_in_valid = pixel_0_in_valid;
  assign pixel_2_in_valid = pixel_0_in_valid;
  assign pixel_0_out_ready = state == SHOWN & out_ready;
  assign pixel_1_out_ready = pixel_0_out_ready;
  assign pixel_2_out_ready = pixel_0_out_ready;
  assign out_valid = state == SHOWN & pixel_0_out_valid;
  assign {out_red, out_green, out_blue} = {pixel_0_light, pixel_1_light, pixel_2_light};
  wire all_added = state == ADDED & light_0_out_valid & added + 4'd1 == times;
  wire shown = out_valid & out_ready;
  assign place_taken = shown | (all_added & ~last_of_pixel);
  always @(posedge clk) begin
    if (blend_out_valid & ~full) blended[30*blended_channel +: 30] <= blend_light;
    if (rst) begin
      state <= ADD;
      added <= 4'd0;
      full <= 1'b0;
      blended_channel <= 2'd0;
      {light_r, light_g, light_b} <= {3*LIGHT_BITS{1'b0}};
    end else begin
      if (blend_out_valid & ~full) begin
        blended_channel <= blended_channel == 2'd2 ? 2'd0 : blended_channel + 2'd1;
        full <= blended_channel == 2'd2;
      end
      if (place_taken) full <= 1'b0;
      case (state)
        ADD: if (full & light_0_in_ready) state <= ADDED;
        ADDED: if (light_0_out_valid) begin
          {light_r, light_g, light_b} <= {light_0_next, light_1_next, light_2_next};
          added <= all_added ? 4'd0 : added + 4'd1;
          state <= all_added & last_of_pixel ? SHOW : ADD;
        end
        SHOW: if (pixel_0_in_ready) state <= SHOWN;
        default: if (shown) begin
          {light_r, light_g, light_b} <= {3*LIGHT_BITS{1'b0}};
          state <= ADD;
        end
      endcase
    end
  end

@INSTANCES@
endmodule

`default_nettype wire
