// Blocks as Yosys uses them, for families of which it has no model of the block: multipliers without registers, memories.
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

// Lattice ECP5, the memory DP16KD without output registers and resets: 2048 units of 9 bits, two ports of 9 or 18 bits, or a write port A and a read port B
// of 36. Bits 0 to 17 of a line of INITVAL are two units, and there are sixteen lines of 20 bits. A unit that is read while the other port writes it is x,
// as in the device. All else has no model here: x comes out.
module ecp5_memory #(
  parameter ASYNC_RESET_RELEASE = "SYNC", CLKAMUX = "CLKA", CLKBMUX = "CLKB", CSDECODE_A = "0b000", CSDECODE_B = "0b000", GSR = "ENABLED",
  parameter REGMODE_A = "NOREG", REGMODE_B = "NOREG", RESETMODE = "SYNC", WRITEMODE_A = "NORMAL", WRITEMODE_B = "NORMAL",
  parameter DATA_WIDTH_A = 18, DATA_WIDTH_B = 18,
  parameter [319:0] INITVAL_00 = 320'd0, INITVAL_01 = 320'd0, INITVAL_02 = 320'd0, INITVAL_03 = 320'd0,
  parameter [319:0] INITVAL_04 = 320'd0, INITVAL_05 = 320'd0, INITVAL_06 = 320'd0, INITVAL_07 = 320'd0,
  parameter [319:0] INITVAL_08 = 320'd0, INITVAL_09 = 320'd0, INITVAL_0A = 320'd0, INITVAL_0B = 320'd0,
  parameter [319:0] INITVAL_0C = 320'd0, INITVAL_0D = 320'd0, INITVAL_0E = 320'd0, INITVAL_0F = 320'd0,
  parameter [319:0] INITVAL_10 = 320'd0, INITVAL_11 = 320'd0, INITVAL_12 = 320'd0, INITVAL_13 = 320'd0,
  parameter [319:0] INITVAL_14 = 320'd0, INITVAL_15 = 320'd0, INITVAL_16 = 320'd0, INITVAL_17 = 320'd0,
  parameter [319:0] INITVAL_18 = 320'd0, INITVAL_19 = 320'd0, INITVAL_1A = 320'd0, INITVAL_1B = 320'd0,
  parameter [319:0] INITVAL_1C = 320'd0, INITVAL_1D = 320'd0, INITVAL_1E = 320'd0, INITVAL_1F = 320'd0,
  parameter [319:0] INITVAL_20 = 320'd0, INITVAL_21 = 320'd0, INITVAL_22 = 320'd0, INITVAL_23 = 320'd0,
  parameter [319:0] INITVAL_24 = 320'd0, INITVAL_25 = 320'd0, INITVAL_26 = 320'd0, INITVAL_27 = 320'd0,
  parameter [319:0] INITVAL_28 = 320'd0, INITVAL_29 = 320'd0, INITVAL_2A = 320'd0, INITVAL_2B = 320'd0,
  parameter [319:0] INITVAL_2C = 320'd0, INITVAL_2D = 320'd0, INITVAL_2E = 320'd0, INITVAL_2F = 320'd0,
  parameter [319:0] INITVAL_30 = 320'd0, INITVAL_31 = 320'd0, INITVAL_32 = 320'd0, INITVAL_33 = 320'd0,
  parameter [319:0] INITVAL_34 = 320'd0, INITVAL_35 = 320'd0, INITVAL_36 = 320'd0, INITVAL_37 = 320'd0,
  parameter [319:0] INITVAL_38 = 320'd0, INITVAL_39 = 320'd0, INITVAL_3A = 320'd0, INITVAL_3B = 320'd0,
  parameter [319:0] INITVAL_3C = 320'd0, INITVAL_3D = 320'd0, INITVAL_3E = 320'd0, INITVAL_3F = 320'd0
) (
  input wire CLKA, CEA, OCEA, WEA, RSTA, CSA0, CSA1, CSA2, CLKB, CEB, OCEB, WEB, RSTB, CSB0, CSB1, CSB2,
  input wire ADA0, ADA1, ADA2, ADA3, ADA4, ADA5, ADA6, ADA7, ADA8, ADA9, ADA10, ADA11, ADA12, ADA13,
  input wire ADB0, ADB1, ADB2, ADB3, ADB4, ADB5, ADB6, ADB7, ADB8, ADB9, ADB10, ADB11, ADB12, ADB13,
  input wire DIA0, DIA1, DIA2, DIA3, DIA4, DIA5, DIA6, DIA7, DIA8, DIA9, DIA10, DIA11, DIA12, DIA13, DIA14, DIA15, DIA16, DIA17,
  input wire DIB0, DIB1, DIB2, DIB3, DIB4, DIB5, DIB6, DIB7, DIB8, DIB9, DIB10, DIB11, DIB12, DIB13, DIB14, DIB15, DIB16, DIB17,
  output wire DOA0, DOA1, DOA2, DOA3, DOA4, DOA5, DOA6, DOA7, DOA8, DOA9, DOA10, DOA11, DOA12, DOA13, DOA14, DOA15, DOA16, DOA17,
  output wire DOB0, DOB1, DOB2, DOB3, DOB4, DOB5, DOB6, DOB7, DOB8, DOB9, DOB10, DOB11, DOB12, DOB13, DOB14, DOB15, DOB16, DOB17
);
  localparam [20479:0] LINES = {
    INITVAL_3F, INITVAL_3E, INITVAL_3D, INITVAL_3C, INITVAL_3B, INITVAL_3A, INITVAL_39, INITVAL_38,
    INITVAL_37, INITVAL_36, INITVAL_35, INITVAL_34, INITVAL_33, INITVAL_32, INITVAL_31, INITVAL_30,
    INITVAL_2F, INITVAL_2E, INITVAL_2D, INITVAL_2C, INITVAL_2B, INITVAL_2A, INITVAL_29, INITVAL_28,
    INITVAL_27, INITVAL_26, INITVAL_25, INITVAL_24, INITVAL_23, INITVAL_22, INITVAL_21, INITVAL_20,
    INITVAL_1F, INITVAL_1E, INITVAL_1D, INITVAL_1C, INITVAL_1B, INITVAL_1A, INITVAL_19, INITVAL_18,
    INITVAL_17, INITVAL_16, INITVAL_15, INITVAL_14, INITVAL_13, INITVAL_12, INITVAL_11, INITVAL_10,
    INITVAL_0F, INITVAL_0E, INITVAL_0D, INITVAL_0C, INITVAL_0B, INITVAL_0A, INITVAL_09, INITVAL_08,
    INITVAL_07, INITVAL_06, INITVAL_05, INITVAL_04, INITVAL_03, INITVAL_02, INITVAL_01, INITVAL_00
  };
  localparam IS_WIDE = DATA_WIDTH_A == 36 && DATA_WIDTH_B == 36;
  localparam UNITS_A = DATA_WIDTH_A / 9, UNITS_B = DATA_WIDTH_B / 9;
  localparam IS_KNOWN = REGMODE_A == "NOREG" && REGMODE_B == "NOREG" && CLKAMUX == "CLKA" && CLKBMUX == "CLKB"
    && (IS_WIDE || ((DATA_WIDTH_A == 9 || DATA_WIDTH_A == 18) && (DATA_WIDTH_B == 9 || DATA_WIDTH_B == 18)))
    && WRITEMODE_A != "WRITETHROUGH" && WRITEMODE_B != "WRITETHROUGH";

  reg [8:0] memory [0:2047];
  integer unit;
  initial for (unit = 0; unit < 2048; unit = unit + 1) memory[unit] = LINES[unit / 2 * 20 + unit % 2 * 9 +: 9];

  // Units from the first one of the addressed word on. Bits of the address below a word are the enables of its bytes.
  wire [13:0] address_a = {ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5, ADA4, ADA3, ADA2, ADA1, ADA0};
  wire [13:0] address_b = {ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5, ADB4, ADB3, ADB2, ADB1, ADB0};
  wire [10:0] first_a = address_a[13:3] & ~(UNITS_A - 1);
  wire [10:0] first_b = address_b[13:3] & ~(UNITS_B - 1);
  wire [3:0] bytes_a = {4{CEA & WEA}} & (UNITS_A == 1 ? 4'd1 : UNITS_A == 2 ? {2'd0, address_a[1:0]} : address_a[3:0]);
  wire [3:0] bytes_b = {4{CEB & WEB & !IS_WIDE}} & (UNITS_B == 1 ? 4'd1 : {2'd0, address_b[1:0]});
  wire [17:0] in_a = {DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9, DIA8, DIA7, DIA6, DIA5, DIA4, DIA3, DIA2, DIA1, DIA0};
  wire [17:0] in_b = {DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9, DIB8, DIB7, DIB6, DIB5, DIB4, DIB3, DIB2, DIB1, DIB0};
  wire [35:0] written_a = {in_b, in_a};

  // A unit for a reader; x if the other port writes it.
  function [8:0] read(input [10:0] at, input [10:0] first, input [3:0] bytes);
    read = (bytes != 0 && at - first < 4 && bytes[at - first]) ? 9'bx : memory[at];
  endfunction

  reg [35:0] out_a = 0, out_b = 0;
  integer at;
  always @(posedge CLKA) begin
    if (CEA && !IS_WIDE && (!WEA || WRITEMODE_A == "READBEFOREWRITE"))
      for (at = 0; at < UNITS_A; at = at + 1) out_a[9 * at +: 9] <= read(first_a + at, first_b, bytes_b);
    for (at = 0; at < 4; at = at + 1) if (bytes_a[at]) memory[first_a + at] <= written_a[9 * at +: 9];
  end
  integer by;
  always @(posedge CLKB) begin
    if (CEB && (IS_WIDE || !WEB || WRITEMODE_B == "READBEFOREWRITE"))
      for (by = 0; by < UNITS_B; by = by + 1) out_b[9 * by +: 9] <= read(first_b + by, first_a, bytes_a);
    for (by = 0; by < 2; by = by + 1) if (bytes_b[by]) memory[first_b + by] <= in_b[9 * by +: 9];
  end

  wire is_right = IS_KNOWN && !(RSTA | RSTB | CSA0 | CSA1 | CSA2 | CSB0 | CSB1 | CSB2);
  assign {DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5, DOA4, DOA3, DOA2, DOA1, DOA0}
    = is_right ? (IS_WIDE ? out_b[17:0] : out_a[17:0]) : 18'bx;
  assign {DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5, DOB4, DOB3, DOB2, DOB1, DOB0}
    = is_right ? (IS_WIDE ? out_b[35:18] : out_b[17:0]) : 18'bx;
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
