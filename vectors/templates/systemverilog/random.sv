
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
