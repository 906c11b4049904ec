// SPEC section 6, "reflect": r = 2n<v.n> - v|n|^2 with the modified normal n.
module reflect #(parameter P = 20, parameter EW = 20) (
    input  wire [3*(P+2)-1:0]   n_m,
    input  wire signed [EW-1:0] n_e,
    input  wire [3*(P+2)-1:0]   v_m,
    input  wire signed [EW-1:0] v_e,
    output wire [3*(P+2)-1:0]   r_m,
    output wire signed [EW-1:0] r_e,
    output wire                 r_zero,
    output wire [2*(P+2)-1:0]   scalars_m,      // <v.n> lowest, |n|^2
    output wire signed [EW-1:0] scalars_e,
    output wire                 below
);
    localparam M  = P + 2;
    localparam PW = 2*M;            // 2P fraction bits and values below 8

    function signed [PW-1:0] dot(input [3*M-1:0] a, input [3*M-1:0] b);
        reg signed [M-1:0] x, y;
        integer i;
        begin
            dot = 0;
            for (i = 0; i < 3; i = i + 1) begin
                x = a[i*M +: M];
                y = b[i*M +: M];
                dot = dot + x * y;
            end
        end
    endfunction

    wire signed [PW-1:0] vn = dot(v_m, n_m);
    wire signed [PW-1:0] nn = dot(n_m, n_m);
    wire                 scalars_zero;
    wire signed [M-1:0]  along  = scalars_m[0 +: M];
    wire signed [M-1:0]  square = scalars_m[M +: M];

    wire [3*PW-1:0] exact;
    genvar a;
    generate for (a = 0; a < 3; a = a + 1) begin : axis
        wire signed [M-1:0] n = n_m[a*M +: M];
        wire signed [M-1:0] v = v_m[a*M +: M];
        wire signed [PW-1:0] twice = (n * along) <<< 1;
        wire signed [PW-1:0] back  = v * square;
        assign exact[a*PW +: PW] = twice - back;
    end endgenerate

    assign below = vn <= 0;
    normalise #(.N(2), .IW(PW), .FB(2*P), .P(P), .EW(EW)) scalars
        (.x({nn, vn}), .e({EW{1'b0}}), .mantissas(scalars_m), .exponent(scalars_e), .zero(scalars_zero));
    normalise #(.N(3), .IW(PW), .FB(2*P), .P(P), .EW(EW)) round
        (.x(exact), .e(scalars_e + v_e + (n_e <<< 1)), .mantissas(r_m), .exponent(r_e), .zero(r_zero));
endmodule
