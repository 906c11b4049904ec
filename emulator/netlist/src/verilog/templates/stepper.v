module @MODULE@ (
@PORTS@);

  reg busy;
  reg @INDEX_BITS@index;
@HELD@
  wire step_ready;
  wire step = busy & step_ready;
  wire last = @INDEX@ + @ONE@ == @COUNT@;
  assign in_ready = ~busy | (step & last);

  always @(posedge clk)
    if (rst) busy <= 1'b0;
    else if (in_ready) busy <= in_valid;

  always @(posedge clk)
    if (in_ready) begin
      index <= @INDEX_ZERO@;
@TAKEN@    end else if (step) begin
      index <= index + @INDEX_ONE@;
    end

  @STEP@ u_step (
    .clk(clk),
    .rst(rst),
    .in_valid(busy),
    .in_ready(step_ready),
    .out_valid(out_valid),
    .out_ready(out_ready)@CONNECTIONS@
  );

  // Beside the step, as long as it takes.
  @DELAY@ #(.WIDTH(@LOD_WIDTH@), .CYCLES(@LATENCY@)) delay_lod_last (
    .clk(clk), .enable(step_ready),
    .in({@LOD@, last}),
    .out({@OUT_LOD@, out_last_flag})
  );

endmodule

`default_nettype wire
