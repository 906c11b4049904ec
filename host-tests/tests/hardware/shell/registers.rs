//! The registers: which ports they are of, and what a bus sees of them.

use std::fs;
use std::process::Command;

use roughxel_core::design::Design;
use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::precision::Precision;
use roughxel_host_tests::simulators::{have, run};
use roughxel_netlist::verilog::{Access, Register};
use roughxel_record as record;

use super::super::rtl::FULL;
use super::{Folder, shell_options};

/// Names of the registers of a design under `compact`.
fn names(design: Design, effects: Effects) -> Vec<String> {
    let verilog = record::verilog(design, &shell_options("compact", effects, None, 32)).expect("the design is proven");
    verilog.shell.expect("a shell").registers.into_iter().map(|register| register.name).collect()
}

#[test]
fn registers_hold_the_constants_of_an_object() {
    assert_eq!(names(Design::Fragment, FULL), ["ident", "take", "edge_texels"]);
    assert_eq!(names(Design::Reflection, FULL), ["ident", "take", "map_log2_texels", "map_last_level"]);
    assert_eq!(names(Design::Highlight, FULL), ["ident", "take", "shininess_exponent", "shininess_root"]);
    assert_eq!(names(Design::Colour, FULL), ["ident", "take", "exponent"]);
    // A mirror reads no map, and every peak has its own numbers.
    assert_eq!(names(Design::Fragment, Effects::NONE), ["ident"]);
    assert_eq!(names(Design::LitPeak, FULL), ["ident"]);
}

#[test]
fn every_design_has_an_input_that_comes_with_the_fragment_and_constants_of_a_word() {
    for &design in Design::ALL {
        let net = record::net(design, &FULL, &Precision::STANDARD);
        let constant = |port: &roughxel_netlist::graph::Port| roughxel_core::bundle::is_constant(&port.path);
        assert!(net.ports.iter().any(|port| !constant(port)), "{}", design.name());
        // A register is a word.
        let mut constants = net.ports.iter().filter(|port| constant(port));
        assert!(constants.all(|port| port.kind.bits() <= 32), "{}", design.name());
    }
    // The fields of vectors that are constants: an edge and a shininess.
    let constants = Datapath::ALL.map(|datapath| {
        let net = record::net(Design::for_datapath(datapath), &FULL, &Precision::STANDARD);
        net.ports.iter().filter(|port| roughxel_core::bundle::is_constant(&port.path)).count()
    });
    assert_eq!(constants, [1, 2, 0]);
}

/// Testbench of the bus: each line of `steps` is a task below.
fn testbench(module: &str, steps: &str) -> String {
    format!(
        "`timescale 1ns / 1ns
module registers;
  reg clk = 0, aresetn = 0, aw_valid = 0, w_valid = 0, ar_valid = 0;
  reg [11:0] aw, ar; reg [31:0] w; reg [3:0] strobes;
  wire aw_ready, w_ready, b_valid, ar_ready, r_valid; wire [1:0] b_resp, r_resp; wire [31:0] r;
  reg words_valid = 0, words_last = 0; wire words_ready;
  always #1 clk = !clk;
  {module} dut (.aclk(clk), .aresetn(aresetn), .s_axis_tvalid(words_valid), .s_axis_tready(words_ready), .s_axis_tdata(32'd0),
    .s_axis_tlast(words_last), .m_axis_tvalid(), .m_axis_tready(1'b1), .m_axis_tdata(), .m_axis_tlast(),
    .s_axi_awvalid(aw_valid), .s_axi_awready(aw_ready), .s_axi_awaddr(aw),
    .s_axi_wvalid(w_valid), .s_axi_wready(w_ready), .s_axi_wdata(w), .s_axi_wstrb(strobes),
    .s_axi_bvalid(b_valid), .s_axi_bready(1'b1), .s_axi_bresp(b_resp),
    .s_axi_arvalid(ar_valid), .s_axi_arready(ar_ready), .s_axi_araddr(ar),
    .s_axi_rvalid(r_valid), .s_axi_rready(1'b1), .s_axi_rdata(r), .s_axi_rresp(r_resp));
  task address(input [11:0] at); begin
    aw = at; aw_valid = 1; @(posedge clk); while (!aw_ready) @(posedge clk); @(negedge clk); aw_valid = 0;
  end endtask
  task data(input [31:0] value, input [3:0] strobe); begin
    w = value; strobes = strobe; w_valid = 1; @(posedge clk); while (!w_ready) @(posedge clk); @(negedge clk); w_valid = 0;
  end endtask
  task response(input [1:0] wanted); begin
    @(posedge clk); while (!b_valid) @(posedge clk);
    if (b_resp !== wanted) $display(\"FAIL write %h: response %0d\", aw, b_resp);
    @(negedge clk);
  end endtask
  // The address comes two cycles before the data, or the data before the address.
  task write(input [11:0] at, input [31:0] value, input [3:0] strobe, input [1:0] wanted); begin
    address(at); repeat (2) @(negedge clk); data(value, strobe); response(wanted);
  end endtask
  task write_late(input [11:0] at, input [31:0] value, input [3:0] strobe, input [1:0] wanted); begin
    data(value, strobe); repeat (2) @(negedge clk); address(at); response(wanted);
  end endtask
  task read(input [11:0] at, input [31:0] value, input [1:0] wanted); begin
    ar = at; ar_valid = 1; @(posedge clk); while (!ar_ready) @(posedge clk); @(negedge clk); ar_valid = 0;
    while (!r_valid) @(negedge clk);
    if (r !== value || r_resp !== wanted) $display(\"FAIL read %h: %h, response %0d, expected %h\", at, r, r_resp, value);
    @(negedge clk);
  end endtask
  task reset; begin aresetn = 0; repeat (3) @(negedge clk); aresetn = 1; end endtask
  task words(input integer count, input last); begin
    repeat (count) begin
      words_valid = 1; words_last = last; @(posedge clk); while (!words_ready) @(posedge clk); @(negedge clk); words_valid = 0;
    end
  end endtask
  initial begin
    reset;
{steps}    $display(\"END\");
    $finish(0);
  end
  initial #100000 $finish(0);
endmodule
"
    )
}

/// Value that a read returns after every bit was written.
fn all_ones(register: &Register) -> u32 {
    if register.signed { u32::MAX } else { u32::MAX >> (32 - register.width.min(32)) }
}

/// Steps of the test of a design with registers of at most 32 bits.
fn steps(registers: &[Register], words: u32) -> String {
    let mut steps = String::new();
    let mut step = |text: String| steps += &format!("    {text};\n");
    let constants: Vec<&Register> = registers.iter().filter(|register| register.port.is_some()).collect();
    for register in registers {
        step(format!("read({}, {}, 0)", register.offset, register.reset));
        let response = if register.access == Access::ReadOnly { 2 } else { 0 };
        let write = if register.offset % 8 == 0 { "write" } else { "write_late" };
        if register.name != "take" {
            step(format!("{write}({}, 32'hffffffff, 15, {response})", register.offset));
        }
    }
    for register in &constants {
        let ones = all_ones(register);
        step(format!("read({}, 32'h{ones:x}, 0)", register.offset));
        // One byte of four.
        step(format!("write({}, 0, 1, 0)", register.offset));
        let rest = u64::from(ones) & !0xff & (u64::MAX >> (64 - register.width));
        let negative = register.signed && register.width > 8;
        let rest = if negative { ones & !0xff } else { rest as u32 };
        step(format!("read({}, 32'h{rest:x}, 0)", register.offset));
    }
    // Nothing is pending until the take is written, and a 0 takes nothing; an early end of a packet takes nothing either.
    for text in ["read(4, 0, 0)", "write(4, 0, 15, 0)", "read(4, 0, 0)", "write(4, 1, 14, 0)", "read(4, 0, 0)"] {
        step(text.to_owned());
    }
    step("write(4, 1, 15, 0)".to_owned());
    step("read(4, 1, 0)".to_owned());
    step(format!("words({}, 0)", words - 1));
    step("read(4, 1, 0)".to_owned());
    step("words(1, 0)".to_owned());
    step("read(4, 0, 0)".to_owned());
    step("write(4, 1, 15, 0)".to_owned());
    step("words(1, 1)".to_owned());
    step("read(4, 1, 0)".to_owned());
    for offset in [0x7fc, 0xffc] {
        step(format!("write({offset}, 1, 15, 2)"));
        step(format!("read({offset}, 0, 2)"));
    }
    step("reset".to_owned());
    for register in registers {
        step(format!("read({}, {}, 0)", register.offset, register.reset));
    }
    steps
}

#[test]
fn a_bus_reads_what_it_wrote_and_a_fragment_takes_it_with_its_last_word() {
    if !have("iverilog") {
        return;
    }
    for (design, profile) in [(Design::Texture, "standard"), (Design::Reflection, "narrow"), (Design::Bump, "compact")]
    {
        let folder = Folder::new(design, &shell_options(profile, FULL, None, 32));
        let shell = folder.shell();
        assert!(shell.input_words > 2 && shell.registers.iter().all(|register| register.width <= 32));
        let text = testbench(&shell.module, &steps(&shell.registers, shell.input_words));
        fs::write(folder.path("registers.v"), text).expect("the directory can be written");
        let mut command = Command::new("iverilog");
        command.args(["-g2005", "-s", "registers", "-y", ".", "-o", "registers.vvp", "registers.v"]);
        run(command.current_dir(folder.path("")));
        let output = run(Command::new("vvp").args(["-N", "registers.vvp"]).current_dir(folder.path("")));
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(text.trim() == "END", "{}: {text}", design.name());
    }
}
