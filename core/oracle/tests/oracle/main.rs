//! Fast oracle that tells a changed core from the right one, built and run in seconds.
//!
//! Tests run one by one, the quick ones first, up to the first failure. An argument selects the tests whose names contain it.

mod batch;
mod designs;
mod elementary;
mod lists;
mod maps;
mod rom;
mod scanline;
mod setup;
mod scalar_api;
mod stages;
mod tile;
mod vectors;
mod words;

/// A test: its name and a function that panics on failure.
type Test = (&'static str, fn());

/// The tests of these modules.
macro_rules! tests {
    ($($module:ident::$name:ident,)*) => {
        const TESTS: &[Test] = &[$((concat!(stringify!($module), "::", stringify!($name)), $module::$name)),*];
    };
}

tests! {
    lists::everything_with_a_name_is_found_by_it,
    lists::what_is_declared_per_object_is_a_constant_with_all_its_parts,
    lists::a_datapath_is_a_design_with_the_status_bits_that_its_stages_raise,
    lists::a_knob_has_the_values_of_its_range_and_no_others,
    lists::a_knob_that_is_set_has_that_value_and_is_read_as_it_is_written,
    lists::precisions_of_a_width_are_profiles_with_that_width,
    lists::profiles_have_the_knobs_that_the_manifests_of_sets_name,
    lists::a_frame_is_needed_for_bumps_roughness_and_what_is_local,
    lists::plans_have_of_the_effects_what_their_datapath_knows,
    elementary::what_rounds_up_to_one_has_the_seed_of_the_last_interval,
    elementary::a_step_squares_the_error_of_a_seed,
    elementary::logarithms_and_powers_are_right_on_words_of_every_width,
    elementary::logarithms_beside_one_keep_the_accuracy_of_small_numbers,
    elementary::a_short_number_is_its_fraction_at_its_exponent,
    elementary::one_and_a_number_is_the_larger_of_them_where_they_are_far_apart,
    stages::the_spread_of_axes_is_right_however_far_apart_they_are,
    stages::a_roughness_is_a_number_up_to_four_with_the_bits_of_its_wide_wire,
    stages::a_sweep_far_from_its_direction_has_a_level_that_far_up_to_its_bound,
    stages::a_backend_that_branches_has_the_frames_of_one_that_does_not,
    words::leading_zeros_by_table_are_those_of_the_processor,
    words::products_without_a_multiplier_are_exact,
    words::words_of_small_processors_round_and_normalise_as_the_others_do,
    words::wires_of_small_processors_are_integers_of_their_bits,
    words::bundles_keep_every_bit_on_words_of_every_backend_but_the_lower_half_of_narrow_words,
    words::limits_are_the_ends_of_the_declared_ranges,
    words::a_bundle_says_how_many_words_it_takes,
    words::a_part_that_is_left_out_has_no_wires,
    words::a_walk_need_not_know_where_it_is,
    words::blocks_are_equal_where_mantissas_and_exponents_are,
    words::places_count_from_zero,
    words::wires_with_a_point_are_integers_shifted,
    words::a_memory_is_read_at_its_end_where_a_place_is_beyond_it,
    words::a_backend_of_one_fragment_takes_its_own_turns,
    rom::an_entry_on_fewer_bits_is_rounded,
    rom::seeds_are_reciprocals_and_inverse_roots_in_the_middle_of_their_intervals,
    rom::logarithms_and_powers_are_to_the_nearest,
    rom::sines_are_to_the_nearest_for_every_even_number_of_steps,
    rom::constants_of_a_count_of_probes_are_to_the_nearest,
    rom::running_sums_of_weights_are_to_the_nearest,
    rom::probes_of_a_sweep_are_parts_of_the_normal_law,
    rom::probes_of_a_sweep_come_from_those_of_one_less,
    setup::scaling_by_powers_of_two_is_exact_to_the_ends_of_float64,
    setup::a_vector_as_a_port_is_rounded_to_the_bits_of_the_profile,
    setup::the_real_numbers_of_ports_are_mantissas_at_their_exponents,
    setup::an_offset_is_rounded_to_its_bits_and_saturated,
    setup::shininess_has_the_exponent_and_its_root_to_the_nearest,
    setup::amplitudes_and_exponents_are_the_nearest_codes,
    setup::the_normal_of_a_stored_peak_has_unit_length_whatever_came,
    setup::a_horizon_has_slopes_and_inverse_widths,
    setup::a_uniform_law_has_its_mean_and_deviation,
    scanline::a_triangle_has_the_pixels_whose_centres_are_inside,
    scanline::corners_out_of_range_and_backs_are_no_triangles,
    scanline::attributes_of_fragments_are_perspective_correct,
    scanline::a_plane_is_its_corners_at_its_corners,
    scalar_api::every_plan_hashes_to_what_it_did,
    scalar_api::an_effect_that_is_off_leaves_its_inputs_unread,
    scalar_api::a_backend_that_branches_has_the_probes_of_one_that_does_not,
    scalar_api::constants_of_a_map_are_those_of_its_longer_edge,
    scalar_api::firmware_has_the_bits_of_the_scalar_api,
    batch::a_batch_ends_after_its_fragments,
    batch::a_batch_has_the_bits_of_its_fragments_alone,
    designs::what_a_design_makes_of_random_integers_hashes_to_what_it_did,
    maps::what_fragments_see_of_maps_hashes_to_what_it_did,
    maps::beyond_the_last_level_of_a_map_the_last_one_is_read,
    maps::levels_of_an_environment_halve_down_to_the_coarsest_edge,
    tile::the_tile_hashes_to_what_it_does_on_every_machine,
    vectors::every_field_of_every_golden_vector_is_that_of_the_scalar_api,
}

fn main() {
    let part = std::env::args().nth(1).unwrap_or_default();
    for (name, test) in TESTS.iter().filter(|(name, _)| name.contains(&part)) {
        println!("{name}");
        test();
    }
}
