// SPEC section 6, "leave": the exponent of a block as a port shows it.
module leave_exponent #(parameter EW = 20) (
    input  wire                 zero,
    input  wire signed [EW-1:0] e,
    output wire signed [15:0]   port_e
);
    assign port_e = zero ? 0 : e > 32767 ? 32767 : e < -32768 ? -32768 : e;
endmodule
