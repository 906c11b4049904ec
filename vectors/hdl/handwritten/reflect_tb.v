`timescale 1ns/1ns
module reflect_tb;
    `include "common.vh"

    wire [3*M-1:0] v_m;
    wire signed [EW-1:0] v_e;
    wire v_zero;
    enter_vector #(.P(P), .EW(EW)) enter_view
        (.port({w[VIEW_Z +: M], w[VIEW_Y +: M], w[VIEW_X +: M]}), .port_e(w[VIEW_E +: 16]),
         .m(v_m), .e(v_e), .zero(v_zero));

    wire [3*M-1:0] mod_m = {w[NORMAL_MOD_Z +: M], w[NORMAL_MOD_Y +: M], w[NORMAL_MOD_X +: M]};
    wire signed [15:0] field_e = w[NORMAL_MOD_E +: 16];
    wire signed [EW-1:0] mod_e = mod_m == 0 ? -(1 << 15) : field_e;

    wire [3*M-1:0] r_m;
    wire signed [EW-1:0] r_e;
    wire r_zero, below;
    wire signed [15:0] out_e;
    reflect #(.P(P), .EW(EW)) dut
        (.n_m(mod_m), .n_e(mod_e), .v_m(v_m), .v_e(v_e), .r_m(r_m), .r_e(r_e), .r_zero(r_zero), .below(below));
    leave_exponent #(.EW(EW)) leave (.zero(r_zero), .e(r_e), .port_e(out_e));

    initial begin
        start;
        for (i = 0; i < COUNT; i = i + 1) begin
            load(i);
            same("reflected_x", $signed(w[REFLECTED_X +: M]), $signed(r_m[0 +: M]));
            same("reflected_y", $signed(w[REFLECTED_Y +: M]), $signed(r_m[M +: M]));
            same("reflected_z", $signed(w[REFLECTED_Z +: M]), $signed(r_m[2*M +: M]));
            same("reflected_e", $signed(w[REFLECTED_E +: 16]), out_e);
            same("view_zero", w[STATUS + 1], v_zero);
            same("view_below", w[STATUS + 3], below);
        end
        report("reflect");
    end
endmodule
