// Drives a generated module with the vectors of a directory and compares every output of every vector.
//
// bench.vh in the include path names the module and its sizes; inputs.hex and expected.hex are in the working
// directory. Prints PASS, or the first wire that differs and FAIL. With +stalls both sides of the handshake pause
// at random. With EXIT_CODE defined, Icarus ends with 1 after FAIL.
//
//   iverilog -g2005 -I DIR -y DIR -s bench -o bench.vvp bench.v && (cd DIR && vvp -N ../bench.vvp +stalls)

`include "bench.vh"
`timescale 1ns / 1ns
`default_nettype none

module bench;

  reg [`IN_BITS-1:0]  inputs   [0:`INPUTS-1];
  reg [`OUT_BITS-1:0] expected [0:`OUTPUTS-1];

  reg        clk = 0;
  reg        rst = 1;
  reg        stalls;
  reg [15:0] noise = 16'hace1;
  integer    taken = 0;
  integer    checked = 0;
  integer    idle = 0;

  wire in_valid  = !rst && taken < `INPUTS && (!stalls || noise[2:0] != 0);
  wire out_ready = !stalls || noise[10:9] != 0;
  wire in_ready, out_valid;
  wire [`OUT_BITS-1:0] out_bits;
  // Nothing is driven without valid: x would come through where it is used all the same.
  wire [`IN_BITS-1:0] in_bits = in_valid ? inputs[taken] : {`IN_BITS{1'bx}};

  `FLAT dut (
    .clk(clk), .rst(rst),
    .in_valid(in_valid), .in_ready(in_ready), .in_bits(in_bits),
    .out_valid(out_valid), .out_ready(out_ready), .out_bits(out_bits)
  );

  task explain(input integer index, input [`OUT_BITS-1:0] got, input [`OUT_BITS-1:0] wanted);
    reg found;
    begin
      found = 0;
      `EXPLAIN
    end
  endtask

  task stop(input passed);
    begin
      if (passed) $display("PASS %0d vectors", checked);
      else $display("FAIL");
`ifdef EXIT_CODE
      $finish_and_return(!passed);
`else
      $finish;
`endif
    end
  endtask

  initial begin
    stalls = $test$plusargs("stalls");
    $readmemh("inputs.hex", inputs);
    $readmemh("expected.hex", expected);
    // Fewer words than the array leave x behind.
    if (^inputs[`INPUTS-1] === 1'bx || ^expected[`OUTPUTS-1] === 1'bx) begin
      $display("the files hold fewer vectors than bench.vh says");
      stop(0);
    end
    repeat (3) @(negedge clk);
    rst = 0;
  end

  always #1 clk = !clk;

  always @(posedge clk) begin
    noise <= {noise[14:0], noise[15] ^ noise[13] ^ noise[12] ^ noise[10]};
    if (in_valid && in_ready) taken <= taken + 1;
    if (out_valid && out_ready) begin
      idle <= 0;
      if (checked >= `OUTPUTS) begin
        $display("an output after the last");
        stop(0);
      end else if (out_bits !== expected[checked]) begin
        explain(checked, out_bits, expected[checked]);
        stop(0);
      end
      checked <= checked + 1;
    end else idle <= idle + 1;
    // The pipeline is empty for long, whatever the stalls.
    if (idle > 20 * (`LATENCY + 10)) begin
      if (checked < `OUTPUTS) $display("only %0d of %0d outputs came", checked, `OUTPUTS);
      stop(checked == `OUTPUTS);
    end
  end

endmodule
