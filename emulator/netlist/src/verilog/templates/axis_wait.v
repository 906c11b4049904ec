  reg [@OUT_BITS@-1:0] waiting;
  reg waits;
  assign out_valid = waits;
  assign out_bits = waiting;
  wire made_valid;
  wire made_ready = ~waits;
  wire [@OUT_BITS@-1:0] made_bits;
  always @(posedge aclk) begin
    if (made_ready) waiting <= made_bits;
    waits <= aresetn & (waits ? ~out_ready : made_valid);
  end
