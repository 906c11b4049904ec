// Multiplier blocks without registers, as Yosys uses them, for families of which it has no model of the block.
`default_nettype none

// Lattice ECP5. A block with registers or a chain has no model here: x comes out.
module MULT18X18D #(
  parameter REG_INPUTA_CLK = "NONE", REG_INPUTB_CLK = "NONE", REG_INPUTC_CLK = "NONE", REG_PIPELINE_CLK = "NONE", REG_OUTPUT_CLK = "NONE"
) (
  input wire A0, A1, A2, A3, A4, A5, A6, A7, A8, A9, A10, A11, A12, A13, A14, A15, A16, A17,
  input wire B0, B1, B2, B3, B4, B5, B6, B7, B8, B9, B10, B11, B12, B13, B14, B15, B16, B17,
  input wire C0, C1, C2, C3, C4, C5, C6, C7, C8, C9, C10, C11, C12, C13, C14, C15, C16, C17,
  input wire SIGNEDA, SIGNEDB, SOURCEA, SOURCEB,
  output wire P0, P1, P2, P3, P4, P5, P6, P7, P8, P9, P10, P11, P12, P13, P14, P15, P16, P17,
  output wire P18, P19, P20, P21, P22, P23, P24, P25, P26, P27, P28, P29, P30, P31, P32, P33, P34, P35
);
  localparam IS_PLAIN = REG_INPUTA_CLK == "NONE" && REG_INPUTB_CLK == "NONE" && REG_PIPELINE_CLK == "NONE" && REG_OUTPUT_CLK == "NONE";
  wire [17:0] a = {A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0};
  wire [17:0] b = {B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0};
  wire signed [35:0] product = $signed({SIGNEDA & A17, a}) * $signed({SIGNEDB & B17, b});
  assign {P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18,
          P17, P16, P15, P14, P13, P12, P11, P10, P9, P8, P7, P6, P5, P4, P3, P2, P1, P0}
    = (IS_PLAIN && !SOURCEA && !SOURCEB) ? product : 36'bx;
endmodule

// Gowin, each width.
module gowin_multiplier #(parameter WIDTH = 18) (
  input wire [WIDTH-1:0] A, B, input wire ASIGN, BSIGN, output wire [2*WIDTH-1:0] DOUT
);
  wire signed [2*WIDTH-1:0] product = $signed({ASIGN & A[WIDTH-1], A}) * $signed({BSIGN & B[WIDTH-1], B});
  assign DOUT = product;
endmodule

module MULT9X9 (
  input wire [8:0] A, B, SIA, SIB, input wire ASIGN, BSIGN, ASEL, BSEL, CE, CLK, RESET, output wire [17:0] DOUT
);
  gowin_multiplier #(.WIDTH(9)) u (.A(A), .B(B), .ASIGN(ASIGN), .BSIGN(BSIGN), .DOUT(DOUT));
endmodule

module MULT18X18 (
  input wire [17:0] A, B, SIA, SIB, input wire ASIGN, BSIGN, ASEL, BSEL, CE, CLK, RESET, output wire [35:0] DOUT
);
  gowin_multiplier #(.WIDTH(18)) u (.A(A), .B(B), .ASIGN(ASIGN), .BSIGN(BSIGN), .DOUT(DOUT));
endmodule

module MULT36X36 (
  input wire [35:0] A, B, input wire ASIGN, BSIGN, CE, CLK, RESET, output wire [71:0] DOUT
);
  gowin_multiplier #(.WIDTH(36)) u (.A(A), .B(B), .ASIGN(ASIGN), .BSIGN(BSIGN), .DOUT(DOUT));
endmodule

`default_nettype wire
