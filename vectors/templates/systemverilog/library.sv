// roughxel_dpi: the scalar datapaths of roughxel as functions of SystemVerilog, by DPI-C from the C library.
//
// `roughxel vectors c` writes this file; roughxel.h beside it says what every number is, vectors/README.md how the library is built
// and linked. Structures of the header are arrays of int here, their members places with names. Every function returns OK or an
// error: its kind in the lowest ERROR_BITS bits, above them the place of the number that is wrong. With an error what it would have
// written means nothing.

package roughxel_dpi;

  // Of this package; roughxel_version() is that of the library.
  localparam int VERSION = @VERSION@;

@ERRORS@
  localparam int ERROR_BITS = @ERROR_BITS@;

  // Effects that are on, a sum of:
@EFFECTS@

@STRUCTURES@

  import "DPI-C" function int roughxel_version();
  import "DPI-C" function string roughxel_error_text(input int error);
  import "DPI-C" function int roughxel_profile_named(input string name, output int profile [PROFILE]);

@DATAPATHS@

  // The next number of a sequence that every simulator draws alike; from any state but 0.
  function automatic int unsigned next_random(input int unsigned state);
    next_random = state ^ (state << 13);
    next_random = next_random ^ (next_random >> 17);
    next_random = next_random ^ (next_random << 5);
  endfunction

  // A number within a range, made of two random ones: an end or 0, anything, or mostly anything of any number of bits.
  function automatic int random_within(input int low, input int high, input int unsigned value, input int unsigned shape);
    longint unsigned count;
    longint number;
    count = 64'(longint'(high) - longint'(low) + 1);
    number = longint'(low) + longint'({32'd0, value} % count);
    if (shape[2:0] == 0) begin
      case (shape[4:3])
        0: number = longint'(low);
        1: number = longint'(high);
        2: number = 0;
        default: number = 1;
      endcase
    end else if (shape[2:0] > 2) number = number >>> shape[9:5];
    if (number < longint'(low)) number = longint'(low);
    if (number > longint'(high)) number = longint'(high);
    random_within = int'(number);
  endfunction

endpackage
