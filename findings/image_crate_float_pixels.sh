#!/usr/bin/env bash
# image (Rust): a smaller copy of a panorama of float pixels is cut to 0..1 by resize, and half a unit brighter by thumbnail.
#
# Expected: a picture that has the same value in all pixels keeps that value in any smaller or blurred copy, for the weights of a filter
#   add up to 1. That holds for light above 1 and for negative numbers too: the pixels are 32-bit floats.
# Seen: 1. imageops::resize and DynamicImage::resize_exact cut float pixels to 0..1 with all five filters, Nearest too, which only
#   copies pixels. The same call with the same size returns the values uncut. fast_blur and the inner pixels of filter3x3 cut as well.
#   2. thumbnail adds 0.5 to each float channel when it makes a picture smaller: 0.25 becomes 0.75, black becomes gray, and a
#   second step 1.25. It is the rounding of integer pixels. When it makes a picture larger, it does not.
#   3. blur keeps all values, as the only one of the five functions. No message in any case.
#   A sun of 4096 in a sky of 0.5 has the mean light 128.5; after resize it is 0.64, after thumbnail 129.0.
# Versions: image 0.25.10 (cargo), with the feature hdr.
# Why it matters: halving a panorama is the usual step before it goes into a texture memory, and mip levels are made that way. A sky without
#   a sun looks nearly right, so the lost light is sought in the hardware. Of a float normal map (-1 to 1) the directions to the left
#   and down are lost: -0.6 becomes 0. Tests with 8- and 16-bit pictures pass.
# Source: documentation of imageops 0.25.10, resize, filter3x3 and fast_blur: the input is assumed to be scene-linear light; no word
#   of a range. Of thumbnail: each source pixel contributes to exactly one target pixel. The README lists the HDR format with 32-bit
#   float RGB. The half unit of thumbnail is reported in the repository's issue 2273, open since 2024.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
mkdir "$T/src"
cat > "$T/Cargo.toml" <<'TOML'
[package]
name = "pixels"
version = "0.0.0"
edition = "2021"
[dependencies]
image = { version = "=0.25.10", default-features = false, features = ["hdr"] }
[profile.dev]
debug = false
incremental = false
[workspace]
TOML
cat > "$T/src/main.rs" <<'RS'
use image::imageops::{self, FilterType};
use image::{DynamicImage, Rgb, Rgb32FImage, RgbImage};

fn check(ok: bool, what: &str) {
    if !ok {
        eprintln!("behaviour changed: {what}");
        std::process::exit(1);
    }
}
fn near(a: f32, b: f32) -> bool {
    (a - b).abs() < 1e-3 * b.abs().max(1.0)
}
fn mean(picture: &Rgb32FImage) -> f32 {
    picture.pixels().map(|p| p[0] as f64).sum::<f64>() as f32 / (picture.width() * picture.height()) as f32
}

fn main() {
    // 1. All pixels alike: bright red, green in range, negative blue.
    let flat = Rgb32FImage::from_pixel(16, 8, Rgb([4.0, 0.25, -0.6]));
    let filters = [FilterType::Nearest, FilterType::Triangle, FilterType::CatmullRom, FilterType::Gaussian, FilterType::Lanczos3];
    println!("every pixel is {:?}; a pixel of the copy:", flat.get_pixel(0, 0).0);
    for filter in filters {
        let small = imageops::resize(&flat, 8, 4, filter).get_pixel(3, 1).0;
        let method = DynamicImage::ImageRgb32F(flat.clone()).resize_exact(8, 4, filter).to_rgb32f().get_pixel(3, 1).0;
        let same = imageops::resize(&flat, 16, 8, filter).get_pixel(3, 1).0;
        println!("  resize to half, {filter:?}: {small:?}; to the same size: {same:?}");
        check(small[0] == 1.0 && near(small[1], 0.25) && small[2] == 0.0 && small == method, "resize to half");
        check(same == [4.0, 0.25, -0.6], "resize to the same size");
    }
    let fast = imageops::fast_blur(&flat, 1.0).get_pixel(3, 3).0;
    let identity = imageops::filter3x3(&flat, &[0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]).get_pixel(3, 3).0;
    let blur = imageops::blur(&flat, 1.0).get_pixel(3, 3).0;
    println!("  fast_blur: {fast:?}\n  filter3x3, only the middle: {identity:?}\n  blur: {blur:?}");
    check(fast[0] == 1.0 && fast[2] == 0.0 && identity == [1.0, 0.25, 0.0], "fast_blur or filter3x3");
    check(near(blur[0], 4.0) && near(blur[1], 0.25) && near(blur[2], -0.6), "blur");

    // 2. thumbnail.
    let half = imageops::thumbnail(&flat, 8, 4);
    let quarter = imageops::thumbnail(&half, 4, 2);
    let twice = imageops::thumbnail(&flat, 32, 16);
    let (h, q, t) = (half.get_pixel(3, 1).0, quarter.get_pixel(1, 1).0, twice.get_pixel(3, 1).0);
    println!("  thumbnail to half: {h:?}, half of that: {q:?}, to twice the size: {t:?}");
    check(near(h[0], 4.5) && near(h[1], 0.75) && near(h[2], -0.1) && near(q[1], 1.25) && near(t[1], 0.25), "thumbnail");

    // 3. A sun, through a Radiance file, and the same with 8-bit pixels.
    let sky = Rgb32FImage::from_fn(16, 8, |x, y| Rgb([if x / 2 == 3 && y / 2 == 1 { 4096.0 } else { 0.5 }; 3]));
    let mut file = Vec::new();
    let pixels: Vec<Rgb<f32>> = sky.pixels().copied().collect();
    image::codecs::hdr::HdrEncoder::new(&mut file).encode(&pixels, 16, 8).unwrap();
    let read = image::load_from_memory(&file).unwrap().to_rgb32f();
    let small = imageops::resize(&read, 8, 4, FilterType::Triangle);
    let thumb = imageops::thumbnail(&read, 8, 4);
    println!("sun of 4096 in a sky of 0.5, mean light: {:.4} as read, {:.4} after resize, {:.4} after thumbnail", mean(&read), mean(&small), mean(&thumb));
    check(near(mean(&read), 128.484) && mean(&small) < 0.7 && near(mean(&thumb), 128.984), "the panorama with a sun");
    let bytes = RgbImage::from_pixel(16, 8, Rgb([64, 128, 255]));
    check(imageops::thumbnail(&bytes, 8, 4).get_pixel(3, 1).0 == [64, 128, 255], "8-bit pixels");
    check(imageops::resize(&bytes, 8, 4, FilterType::Triangle).get_pixel(3, 1).0 == [64, 128, 255], "8-bit pixels");
}
RS
cd "$T"
nice cargo run --quiet 2> log.txt || {
  cat log.txt
  exit 1
}
echo "as described"
