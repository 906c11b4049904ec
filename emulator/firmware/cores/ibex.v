// Ibex with a memory port for each of its buses. Its bus can ask again in the clock of an answer.
module top #(
    // Of ibex_pkg: 1 is bit-serial, 2 takes three clocks, 3 takes one.
    parameter integer RV32M = 2,
    parameter [0:0] BRANCH_TARGET_ALU = 0,
    parameter [0:0] WRITEBACK_STAGE = 0
) (
    input clk,
    input reset
);
    wire fetch, fetch_granted, fetched, request, granted, answered, writes;
    wire [31:0] fetch_address, fetch_word, address, data, word;
    wire [3:0] bytes;

    // The core begins 0x80 after the start of a page. The word there jumps to the start of the memory.
    reg begins;
    always @(posedge clk) if (fetch_granted) begins <= !fetch_address[31];

    ibex_top #(
        .RV32M(ibex_pkg::rv32m_e'(RV32M)),
        .BranchTargetALU(BRANCH_TARGET_ALU),
        .WritebackStage(WRITEBACK_STAGE)
    ) core (
        .clk_i(clk),
        .rst_ni(!reset),
        .test_en_i(1'b0),
        .scan_rst_ni(1'b1),
        .hart_id_i(32'd0),
        .boot_addr_i(32'h7fffff00),
        .instr_req_o(fetch),
        .instr_gnt_i(fetch_granted),
        .instr_rvalid_i(fetched),
        .instr_addr_o(fetch_address),
        .instr_rdata_i(begins ? 32'h0800006f : fetch_word),
        .instr_rdata_intg_i(7'd0),
        .instr_err_i(1'b0),
        .data_req_o(request),
        .data_gnt_i(granted),
        .data_rvalid_i(answered),
        .data_we_o(writes),
        .data_be_o(bytes),
        .data_addr_o(address),
        .data_wdata_o(data),
        .data_rdata_i(word),
        .data_rdata_intg_i(7'd0),
        .data_err_i(1'b0),
        .irq_software_i(1'b0),
        .irq_timer_i(1'b0),
        .irq_external_i(1'b0),
        .irq_fast_i(15'd0),
        .irq_nm_i(1'b0),
        .scramble_key_valid_i(1'b0),
        .debug_req_i(1'b0),
        .fetch_enable_i(ibex_pkg::IbexMuBiOn)
    );

    memory #(.OVERLAPS(1)) memory (
        .clk(clk),
        .reset(reset),
        .fetch(fetch),
        .fetch_address(fetch_address),
        .fetch_granted(fetch_granted),
        .fetched(fetched),
        .fetch_word(fetch_word),
        .request(request),
        .address(address),
        .data(data),
        .write(writes ? bytes : 4'd0),
        .granted(granted),
        .answered(answered),
        .word(word)
    );
endmodule

// Cells that a technology gives to the core.
module prim_buf #(
    parameter integer Width = 1
) (
    input  [Width-1:0] in_i,
    output [Width-1:0] out_o
);
    assign out_o = in_i;
endmodule

// The clock is never stopped.
module prim_clock_gating (
    input  clk_i,
    input  en_i,
    input  test_en_i,
    output clk_o
);
    assign clk_o = clk_i;
endmodule
