//! `roughxel eval` as its users see it.

use std::collections::HashMap;

use super::fixture::{Folder, Run, program};

const REQUIRED: &str = "nx,ny,nz,vx,vy,vz";

fn eval(arguments: &[&str], input: &str) -> Run {
    Run::reading(&mut program(&[&["eval"], arguments].concat()), input)
}

/// Reads the columns of a result by name.
fn table(run: &Run) -> HashMap<String, Vec<f64>> {
    assert_eq!(run.code, Some(0), "{}", run.err);
    let mut lines = run.out.lines();
    let names: Vec<_> = lines.next().unwrap().split(',').collect();
    let mut table: HashMap<String, Vec<f64>> = names.iter().map(|name| (name.to_string(), Vec::new())).collect();
    for line in lines {
        let cells: Vec<_> = line.split(',').collect();
        assert_eq!(cells.len(), names.len());
        for (name, cell) in names.iter().zip(cells) {
            table.get_mut(*name).unwrap().push(cell.parse().unwrap());
        }
    }
    table
}

#[test]
fn a_mirror_seen_head_on_reflects_straight_back() {
    let result = table(&eval(&["-"], "nx,ny,nz,vx,vy,vz,dv_dx_x,dv_dy_y,size\n0,0,1,0,0,2,-0.015625,0.015625,512\n"));
    let one = |name: &str| result[name][0];
    assert_eq!((one("face"), one("s"), one("t"), one("status")), (4.0, 0.0, 0.0, 0.0));
    // r = 2n(v.n) - v|n|^2 = v; a pixel is 2^-7 on the face, two texels of 512.
    assert_eq!((one("r_x"), one("r_y"), one("r_z")), (0.0, 0.0, 2.0));
    assert_eq!((one("probes"), one("step_s"), one("lod")), (1.0, 0.007_812_5, 1.0));
    // A pixel box has variance 1/12. `standard` keeps 20 bits in three roots and products.
    let sigma = 0.007_812_5 / 12_f64.sqrt();
    assert!((one("lambda1") / sigma - 1.0).abs() < 1.0 / f64::from(1 << 17));
    // If h is not given, it is (0, 1, 0): E1 = h x n, E2 = n x E1.
    assert!((one("e1_x") - 1.0).abs() < 1e-5 && (one("e2_y") - 1.0).abs() < 1e-5);
}

#[test]
fn quantised_inputs_go_through_unchanged() {
    let header = "nx,ny,nz,vx,vy,vz,hx,hy,hz,b1,b2,d1,d2,d3,\
                  dv_dx_x,dv_dx_y,dv_dx_z,dv_dy_x,dv_dy_y,dv_dy_z,dn_dx_x,dn_dx_y,dn_dx_z,dn_dy_x,dn_dy_y,dn_dy_z";
    let row = "0.1,-0.7,3,1e-5,2,1e3,.3,.2,-.9,.123,-.456,.01,-.02,.03,\
               1e-3,-2e-3,3e-7,4e-3,5e-3,-6e-3,1e-4,2e-9,3e-4,-4e-4,5e-4,6e-4";
    for profile in ["narrow", "paper", "compact", "standard", "precise"] {
        let first = eval(&["--profile", profile], &format!("{header}\n{row}\n"));
        let values = table(&first);
        let again: Vec<_> = header.split(',').map(|name| format!("{:e}", values[&format!("q_{name}")][0])).collect();
        let second = eval(&["--profile", profile], &format!("{header}\n{}\n", again.join(",")));
        assert_eq!(first.out, second.out, "{profile}");
    }
}

#[test]
fn columns_may_come_in_any_order_with_bom_crlf_comments_and_blank_lines() {
    let plain = eval(&[], &format!("{REQUIRED},b1\n1,2,3,4,5,6,0.25\n-1,2,3,4,5,6,0.5\n"));
    let shuffled = eval(
        &[],
        "\u{feff}# made by hand\r\n\r\nb1, vz ,vy,\"vx\",nz,ny,nx\r\n0.25,6,5,4,3,2,1\r\n\r\n# next\r\n0.5,6,5,4,3,2,-1\r\n\r\n",
    );
    assert_eq!(plain.ends(0).out, shuffled.out);
}

#[test]
fn a_missing_column_is_named() {
    eval(&[], "nx,ny,vx,vy\n1,2,3,4\n").ends(1).complains(&["stdin:1: missing columns: nz, vz"]);
}

#[test]
fn an_unknown_or_double_column_is_named_beside_the_known_ones() {
    let with = |column: &str| eval(&[], &format!("{REQUIRED},{column}\n1,2,3,4,5,6,7\n")).ends(1);
    with("bump").complains(&["stdin:1: unknown column `bump`", "dn_dy_z, size"]);
    with("ny").complains(&["stdin:1: column `ny` is there twice"]);
}

#[test]
fn a_value_that_is_no_number_is_named_with_line_and_column() {
    for (value, problem) in [
        ("abc", "is not a number"),
        ("", "is not a number"),
        ("1,5", "7 values, but the header names 6"),
        ("NaN", "is not a finite number"),
        ("inf", "is not a finite number"),
        ("1e999", "is not a finite number"),
    ] {
        let run = eval(&[], &format!("{REQUIRED}\n# comment\n\n1,2,3,4,5,6\n1,2,{value},4,5,6\n"));
        let run = run.ends(1).complains(&["stdin:5:", problem]);
        assert!(value.contains(',') || run.err.contains("column `nz`"), "{}", run.err);
    }
}

#[test]
fn values_beyond_their_port_are_refused() {
    for (column, value) in
        [("b1", "8"), ("b2", "-8.1"), ("d3", "1e9"), ("size", "0"), ("size", "2.5"), ("size", "16385")]
    {
        let run = eval(&[], &format!("{REQUIRED},{column}\n1,2,3,4,5,6,{value}\n"));
        run.ends(1).complains(&[&format!("stdin:2: column `{column}`: `{value}`")]);
    }
}

#[test]
fn an_empty_input_is_refused_and_a_header_alone_is_not() {
    eval(&[], "\n# nothing\n").ends(1).complains(&["stdin: empty"]);
    assert_eq!(table(&eval(&[], REQUIRED))["nmod_x"].len(), 0);
}

#[test]
fn huge_and_tiny_vectors_are_evaluated() {
    let rows = "1e308,1e308,0,1,0,0\n5e-324,0,0,1,0,0\n0,0,0,0,0,0\n";
    let result = table(&eval(&["--effects", "none"], &format!("{REQUIRED}\n{rows}")));
    assert_eq!(result["face"], [2.0, 0.0, 4.0]);
    // normal_zero, view_zero, view_below_surface, face_tie, footprint_zero.
    assert_eq!(result["status"][2], f64::from(1 + 2 + 8 + 16 + 32));
}

#[test]
fn effects_select_blocks() {
    let fragment = format!("{REQUIRED},b1,d1,dv_dx_x,dn_dx_y\n0,0,1,0.3,0.2,1,0.5,0.25,0.01,0.01\n");
    let with = |effects: &str| table(&eval(&["--effects", effects], &fragment));
    assert_eq!(with("none")["lambda1"], [0.0]);
    assert_eq!(with("none")["nmod_x"], [0.0]);
    assert_ne!(with("bump")["nmod_x"], [0.0]);
    let widths = ["footprint", "footprint,curvature", "footprint,roughness", "footprint,roughness-iso"]
        .map(|effects| with(effects)["k_a"][0]);
    for (i, width) in widths.iter().enumerate() {
        assert!(!widths[..i].contains(width), "{widths:?}");
    }
    assert_eq!(with("all"), with("bump,roughness,curvature,footprint"));
}

#[test]
fn raw_integers_and_json_say_the_same_as_real_numbers() {
    let input = format!("{REQUIRED},b1,dv_dx_x,dv_dy_y\n0.3,0.2,1,-0.3,0.2,1,0.125,0.01,0.02\n1,0,0,1,0,0,0,0,0\n");
    let (real, raw) = (table(&eval(&[], &input)), table(&eval(&["--raw"], &input)));
    for row in 0..2 {
        let mantissa = |name: &str, exponent: &str| raw[name][row] * 2_f64.powf(raw[exponent][row] - 30.0);
        assert_eq!(real["r_z"][row], mantissa("r_z", "r_e"));
        assert_eq!(real["lambda2"][row], mantissa("lambda2", "lambda2_e"));
        assert_eq!(real["q_b1"][row], raw["q_b1"][row] / f64::from(1 << 28));
        assert_eq!(real["lod"][row], raw["lod"][row] / 65536.0);
    }
    let json = eval(&["--json"], &input).json();
    for (name, values) in &real {
        for (row, value) in values.iter().enumerate() {
            // serde_json reads decimals to within one last place.
            let found = json[row][name].as_f64().unwrap();
            assert!((found - value).abs() <= f64::EPSILON * value.abs(), "{name}");
        }
    }
    assert_eq!(json[1]["status_names"], serde_json::json!(["footprint_zero"]));
    let empty = eval(&["--json"], REQUIRED).json();
    assert_eq!(empty, serde_json::json!([]));
}

#[test]
fn rows_keep_their_order_across_parallel_blocks() {
    let rows: String = (1..=20_000).map(|i| format!("0,0,{i},0,0,1\n")).collect();
    let result = table(&eval(&["--profile", "precise"], &format!("{REQUIRED}\n{rows}")));
    let expected: Vec<_> = (1..=20_000).map(f64::from).collect();
    assert_eq!(result["q_nz"], expected);
}

#[test]
fn an_output_file_appears_whole_or_not_at_all() {
    let directory = Folder::new();
    let argument = &directory.file("result.csv");
    let good = format!("{REQUIRED}\n1,2,3,4,5,6\n");
    eval(&["-o", argument], &format!("{good}1,2,3,4,5,x\n")).ends(1);
    assert_eq!(directory.path().read_dir().unwrap().count(), 0);
    assert_eq!(eval(&["-o", argument], &good).ends(0).out, "");
    let written = directory.read("result.csv");
    assert_eq!(written, eval(&[], &good).out);
    eval(&["-o", argument], "rubbish\n").ends(1);
    assert_eq!(directory.read("result.csv"), written);
    eval(&["-o", &directory.file("no/where.csv")], &good).ends(1).complains(&["cannot write", "no directory"]);
    eval(&["-o", &directory.file("")], &good).ends(1).complains(&["cannot write"]);
}

#[cfg(unix)]
#[test]
fn a_device_is_written_to_and_not_replaced() {
    use std::os::unix::fs::FileTypeExt;
    eval(&["-o", "/dev/null"], &format!("{REQUIRED}\n1,2,3,4,5,6\n")).ends(0);
    assert!(std::fs::metadata("/dev/null").unwrap().file_type().is_char_device());
}
