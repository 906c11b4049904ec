//! Contents of `places.toml`, and the violations of packages and files.

use std::collections::BTreeSet;

use roughxel_host_tests::imports::SourceFile;
use serde::Deserialize;

/// All packages, in their order.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Places {
    #[serde(rename = "package")]
    pub(crate) packages: Vec<Package>,
}

/// A package.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Package {
    /// Path from the root of the workspace.
    pub(crate) folder: String,
    pub(crate) holds: String,
    /// Folders of the packages in its Cargo.toml.
    pub(crate) uses: Vec<String>,
    /// True if the package is no member of the workspace: only its Cargo.toml is checked, not its sources.
    #[serde(default)]
    pub(crate) own_workspace: bool,
    #[serde(default, rename = "place")]
    places: Vec<Written>,
}

/// A place as the file states it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    files: Vec<String>,
    #[expect(dead_code, reason = "readers of the file use it")]
    holds: String,
    uses: Vec<String>,
}

/// A place: paths from the root of the workspace, without `.rs`.
#[derive(Debug)]
pub(crate) struct Place {
    pub(crate) package: String,
    pub(crate) files: Vec<String>,
    /// Packages by their folders, files by their paths.
    pub(crate) uses: Vec<String>,
}

/// Returns true if a file is a place or is inside it: `core/src/stage` is `stage.rs` and everything below `stage/`.
pub(crate) fn lies_in(file: &str, place: &str) -> bool {
    let rest = file.trim_end_matches(".rs").strip_prefix(place);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

impl Places {
    /// Reads the text of the file.
    pub(crate) fn read(text: &str) -> Self {
        toml::from_str(text).unwrap_or_else(|error| panic!("places.toml: {error}"))
    }

    /// The place in the order of the package with this folder.
    pub(crate) fn rank(&self, folder: &str) -> Option<usize> {
        self.packages.iter().position(|package| package.folder == folder)
    }

    /// The package that contains a file, the innermost one if packages are nested.
    pub(crate) fn package_of(&self, file: &str) -> Option<&Package> {
        let around = self.packages.iter().filter(|package| lies_in(file, &package.folder));
        around.max_by_key(|package| package.folder.len())
    }

    /// The places of the workspace's packages; a package without places counts as one place.
    pub(crate) fn places(&self) -> Vec<Place> {
        let of_package = |package: &Package| {
            let Package { folder, uses, places, .. } = package;
            if places.is_empty() {
                return vec![Place { package: folder.clone(), files: vec![folder.clone()], uses: uses.clone() }];
            }
            let own = |name: &String| format!("{folder}/src/{name}");
            let names: BTreeSet<&str> = places.iter().flat_map(|place| &place.files).map(String::as_str).collect();
            // `verilog/body` is a file of the place `verilog`.
            let is_own = |name: &str| names.iter().any(|place| lies_in(name, place));
            let whole = |name: &String| if is_own(name) { own(name) } else { name.clone() };
            let place = |Written { files, uses, .. }: &Written| Place {
                package: folder.clone(),
                files: files.iter().map(own).collect(),
                uses: uses.iter().map(whole).collect(),
            };
            places.iter().map(place).collect()
        };
        self.packages.iter().filter(|package| !package.own_workspace).flat_map(of_package).collect()
    }

    /// Imports that break the rules: `FILE:LINE uses FILE`.
    pub(crate) fn forbidden(&self, files: &[SourceFile]) -> Vec<String> {
        let places = self.places();
        let mut found = Vec::new();
        for file in files {
            let Some(place) = place_of(&places, &file.path) else { continue };
            for (used, line) in &file.uses {
                let own = place_of(&places, used).is_some_and(|other| other.files == place.files);
                let of_package = self.package_of(used).map(|package| package.folder.as_str());
                // A package named by its folder is that package alone, without packages in subfolders.
                let is_it = |name: &String| match self.rank(name) {
                    Some(_) => of_package == Some(name),
                    None => lies_in(used, name),
                };
                if !own && !place.uses.iter().any(is_it) {
                    found.push(format!("{}:{line} uses {used}", file.path));
                }
            }
        }
        found
    }

    /// Dependencies that point upwards: `FOLDER uses FOLDER`, the second not before the first; or files of a package that are not listed as its
    /// own.
    pub(crate) fn upwards(&self) -> Vec<String> {
        let mut found = Vec::new();
        for (rank, package) in self.packages.iter().enumerate() {
            let above = package.uses.iter().filter(|used| self.rank(used).is_none_or(|used| used >= rank));
            found.extend(above.map(|used| format!("{} uses {used}", package.folder)));
        }
        for Place { package, files, uses } in self.places() {
            let whole = &self.packages[self.rank(&package).expect("a place is of a package")];
            for name in &uses {
                let of = self.package_of(name).map_or("nothing", |package| package.folder.as_str());
                if of != package && !whole.uses.iter().any(|used| used == of) {
                    found.push(format!("{} uses {name}", files.join(", ")));
                }
            }
        }
        found
    }
}

/// The place of a file: the one with the longest matching path.
pub(crate) fn place_of<'a>(places: &'a [Place], file: &str) -> Option<&'a Place> {
    let fits = |place: &Place| place.files.iter().filter(|name| lies_in(file, name)).map(String::len).max();
    places
        .iter()
        .filter_map(|place| Some((fits(place)?, place)))
        .max_by_key(|(length, _)| *length)
        .map(|(_, place)| place)
}
