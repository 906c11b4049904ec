//! Built-in scenes: those of the papers, with maps that the program generates.

/// Name and text of each scene.
const SCENES: [(&str, &str); 22] = [
    ("lake", include_str!("../../scenes/lake.toml")),
    ("zebra", include_str!("../../scenes/zebra.toml")),
    ("puzzle", include_str!("../../scenes/puzzle.toml")),
    ("globe", include_str!("../../scenes/globe.toml")),
    ("cylinder-mirror", include_str!("../../scenes/cylinder-mirror.toml")),
    ("parabola", include_str!("../../scenes/parabola.toml")),
    ("corrugated", include_str!("../../scenes/corrugated.toml")),
    ("brushed", include_str!("../../scenes/brushed.toml")),
    ("highlight", include_str!("../../scenes/highlight.toml")),
    ("cylinders-plane", include_str!("../../scenes/cylinders-plane.toml")),
    ("spheres-plane", include_str!("../../scenes/spheres-plane.toml")),
    ("spheres-sphere", include_str!("../../scenes/spheres-sphere.toml")),
    ("denim-plane", include_str!("../../scenes/denim-plane.toml")),
    ("denim-drapery", include_str!("../../scenes/denim-drapery.toml")),
    ("three-normals", include_str!("../../scenes/three-normals.toml")),
    ("anisotropic-sphere", include_str!("../../scenes/anisotropic-sphere.toml")),
    ("velvet", include_str!("../../scenes/velvet.toml")),
    ("silk", include_str!("../../scenes/silk.toml")),
    ("horizon-plane", include_str!("../../scenes/horizon-plane.toml")),
    ("horizon-sphere", include_str!("../../scenes/horizon-sphere.toml")),
    ("mesh", include_str!("../../scenes/mesh.toml")),
    ("shapes", include_str!("../../scenes/shapes.toml")),
];

/// Names of the built-in scenes.
pub fn builtin_names() -> impl ExactSizeIterator<Item = &'static str> {
    SCENES.iter().map(|(name, _)| *name)
}

/// The TOML of a built-in scene, to read or to copy; `None` for other names.
pub fn builtin_text(name: &str) -> Option<&'static str> {
    SCENES.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}
