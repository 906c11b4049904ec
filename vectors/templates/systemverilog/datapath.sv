  import "DPI-C" function int roughxel_@NAME@(input int profile [PROFILE], input int unsigned effects,
    input int inputs [@LARGE@_IN], output int outputs [@LARGE@_OUT]);
  import "DPI-C" function int roughxel_@NAME@_input_range(input int profile [PROFILE],
    output int low [@LARGE@_IN], output int high [@LARGE@_IN]);
