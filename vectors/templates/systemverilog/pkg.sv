// @NAME@_pkg: the fields of the vector set @SET@ for a bench.
//
// @DESCRIPTION@
// set.json has unit and description of every field.

package @NAME@_pkg;

  localparam int N_VECTORS   = @COUNT@;
  localparam int WORD_BITS   = @WORD_BITS@;
  localparam int INPUT_BITS  = @INPUT_BITS@;
  localparam int OUTPUT_BITS = @OUTPUT_BITS@;
  // Of the file of words.
  localparam logic [255:0] SHA256 = 256'h@SHA256@;

  // A word as its file has it: every field on whole hex digits, the check value last.
  typedef logic [WORD_BITS-1:0] word_t;

  // What goes in, in the word's order.
  typedef struct packed {
@INPUT_MEMBERS@
  } inputs_t;

  // What comes out, earliest stage first.
  typedef struct packed {
@OUTPUT_MEMBERS@
  } outputs_t;

  // The inputs of a word.
  function automatic inputs_t inputs_of(input word_t word);
    inputs_of = {
@INPUT_PARTS@
    };
  endfunction

  // The outputs that belong to them.
  function automatic outputs_t outputs_of(input word_t word);
    outputs_of = {
@OUTPUT_PARTS@
    };
  endfunction

  // The word with other outputs; its check value stays.
  function automatic word_t with_outputs(input word_t word, input outputs_t outputs);
    with_outputs = word;
@OUTPUT_PLACES@
  endfunction

  // Whether a word was loaded whole: its last 32 bits are the CRC-32 of those above.
  function automatic logic is_whole(input word_t word);
    logic [31:0] crc;
    crc = 32'hffffffff;
    for (int i = WORD_BITS - 1; i >= 32; i = i - 1)
      crc = (crc << 1) ^ ((crc[31] ^ word[i]) ? 32'h04c11db7 : 32'h0);
    is_whole = crc === word[31:0];
  endfunction

  // The number of a field: its integer over 2^fraction_bits. Of a field beside an exponent that is the mantissa alone.
  function automatic real number(input longint integer_of_field, input int fraction_bits);
    number = (1.0 * integer_of_field) / (2.0 ** fraction_bits);
  endfunction

  // How many fields differ, taps aside with `outputs_only`; prints each, earliest stage first, if not `silent`.
  function automatic int compare(input int index, input outputs_t expected, input outputs_t got, input logic outputs_only,
                                 input logic silent);
    compare = 0;
    if (expected !== got) begin
@COMPARISONS@
    end
  endfunction

endpackage
