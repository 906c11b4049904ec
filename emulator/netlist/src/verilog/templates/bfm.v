@PORTS@
  localparam WIDTH = @WIDTH@;
  localparam IN_WORDS = @IN_WORDS@;
  localparam OUT_WORDS = @OUT_WORDS@;
  localparam WRITES = @WRITES@;

  // With +stalls, words have random gaps on both streams.
  reg gaps;
  initial gaps = $test$plusargs("stalls") != 0;
  reg [15:0] noise = 16'hace1;
  always @(posedge clk) noise <= {noise[14:0], noise[15] ^ noise[13] ^ noise[12] ^ noise[10]};

  // ---- registers: written if a constant differs from that of the fragment before ----
  wire [WRITES*32-1:0] image = @IMAGE@;
  reg [WRITES*32-1:0] written;
  reg is_known;
  reg [31:0] number;                      // of the next word that is written; WRITES if all are
  reg aw_valid;
  reg w_valid;
  wire b_valid;
  wire [1:0] b_resp;
  wire aw_ready;
  wire w_ready;
  wire [WRITES*32-1:0] shifted = written >> (32 * number);
  wire [31:0] offset = number == WRITES - 1 ? 32'd4 : 32'd8 + 4 * number;
  wire is_writing = number != WRITES;

  // ---- words of a fragment; the last one waits until the registers are written ----
  wire take = in_valid & in_ready;
  wire differs = @DIFFERS@;
  reg [IN_WORDS*WIDTH-1:0] sending;
  reg [31:0] left;
  reg offered;
  wire s_ready;
  wire s_valid = left != 0 & ~(left == 1 & is_writing) & (offered | ~gaps | noise[0]);
  wire s_fire = s_valid & s_ready;
  assign in_ready = ~rst & (left == 0 | (left == 1 & s_fire));
  always @(posedge clk) begin
    if (take) begin
      sending <= @SENDING@;
      written <= image;
    end@SHIFT@
    if (rst) begin
      left <= 0;
      offered <= 1'b0;
      is_known <= 1'b0;
      number <= WRITES;
      aw_valid <= 1'b0;
      w_valid <= 1'b0;
    end else begin
      offered <= s_valid & ~s_ready;
      left <= take ? IN_WORDS : left - {31'd0, s_fire};
      if (take) is_known <= 1'b1;
      if (aw_valid & aw_ready) aw_valid <= 1'b0;
      if (w_valid & w_ready) w_valid <= 1'b0;
      if (take & (differs | ~is_known)) begin
        number <= @FIRST@;
        aw_valid <= @HAS_WRITES@;
        w_valid <= @HAS_WRITES@;
      end else if (b_valid) begin
        number <= number + 1;
        aw_valid <= number + 1 != WRITES;
        w_valid <= number + 1 != WRITES;
      end
    end
  end

  // ---- words of an outcome ----
  reg [OUT_WORDS*WIDTH-1:0] got;
  reg [31:0] have;
  // A shell that breaks a rule of its buses gives no more outcomes, so every testbench fails.
  reg failed;
  wire m_valid;
  wire m_last;
  wire [WIDTH-1:0] m_data;
  wire out_fire = out_valid & out_ready;
  wire m_ready = (have != OUT_WORDS | out_ready) & (~gaps | noise[5]) & ~failed;
  wire m_fire = m_valid & m_ready;
  wire [31:0] kept = out_fire ? 0 : have;
  assign out_valid = have == OUT_WORDS & ~failed;
@OUTPUTS@
  reg m_waits;
  reg [WIDTH:0] m_before;
  wire is_early_or_late = m_fire & (m_last != (kept == OUT_WORDS - 1));
  wire has_changed = m_waits & (~m_valid | m_before != {m_last, m_data});
  wire is_refused = b_valid & b_resp != 2'd0;
  always @(posedge clk) begin
    if (m_fire) got <= @GOT@;
    have <= rst ? 0 : kept + {31'd0, m_fire};
    m_waits <= ~rst & m_valid & ~m_ready;
    m_before <= {m_last, m_data};
    if (rst) failed <= 1'b0;
    else begin
      failed <= failed | is_early_or_late | has_changed | is_refused;
      if (is_early_or_late) $display("ERROR m_axis_tlast is %0d at word %0d", m_last, kept);
      if (has_changed) $display("ERROR m_axis changed before it was taken");
      if (is_refused) $display("ERROR s_axi_bresp is %0d at address %0d", b_resp, offset);
    end
  end

  wire r_valid;
  wire ar_ready;
  wire [1:0] r_resp;
  wire [31:0] r_data;
  @SHELL@ u_shell (
    .aclk(clk), .aresetn(~rst),
    .s_axis_tvalid(s_valid), .s_axis_tready(s_ready), .s_axis_tdata(sending[WIDTH-1:0]), .s_axis_tlast(left == 1),
    .m_axis_tvalid(m_valid), .m_axis_tready(m_ready), .m_axis_tdata(m_data), .m_axis_tlast(m_last),
    .s_axi_awvalid(aw_valid), .s_axi_awready(aw_ready), .s_axi_awaddr(offset[@ADDRESS_BITS@-1:0]),
    .s_axi_wvalid(w_valid), .s_axi_wready(w_ready), .s_axi_wdata(shifted[31:0]), .s_axi_wstrb(4'd15),
    .s_axi_bvalid(b_valid), .s_axi_bready(1'b1), .s_axi_bresp(b_resp),
    .s_axi_arvalid(1'b0), .s_axi_arready(ar_ready), .s_axi_araddr({@ADDRESS_BITS@{1'b0}}),
    .s_axi_rvalid(r_valid), .s_axi_rready(1'b0), .s_axi_rdata(r_data), .s_axi_rresp(r_resp)
  );

  wire unused = &{1'b0, noise, shifted, offset, got, written, r_valid, ar_ready, r_resp, r_data};

endmodule

`default_nettype wire
