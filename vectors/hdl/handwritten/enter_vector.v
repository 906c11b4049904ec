// SPEC section 6, "enter": a port's vector to a block; its exponent is read within +-2^11.
module enter_vector #(parameter P = 20, parameter EW = 20) (
    input  wire [3*(P+2)-1:0]   port,
    input  wire signed [15:0]   port_e,
    output wire [3*(P+2)-1:0]   m,
    output wire signed [EW-1:0] e,
    output wire                 zero
);
    wire signed [EW-1:0] near = port_e > 2048 ? 2048 : port_e < -2048 ? -2048 : port_e;
    normalise #(.N(3), .IW(P+2), .FB(P), .P(P), .EW(EW)) block
        (.x(port), .e(near), .mantissas(m), .exponent(e), .zero(zero));
endmodule
