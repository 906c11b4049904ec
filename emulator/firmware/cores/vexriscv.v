// VexRiscv with a memory port for each of its Wishbone buses.
module top (
    input clk,
    input reset
);
    wire fetch, fetched, strobe, writes, answered;
    wire [29:0] fetch_place, place;
    wire [31:0] fetch_word, word, data;
    wire [3:0] bytes;

    VexRiscv core (
        .clk(clk),
        .reset(reset),
        .externalResetVector(32'h80000000),
        .timerInterrupt(1'b0),
        .softwareInterrupt(1'b0),
        .externalInterruptArray(32'd0),
        .iBusWishbone_STB(fetch),
        .iBusWishbone_ADR(fetch_place),
        .iBusWishbone_ACK(fetched),
        .iBusWishbone_DAT_MISO(fetch_word),
        .iBusWishbone_ERR(1'b0),
        .dBusWishbone_STB(strobe),
        .dBusWishbone_WE(writes),
        .dBusWishbone_ADR(place),
        .dBusWishbone_SEL(bytes),
        .dBusWishbone_DAT_MOSI(data),
        .dBusWishbone_ACK(answered),
        .dBusWishbone_DAT_MISO(word),
        .dBusWishbone_ERR(1'b0)
    );

    memory memory (
        .clk(clk),
        .reset(reset),
        .fetch(fetch),
        .fetch_address({fetch_place, 2'd0}),
        .fetched(fetched),
        .fetch_word(fetch_word),
        .request(strobe),
        .address({place, 2'd0}),
        .data(data),
        .write(writes ? bytes : 4'd0),
        .answered(answered),
        .word(word)
    );
endmodule
