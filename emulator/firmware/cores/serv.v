// SERV, which computes one bit a clock, with a memory port for each of its buses.
module top (
    input clk,
    input reset
);
    wire fetch, fetched, request, writes, answered;
    wire [31:0] fetch_address, fetch_word, address, data, word;
    wire [3:0] bytes;

    serv_rf_top #(
        .RESET_PC(32'h80000000),
        .WITH_CSR(0)
    ) core (
        .clk(clk),
        .i_rst(reset),
        .i_timer_irq(1'b0),
        .o_ibus_adr(fetch_address),
        .o_ibus_cyc(fetch),
        .i_ibus_rdt(fetch_word),
        .i_ibus_ack(fetched),
        .o_dbus_adr(address),
        .o_dbus_dat(data),
        .o_dbus_sel(bytes),
        .o_dbus_we(writes),
        .o_dbus_cyc(request),
        .i_dbus_rdt(word),
        .i_dbus_ack(answered),
        .i_ext_rd(32'd0),
        .i_ext_ready(1'b0)
    );

    memory memory (
        .clk(clk),
        .reset(reset),
        .fetch(fetch),
        .fetch_address(fetch_address),
        .fetched(fetched),
        .fetch_word(fetch_word),
        .request(request),
        .address(address),
        .data(data),
        .write(writes ? bytes : 4'd0),
        .answered(answered),
        .word(word)
    );
endmodule
