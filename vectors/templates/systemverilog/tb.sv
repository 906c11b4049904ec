// @NAME@_tb: drives @NAME@_device with every vector of the set @SET@ and compares every field.
//
// For Icarus (-g2012) and Verilator (--binary --timing); `sh run.sh` has the command lines. Arguments:
//   +words=FILE     the words (words.hex)
//   +got=FILE       writes the device's words there, for `roughxel vectors check`, all of them: +stop ends what is printed
//   +stop=N         ends at the N-th vector that differs (10)
//   +outputs_only   compares what leaves the datapath alone, for a device that does not show its stages
//   +stalls         both sides of the handshake pause at random
//   +timeout=N      cycles without an output after which it gives up (10000)
// Prints PASS, or each difference and FAIL; ERROR where the comparison could not be made.

module @NAME@_tb;

  import @NAME@_pkg::*;

  word_t     words [0:N_VECTORS-1];
  string     path, got_path;
  int        got = 0;
  int        stop, timeout;
  logic      outputs_only, stalls;
  logic      clk = 0;
  logic      rst = 1;
  logic [15:0] noise = 16'hace1;
  int unsigned taken = 0;
  int unsigned checked = 0;
  int        wrong = 0;
  int        idle = 0;
  int        differing;

  wire       in_valid  = !rst && taken < N_VECTORS && (!stalls || noise[2:0] != 0);
  wire       out_ready = !stalls || noise[10:9] != 0;
  wire       in_ready, out_valid;
  inputs_t   inputs;
  outputs_t  outputs;

  // Nothing is driven without valid: x would come through where it is used all the same.
  assign inputs = in_valid ? inputs_of(words[taken]) : 'x;

  @NAME@_device device (
    .clk(clk), .rst(rst),
    .in_valid(in_valid), .in_ready(in_ready), .inputs(inputs),
    .out_valid(out_valid), .out_ready(out_ready), .outputs(outputs)
  );

  initial begin
    if (!$value$plusargs("words=%s", path)) path = "words.hex";
    if ($value$plusargs("got=%s", got_path)) begin
      got = $fopen(got_path, "w");
      if (got == 0) begin
        $display("ERROR %0s cannot be written", got_path);
        $fatal(1);
      end
    end
    if (!$value$plusargs("stop=%d", stop)) stop = 10;
    if (!$value$plusargs("timeout=%d", timeout)) timeout = 10000;
    outputs_only = $test$plusargs("outputs_only") != 0;
    stalls = $test$plusargs("stalls") != 0;
    if ($bits(inputs_t) != INPUT_BITS || $bits(outputs_t) != OUTPUT_BITS || $bits(word_t) != WORD_BITS) begin
      $display("ERROR the package's structures are not as long as its fields");
      $fatal(1);
    end
    $readmemh(path, words);
    // A simulator fills with x or with zeros what a file lacks, and cuts what is too long.
    for (int i = 0; i < N_VECTORS; i = i + 1)
      if (!is_whole(words[i])) begin
        $display("ERROR %0s: word %0d of %0d is missing or damaged; make the bench again", path, i, N_VECTORS);
        $fatal(1);
      end
    repeat (3) @(negedge clk);
    rst = 0;
  end

  always #1 clk = !clk;

  always @(posedge clk) begin
    noise <= {noise[14:0], noise[15] ^ noise[13] ^ noise[12] ^ noise[10]};
    if (in_valid && in_ready === 1'b1) taken <= taken + 1;
    if (!rst && out_valid === 1'b1 && out_ready) begin
      idle <= 0;
      if (checked == N_VECTORS) begin
        $display("ERROR an output after the last of %0d vectors", N_VECTORS);
        $fatal(1);
      end
      if (got != 0) $fdisplay(got, "%h", with_outputs(words[checked], outputs));
      differing = compare(checked, outputs_of(words[checked]), outputs, outputs_only, got != 0 && wrong >= stop);
      if (differing != 0) begin
        wrong = wrong + 1;
        if (wrong == stop && got == 0) begin
          $display("FAIL @SET@: %0d of %0d vectors differ, stopped there", wrong, checked + 1);
          $fatal(1);
        end
      end
      checked <= checked + 1;
    end else if (!rst) idle <= idle + 1;
    // A device that gives one output too many does so soon.
    if (checked == N_VECTORS && idle > 100) begin
      if (got != 0) $fclose(got);
      if (wrong == 0) begin
        $display("PASS @SET@: %0d vectors", checked);
        $finish;
      end else begin
        $display("FAIL @SET@: %0d of %0d vectors differ", wrong, checked);
        $fatal(1);
      end
    end else if (idle > timeout) begin
      $display("ERROR only %0d of %0d outputs came: none for %0d cycles", checked, N_VECTORS, timeout);
      $fatal(1);
    end
  end

endmodule
