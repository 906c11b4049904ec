//! The axes of a cube map's faces.

/// One axis of a face's coordinates: index into (x, y, z) and sign.
pub type SignedAxis = (usize, i32);

/// Vulkan's table per face: the axes of s_c, t_c and of the major component m.
pub const FACE_AXES: [[SignedAxis; 3]; 6] = [
    [(2, -1), (1, -1), (0, 1)],
    [(2, 1), (1, -1), (0, -1)],
    [(0, 1), (2, 1), (1, 1)],
    [(0, 1), (2, -1), (1, -1)],
    [(0, 1), (1, -1), (2, 1)],
    [(0, -1), (1, -1), (2, -1)],
];
