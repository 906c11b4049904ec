// SPEC section 6, "cube_face": the face that r meets and s, t on it.
module cube_face #(
    parameter P = 20, parameter K = 10, parameter STEPS = 1, parameter SEEDS = "reciprocal_10.hex"
) (
    input  wire [3*(P+2)-1:0]  r_m,
    output wire [2:0]          face,
    output wire signed [P+1:0] s,
    output wire signed [P+1:0] t,
    output wire signed [P+1:0] half_inverse,    // 1/(2m)
    output wire                tie
);
    localparam M = P + 2;

    wire signed [M-1:0] x = r_m[0 +: M];
    wire signed [M-1:0] y = r_m[M +: M];
    wire signed [M-1:0] z = r_m[2*M +: M];
    wire signed [M-1:0] ax = x < 0 ? -x : x;
    wire signed [M-1:0] ay = y < 0 ? -y : y;
    wire signed [M-1:0] az = z < 0 ? -z : z;

    // z wins a tie over y, y over x
    wire by_z = az >= ax && az >= ay;
    wire by_y = !by_z && ay >= ax;
    assign face = by_z ? {2'd2, z[M-1]} : by_y ? {2'd1, y[M-1]} : {2'd0, x[M-1]};
    assign tie  = by_z ? (ax >= az || ay >= az) : by_y ? (ax >= ay || az >= ay) : (ay >= ax || az >= ax);

    wire signed [M-1:0] m = by_z ? az : by_y ? ay : ax;
    reg  signed [M-1:0] sc, tc;
    always @*
        case (face)
            3'd0:    begin sc = -z; tc = -y; end
            3'd1:    begin sc =  z; tc = -y; end
            3'd2:    begin sc =  x; tc =  z; end
            3'd3:    begin sc =  x; tc = -z; end
            3'd4:    begin sc =  x; tc = -y; end
            default: begin sc = -x; tc = -y; end
        endcase

    half_reciprocal #(.P(P), .K(K), .STEPS(STEPS), .SEEDS(SEEDS)) inverse (.x(m), .h(half_inverse));

    function signed [M-1:0] quotient(input signed [M-1:0] c, input signed [M-1:0] h);
        reg signed [2*M-1:0] q;
        begin
            q = c * h;
            q = (q + $signed({{(2*M-1){1'b0}}, 1'b1} << (P - 2))) >>> (P - 1);
            quotient = q > (1 << P) ? (1 << P) : q < -(1 << P) ? -(1 << P) : q;
        end
    endfunction

    assign s = quotient(sc, half_inverse);
    assign t = quotient(tc, half_inverse);
endmodule
