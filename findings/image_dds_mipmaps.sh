#!/usr/bin/env bash
# The mip levels that image_dds makes: a 511 x 511 texture shrinks to its top left quarter, and small
# BC blocks are compressed together with black.
#
# Expected: each mip level shows the whole picture. In BC formats the pixels beyond the edge of a level
#   (a 2 x 2 level lives in a block of 4 x 4) do not cost the visible ones quality. Levels keep the mean.
# Seen: 1. Each level averages 2 x 2 pixels and drops an odd last row and column, eight times in turn at
#   511 x 511: the 1 x 1 level is the mean of the 256 x 256 pixels at the top left. A picture that is 0
#   there and 200 elsewhere ends as 0 in place of 150. The dds crate, asked for the same file, gives 150.
#   2. Blocks are filled up with zeros, so black becomes one of the two end colours. The 2 x 2 level of a
#   power-of-two BC1 texture, 158 190 190 223, decodes as 137 206 206 206; from the same pixels with the
#   edge repeated as 148 197 197 222. A 6 x 6 ramp without any mip levels is off by 29, 8 if the
#   caller repeats the edge first; in BC4 and BC5 by 13 and 4.
#   3. Averages are cut, not rounded: noise of mean 127.5 sinks to 124 over ten levels, which tilts a
#   normal map. 4. In the _SRGB formats the encoded values are averaged: black and white give 127
#   (21 % of the light) in place of 188. The dds crate rounds.
# Versions: image_dds 0.7.2, dds 0.2.0 (cargo, with Cargo's own choice for their dependencies).
# Why it matters: scanned height maps, normal maps and renderings are seldom a power of two. The lit side
#   vanishes with distance, while every level by itself looks plausible. BC5 normal maps
#   get worse normals along two of their edges.
# Source: image_dds' documentation, enum Mipmaps: "Generate mipmaps starting from the base level"; it says
#   nothing of dropped pixels, padding or colour space. OpenGL extensions S3TC and RGTC: the data of texels
#   outside the image are irrelevant and undefined, so an encoder is free to choose them. Vulkan, sRGB
#   formats: values become linear before filtering. The right means are worked out here from the base
#   level, and all blocks are decoded by the dds crate, not by image_dds.
set -euo pipefail

dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
mkdir src
cat > Cargo.toml <<'TOML'
[package]
name = "mips"
version = "0.1.0"
edition = "2021"

[dependencies]
image_dds = { version = "=0.7.2", default-features = false, features = ["encode"] }
dds = { version = "=0.2.0", default-features = false }

[profile.dev]
debug = false
TOML
cat > src/main.rs <<'RUST'
use image_dds::{ImageFormat, Mipmaps, Quality, SurfaceRgba8};

// the C++ part of the texture compressor of image_dds needs it on some machines
#[link(name = "stdc++")]
extern "C" {}

type Gray = dyn Fn(u32, u32) -> u8;

fn rgba(w: u32, h: u32, pixel: &Gray) -> Vec<u8> {
    let mut data = Vec::new();
    for y in 0..h {
        for x in 0..w {
            let v = pixel(x, y);
            data.extend([v, v, v, 255]);
        }
    }
    data
}

/// The red channel of all levels; the blocks are decoded by the dds crate.
fn by_image_dds(n: u32, image: ImageFormat, format: dds::Format, pixel: &Gray, mips: Mipmaps) -> Vec<Vec<u8>> {
    let data = rgba(n, n, pixel);
    let surface = SurfaceRgba8 { width: n, height: n, depth: 1, layers: 1, mipmaps: 1, data: &data[..] };
    let made = surface.encode(image, Quality::Slow, mips).unwrap();
    let mut rest: &[u8] = &made.data;
    let mut levels = Vec::new();
    for level in 0..made.mipmaps {
        let m = (n >> level).max(1);
        levels.push(read_level(&mut rest, m, format));
    }
    assert!(rest.is_empty());
    levels
}

fn read_level(rest: &mut &[u8], m: u32, format: dds::Format) -> Vec<u8> {
    let mut out = vec![0; (m * m * 4) as usize];
    let view = dds::ImageViewMut::new(&mut out, dds::Size::new(m, m), dds::ColorFormat::RGBA_U8).unwrap();
    dds::decode(rest, view, format, &dds::DecodeOptions::default()).unwrap();
    out.iter().step_by(4).copied().collect()
}

fn by_dds(n: u32, format: dds::Format, pixel: &Gray) -> Vec<Vec<u8>> {
    let data = rgba(n, n, pixel);
    let header = dds::header::Header::new_image(n, n, format).with_mipmaps();
    let mut file = Vec::new();
    let mut encoder = dds::Encoder::new(&mut file, format, &header).unwrap();
    encoder.mipmaps.generate = true;
    encoder.write_surface(dds::ImageView::new(&data, dds::Size::new(n, n), dds::ColorFormat::RGBA_U8).unwrap()).unwrap();
    encoder.finish().unwrap();
    let mut decoder = dds::Decoder::new(&file[..]).unwrap();
    let mut levels = Vec::new();
    let mut m = n;
    loop {
        let mut out = vec![0; (m * m * 4) as usize];
        let view = dds::ImageViewMut::new(&mut out, dds::Size::new(m, m), dds::ColorFormat::RGBA_U8).unwrap();
        decoder.read_surface(view).unwrap();
        levels.push(out.iter().step_by(4).copied().collect());
        if m == 1 {
            return levels;
        }
        m /= 2;
    }
}

fn mean(pixels: &[u8]) -> f64 {
    pixels.iter().map(|&v| v as f64).sum::<f64>() / pixels.len() as f64
}

fn off(got: &[u8], right: &[u8]) -> i32 {
    got.iter().zip(right).map(|(&a, &b)| (a as i32 - b as i32).abs()).max().unwrap()
}

fn check(good: bool, what: &str) {
    if !good {
        eprintln!("behaviour changed: {what}");
        std::process::exit(1);
    }
}

fn main() {
    let all = Mipmaps::GeneratedAutomatic;
    let plain = (ImageFormat::Rgba8Unorm, dds::Format::R8G8B8A8_UNORM);

    // 1. sizes that are not a power of two
    for n in [3u32, 7, 63, 511] {
        let half = (n + 1) / 2;
        let picture = move |x: u32, y: u32| if x < half && y < half { 0 } else { 200 };
        let levels = by_image_dds(n, plain.0, plain.1, &picture, all);
        let other = by_dds(n, plain.1, &picture);
        let right = mean(&levels[0]);
        let (got, peer) = (levels.last().unwrap()[0], other.last().unwrap()[0]);
        println!("{n} x {n}, mean {right:.1}: the 1 x 1 level is {got} by image_dds, {peer} by dds");
        check(got == 0, "an odd row or column is used");
        check((peer as f64 - right).abs() < 25.0, "the dds crate leaves pixels out");
    }
    check(by_image_dds(512, plain.0, plain.1, &|x, y| if x < 256 && y < 256 { 0 } else { 200 }, all)[9] == [150], "512 x 512");

    // 2. blocks that are not full
    let ramp = |x: u32, y: u32| (128 + 10 * x.min(5) + 10 * y.min(5)) as u8;
    let formats = [
        ("BC1", ImageFormat::BC1RgbaUnorm, dds::Format::BC1_UNORM),
        ("BC4", ImageFormat::BC4RUnorm, dds::Format::BC4_UNORM),
        ("BC5", ImageFormat::BC5RgUnorm, dds::Format::BC5_UNORM),
    ];
    let right = by_image_dds(8, plain.0, plain.1, &ramp, all)[2].clone();
    let level = by_image_dds(8, formats[0].1, formats[0].2, &ramp, all)[2].clone();
    let two = right.clone();
    let repeated = move |x: u32, y: u32| two[(y.min(1) * 2 + x.min(1)) as usize];
    let best = &by_image_dds(4, formats[0].1, formats[0].2, &repeated, Mipmaps::Disabled)[0];
    let best = [best[0], best[1], best[4], best[5]];
    println!("8 x 8 in BC1: its 2 x 2 level {right:?} is decoded as {level:?}, with the edge repeated as {best:?}");
    check(off(&level, &right) >= 2 * off(&best, &right) && off(&level, &right) > 15, "the 2 x 2 block is not filled with zeros");

    let want: Vec<u8> = (0..36).map(|i| ramp(i % 6, i / 6)).collect();
    for (title, image, format) in formats {
        let six = &by_image_dds(6, image, format, &ramp, Mipmaps::Disabled)[0];
        let eight = &by_image_dds(8, image, format, &ramp, Mipmaps::Disabled)[0];
        let inner: Vec<u8> = (0..36).map(|i| eight[(i / 6 * 8 + i % 6) as usize]).collect();
        let peer = by_dds(6, format, &ramp);
        let (bad, good, peer) = (off(six, &want), off(&inner, &want), off(&peer[0], &want));
        println!("6 x 6 ramp in {title}: off by {bad}, with the edge repeated by {good}, by the dds crate {peer}");
        check(bad >= 3 * good && peer < bad, "blocks are not filled with zeros");
    }

    // 3. rounding
    let hash = |x: u32, y: u32| {
        let mut v = (x * 1024 + y).wrapping_mul(0x9e37_79b1);
        v = (v ^ (v >> 15)).wrapping_mul(0x85eb_ca77);
        64 + ((v ^ (v >> 13)) >> 20) as u8 % 128
    };
    let levels = by_image_dds(1024, plain.0, plain.1, &hash, all);
    let other = by_dds(1024, plain.1, &hash);
    let means: Vec<String> = levels.iter().map(|l| format!("{:.1}", mean(l))).collect();
    println!("noise, means of the levels: {}; by dds the last is {}", means.join(" "), other[10][0]);
    check(mean(&levels[0]) - levels[10][0] as f64 > 3.0, "averages are rounded");
    check((mean(&levels[0]) - other[10][0] as f64).abs() < 1.5, "the dds crate does not round");

    // 4. sRGB
    let checker = |x: u32, y: u32| if (x + y) % 2 == 0 { 0 } else { 255 };
    let levels = by_image_dds(4, ImageFormat::Rgba8UnormSrgb, plain.1, &checker, all);
    println!("black and white in R8G8B8A8_UNORM_SRGB: {:?}, half of the light is 188", levels[1]);
    check(levels[1] == [127; 4], "sRGB is averaged as light");
}
RUST
cargo run -q 2> cargo.log || { tail -n 5 cargo.log >&2; exit 1; }
echo "as described"
