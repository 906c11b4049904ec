module @NAME@ (
  input  wire aclk,
  input  wire aresetn,                    // synchronous, low clears what is under way and resets the registers
  input  wire s_axis_tvalid,
  output wire s_axis_tready,
  input  wire [@WIDTH@-1:0] s_axis_tdata,
  input  wire s_axis_tlast,               // an early one drops the words before it
  output wire m_axis_tvalid,
  input  wire m_axis_tready,
  output wire [@WIDTH@-1:0] m_axis_tdata,
  output wire m_axis_tlast,
  input  wire s_axi_awvalid,
  output wire s_axi_awready,
  input  wire [@ADDRESS_BITS@-1:0] s_axi_awaddr,
  input  wire s_axi_wvalid,
  output wire s_axi_wready,
  input  wire [31:0] s_axi_wdata,
  input  wire [3:0] s_axi_wstrb,
  output wire s_axi_bvalid,
  input  wire s_axi_bready,
  output wire [1:0] s_axi_bresp,          // SLVERR: no register at this address can be written
  input  wire s_axi_arvalid,
  output wire s_axi_arready,
  input  wire [@ADDRESS_BITS@-1:0] s_axi_araddr,
  output wire s_axi_rvalid,
  input  wire s_axi_rready,
  output wire [31:0] s_axi_rdata,
  output wire [1:0] s_axi_rresp           // SLVERR: no register has this address
);

  // ---- writes: address and data wait for each other ----
  reg has_address;
  reg has_data;
  reg [@ADDRESS_BITS@-1:2] address;
  reg [31:0] data;
  reg [3:0] strobes;
  reg b_valid;
  reg b_error;
  assign s_axi_awready = ~has_address;
  assign s_axi_wready = ~has_data;
  assign s_axi_bvalid = b_valid;
  assign s_axi_bresp = {b_error, 1'b0};
  wire write = has_address & has_data & ~b_valid;
  wire can_write = @CAN_WRITE@;
  wire [31:0] mask = {{8{strobes[3]}}, {8{strobes[2]}}, {8{strobes[1]}}, {8{strobes[0]}}};
  always @(posedge aclk) begin
    if (!has_address) address <= s_axi_awaddr[@ADDRESS_BITS@-1:2];
    if (!has_data) begin
      data <= s_axi_wdata;
      strobes <= s_axi_wstrb;
    end
    if (write) b_error <= ~can_write;
    if (!aresetn) begin
      has_address <= 1'b0;
      has_data <= 1'b0;
      b_valid <= 1'b0;
    end else begin
      has_address <= ~write & (has_address | s_axi_awvalid);
      has_data <= ~write & (has_data | s_axi_wvalid);
      b_valid <= write | (b_valid & ~s_axi_bready);
    end
  end
@REGISTERS@
  // ---- reads ----
  reg r_valid;
  reg r_error;
  reg [31:0] r_data;
  assign s_axi_arready = ~r_valid;
  assign s_axi_rvalid = r_valid;
  assign s_axi_rresp = {r_error, 1'b0};
  assign s_axi_rdata = r_data;
  always @(posedge aclk) begin
    if (!r_valid) begin
      r_error <= 1'b0;
      case (s_axi_araddr[@ADDRESS_BITS@-1:2])
@READS@        default: begin
          r_error <= 1'b1;
          r_data <= 32'd0;
        end
      endcase
    end
    if (!aresetn) r_valid <= 1'b0;
    else r_valid <= r_valid ? ~s_axi_rready : s_axi_arvalid;
  end

  // ---- streams ----
  @AXIS@ u_axis (
    .aclk(aclk), .aresetn(aresetn),
    .s_axis_tvalid(s_axis_tvalid), .s_axis_tready(s_axis_tready), .s_axis_tdata(s_axis_tdata), .s_axis_tlast(s_axis_tlast),
    .m_axis_tvalid(m_axis_tvalid), .m_axis_tready(m_axis_tready), .m_axis_tdata(m_axis_tdata), .m_axis_tlast(m_axis_tlast)@CONNECTIONS@
  );

  // Addresses are of words; no register needs every bit of its word.
  wire unused = &{1'b0, s_axi_awaddr[1:0], s_axi_araddr[1:0], address, data, mask};

endmodule

`default_nettype wire
