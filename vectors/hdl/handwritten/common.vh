// Part of every bench: the words of a set, their check values, and the comparison of a field.
`include "fields.vh"
localparam M = P + 2;
localparam EW = 20;

reg [WORD_BITS-1:0] words [0:COUNT-1];
reg [WORD_BITS-1:0] w;
integer i, place, compared, wrong, damaged, vectors;
reg [31:0] crc;

task load(input integer index);
    begin
        w = words[index];
        crc = 32'hffffffff;
        for (place = WORD_BITS - 1; place >= 32; place = place - 1)
            crc = (crc << 1) ^ ((crc[31] ^ w[place]) ? 32'h04c11db7 : 32'h0);
        if (crc !== w[31:0]) begin
            damaged = damaged + 1;
            $display("%s: vector %0d: damaged word", `SET_NAME, index);
        end
        vectors = vectors + 1;
        #1;
    end
endtask

task same(input [8*16-1:0] field, input signed [39:0] expected, input signed [39:0] got);
    begin
        compared = compared + 1;
        if (expected !== got) begin
            wrong = wrong + 1;
            if (wrong <= 8)
                $display("%s: vector %0d: %0s: expected %0d (%h), got %0d (%h)", `SET_NAME, i, field,
                         expected, expected, got, got);
        end
    end
endtask

task start;
    begin
        compared = 0; wrong = 0; damaged = 0; vectors = 0;
        $readmemh(`WORDS, words);
    end
endtask

task report(input [8*16-1:0] stage);
    begin
        $display("%s %0s %s: %0d vectors, %0d fields compared, %0d wrong, %0d words damaged",
                 vectors == 0 ? "NONE" : wrong == 0 && damaged == 0 ? "PASS" : "FAIL", stage, `SET_NAME, vectors,
                 compared, wrong, damaged);
        $finish;
    end
endtask

// The normal as entered, which no field holds.
wire [3*M-1:0] n_m;
wire signed [EW-1:0] n_e;
wire n_zero;
enter_vector #(.P(P), .EW(EW)) enter_normal
    (.port({w[NORMAL_Z +: M], w[NORMAL_Y +: M], w[NORMAL_X +: M]}), .port_e(w[NORMAL_E +: 16]),
     .m(n_m), .e(n_e), .zero(n_zero));
