// Block RAM with two ports, which answers one clock after a request, and the two devices that a program needs. +waits=N adds N clocks to each answer.
//
// A store to the finisher (0x00100000) marks the begin (1) or the end (2) of a measured part, prints the clocks since the last begin (3), or prints
// the clocks of all parts and ends the simulation (0x5555).
// A store to the serial port (0x10000000) prints a character. Everything else is memory.
module memory #(
    // 1: a request in the clock of an answer is a new one. 0: it is the answered one.
    parameter [0:0] OVERLAPS = 0
) (
    input             clk,
    input             reset,
    // Words to read: instructions, if a core has a bus for them.
    input             fetch,
    input      [31:0] fetch_address,
    output            fetch_granted,
    output reg        fetched,
    output reg [31:0] fetch_word,
    // Words to read and write. Each bit of `write` is a byte; none is a read.
    input             request,
    input      [31:0] address,
    input      [31:0] data,
    input      [3:0]  write,
    output            granted,
    output reg        answered,
    output reg [31:0] word
);
    // 256 KiB.
    reg [31:0] words [0:65535];
    reg [8*512-1:0] image;
    reg [7:0] waits = 0;
    initial begin
        if ($value$plusargs("waits=%d", waits)) begin end
        if (!$value$plusargs("image=%s", image)) $fatal(1, "+image=FILE names the program");
        $readmemh(image, words);
    end

    reg [63:0] clock = 0, begun = 0, clocks = 0;

    // Clocks for which each port has waited.
    reg [7:0] fetch_waited = 0, waited = 0;
    wire fetches = fetch && (OVERLAPS || !fetched) && !reset && fetch_waited == waits;
    wire answers = request && (OVERLAPS || !answered) && !reset && waited == waits;
    assign fetch_granted = fetches;
    assign granted = answers;

    always @(posedge clk) begin
        clock <= clock + 1;
        fetch_waited <= fetch && (OVERLAPS || !fetched) && !fetches && !reset ? fetch_waited + 1 : 0;
        waited <= request && (OVERLAPS || !answered) && !answers && !reset ? waited + 1 : 0;
        fetched <= fetches;
        fetch_word <= words[fetch_address[17:2]];
        answered <= answers;
        word <= words[address[17:2]];
        if (answers && write != 0) begin
            if (address == 32'h00100000) begin
                case (data)
                    1: begun <= clock;
                    2: clocks <= clocks + clock - begun;
                    3: $display("%0d", clock - begun);
                    default: begin
                        $display("clocks %0d", clocks);
                        $finish;
                    end
                endcase
            end else if (address == 32'h10000000) begin
                $write("%c", data[7:0]);
            end else begin
                if (write[0]) words[address[17:2]][7:0] <= data[7:0];
                if (write[1]) words[address[17:2]][15:8] <= data[15:8];
                if (write[2]) words[address[17:2]][23:16] <= data[23:16];
                if (write[3]) words[address[17:2]][31:24] <= data[31:24];
            end
        end
    end
endmodule
