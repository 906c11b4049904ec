//! What tells a changed core from the right one, built and run in seconds. Tests run one by one, the quick ones first, up to the first that
//! fails; an argument is a part of the names of those that run.

mod designs;
mod maps;
mod random;
mod tile;
mod vectors;
mod walk;

/// A test: its name and what panics where it fails.
type Test = (&'static str, fn());

/// The tests of these modules.
macro_rules! tests {
    ($($module:ident::$name:ident,)*) => {
        const TESTS: &[Test] = &[$((concat!(stringify!($module), "::", stringify!($name)), $module::$name)),*];
    };
}

tests! {
    maps::levels_of_an_environment_halve_down_to_the_coarsest_edge,
    designs::what_a_design_makes_of_random_integers_hashes_to_what_it_did,
    maps::what_fragments_see_of_maps_hashes_to_what_it_did,
    tile::the_tile_hashes_to_what_it_does_on_every_machine,
    vectors::every_field_of_every_golden_vector_is_that_of_the_soft_core,
}

fn main() {
    let part = std::env::args().nth(1).unwrap_or_default();
    for (name, test) in TESTS.iter().filter(|(name, _)| name.contains(&part)) {
        println!("{name}");
        let begin = std::time::Instant::now();
        test();
        println!("{:?}", begin.elapsed());
    }
}
