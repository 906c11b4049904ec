//! Lines as programs and people write them, offsets, and what is wrong with a line.

use std::path::Path;

use glam::DVec3;

use super::{message, read};
use roughxel_assets::{ReadOptions, parse_obj};

#[test]
fn comments_continuations_and_line_ends_change_no_mesh() {
    let plain = read("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n").unwrap().mesh;
    for text in [
        "v 0 0 0 # origin\nv 1 0 0# no blank\nv 1 1 0 #\nv 0 1 0\nf 1 2 3 4 # the square\n",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 \\\n3 4\n",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 \\  \n3 4\n",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 \\\t\n2 \\\r\n3 4\n",
        "v 0 0 \\\n0\nv 1 \\\n0 \\\n0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\\\n",
        "v 0 0 0\rv 1 0 0\rv 1 1 0\rv 0 1 0\rf 1 2 3 4\r",
        "v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nf 1 2 3 4\r\n",
        "# saved as C:\\meshes\\\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n",
        "  v\t0  0\t0\nv 1 0 0\n\n\tv 1 1 0\nv 0 1 0   \n f  1 2\t3 4",
        "v 0 0 0 1\nv 1 0 0 0.5 0.5 0.5\nv 1 1 0 1 1 1 1\nv 0 1 0\nvn 0 0 1\nf 1 2 3 4\n",
        "f 1 2 3 4\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nfo 1 2 3 4\n",
        "v 0e0 -0.0 +0\nv 1. 0 0\nv 1.0E0 1e+0 0\nv .0 1 0\nf 1 2 3 4 # \\\n",
        "\u{feff}#\nmtllib a.mtl\no \u{00e9}\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\ng\nusemtl\nf -4 -3 -2 -1\nl 1 2\np 1\nvp 0.5\ncurv 0 1 1 2\n",
    ] {
        let mesh = read(text).unwrap_or_else(|error| panic!("{text:?}: {error}")).mesh;
        assert_eq!((&mesh.vertices, &mesh.triangles), (&plain.vertices, &plain.triangles), "{text:?}");
    }
}

#[test]
fn errors_name_the_first_line_of_a_continued_one_and_the_line_of_an_index_ahead() {
    for (text, expected) in [
        ("v 0 0 0\n\nf 1 \\\n 1 \\\n x\nv 0 0 0\n", "test.obj:3: `x` in `x` is not an index"),
        ("v 0 0 0 \\\n\nv 0 q 0\n", "test.obj:3: `q` is not a number"),
        (
            "f 1 2 3\nf 1 2 9\nf 1 2 4\nv 0 0 0\nv 1 0 0\nv 0 1 0\n",
            "test.obj:2: vertex 9 is out of range: the file has 3",
        ),
        (
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/7 2/7 3/7\n",
            "test.obj:4: texture coordinate 7 is out of range: the file has 0",
        ),
        ("v 0 0 0\nf -1 -1 -5\nv 0 0 0\n", "test.obj:2: vertex -5 is out of range: the file has 1 up to this line"),
        ("v 1,5 0 0\n", "test.obj:1: `1,5` is not a number"),
        ("v 1e400 0 0\n", "test.obj:1: coordinate `1e400` is not finite"),
        ("vt 1e7 0\n", "test.obj:1: texture coordinates"),
        ("vt\n", "test.obj:1: `vt` has 0 numbers and needs 1"),
        ("v 0 0 0\nf 1 # 1 1\n", "test.obj:2: a face has 1 corners"),
        ("v 0 0 0\nf 1/1/1/1 1 1\n", "is not a corner"),
        ("v 0 0 0\nf 1 1 99999999999\n", "vertex 99999999999 is out of range"),
    ] {
        let found = message(text);
        assert!(found.contains(expected), "{text:?}: {found}");
    }
}

#[test]
fn an_offset_moves_meshes_of_map_coordinates_to_the_origin() {
    for (middle, proposed) in [
        ([457_123.25, 5_412_345.5, 12.0], "offset = [457000, 5412000, 0]"),
        ([3_500_000.0, 5_800_000.0, 0.0], "offset = [3500000, 5800000, 0]"),
        ([-1_200_000.0, 0.0, 0.0], "offset = [-1200000, 0, 0]"),
        ([4_075_539.0, 931_735.0, 4_801_629.0], "offset = [4076000, 932000, 4802000]"),
        ([1_113_194.9, 6_621_293.7, 0.0], "offset = [1113000, 6621000, 0]"),
        ([691_607.9, 5_334_760.4, 480.0], "offset = [692000, 5335000, 0]"),
        ([-2_036_000.6, 2_228_000.2, 0.0], "offset = [-2036000, 2228000, 0]"),
        ([13_358_338.9, 4_721_671.6, 30.0], "offset = [13358000, 4722000, 0]"),
        ([500_000.0, 10_000_000.0, 0.0], "offset = [500000, 10000000, 0]"),
        ([0.0, -1_500_900.4, 0.0], "offset = [0, -1501000, 0]"),
    ] {
        let [x, y, z] = middle;
        let text: String = [[0.0, 0.0], [0.5, 0.0], [0.5, 0.25], [0.0, 0.25]]
            .map(|[a, b]| format!("v {} {} {z}\n", x + a, y + b))
            .concat()
            + "f 1 2 3 4\n";
        let error = message(&text);
        assert!(error.starts_with("test.obj:1: coordinate `"), "{error}");
        assert!(error.contains("is not within ±1e6 units") && error.contains(proposed), "{error}");
        let numbers = proposed.trim_start_matches("offset = [").trim_end_matches(']');
        let offset: Vec<f64> = numbers.split(", ").map(|number| number.parse().unwrap()).collect();
        let offset = DVec3::from_slice(&offset);
        let read = parse_obj(Path::new("test.obj"), &text, &ReadOptions { offset, ..ReadOptions::default() }).unwrap();
        let near = DVec3::from_array(middle) - offset;
        for (vertex, corner) in read.mesh.vertices.iter().zip([[0.0, 0.0], [0.5, 0.0], [0.5, 0.25], [0.0, 0.25]]) {
            assert!((vertex.position - near - DVec3::new(corner[0], corner[1], 0.0)).length() < 4e-9, "{vertex:?}");
        }
    }
    let wide = message("v -2e6 0 0\nv 2e6 0 0\nv 0 1 0\nf 1 2 3\n");
    assert!(wide.contains("4e6 units across: make it smaller"), "{wide}");
}

#[test]
fn a_text_of_any_bytes_is_read_or_refused() {
    let text = "# a \\\nv 0 0 0\nv 1 0 \\ \n0\nv 1 1 0\nv 0 1 0\nv .5 .2 0\nvt 0 0\nvt 1\nvn 0 0 1\ns 1\nf 1/1/1 2/2/1 3/1/1 \\\n4/2/1\n\
                s off\nf 1 2 5 4 3\nf -1//-1 1//1 2//1\n";
    assert!(read(text).is_ok());
    for end in 0..text.len() {
        let _ = read(&text[..end]);
    }
    let mut state = 1u64;
    for _ in 0..4000 {
        let mut bytes = text.as_bytes().to_vec();
        for _ in 0..3 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let place = (state >> 33) as usize % bytes.len();
            bytes[place] = b"0123456789/-.\\#\n\r fvtnse\xff\0"[(state >> 20) as usize % 26];
        }
        let _ = read(&String::from_utf8_lossy(&bytes));
    }
}
