`timescale 1ns/1ns
// normalise has no fields of its own: where a vector has no offset, normal_mod is the entered normal. For p = 20 the
// worked numbers of SPEC section 3 come behind, through a module of 2 components of 64 bits.
module normalise_tb;
    `include "common.vh"

    wire signed [15:0] out_e;
    leave_exponent #(.EW(EW)) leave (.zero(n_zero), .e(n_e), .port_e(out_e));

    reg signed [63:0] x0, x1;
    reg signed [EW-1:0] e;
    wire [2*M-1:0] m;
    wire signed [EW-1:0] y_e;
    wire y_zero;
    normalise #(.N(2), .IW(64), .FB(30), .P(P), .EW(EW)) dut
        (.x({x1, x0}), .e(e), .mantissas(m), .exponent(y_e), .zero(y_zero));

    task worked(input signed [63:0] a, input signed [63:0] b, input signed [39:0] e_in, input signed [39:0] c,
                input signed [39:0] d, input signed [39:0] e_out);
        begin
            x0 = a; x1 = b; e = e_in;
            #1;
            same("worked 0", c >>> (30 - P), $signed(m[0 +: M]));
            same("worked 1", d >>> (30 - P), $signed(m[M +: M]));
            same("worked e", e_out, y_e);
        end
    endtask

    initial begin
        start;
        for (i = 0; i < COUNT; i = i + 1)
            if (words[i][OFFSET_1 +: M] == 0 && words[i][OFFSET_2 +: M] == 0) begin
                load(i);
                same("normal_mod_x", $signed(w[NORMAL_MOD_X +: M]), $signed(n_m[0 +: M]));
                same("normal_mod_y", $signed(w[NORMAL_MOD_Y +: M]), $signed(n_m[M +: M]));
                same("normal_mod_z", $signed(w[NORMAL_MOD_Z +: M]), $signed(n_m[2*M +: M]));
                same("normal_mod_e", $signed(w[NORMAL_MOD_E +: 16]), out_e);
            end
        if (P == 20) begin
            vectors = vectors + 6;
            i = -1;
            worked(3, -2, 35, 3 << 28, -1 << 29, 7);
            worked((1 << 30) - 1, 0, 0, 1 << 30, 0, 0);
            worked(-(1 << 30), 1 << 29, 0, -(1 << 30), 1 << 29, 0);
            worked(1 << 30, 0, 0, 1 << 29, 0, 1);
            worked(-1, 0, -27, -(1 << 30), 0, -57);
            worked(0, 0, 3, 0, 0, -32768);
        end
        report("normalise");
    end
endmodule
