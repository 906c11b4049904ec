// SPEC section 3, "normalise": N integers with FB fraction bits and one exponent become a block.
// The block has P + 2 bit mantissas with P fraction bits, and the exponent -2^15 if all are zero.
module normalise #(
    parameter N  = 3,       // components
    parameter IW = 44,      // bits of an input component
    parameter FB = 40,      // its fraction bits
    parameter P  = 20,      // fraction bits kept in a mantissa
    parameter EW = 20       // bits of an exponent inside the datapath
) (
    input  wire [N*IW-1:0]      x,
    input  wire signed [EW-1:0] e,
    output reg  [N*(P+2)-1:0]   mantissas,
    output reg  signed [EW-1:0] exponent,
    output wire                 zero
);
    // Narrow inputs are widened, so that the rounding below always drops at least one bit.
    localparam AW   = IW > P + 2 ? IW : P + 2;
    localparam DROP = AW - 1 - P;

    reg [AW-1:0]      span;     // or of the magnitudes, negative ones as ~x
    reg signed [AW-1:0] part, left;
    reg signed [AW:0]   rounded;
    integer           i, top;   // top: bits of the longest component

    assign zero = (x == {N*IW{1'b0}});

    always @* begin
        span = {AW{1'b0}};
        for (i = 0; i < N; i = i + 1) begin
            part = $signed(x[i*IW +: IW]);
            span = span | (part ^ {AW{part[AW-1]}});
        end
        top = 0;
        for (i = 0; i < AW; i = i + 1)
            if (span[i]) top = i + 1;
        for (i = 0; i < N; i = i + 1) begin
            part    = $signed(x[i*IW +: IW]);
            left    = part <<< (AW - 1 - top);
            rounded = {left[AW-1], left} + {{(P+2){1'b0}}, 1'b1, {(DROP-1){1'b0}}};
            mantissas[i*(P+2) +: P+2] = rounded[AW : DROP];
        end
        exponent = zero ? -(1 << 15) : e + top - FB;
    end
endmodule
