`timescale 1ns/1ns
module cube_face_tb;
    `include "common.vh"

    wire [3*M-1:0] r_m = {w[REFLECTED_Z +: M], w[REFLECTED_Y +: M], w[REFLECTED_X +: M]};
    wire [2:0] face;
    wire signed [M-1:0] s, t;
    wire tie;
    cube_face #(.P(P), .K(K), .STEPS(STEPS), .SEEDS(`SEEDS)) dut (.r_m(r_m), .face(face), .s(s), .t(t), .tie(tie));

    initial begin
        start;
        for (i = 0; i < COUNT; i = i + 1) begin
            load(i);
            same("face", w[FACE +: 3], face);
            same("st_s", $signed(w[ST_S +: M]), s);
            same("st_t", $signed(w[ST_T +: M]), t);
            same("face_tie", w[STATUS + 4], tie);
        end
        report("cube_face");
    end
endmodule
