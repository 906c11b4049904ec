use std::collections::BTreeSet;

use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::*;

/// Few values, so that many are equal, and some that are not numbers.
fn figure() -> impl Strategy<Value = f64> {
    prop_oneof![8 => (0..6).prop_map(f64::from), 1 => Just(f64::NAN), 1 => Just(f64::INFINITY)]
}

fn aim() -> impl Strategy<Value = Aim> {
    prop_oneof![figure().prop_map(Aim::Psnr), figure().prop_map(Aim::Budget)]
}

fn named(precision: Precision) -> Option<String> {
    Profile::ALL.into_iter().find(|profile| profile.precision() == precision).map(|profile| profile.name().into())
}

/// Candidates of the grid with random figures.
fn list() -> impl Strategy<Value = Vec<Candidate>> {
    let one = (0..40_usize, figure(), proptest::array::uniform4(proptest::option::of(figure())));
    proptest::collection::vec(one, 0..12).prop_map(|drawn| {
        let (mut all, mut list) = (candidates(), Vec::new());
        for (place, psnr, cost) in drawn {
            // No precision twice: a precision has one cost.
            let precision = all.remove(place);
            list.push(Candidate { precision, name: named(precision), psnr, cost });
        }
        list
    })
}

/// The choice by its definition: a candidate that meets the aim, and no candidate that meets it is better.
fn brute_force(list: &[Candidate], aim: Aim, clock: Clock) -> Option<&Candidate> {
    let cost = |of: &Candidate| of.cost[clock as usize].unwrap_or(f64::NAN);
    let meets = |of: &&Candidate| match aim {
        Aim::Psnr(bar) => of.psnr >= bar && !cost(of).is_nan(),
        Aim::Budget(most) => cost(of) <= most && !of.psnr.is_nan(),
    };
    let is_better = |a: &Candidate, b: &Candidate| {
        let cheaper = [cost(a) < cost(b), cost(a) > cost(b)];
        let closer = [a.psnr > b.psnr, a.psnr < b.psnr];
        let order = if matches!(aim, Aim::Psnr(_)) { [cheaper, closer] } else { [closer, cheaper] };
        let decided = order.into_iter().find(|[better, worse]| *better || *worse);
        decided.map_or(a.name.is_some() && b.name.is_none(), |[better, _]| better)
    };
    let good: Vec<_> = list.iter().filter(meets).collect();
    good.iter().find(|one| !good.iter().any(|other| is_better(other, one))).copied()
}

/// Knobs of a choice: NaN does not equal itself, knobs do.
fn knobs(choice: Result<&Candidate, &NoChoice>) -> Result<Precision, Option<Precision>> {
    match choice {
        Ok(candidate) => Ok(candidate.precision),
        Err(NoChoice::Unknown(_)) => Err(None),
        Err(NoChoice::Missed { nearest, .. }) => Err(Some(nearest.precision)),
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 1000, failure_persistence: None, rng_seed: RngSeed::Fixed(13), ..Default::default()
    })]

    #[test]
    fn the_choice_is_that_of_brute_force(list in list(), aim in aim()) {
        for clock in Clock::ALL {
            let chosen = choose(&list, aim, clock);
            prop_assert_eq!(chosen.as_ref().ok().map(|one| one.precision), brute_force(&list, aim, clock).map(|one| one.precision));
            if let Err(NoChoice::Missed { nearest, .. }) = chosen {
                let known = list.iter().filter_map(|one| Some((one, one.cost_on(clock)?)));
                for (one, cost) in known {
                    match aim {
                        Aim::Psnr(_) => prop_assert!(nearest.psnr >= one.psnr || one.psnr.is_nan()),
                        Aim::Budget(_) => prop_assert!(nearest.cost_on(clock).is_some_and(|least| least <= cost)),
                    }
                }
            }
        }
    }

    #[test]
    fn the_lazy_choice_is_the_exhaustive_one_and_measures_no_more_than_it_needs(list in list(), aim in aim()) {
        for clock in Clock::ALL {
            let of = |p: &Precision| list.iter().find(|one| one.precision == *p).unwrap();
            let precisions: Vec<_> = list.iter().map(|one| one.precision).collect();
            let mut looked_at = 0;
            let measured = measure(&precisions, aim, clock, |p| of(p).cost_on(clock), |p| {
                looked_at += 1;
                of(p).psnr
            });
            let (lazy, all) = (choose(&measured, aim, clock), choose(&list, aim, clock));
            prop_assert_eq!(knobs(lazy.as_ref().copied()), knobs(all.as_ref().copied()));
            prop_assert_eq!(looked_at, measured.len());
            let last = measured.last().and_then(|one| one.cost_on(clock));
            match (aim, all) {
                (Aim::Psnr(_), Ok(chosen)) => prop_assert_eq!(last, chosen.cost_on(clock)),
                (Aim::Budget(most), Ok(_)) => prop_assert!(last.is_some_and(|cost| cost <= most)),
                _ => {}
            }
        }
    }

    #[test]
    fn what_is_next_cheaper_misses_the_bar(list in list(), bar in figure()) {
        let (aim, clock) = (Aim::Psnr(bar), Clock::Hardware);
        if let Ok(chosen) = choose(&list, aim, clock) && let Some(next) = next_cheaper(&list, chosen, clock) {
            prop_assert!(next.cost_on(clock) < chosen.cost_on(clock));
            prop_assert!(next.psnr.is_nan() || next.psnr < bar);
        }
    }
}

#[test]
fn the_grid_has_every_named_profile_and_nothing_twice() {
    let all = candidates();
    assert_eq!(all[..5], Profile::ALL.map(Profile::precision));
    // Only `paper` of the named profiles is not a point of the grid.
    assert_eq!(all.len(), 9 * 3 * 2 * 5 * 2 + 1);
    assert_eq!(all.iter().map(|p| format!("{p:?}")).collect::<BTreeSet<_>>().len(), all.len());
    assert!(all.iter().all(|p| p.checked().is_ok()));
}

#[test]
fn what_misses_says_by_how_much() {
    let candidate = |psnr, cost| Candidate { precision: Precision::STANDARD, name: None, psnr, cost: [Some(cost); 4] };
    let list = [candidate(40.0, 10.0), candidate(30.0, 4.0)];
    let message = |aim| choose(&list, aim, Clock::Host).unwrap_err().to_string();
    assert_eq!(message(Aim::Psnr(42.5)), "none reaches 42.5 dB; the most accurate has 40.00 dB, 2.50 dB less");
    assert!(message(Aim::Budget(2.0)).ends_with("the cheapest costs 4.000000, 2.00 times that"));
    assert_eq!(choose(&[], Aim::Psnr(1.0), Clock::Memory), Err(NoChoice::Unknown(Clock::Memory)));
    for clock in Clock::ALL {
        assert_eq!(clock.to_string().parse(), Ok(clock));
    }
    assert!("watch".parse::<Clock>().unwrap_err().contains("softcore"));
}
