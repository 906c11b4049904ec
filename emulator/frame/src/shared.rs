//! Maps of objects, each made once for all objects that share it.

use std::ptr;

use rayon::prelude::*;
use roughxel_core::datapath::LobeLaw;
use roughxel_core::precision::RoughnessKind;
use roughxel_maps::bump::BumpPyramid;
use roughxel_maps::law::Law;
use roughxel_shader::{ObjectPlan, core_and_whole};

use super::texture::StoredBumps;

/// Values of all objects, in their order. Objects with equal keys share a map: `make` is called once for them, with their indices, and returns a value
/// for each.
pub fn shared<K: Ord + Send, T: Send>(
    keys: impl Iterator<Item = K>,
    make: impl Fn(&[usize]) -> Vec<T> + Sync,
) -> Vec<T> {
    let mut order: Vec<(K, usize)> = keys.zip(0..).collect();
    order.sort_unstable();
    let group = |group: &[(K, usize)]| group.iter().map(|&(_, index)| index).collect();
    let groups: Vec<Vec<usize>> = order.chunk_by(|one, next| one.0 == next.0).map(group).collect();
    let made = groups.into_par_iter().flat_map_iter(|group| {
        let values = make(&group);
        group.into_iter().zip(values)
    });
    let mut made: Vec<(usize, T)> = made.collect();
    made.sort_unstable_by_key(|&(index, _)| index);
    made.into_iter().map(|(_, value)| value).collect()
}

/// Key of a map that several objects may hold; valid while it lives.
pub fn address<T>(map: &T) -> usize {
    ptr::from_ref(map).addr()
}

/// Plan of an object and the bumps that it reads.
pub(super) struct PlannedBumps {
    pub(super) plan: ObjectPlan,
    /// Laws of two lobes on the levels of the bump map, at least one.
    pub(super) lobes: Vec<LobeLaw<i32>>,
    pub(super) bumps: Option<StoredBumps>,
}

impl PlannedBumps {
    /// Bumps of objects that share a pyramid, from their plans. At most two forms are stored: with roughness, and without it.
    pub(super) fn of(pyramid: Option<BumpPyramid>, plans: Vec<ObjectPlan>) -> Vec<Self> {
        let mut lobes: Vec<_> = pyramid.iter().flat_map(|pyramid| &pyramid.laws).map(Law::ports).collect();
        if lobes.is_empty() {
            lobes.push(core_and_whole());
        }
        let stored = pyramid.filter(|_| plans.iter().any(ObjectPlan::bump_map)).as_ref().map(StoredBumps::new);
        let is_smooth = |plan: &ObjectPlan| plan.roughness() == RoughnessKind::None;
        let form = |smooth: bool| {
            let plan = plans.iter().find(|plan| plan.bump_map() && is_smooth(plan) == smooth)?;
            stored.as_ref()?.with_plan(plan)
        };
        let [rough, smooth] = [false, true].map(form);
        let planned = |plan: ObjectPlan| {
            let bumps = if is_smooth(&plan) { &smooth } else { &rough };
            Self { plan, lobes: lobes.clone(), bumps: bumps.clone().filter(|_| plan.bump_map()) }
        };
        plans.into_iter().map(planned).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_made_once_for_each_key_and_keep_their_places() {
        let keys = [3, 1, 3, 2, 1, 3];
        let calls = std::sync::Mutex::new(Vec::new());
        let made = shared(keys.into_iter(), |group| {
            calls.lock().expect("no call fails").push(group.to_vec());
            group.iter().map(|index| (keys[*index], *index)).collect()
        });
        assert_eq!(made, [(3, 0), (1, 1), (3, 2), (2, 3), (1, 4), (3, 5)]);
        let mut calls = calls.into_inner().expect("no call fails");
        calls.sort();
        assert_eq!(calls, [vec![0, 2, 5], vec![1, 4], vec![3]]);
    }
}
