//! Neighbour texel across an edge of the cube, and the three texels that meet at a corner: nearest, mutual, complete.

use roughxel_core::fx::Fx;
use roughxel_core::stage::seam;
use roughxel_scene::cube::FACE_AXES;

/// A texel of a cube map level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct FaceTexel {
    face: u8,
    i: u32,
    j: u32,
}

/// Texel at an address of a face that may be one step outside of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum CubeTexel {
    Texel(FaceTexel),
    Corner([FaceTexel; 3]),
}

fn texel_across_edge(face: u8, i: i32, j: i32, edge: u32) -> CubeTexel {
    let texel = seam::texel::<i32>(Fx::from_raw(face.into()), [i, j].map(Fx::from_raw), Fx::from_raw(edge as i32));
    let plain = |texel: seam::FaceTexel<i32>| {
        let [i, j] = texel.index.map(|index| index.raw() as u32);
        FaceTexel { face: texel.face.raw() as u8, i, j }
    };
    let [s, t] = texel.across.map(plain);
    if texel.corner { CubeTexel::Corner([plain(texel.texel), s, t]) } else { CubeTexel::Texel(plain(texel.texel)) }
}

const EDGES: [u32; 5] = [1, 2, 3, 8, 13];

/// Centre of a texel in space, in units of half a texel.
fn centre(texel: FaceTexel, edge: u32) -> [i32; 3] {
    let edge = edge as i32;
    let local = [2 * texel.i as i32 + 1 - edge, 2 * texel.j as i32 + 1 - edge, edge];
    let mut vector = [0; 3];
    for ((axis, sign), component) in FACE_AXES[usize::from(texel.face)].into_iter().zip(local) {
        vector[axis] = sign * component;
    }
    vector
}

fn distance_squared(a: [i32; 3], b: [i32; 3]) -> i32 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

fn all_texels(edge: u32) -> impl Iterator<Item = FaceTexel> {
    (0..6).flat_map(move |face| (0..edge).flat_map(move |j| (0..edge).map(move |i| FaceTexel { face, i, j })))
}

/// Steps (di, dj) from a texel to the four sides, with the texel on each.
fn steps(texel: FaceTexel, edge: u32) -> [(i32, i32, CubeTexel); 4] {
    [(-1, 0), (1, 0), (0, -1), (0, 1)].map(|(di, dj)| {
        let (i, j) = (texel.i as i32 + di, texel.j as i32 + dj);
        (di, dj, texel_across_edge(texel.face, i, j, edge))
    })
}

#[test]
fn the_texel_across_an_edge_is_the_nearest_one_of_the_other_faces() {
    for edge in EDGES {
        for texel in all_texels(edge) {
            for (di, dj, neighbour) in steps(texel, edge) {
                let CubeTexel::Texel(neighbour) = neighbour else { panic!("a step to the side never meets a corner") };
                assert!(neighbour.i < edge && neighbour.j < edge);
                if neighbour.face == texel.face {
                    continue;
                }
                // The middle of the shared edge of the two squares.
                let here = centre(texel, edge);
                let [(s, s_sign), (t, t_sign), _] = FACE_AXES[usize::from(texel.face)];
                let mut border = here;
                border[s] += s_sign * di;
                border[t] += t_sign * dj;
                let nearest = all_texels(edge)
                    .filter(|other| other.face != texel.face)
                    .min_by_key(|other| distance_squared(centre(*other, edge), border));
                assert_eq!(nearest, Some(neighbour), "{texel:?} {di} {dj}, edge {edge}");
                assert_eq!(distance_squared(centre(neighbour, edge), border), 1);
                assert_eq!(distance_squared(centre(neighbour, edge), here), 2);
            }
        }
    }
}

#[test]
fn going_across_an_edge_and_back_returns_to_the_texel() {
    for edge in EDGES {
        for texel in all_texels(edge) {
            let neighbours = steps(texel, edge).map(|(.., neighbour)| neighbour);
            for (index, neighbour) in neighbours.iter().enumerate() {
                assert!(!neighbours[..index].contains(neighbour), "four different ones");
                let CubeTexel::Texel(neighbour) = *neighbour else { panic!("a step to the side never meets a corner") };
                let back =
                    steps(neighbour, edge).iter().filter(|(.., there)| *there == CubeTexel::Texel(texel)).count();
                assert_eq!(back, 1, "{texel:?} → {neighbour:?}, edge {edge}");
            }
        }
    }
}

#[test]
fn corners_name_the_three_texels_that_touch_them() {
    for edge in EDGES {
        let last = edge as i32;
        let mut corners = Vec::new();
        for face in 0..6 {
            for (i, j) in [(-1, -1), (last, -1), (-1, last), (last, last)] {
                let CubeTexel::Corner(texels) = texel_across_edge(face, i, j, edge) else {
                    panic!("both coordinates are outside")
                };
                assert_eq!(texels[0].face, face);
                let faces: std::collections::BTreeSet<_> = texels.iter().map(|texel| texel.face).collect();
                assert_eq!(faces.len(), 3);
                // The corner of the cube next to which all three centres lie, at distance √2.
                let [(s, s_sign), (t, t_sign), (m, m_sign)] = FACE_AXES[usize::from(face)];
                let mut corner = [0; 3];
                corner[s] = s_sign * i.signum() * last;
                corner[t] = t_sign * j.signum() * last;
                corner[m] = m_sign * last;
                for texel in texels {
                    assert_eq!(distance_squared(centre(texel, edge), corner), 2);
                }
                let mut set = texels.map(|texel| (texel.face, texel.i, texel.j));
                set.sort_unstable();
                corners.push((corner, set));
            }
        }
        // Each of the eight corners has the same three texels from all three faces.
        corners.sort_unstable();
        corners.dedup();
        assert_eq!(corners.len(), 8);
    }
}

#[test]
fn texels_inside_are_themselves() {
    for edge in EDGES {
        for texel in all_texels(edge) {
            let FaceTexel { face, i, j } = texel;
            assert_eq!(texel_across_edge(face, i as i32, j as i32, edge), CubeTexel::Texel(texel));
        }
    }
}
