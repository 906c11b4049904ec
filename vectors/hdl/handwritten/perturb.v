// SPEC section 6, "perturb": n + b1*E1 + b2*E2. Vectors are packed, component x lowest.
module perturb #(parameter P = 20, parameter EW = 20) (
    input  wire [3*(P+2)-1:0]   n_m,
    input  wire signed [EW-1:0] n_e,
    input  wire signed [P+1:0]  b1,             // P - 2 fraction bits
    input  wire signed [P+1:0]  b2,
    input  wire [3*(P+2)-1:0]   t1_m,           // E1 and E2, in units of the mantissas of n
    input  wire signed [EW-1:0] t1_e,
    input  wire [3*(P+2)-1:0]   t2_m,
    input  wire signed [EW-1:0] t2_e,
    output wire [3*(P+2)-1:0]   mod_m,
    output wire signed [EW-1:0] mod_e,
    output wire                 mod_zero
);
    localparam M   = P + 2;
    localparam W   = P <= 14 ? 16 : 32;
    localparam F   = W - 2;
    localparam PAD = 2*(F - P);
    localparam TW  = 2*W;                       // a term, with 2W - 7 fraction bits
    localparam signed [EW-1:0] NEVER = -(1 << 15);

    wire n_zero = (n_m == 0);
    wire flat   = (b1 == 0) && (b2 == 0);

    // Only terms that are not zero have a say in the common exponent.
    wire signed [EW-1:0] e1   = b1 == 0 ? NEVER : t1_e;
    wire signed [EW-1:0] e2   = b2 == 0 ? NEVER : t2_e;
    wire signed [EW-1:0] e0   = n_zero ? NEVER : {EW{1'b0}};
    wire signed [EW-1:0] e12  = e1 > e2 ? e1 : e2;
    wire signed [EW-1:0] top  = e12 > e0 ? e12 : e0;

    // floor(x / 2^k), where a k below 0 counts as 0 and one beyond the width leaves the sign
    function signed [TW-1:0] floored(input signed [TW-1:0] x, input signed [EW-1:0] k);
        floored = x >>> (k <= 0 ? 0 : k >= TW ? TW - 1 : k);
    endfunction

    wire [3*TW-1:0] total;
    genvar a;
    generate for (a = 0; a < 3; a = a + 1) begin : axis
        wire signed [M-1:0]   n  = n_m[a*M +: M];
        wire signed [M-1:0]   p1 = t1_m[a*M +: M];
        wire signed [M-1:0]   p2 = t2_m[a*M +: M];
        wire signed [2*M-1:0] q1 = b1 * p1;
        wire signed [2*M-1:0] q2 = b2 * p2;
        wire signed [TW-1:0]  x0 = {{(TW-M){n[M-1]}}, n} <<< (2*W - 7 - P);
        wire signed [TW-1:0]  x1 = $signed({q1, {PAD{1'b0}}}) >>> 1;
        wire signed [TW-1:0]  x2 = $signed({q2, {PAD{1'b0}}}) >>> 1;
        assign total[a*TW +: TW] = floored(x0, top) + floored(x1, top - e1) + floored(x2, top - e2);
    end endgenerate

    wire [3*M-1:0]       sum_m;
    wire signed [EW-1:0] sum_e;
    wire                 sum_zero;
    normalise #(.N(3), .IW(TW), .FB(2*W - 7), .P(P), .EW(EW)) round
        (.x(total), .e(top + n_e), .mantissas(sum_m), .exponent(sum_e), .zero(sum_zero));

    assign mod_m    = flat ? n_m : sum_m;
    assign mod_e    = flat ? n_e : sum_e;
    assign mod_zero = flat ? n_zero : sum_zero;
endmodule
