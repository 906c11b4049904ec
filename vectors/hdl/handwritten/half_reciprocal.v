// SPEC section 5, "half_reciprocal": 1/(2x) of a mantissa x in [1/2, 1], in [1/2, 1].
// One Newton step y + y*(1 - 2xy), the residual shifted up by S before it is rounded to a mantissa.
module reciprocal_step #(parameter P = 20, parameter S = 7) (
    input  wire signed [P+1:0] x,
    input  wire signed [P+1:0] y,
    output wire signed [P+1:0] better
);
    localparam W    = P <= 14 ? 16 : 32;
    localparam F    = W - 2;
    localparam PAD  = 2*(F - P);            // zeros that full words have behind a product of kept mantissas
    localparam PW   = 2*P + 8;              // a product with room for sums
    localparam FW   = PW + PAD + 1;

    localparam signed [PW-1:0] ONE   = {{(PW-1){1'b0}}, 1'b1} << (2*P);
    localparam signed [PW-1:0] LIMIT = ONE >>> S;

    wire signed [PW-1:0] exact    = ONE - ((x * y) <<< 1);
    wire signed [PW-1:0] residual = exact > LIMIT ? LIMIT : exact < -LIMIT ? -LIMIT : exact;
    wire signed [PW+S-1:0] raised = {{S{residual[PW-1]}}, residual} <<< S;
    wire signed [PW+S-1:0] operand_wide = (raised + $signed({{(PW+S-1){1'b0}}, 1'b1} << (P-1))) >>> P;
    wire signed [P+1:0]  operand  = operand_wide[P+1:0];

    wire signed [PW-1:0] step     = y * operand;
    wire signed [FW-1:0] fine     = $signed({step[PW-1], step, {PAD{1'b0}}}) >>> S;     // 2F fraction bits, floored
    wire signed [FW-1:0] whole    = {{(FW-P-2){y[P+1]}}, y} <<< (2*F - P);
    wire signed [FW-1:0] sum      = whole + fine + ({{(FW-1){1'b0}}, 1'b1} << (2*F - P - 1));
    assign better = sum[2*F-P +: P+2];
endmodule

module half_reciprocal #(
    parameter P     = 20,
    parameter K     = 10,                   // index bits of the seeds
    parameter STEPS = 1,
    parameter SEEDS = "reciprocal_10.hex"   // words of 32 bits, 30 of them fraction bits
) (
    input  wire signed [P+1:0] x,
    output wire signed [P+1:0] h
);
    localparam F = (P <= 14 ? 16 : 32) - 2;
    localparam signed [P+1:0] ONE = {2'b01, {P{1'b0}}};

    reg [31:0] seed [0:(1<<K)-1];
    initial $readmemh(SEEDS, seed);

    wire signed [P+1:0] above = x - (ONE >>> 1);
    wire signed [P+1:0] place = above >>> (P - K - 1);
    wire [K-1:0] index = place < 0 ? {K{1'b0}} : place >= (1 << K) ? {K{1'b1}} : place[K-1:0];
    wire [31:0] word = seed[index];

    wire signed [P+1:0] y [0:STEPS];
    assign y[0] = word[31 -: P+2];
    genvar j;
    generate for (j = 0; j < STEPS; j = j + 1) begin : newton
        localparam UP = (K - 3) << j;
        reciprocal_step #(.P(P), .S(UP < F - 2 ? UP : F - 2)) refine (.x(x), .y(y[j]), .better(y[j+1]));
    end endgenerate
    assign h = y[STEPS] > ONE ? ONE : y[STEPS];
endmodule
