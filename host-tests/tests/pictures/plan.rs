//! Promises of a plan for every effect: a neutral map changes no bit, a block planned away is never entered, and a map planned away takes no
//! memory. `benches/effects.rs` measures the cost of each effect.

mod blocks;

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use roughxel_core::plan::ReflectionPlan;
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_frame::plan::Mode;
use roughxel_frame::{Frame, Prepared};
use roughxel_host_tests::bars::{self, MODES};
use roughxel_host_tests::keys::{has_keys, without_keys};
use roughxel_host_tests::space::profiles;
use roughxel_peaks::ScenePeaks;
use roughxel_scene::{RoughnessField, Scene};
use roughxel_shader::{Effect, ObjectPlan};

const FRAMES: [&str; 3] = ["main-direction", "natural", "natural-normalised"];

/// A height map without heights.
const FLAT: &str = "height_map = { generate = \"waves\", size = 32, scale = 0 }";

const LIGHT: &str = "[[light]]\ndirection = [-0.4, 0.9, 0.5]\n";

/// A plane and a ball of `material` each, under a light.
fn two_shapes(material: &str) -> Scene {
    bars::two_shapes("checker", LIGHT, material)
}

/// A plane parallel to the picture, so near that a texel of a map or of the reflected environment is many pixels wide.
fn facing(material: &str) -> Scene {
    let text = format!(
        "[camera]\neye = [0, 4, 0]\ntarget = [0, 0, 0]\nup = [0, 0, -1]\nfov_y = 30\nwidth = 96\nheight = 72\n\
         [background]\ncolour = [0, 0, 0]\n[environment]\ngenerate = \"zebra\"\nface_edge = 16\n{LIGHT}\
         [[object]]\nshape = \"plane\"\nsize = [8, 8]\nsegments = [8, 8]\nmaterial = {{ {material} }}\n"
    );
    Scene::from_toml("plan", &text, Path::new("")).unwrap()
}

/// Columns of [`facing`] that show nothing from the right of its middle, with a margin of a twentieth of a picture.
const LEFT: Range<usize> = 0..48;
const ALL: Range<usize> = 0..96;

/// Two frames that must have the same bits.
struct Neutral {
    /// A scene with the effect in a form that changes nothing.
    with: Scene,
    /// The scene without the effect.
    without: Scene,
    /// The plan of the first scene, if a scene alone cannot ask for the effect.
    plan_with: fn(ObjectPlan) -> ObjectPlan,
    /// The plan of the second scene.
    plan_without: fn(ObjectPlan) -> ObjectPlan,
    /// Columns to compare.
    columns: Range<usize>,
    /// True if the effect needs samples with footprints.
    needs_footprint: bool,
}

impl Neutral {
    /// Two scenes with their own plans.
    fn scenes(shapes: fn(&str) -> Scene, common: &str, neutral: &str) -> Self {
        let with = shapes(&format!("{common}, {neutral}"));
        let same: fn(ObjectPlan) -> ObjectPlan = |plan| plan;
        let without = shapes(common);
        Self { with, without, plan_with: same, plan_without: same, columns: ALL, needs_footprint: false }
    }

    /// One scene under its own plan, with footprints of samples, and under a different plan.
    fn plans(scene: Scene, plan_without: fn(ObjectPlan) -> ObjectPlan, columns: Range<usize>) -> Self {
        let with = scene.clone();
        Self { with, without: scene, plan_with: |plan| plan, plan_without, columns, needs_footprint: true }
    }
}

/// Removes roughness but keeps the footprint: on the sphere a smooth fragment also has one if other fragments of its object are rough.
fn smooth_on_the_same_footprint(plan: ObjectPlan) -> ObjectPlan {
    let reflection = plan.reflection.map(|kept| ReflectionPlan { roughness: RoughnessKind::None, ..kept });
    ObjectPlan { reflection, ..plan.without(Effect::Roughness) }
}

/// A surface that faces the picture, rough only to the right of its middle.
fn half_rough(material: &str) -> Scene {
    let mut scene = facing(material);
    let factor = |index: usize| if index % 64 < 34 { [0.0; 3] } else { [0.3, 0.1, 0.2] };
    let factors = (0..64 * 64).map(factor).collect();
    scene.objects[0].material.roughness = Some(Arc::new(RoughnessField { width: 64, height: 64, factors }));
    scene
}

/// Every neutral form of an effect.
fn neutral_forms(effect: Effect) -> Vec<Neutral> {
    match effect {
        // 1 is stored as 65535/65536; half is exact, and so is half of twice the colour.
        Effect::ColourTexture => vec![Neutral {
            without: two_shapes("colour = [0.25, 0.125, 0.5]"),
            ..Neutral::scenes(
                two_shapes,
                "colour = [0.5, 0.25, 1]",
                "colour_map = { generate = \"checker\", size = 16, light = [0.5, 0.5, 0.5], dark = [0.5, 0.5, 0.5] }",
            )
        }],
        Effect::Bump => FRAMES
            .iter()
            .flat_map(|frame| {
                ["reflectance = 0.8", "highlight = { exponent = 20 }"]
                    .map(|shine| Neutral::scenes(two_shapes, &format!("{shine}, frame = \"{frame}\""), FLAT))
            })
            .collect(),
        // A map that is rough only to the right of the middle; fragments seen on the left wait in the same batches. A highlight shows it in every
        // mode.
        Effect::Roughness => [("reflectance = 0.8", true), ("highlight = { exponent = 20 }", false)]
            .map(|(shine, needs_footprint)| {
                let scene = half_rough(shine);
                Neutral { needs_footprint, ..Neutral::plans(scene, smooth_on_the_same_footprint, LEFT) }
            })
            .into(),
        // Less than half a unit of the reflectance's last place.
        Effect::Environment => vec![Neutral::scenes(two_shapes, "colour = [0.5, 0.25, 1]", "reflectance = 1e-6")],
        // If nothing is rough, both lobes are none.
        Effect::TwoLobes => {
            let scene = half_rough("reflectance = 0.8, two_lobes = true");
            vec![Neutral::plans(scene, |plan| plan.without(Effect::TwoLobes), LEFT)]
        }
        // One probe at the finest level, exactly at the place of the sample.
        Effect::Footprint => {
            let map = "colour_map = { generate = \"checker\", size = 8, squares = 2 }";
            let bumps = "height_map = { generate = \"waves\", size = 8, highest = 2, scale = 0 }";
            ["colour = [1, 1, 1]", "reflectance = 0.5", "highlight = { exponent = 20 }"]
                .map(|shine| facing(&format!("{shine}, {map}, {bumps}")))
                .map(|scene| Neutral::plans(scene, |plan| plan.without(Effect::Footprint), ALL))
                .into()
        }
        // One object in every pixel.
        Effect::Edges => {
            vec![Neutral::plans(facing("colour = [1, 0.5, 0.25]"), |plan| plan.without(Effect::Edges), ALL)]
        }
        // Triangles to the right of the middle are curved; those on the left wait in the same batches.
        Effect::Curvature => {
            let mut scene = facing("reflectance = 0.8");
            for vertex in scene.objects[0].mesh.vertices.iter_mut().filter(|vertex| vertex.position.x > 0.5) {
                vertex.normal = (DVec3::Y + 0.2 * vertex.position.x * DVec3::X).normalize();
            }
            vec![Neutral::plans(scene, |plan| plan.without(Effect::Curvature), LEFT)]
        }
        Effect::Highlight => ["colour = [0.5, 0.25, 1]", "reflectance = 0.8"]
            .map(|common| Neutral::scenes(two_shapes, common, "highlight = { exponent = 20, colour = [0, 0, 0] }"))
            .into(),
        Effect::Peaks => {
            let none = "peaks = { given = [{ amplitude = 0, normal = [0.6, 0, 0.8], exponent = 10 }] }";
            let black = format!("{FLAT}, peaks = {{ exponent = 20, colour = [0, 0, 0] }}");
            [none, &black].map(|peaks| Neutral::scenes(two_shapes, "colour = [0.5, 0.25, 1]", peaks)).into()
        }
        Effect::Horizon => {
            let peaks = |shadowing| two_shapes(&format!("{FLAT}, peaks = {{ exponent = 5, shadowing = {shadowing} }}"));
            vec![Neutral {
                with: peaks(true),
                without: peaks(false),
                plan_with: |plan| plan,
                plan_without: |plan| plan,
                columns: ALL,
                needs_footprint: false,
            }]
        }
    }
}

/// A scene with different plans from its own.
fn planned<'a>(scene: &'a Scene, mode: Mode, p: &Precision, change: impl Fn(ObjectPlan) -> ObjectPlan) -> Prepared<'a> {
    let prepared = Prepared::new(scene, mode, p).unwrap();
    let plans: Vec<ObjectPlan> = prepared.plans().map(|plan| change(*plan)).collect();
    plans.into_iter().enumerate().fold(prepared, |prepared, (index, plan)| prepared.with_plan(index, plan))
}

fn draw(prepared: &Prepared<'_>) -> Frame {
    prepared.render(&|| ()).unwrap()
}

/// Pixels that differ in some columns of two frames, and the largest difference.
fn different(a: &Frame, b: &Frame, columns: &Range<usize>) -> (usize, i32) {
    let pairs = a.pixels.iter().zip(&b.pixels).enumerate();
    let seen = pairs.filter(|(index, _)| columns.contains(&(index % a.width as usize)));
    let differences = seen.map(|(_, (a, b))| (0..3).map(|i| (a[i] - b[i]).abs()).max().unwrap());
    differences.filter(|difference| *difference != 0).fold((0, 0), |(count, most), one| (count + 1, most.max(one)))
}

#[test]
fn a_neutral_map_changes_no_bit() {
    let mut found = Vec::new();
    for effect in Effect::ALL {
        for (form, neutral) in neutral_forms(effect).iter().enumerate() {
            for (profile, p) in profiles() {
                for mode in MODES {
                    let with = planned(&neutral.with, mode, &p, neutral.plan_with);
                    let without = planned(&neutral.without, mode, &p, neutral.plan_without);
                    let known =
                        ![Effect::Roughness, Effect::TwoLobes].contains(&effect) || p.roughness != RoughnessKind::None;
                    let on = known && (mode.filters() || !neutral.needs_footprint);
                    assert!(with.plans().all(|plan| plan.has(effect) == on), "{effect:?} {form}, {profile}, {mode}");
                    let off = without.plans().all(|plan| !plan.has(effect));
                    assert!(off, "{effect:?} {form}, {profile}, {mode}");
                    let (count, most) = different(&draw(&with), &draw(&without), &neutral.columns);
                    if count > 0 {
                        found.push(format!(
                            "{} {form}, {profile}, {mode}: {count} pixels, 2^{:.1} of 2^24",
                            effect.name(),
                            f64::from(most).log2()
                        ));
                    }
                }
            }
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

/// Squared distance of two frames, in units of the brightest of 64.
fn squared_distance(a: &Frame, b: &Frame) -> f64 {
    let channels = a.pixels.iter().flatten().zip(b.pixels.iter().flatten());
    channels.map(|(a, b)| (f64::from(a - b) / f64::from(1 << 24)).powi(2)).sum()
}

/// Roughness from the ramp between two texels within a pixel brings it nearer to many samples of it, not further away. No map that is seen from
/// nearby is blurred.
#[test]
fn magnified_bumps_have_the_roughness_of_their_pixels_and_no_more() {
    let bumps = "height_map = { generate = \"waves\", size = 16, highest = 4, rms_slope = 0.1 }";
    for shine in [
        "reflectance = 0.8, footprint = \"face\"",
        "reflectance = 0.8, footprint = \"sphere\"",
        "colour = [0, 0, 0], highlight = { exponent = 20 }",
    ] {
        let scene = facing(&format!("{shine}, {bumps}"));
        for (name, p) in profiles() {
            let truth = draw(&planned(&scene, Mode::Supersampled { edge: 8 }, &p, |plan| plan));
            for mode in [Mode::Isotropic, Mode::Footprint] {
                let rough = planned(&scene, mode, &p, |plan| plan);
                assert!(rough.plans().all(|plan| plan.has(Effect::Roughness)));
                let smooth = planned(&scene, mode, &p, smooth_on_the_same_footprint);
                let [rough, smooth] = [rough, smooth].map(|prepared| draw(&prepared));
                let [rough_error, smooth_error] = [&rough, &smooth].map(|frame| squared_distance(frame, &truth));
                // A thousandth is rounding noise if few pixels differ at all.
                let context = || format!("{shine}, {name}, {mode}: {rough_error:.4e}, smooth {smooth_error:.4e}");
                assert!(rough_error <= 1.001 * smooth_error, "{}", context());
                // Reflections that differ from those of a probe or of a lobe are hidden by the texels of their environment.
                let seen = shine.starts_with("reflectance") && mode == Mode::Footprint;
                assert!(!seen || rough_error < 0.96 * smooth_error, "{}", context());
            }
        }
    }
}

/// A frame that an effect changes shows that the comparison of columns works: to the right of the middle, half maps are not neutral.
#[test]
fn half_neutral_forms_are_seen_where_they_are_not() {
    for effect in [Effect::Roughness, Effect::TwoLobes, Effect::Curvature] {
        let half = neutral_forms(effect).into_iter().filter(|neutral| neutral.columns == LEFT);
        for neutral in half {
            for mode in MODES.into_iter().filter(|mode| *mode == Mode::Footprint || !neutral.needs_footprint) {
                let frame = |change| draw(&planned(&neutral.with, mode, &Precision::STANDARD, change));
                let (count, _) = different(&frame(neutral.plan_with), &frame(neutral.plan_without), &(60..96));
                assert!(count > 100, "{}, {mode}: {count}", effect.name());
            }
        }
    }
}

/// A highlight has no footprint: its roughness from a map is the same for a sample and for a pixel. A reflection needs a footprint.
#[test]
fn a_roughness_map_is_part_of_the_surface_of_a_highlight_in_every_mode() {
    let map = "roughness_map = { generate = \"uniform\", along = 0.1, across = 0.3 }";
    for (name, p) in profiles() {
        let scene = facing(&format!("colour = [0, 0, 0], highlight = {{ exponent = 40 }}, {map}"));
        let [unfiltered, footprint] = [Mode::Unfiltered, Mode::Footprint].map(|mode| {
            let rough = draw(&planned(&scene, mode, &p, |plan| plan));
            let smooth = draw(&planned(&scene, mode, &p, |plan| plan.without(Effect::Roughness)));
            let (count, _) = different(&rough, &smooth, &ALL);
            assert!(count > 1000, "{name}, {mode}: {count}");
            rough
        });
        assert!(unfiltered == footprint, "{name}: {:?}", different(&unfiltered, &footprint, &ALL));
        let mirror = facing(&format!("reflectance = 0.8, {map}"));
        for mode in MODES {
            let prepared = Prepared::new(&mirror, mode, &p).unwrap();
            assert!(prepared.plans().all(|plan| plan.has(Effect::Roughness) == mode.filters()), "{name}, {mode}");
        }
    }
}

#[test]
fn a_roughness_map_that_shows_nothing_is_not_sampled() {
    let uniform = |deviation: f64| {
        format!("roughness_map = {{ generate = \"uniform\", along = {deviation}, across = {deviation} }}")
    };
    for (shine, map, why) in [
        ("highlight = { exponent = 20 }", uniform(0.0), "`roughness_map` is all zero"),
        ("reflectance = 0.8", uniform(0.0), "`roughness_map` is all zero"),
        ("highlight = { exponent = 20, form = \"plain\" }", uniform(0.2), "`form` of the `highlight` is plain"),
        ("colour = [1, 1, 1]", uniform(0.2), "nothing is reflected or shines"),
    ] {
        let scene = facing(&format!("{shine}, {map}"));
        for mode in MODES {
            let prepared = Prepared::new(&scene, mode, &Precision::STANDARD).unwrap();
            assert!(prepared.plans().all(|plan| !plan.bump_map()), "{shine}, {mode}");
            let decision = prepared.decisions().flatten().find(|decision| decision.effect == Effect::Roughness);
            assert_eq!(decision.map(|decision| (decision.on, decision.why.as_str())), Some((false, why)), "{mode}");
            let bytes = bytes(&prepared);
            assert!(!bytes.contains_key("bump") && !bytes.contains_key("roughness"), "{shine}, {mode}: {bytes:?}");
        }
    }
}

/// A scene with every kind of map: a highlight has none.
fn every_map() -> Scene {
    let bumps = "height_map = { generate = \"waves\", size = 16, highest = 6, rms_slope = 0.2 }";
    two_shapes(&format!(
        "reflectance = 0.5, {bumps}, peaks = {{ exponent = 20, shadowing = true }}, \
         colour_map = {{ generate = \"checker\", size = 32, squares = 2 }}"
    ))
}

fn bytes(prepared: &Prepared<'_>) -> BTreeMap<&'static str, u64> {
    prepared.map_bytes(0).into_iter().map(|(effect, bytes)| (effect.name(), bytes)).collect()
}

/// Peaks of a scene without the keys of an effect. A scene with horizons has different peaks from one without, each for facets that see alike;
/// those peaks stay when the blocks of horizons are removed.
fn peaks_without(scene: &Scene, bare: &Scene, effect: Effect, mode: Mode) -> ScenePeaks {
    let of = if effect == Effect::Horizon { scene } else { bare };
    ScenePeaks::new(of, mode.filters(), None, &|_| ()).unwrap()
}

#[test]
fn an_effect_planned_away_leaves_the_frame_of_a_scene_without_its_keys() {
    let shiny = "colour = [0.3, 0.2, 0.1], height_map = { generate = \"waves\", size = 64, rms_slope = 0.2 }, \
                 highlight = { exponent = 40 }";
    let rough = format!("{shiny}, roughness_map = {{ generate = \"uniform\" }}");
    let lobes = format!("reflectance = 0.5, two_lobes = true, {shiny}");
    for scene in [every_map(), two_shapes(shiny), two_shapes(&rough), two_shapes(&lobes)] {
        for mode in MODES {
            let p = Precision::STANDARD;
            let prepared = Prepared::new(&scene, mode, &p).unwrap();
            let plan = *prepared.plans().next().unwrap();
            let has_peaks = plan.has(Effect::Peaks);
            for effect in Effect::ALL.into_iter().filter(|effect| plan.has(*effect) && has_keys(*effect)) {
                let away = planned(&scene, mode, &p, |plan| match effect {
                    // Peaks of a map need its bumps.
                    Effect::Bump => plan.without(Effect::Bump).without(Effect::Peaks),
                    _ => plan.without(effect),
                });
                let (bare, p) = without_keys(&scene, effect, &p);
                let peaks = peaks_without(&scene, &bare, effect, mode);
                let bare = Prepared::with_peaks(&bare, mode, &p, &peaks).unwrap();
                assert!(draw(&away) == draw(&bare), "{}, {mode}, peaks: {has_peaks}", effect.name());
            }
        }
    }
}

#[test]
fn maps_of_an_effect_planned_away_take_no_memory() {
    let scene = every_map();
    let p = Precision::STANDARD;
    let with = bytes(&Prepared::new(&scene, Mode::Footprint, &p).unwrap());
    for effect in Effect::ALL {
        // Effects removed together, the effect itself first.
        let gone: &[Effect] = match effect {
            Effect::Bump => &[Effect::Bump, Effect::Roughness],
            Effect::Peaks => &[Effect::Peaks, Effect::Horizon],
            Effect::ColourTexture | Effect::Roughness | Effect::Environment | Effect::Horizon => &[effect],
            Effect::TwoLobes | Effect::Footprint | Effect::Edges | Effect::Curvature | Effect::Highlight => continue,
        };
        assert!(gone.iter().all(|gone| with[gone.name()] > 0), "{}: {with:?}", effect.name());
        let mut left = with.clone();
        left.retain(|name, _| gone.iter().all(|gone| gone.name() != *name));
        let prepared = Prepared::new(&scene, Mode::Footprint, &p).unwrap();
        let plan = prepared.plans().next().unwrap().without(effect);
        // Nothing else that reflects or shines needs them.
        if effect == Effect::Environment {
            left.retain(|name, _| *name != Effect::Bump.name() && *name != Effect::Roughness.name());
        }
        assert_eq!(bytes(&prepared.with_plan(0, plan)), left, "another plan without {}", effect.name());
        // Peaks of a map are made of its bumps.
        if effect == Effect::Bump {
            left.retain(|name, _| *name != Effect::Peaks.name() && *name != Effect::Horizon.name());
        }
        let (bare, p) = without_keys(&scene, effect, &p);
        let peaks = peaks_without(&scene, &bare, effect, Mode::Footprint);
        let prepared = Prepared::with_peaks(&bare, Mode::Footprint, &p, &peaks).unwrap();
        assert_eq!(bytes(&prepared), left, "no key of {}", effect.name());
    }
}

#[test]
fn maps_without_footprints_are_their_finest_level_alone() {
    let scene = every_map();
    let [whole, finest] = [Mode::Footprint, Mode::Unfiltered]
        .map(|mode| bytes(&Prepared::new(&scene, mode, &Precision::STANDARD).unwrap()));
    // 32 by 32 texels of three 16-bit words, 16 by 16 of two; six faces of 64 by 64.
    assert_eq!((finest["colour texture"], finest["bump"]), (32 * 32 * 6, 16 * 16 * 4));
    assert!(!finest.contains_key("roughness"));
    for name in ["colour texture", "bump", "environment", "peaks", "horizon"] {
        assert!(finest[name] < whole[name], "{name}: {finest:?} {whole:?}");
    }
}
