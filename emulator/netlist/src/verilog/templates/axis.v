module @NAME@ (
  input  wire aclk,
  input  wire aresetn,                    // synchronous, low clears what is under way
  input  wire s_axis_tvalid,
  output wire s_axis_tready,
  input  wire [@WIDTH@-1:0] s_axis_tdata,
  input  wire s_axis_tlast,               // an early one drops the words before it
  output wire m_axis_tvalid,
  input  wire m_axis_tready,
  output wire [@WIDTH@-1:0] m_axis_tdata,
  output wire m_axis_tlast@CONSTANT_PORTS@
);

  localparam WIDTH = @WIDTH@;
  localparam IN_WORDS = @IN_WORDS@;
  localparam OUT_WORDS = @OUT_WORDS@;

  // ---- words to an input ----
  reg [IN_WORDS*WIDTH-1:0] words;
  reg [@IN_COUNT@:0] received;
  reg full;
  wire in_ready;
  assign s_axis_tready = ~full | in_ready;
  wire taken = s_axis_tvalid & s_axis_tready;
  wire complete = received == @IN_LAST@;
  always @(posedge aclk) begin
    if (taken) words <= @SHIFTED@;
    if (!aresetn) begin
      received <= @IN_ZERO@;
      full <= 1'b0;
    end else begin
      if (taken) received <= (complete | s_axis_tlast) ? @IN_ZERO@ : received + @IN_ONE@;
      if (taken & complete) full <= 1'b1;
      else if (in_ready) full <= 1'b0;
    end
  end
@CONSTANTS@
  // ---- the design ----
  wire out_valid;
  wire out_ready;
  wire [@OUT_BITS@-1:0] out_bits;
@SLICE@@MODULE@ u_design (
    .clk(aclk), .rst(~aresetn),
    .in_valid(full), .in_ready(in_ready), .out_valid(@MADE@_valid), .out_ready(@MADE@_ready)@CONNECTIONS@
  );

  // ---- an output to words ----
  reg [OUT_WORDS*WIDTH-1:0] result;
  reg [@OUT_COUNT@:0] left;
  assign m_axis_tvalid = left != @OUT_ZERO@;
  assign m_axis_tdata = result[WIDTH-1:0];
  assign m_axis_tlast = left == @OUT_ONE@;
  wire sent = m_axis_tvalid & m_axis_tready;
  assign out_ready = ~m_axis_tvalid | (m_axis_tlast & m_axis_tready);
  always @(posedge aclk) begin
    if (out_valid & out_ready) result <= @PADDED@;
@SHIFT@    if (!aresetn) left <= @OUT_ZERO@;
    else if (out_valid & out_ready) left <= @OUT_ALL@;
    else if (sent) left <= left - @OUT_ONE@;
  end
@UNUSED@
endmodule

`default_nettype wire
