//! Order of declarations in Verilog, on small modules.

use roughxel_host_tests::declarations::used_before_declared;

#[test]
fn a_use_above_its_declaration_is_found() {
    let early = "module m (input [3:0] a, output b);\n  assign b = c[0] & a[0];\n  wire [1:0] c = a;\nendmodule\n";
    assert_eq!(used_before_declared(early), [(2, "c".to_owned())]);
    let list = "module m;\n  reg d = f;\n  reg [1:0] e [0:3], f = 1'b0;\nendmodule\n";
    assert_eq!(used_before_declared(list), [(2, "f".to_owned())]);
}

#[test]
fn a_type_is_no_name() {
    let fine = "import a_pkg::*;\nmodule m (input a_pkg::in_t a, output out_t b);\n  out_t c = b;\n\
                function int f(input out_t c);\nendmodule\n";
    assert_eq!(used_before_declared(fine), []);
    let early = "module m;\n  assign x = c;\n  out_t [1:0] c;\nendmodule\n";
    assert_eq!(used_before_declared(early), [(2, "c".to_owned())]);
}

#[test]
fn ports_digits_comments_and_other_modules_are_no_uses() {
    let fine = "// c\nmodule m;\n  other u (.c(1'b0), .d(4'sd1));\n  wire c = u.d;\n  reg signed [3:0] d, sd1;\nendmodule\n\
                module other (input c, output signed [3:0] d);\n  assign d = {4{c}};\nendmodule\n";
    assert_eq!(used_before_declared(fine), []);
}
