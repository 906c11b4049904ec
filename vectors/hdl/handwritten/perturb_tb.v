`timescale 1ns/1ns
module perturb_tb;
    `include "common.vh"

    // The field `frame` has the exponent of n in it; that of zeros is not the one inside.
    wire [3*M-1:0] t1_m = {w[FRAME_0_Z +: M], w[FRAME_0_Y +: M], w[FRAME_0_X +: M]};
    wire [3*M-1:0] t2_m = {w[FRAME_1_Z +: M], w[FRAME_1_Y +: M], w[FRAME_1_X +: M]};
    wire signed [15:0] f1_e = w[FRAME_0_E +: 16];
    wire signed [15:0] f2_e = w[FRAME_1_E +: 16];
    wire signed [EW-1:0] t1_e = t1_m == 0 ? -(1 << 15) : f1_e - n_e;
    wire signed [EW-1:0] t2_e = t2_m == 0 ? -(1 << 15) : f2_e - n_e;

    wire [3*M-1:0] mod_m;
    wire signed [EW-1:0] mod_e;
    wire mod_zero;
    wire signed [15:0] out_e;
    perturb #(.P(P), .EW(EW)) dut
        (.n_m(n_m), .n_e(n_e), .b1(w[OFFSET_1 +: M]), .b2(w[OFFSET_2 +: M]), .t1_m(t1_m), .t1_e(t1_e),
         .t2_m(t2_m), .t2_e(t2_e), .mod_m(mod_m), .mod_e(mod_e), .mod_zero(mod_zero));
    leave_exponent #(.EW(EW)) leave (.zero(mod_zero), .e(mod_e), .port_e(out_e));

    initial begin
        start;
        for (i = 0; i < COUNT; i = i + 1) begin
            load(i);
            same("normal_mod_x", $signed(w[NORMAL_MOD_X +: M]), $signed(mod_m[0 +: M]));
            same("normal_mod_y", $signed(w[NORMAL_MOD_Y +: M]), $signed(mod_m[M +: M]));
            same("normal_mod_z", $signed(w[NORMAL_MOD_Z +: M]), $signed(mod_m[2*M +: M]));
            same("normal_mod_e", $signed(w[NORMAL_MOD_E +: 16]), out_e);
            same("normal_zero", w[STATUS], n_zero);
        end
        report("perturb");
    end
endmodule
