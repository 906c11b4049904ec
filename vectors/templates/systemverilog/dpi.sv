// @NAME@_dpi: drives @NAME@_device with random inputs and compares every field with what the C library computes, by DPI-C.
//
// For Verilator (--binary --timing), with roughxel_dpi.sv and the library; `sh run.sh dpi` has the command line. Arguments:
//   +words=FILE     the words (words.hex), which half of the inputs are near to
//   +count=N        inputs (100000)
//   +seed=N         of the random inputs (1)
//   +stop=N         ends at the N-th input that differs (10)
//   +outputs_only   compares what leaves the datapath alone, for a device that does not show its stages
//   +stalls         both sides of the handshake pause at random
//   +timeout=N      cycles without an output after which it gives up (10000)
// Prints PASS, or each difference and FAIL; ERROR where the comparison could not be made.

module @NAME@_dpi;

  import @NAME@_pkg::*;
  import roughxel_dpi::*;

  localparam int INPUTS = @INPUTS@;
  // The accuracy and the effects of the set.
  localparam profile_t KNOBS = '{@KNOBS@};
  localparam int unsigned EFFECTS = @EFFECTS@;

  word_t     words [0:N_VECTORS-1];
  string     path;
  int        count, stop, timeout;
  int unsigned seed;
  logic      outputs_only, stalls;
  logic      clk = 0;
  logic      rst = 1;
  logic [15:0] noise = 16'hace1;
  @DATAPATH@_in_t low, high;
  int        error;
  int unsigned state;
  int        taken = 0;
  int        checked = 0;
  int        wrong = 0;
  int        idle = 0;
  inputs_t   waiting_inputs [$];
  outputs_t  waiting_outputs [$];

  wire       in_valid  = !rst && taken < count && (!stalls || noise[2:0] != 0);
  wire       out_ready = !stalls || noise[10:9] != 0;
  wire       in_ready, out_valid;
  inputs_t   next;
  inputs_t   inputs;
  outputs_t  outputs;

  // Nothing is driven without valid: x would come through where it is used all the same.
  assign inputs = in_valid ? next : 'x;

  @NAME@_device device (
    .clk(clk), .rst(rst),
    .in_valid(in_valid), .in_ready(in_ready), .inputs(inputs),
    .out_valid(out_valid), .out_ready(out_ready), .outputs(outputs)
  );

  function automatic int unsigned random();
    state = next_random(state);
    random = state;
  endfunction

  // A random number within the range of the input at this place.
  function automatic int random_input(input int place);
    int unsigned value, shape;
    value = random();
    shape = random();
    random_input = random_within(low[place], high[place], value, shape);
  endfunction

  // Every other time all inputs are random; else they are those of a vector with one changed: numbers that fit together, near which
  // decisions turn.
  function automatic inputs_t drawn();
    int unsigned word, which;
    word = random() % N_VECTORS;
    which = random() % (2 * INPUTS);
    drawn = inputs_of(words[word]);
@DRAWN@
  endfunction

  // What the library computes of these inputs.
  function automatic outputs_t computed(input inputs_t inputs);
    @DATAPATH@_in_t given;
    @DATAPATH@_out_t results;
    int error;
    for (int i = 0; i < @DATAPATH_CAPITALS@_IN; i = i + 1) given[i] = 0;
@GIVEN@
    error = roughxel_@DATAPATH@(KNOBS, EFFECTS, given, results);
    if (error != OK) begin
      $display("ERROR the C library refuses an input: %0s (%0d)", roughxel_error_text(error), error >> ERROR_BITS);
      $fatal(1);
    end
@RESULTS@
  endfunction

  // The inputs of a device that was wrong, in the order of the word.
  function automatic void show(input int index, input inputs_t inputs);
    $write("@SET@ #%0d of seed %0d: inputs", index, seed);
@SHOWN@
    $display("");
  endfunction

  initial begin
    if (!$value$plusargs("words=%s", path)) path = "words.hex";
    if (!$value$plusargs("count=%d", count)) count = 100000;
    if (!$value$plusargs("seed=%d", seed)) seed = 1;
    if (!$value$plusargs("stop=%d", stop)) stop = 10;
    if (!$value$plusargs("timeout=%d", timeout)) timeout = 10000;
    outputs_only = $test$plusargs("outputs_only") != 0;
    stalls = $test$plusargs("stalls") != 0;
    if (roughxel_version() != VERSION) begin
      $display("ERROR the C library is version %0d, roughxel_dpi.sv %0d; make both anew", roughxel_version(), VERSION);
      $fatal(1);
    end
    $readmemh(path, words);
    for (int i = 0; i < N_VECTORS; i = i + 1)
      if (!is_whole(words[i])) begin
        $display("ERROR %0s: word %0d of %0d is missing or damaged; make the bench again", path, i, N_VECTORS);
        $fatal(1);
      end
    error = roughxel_@DATAPATH@_input_range(KNOBS, low, high);
    if (error != OK) begin
      $display("ERROR the C library refuses the profile: %0s (%0d)", roughxel_error_text(error), error >> ERROR_BITS);
      $fatal(1);
    end
    // The sequence stands still at 0.
    state = seed ^ 32'h9e3779b9;
    if (state == 0) state = 1;
    next = drawn();
    repeat (3) @(negedge clk);
    rst = 0;
  end

  always #1 clk = !clk;

  always @(posedge clk) begin
    noise <= {noise[14:0], noise[15] ^ noise[13] ^ noise[12] ^ noise[10]};
    if (in_valid && in_ready === 1'b1) begin
      taken <= taken + 1;
      waiting_inputs.push_back(next);
      waiting_outputs.push_back(computed(next));
      next <= drawn();
    end
    if (!rst && out_valid === 1'b1 && out_ready) begin
      idle <= 0;
      if (waiting_outputs.size() == 0) begin
        $display("ERROR an output that no input belongs to, after %0d", checked);
        $fatal(1);
      end
      if (compare(checked, waiting_outputs[0], outputs, outputs_only, 1'b0) != 0) begin
        show(checked, waiting_inputs[0]);
        wrong = wrong + 1;
        if (wrong == stop) begin
          $display("FAIL @SET@: %0d of %0d random inputs differ, stopped there", wrong, checked + 1);
          $fatal(1);
        end
      end
      void'(waiting_inputs.pop_front());
      void'(waiting_outputs.pop_front());
      checked <= checked + 1;
    end else if (!rst) idle <= idle + 1;
    // A device that gives one output too many does so soon.
    if (checked == count && idle > 100) begin
      if (wrong == 0) begin
        $display("PASS @SET@: %0d random inputs of seed %0d", checked, seed);
        $finish;
      end else begin
        $display("FAIL @SET@: %0d of %0d random inputs differ", wrong, checked);
        $fatal(1);
      end
    end else if (idle > timeout) begin
      $display("ERROR only %0d of %0d outputs came: none for %0d cycles", checked, count, timeout);
      $fatal(1);
    end
  end

endmodule
