//! Offsets of bump fields.

use super::*;

fn picture(width: u32, height: u32, value: impl Fn(u32, u32) -> [f32; 3]) -> Picture {
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| value(x, y)).collect();
    Picture { width, height, pixels }
}

#[test]
fn offsets_are_minus_the_slope_and_v_runs_up() {
    // A tent along u and a tent along v, in eighths.
    let tent = |x: u32| [0.0, 0.125, 0.25, 0.375, 0.5, 0.375, 0.25, 0.125][x as usize];
    let along_u = picture(8, 4, |x, _| [tent(x); 3]);
    let (field, clamped) =
        BumpField::from_heights(&along_u, HeightScale::Height(0.5), FrameSystem::MainDirection, Edges::Wrapped);
    assert_eq!(clamped, 0);
    assert_eq!(field.offsets[1], [-0.5, 0.0]);
    assert_eq!(field.offsets[5], [0.5, 0.0]);
    let along_v = picture(8, 8, |_, y| [tent(7 - y); 3]);
    let (field, _) =
        BumpField::from_heights(&along_v, HeightScale::Height(0.5), FrameSystem::MainDirection, Edges::Wrapped);
    assert_eq!(field.offsets[8], [0.0, -0.5], "row 1 from the bottom climbs with v");
}

#[test]
fn differences_wrap_around_both_edges() {
    let spike = picture(4, 4, |x, y| [if (x, y) == (0, 0) { 1.0 } else { 0.0 }; 3]);
    let (field, _) =
        BumpField::from_heights(&spike, HeightScale::Height(0.5), FrameSystem::MainDirection, Edges::Wrapped);
    assert_eq!(field.offsets[3 * 4 + 3], [-1.0, 0.0], "left of the spike, through the seam");
    assert_eq!(field.offsets[0], [0.0, 1.0], "above the spike, through the seam");
}

#[test]
fn the_natural_system_takes_slopes_per_unit_of_v() {
    let tall = picture(2, 8, |_, y| [if y == 7 { 0.125 } else { 0.0 }; 3]);
    let (square, _) =
        BumpField::from_heights(&tall, HeightScale::Height(1.0), FrameSystem::NaturalNormalised, Edges::Wrapped);
    let (natural, _) = BumpField::from_heights(&tall, HeightScale::Height(1.0), FrameSystem::Natural, Edges::Wrapped);
    assert_eq!(square.offsets[2], [0.0, 0.125]);
    assert_eq!(natural.offsets[2], [0.0, 0.5]);
}

const FRAMES: [FrameSystem; 3] = [FrameSystem::MainDirection, FrameSystem::Natural, FrameSystem::NaturalNormalised];

/// One smooth hill a repeat, for maps of any shape.
fn hill(width: u32, height: u32) -> Picture {
    let wave = |place: u32, size: u32| (std::f64::consts::TAU * f64::from(place) / f64::from(size)).cos();
    picture(width, height, |x, y| [(0.5 + 0.2 * wave(x, width) + 0.3 * wave(y + 2, height)) as f32; 3])
}

/// The hill in all shapes, bases and scales.
fn kept_hills() -> impl Iterator<Item = (FrameSystem, BumpField)> {
    [(24, 24), (40, 16), (12, 60)].into_iter().flat_map(|(width, height)| {
        FRAMES.into_iter().flat_map(move |frame| {
            let scales = [HeightScale::Height(0.3), HeightScale::Height(-0.07), HeightScale::RmsSlope(0.4)];
            let field = move |scale| BumpField::with_heights(&hill(width, height), scale, frame, Edges::Wrapped);
            scales.into_iter().map(field).map(move |(field, clamped)| {
                assert_eq!(clamped, 0);
                (frame, field)
            })
        })
    })
}

#[test]
fn heights_and_offsets_are_one_surface_in_every_frame_and_shape() {
    for (frame, field) in kept_hills() {
        let (width, height) = (field.width as usize, field.height as usize);
        let HeightField { heights, rows_apart, .. } = field.heights.as_ref().unwrap();
        let is_natural = frame == FrameSystem::Natural;
        assert_eq!(*rows_apart, if is_natural { width as f64 / height as f64 } else { 1.0 });
        let at = |x: usize, y: usize| f64::from(heights[y % height * width + x % width]);
        let highest = heights.iter().fold(0.0_f32, |most, height| most.max(height.abs()));
        for (index, offset) in field.offsets.iter().enumerate() {
            let (x, y) = (index % width, index / width);
            let slopes = [
                0.5 * (at(x + 1, y) - at(x + width - 1, y)),
                0.5 * (at(x, y + 1) - at(x, y + height - 1)) / rows_apart,
            ];
            for (offset, slope) in offset.iter().zip(slopes) {
                // Two heights rounded to f32, and the offset.
                let rounding = f64::from(f32::EPSILON * highest) * (1.0 + 1.0 / rows_apart);
                assert!((f64::from(*offset) + slope).abs() <= rounding, "{frame:?} {offset} {slope}");
            }
        }
    }
}

#[test]
fn a_map_one_texel_wide_or_high_has_no_slope_along_that_axis() {
    for (frame, (width, height)) in FRAMES.into_iter().zip([(1, 1), (1, 6), (6, 1)]) {
        let bumpy = picture(width, height, |x, y| [((x + y) % 3) as f32 * 0.1 + 0.5; 3]);
        let (field, _) = BumpField::with_heights(&bumpy, HeightScale::Height(0.5), frame, Edges::Wrapped);
        assert!(field.offsets.iter().all(|[u, v]| (width > 1 || *u == 0.0) && (height > 1 || *v == 0.0)));
        assert_eq!(field.offsets.iter().any(|offset| *offset != [0.0; 2]), width * height > 1);
    }
}

#[test]
fn an_rms_slope_is_met_and_a_flat_map_stays_flat() {
    let waves = picture(16, 16, |x, y| [((x * 7 + y * 3) % 16) as f32 / 16.0; 3]);
    let (field, _) =
        BumpField::from_heights(&waves, HeightScale::RmsSlope(0.25), FrameSystem::MainDirection, Edges::Wrapped);
    let mean: f32 = field.offsets.iter().map(|[u, v]| u * u + v * v).sum::<f32>() / 256.0;
    // f32 rounding of 256 squares.
    assert!((mean.sqrt() - 0.25).abs() < 1e-6);
    let flat = picture(4, 4, |_, _| [0.5; 3]);
    let (field, _) =
        BumpField::from_heights(&flat, HeightScale::RmsSlope(0.25), FrameSystem::MainDirection, Edges::Wrapped);
    assert!(field.offsets.iter().all(|offset| *offset == [0.0; 2]));
}

#[test]
fn the_neutral_8_bit_normal_is_exactly_flat_and_16_bit_uses_its_whole_range() {
    let neutral = picture(2, 2, |_, _| [128.0 / 255.0, 128.0 / 255.0, 1.0]);
    assert!(
        BumpField::from_normals(&neutral, Green::Up, NormalCoding::ZeroAt128)
            .0
            .offsets
            .iter()
            .all(|offset| *offset == [0.0; 2])
    );
    let deep = picture(1, 1, |_, _| [49_152.0 / 65_535.0, 0.5, 0.75]);
    let (field, _) = BumpField::from_normals(&deep, Green::Up, NormalCoding::ZeroAt128);
    // Half a 16-bit code.
    assert!((field.offsets[0][0] - 1.0).abs() < 1e-4 && field.offsets[0][1] == 0.0);
}

#[test]
fn normals_pointing_inwards_are_clamped_and_counted() {
    let inwards = picture(2, 1, |x, _| if x == 0 { [1.0, 0.5, 0.2] } else { [0.0; 3] });
    let (field, clamped) = BumpField::from_normals(&inwards, Green::Up, NormalCoding::ZeroAt128);
    assert_eq!(clamped, 2);
    assert!(field.offsets.iter().flatten().all(|coordinate| coordinate.abs() <= OFFSET_LIMIT));
    assert_eq!(field.offsets[0][0], OFFSET_LIMIT);
}

/// A height map that does not repeat: kind, size, height of a texel (row 0 at the top), and its slopes along +u and +v in
/// units of 1 / width, where the differences of its formula are known.
type OpenMap = (&'static str, [u32; 2], fn(f64, f64) -> f64, fn(f64, f64) -> [f64; 2]);

/// Maps of degree 1 have one slope; of degree 2, the slope at a texel inside and half a texel inside an edge.
const OPEN_MAPS: [OpenMap; 12] = [
    ("level", [5, 4], |_, _| 0.7, |_, _| [0.0, 0.0]),
    ("ramp along u", [32, 32], |x, _| x / 31.0, |_, _| [1.0 / 31.0, 0.0]),
    ("falling ramp", [32, 8], |x, _| 1.0 - x / 31.0, |_, _| [-1.0 / 31.0, 0.0]),
    ("ramp along v", [8, 32], |_, y| 1.0 - y / 31.0, |_, _| [0.0, 1.0 / 31.0]),
    ("slanted plane", [16, 16], |x, y| 0.5 + 0.02 * x - 0.01 * y, |_, _| [0.02, 0.01]),
    ("slanted and wide", [64, 4], |x, y| 0.2 + 0.01 * x + 0.05 * y, |_, _| [0.01, -0.05]),
    ("two columns", [2, 6], |x, _| 0.25 * x, |_, _| [0.25, 0.0]),
    ("two rows", [6, 2], |_, y| 0.25 * y, |_, _| [0.0, -0.25]),
    ("one column", [1, 9], |_, y| 0.1 * y, |_, _| [0.0, -0.1]),
    ("one row", [9, 1], |x, _| 0.1 * x, |_, _| [0.1, 0.0]),
    ("parabola", [8, 3], |x, _| 0.01 * x * x, |x, _| [0.02 * x.clamp(0.5, 6.5), 0.0]),
    ("saddle", [7, 7], |x, y| 0.5 + 0.01 * x * y, |x, y| [0.01 * y, -0.01 * x]),
];

#[test]
fn a_map_that_does_not_repeat_has_its_own_slopes_at_its_edges() {
    for (kind, [width, height], value, slope) in OPEN_MAPS {
        let map = picture(width, height, |x, y| [value(f64::from(x), f64::from(y)) as f32; 3]);
        let scale = HeightScale::Height(1.0 / f64::from(width));
        let offsets = |edges| BumpField::from_heights(&map, scale, FrameSystem::MainDirection, edges).0.offsets;
        let open = offsets(Edges::Open);
        for (index, offset) in open.iter().enumerate() {
            let (x, y) = (index as u32 % width, height - 1 - index as u32 / width);
            let wanted = slope(f64::from(x), f64::from(y));
            for (offset, wanted) in offset.iter().zip(wanted) {
                // Heights are f32.
                assert!((f64::from(*offset) + wanted).abs() < 1e-6, "{kind} ({x}, {y}): {offset} {wanted}");
            }
        }
        // Inside, both kinds of edges give the same bits.
        let wrapped = offsets(Edges::Wrapped);
        for (x, y) in (1..height.saturating_sub(1)).flat_map(|y| (1..width.saturating_sub(1)).map(move |x| (x, y))) {
            let index = (y * width + x) as usize;
            assert_eq!(open[index], wrapped[index], "{kind}");
        }
    }
}

#[test]
fn slopes_of_an_open_map_decide_its_scale_and_stay_with_its_heights() {
    let ramp = picture(16, 4, |x, _| [x as f32 / 15.0; 3]);
    for frame in FRAMES {
        let (field, _) = BumpField::with_heights(&ramp, HeightScale::RmsSlope(0.31), frame, Edges::Open);
        assert!(field.offsets.iter().all(|[u, v]| (u + 0.31).abs() < 1e-6 && *v == 0.0), "{frame:?}");
        let kept = field.heights.unwrap();
        assert_eq!(kept.edges, Edges::Open);
        assert!(kept.heights.chunks(16).all(|row| row.windows(2).all(|pair| (pair[1] - pair[0] - 0.31).abs() < 1e-5)));
    }
}

/// A normal map of DirectX: kind, its codes, and the offsets that they mean by (n_x, −n_y) / n_z.
#[test]
fn green_down_is_the_same_surface_as_green_up_with_its_green_reversed() {
    let table: [(&str, [f32; 3], [f32; 2]); 10] = [
        ("flat", [128.0, 128.0, 255.0], [0.0, 0.0]),
        ("leans to +v", [128.0, 38.0, 218.0], [0.0, 1.0]),
        ("leans to −v", [128.0, 218.0, 218.0], [0.0, -1.0]),
        ("leans to +u", [218.0, 128.0, 218.0], [1.0, 0.0]),
        ("leans to −u", [38.0, 128.0, 218.0], [-1.0, 0.0]),
        ("diagonal", [188.0, 68.0, 248.0], [0.5, 0.5]),
        ("other diagonal", [68.0, 68.0, 248.0], [-0.5, 0.5]),
        ("away", [68.0, 188.0, 248.0], [-0.5, -0.5]),
        ("slight", [128.0, 127.0, 255.0], [0.0, 1.0 / 127.0]),
        ("steep", [128.0, 1.0, 255.0], [0.0, 1.0]),
    ];
    for (kind, codes, wanted) in table {
        let map = picture(1, 1, |_, _| codes.map(|code| code / 255.0));
        let (field, _) = BumpField::from_normals(&map, Green::Down, NormalCoding::ZeroAt128);
        for (offset, wanted) in field.offsets[0].iter().zip(wanted) {
            assert!((offset - wanted).abs() < 1e-6, "{kind}: {offset} {wanted}");
        }
        let reversed = picture(1, 1, |_, _| [codes[0], 256.0 - codes[1], codes[2]].map(|code| code / 255.0));
        assert_eq!(field, BumpField::from_normals(&reversed, Green::Up, NormalCoding::ZeroAt128).0, "{kind}");
    }
}

/// Component of an 8-bit code.
type Decode = fn(f64) -> f64;

#[test]
fn codes_of_gltf_have_no_zero_and_those_of_others_have_it_at_128() {
    // Components of 8-bit codes by hand: glTF 2c/255 − 1, others (c − 128)/127. Offsets are x/z and y/z.
    let codes = [[128.0, 128.0, 255.0], [255.0, 0.0, 255.0], [0.0, 191.0, 192.0], [127.0, 64.0, 255.0]];
    let map = picture(4, 1, |x, _| codes[x as usize].map(|code: f64| (code / 255.0) as f32));
    let decoders: [(NormalCoding, Decode); 2] = [
        (NormalCoding::Gltf, |code| 2.0 * code / 255.0 - 1.0),
        (NormalCoding::ZeroAt128, |code| (code - 128.0) / 127.0),
    ];
    for (coding, decode) in decoders {
        let (field, _) = BumpField::from_normals(&map, Green::Up, coding);
        for (offset, code) in field.offsets.iter().zip(codes) {
            let [x, y, z] = code.map(decode);
            for (got, right) in offset.iter().zip([x / z, y / z]) {
                assert!((f64::from(*got) - right).abs() < 1e-5, "{coding:?} {code:?}: {got}, {right}");
            }
        }
    }
}
