// PicoRV32 with one memory. The parameters are the core's own.
module top #(
    parameter [0:0] BARREL_SHIFTER = 0,
    parameter [0:0] TWO_STAGE_SHIFT = 1,
    parameter [0:0] ENABLE_MUL = 0,
    parameter [0:0] ENABLE_FAST_MUL = 0
) (
    input clk,
    input reset
);
    wire trap, valid, ready;
    wire [31:0] address, data, word;
    wire [3:0] write;

    picorv32 #(
        .BARREL_SHIFTER(BARREL_SHIFTER),
        .TWO_STAGE_SHIFT(TWO_STAGE_SHIFT),
        .ENABLE_MUL(ENABLE_MUL),
        .ENABLE_FAST_MUL(ENABLE_FAST_MUL),
        .ENABLE_DIV(ENABLE_MUL | ENABLE_FAST_MUL),
        .PROGADDR_RESET(32'h80000000)
    ) core (
        .clk(clk),
        .resetn(!reset),
        .trap(trap),
        .mem_valid(valid),
        .mem_ready(ready),
        .mem_addr(address),
        .mem_wdata(data),
        .mem_wstrb(write),
        .mem_rdata(word),
        .pcpi_wr(1'b0),
        .pcpi_rd(32'd0),
        .pcpi_wait(1'b0),
        .pcpi_ready(1'b0),
        .irq(32'd0)
    );

    memory memory (
        .clk(clk),
        .reset(reset),
        .fetch(1'b0),
        .fetch_address(32'd0),
        .request(valid),
        .address(address),
        .data(data),
        .write(write),
        .answered(ready),
        .word(word)
    );

    always @(posedge clk) if (trap && !reset) $fatal(1, "the core trapped");
endmodule
