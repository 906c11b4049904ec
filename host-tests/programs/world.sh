#!/usr/bin/env bash
# Fetches panoramas, normal maps and photographs that nobody here made to target/world and target/photographs.
#
#   bash host-tests/programs/world.sh
#
# Needs npm and Python with pip. It downloads some 30 MB. `cargo run --release --bin reflection-bars -- --world` draws them.
# The panoramas are 512x256 OpenEXR files, the normal maps 512x512 WebP files (@pmndrs/assets 1.7.0, CC0).
set -euo pipefail
[ $# = 0 ] || { sed -n 's/^# \{0,1\}//p' "$0" | head -5 >&2; exit 2; }
target=$(cd "$(dirname "$0")/../.." && pwd)/target
mkdir -p "$target/world"
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
(cd "$T" && npm pack --silent @pmndrs/assets@1.7.0 >package.name && tar xzf "$(cat package.name)")
python3 - "$T/package" "$target/world" <<'PYTHON'
"""Each file of the package is a module whose text has a picture in base 64."""
import base64, pathlib, re, sys

package, folder = map(pathlib.Path, sys.argv[1:])
modules = sorted(package.glob("hdri/*.exr.js")) + sorted(package.glob("normals/*.webp.js"))
for module in modules:
    text = re.search(r"base64,([A-Za-z0-9+/=]+)", module.read_text())
    if not text:
        sys.exit(f"{module.name} has no picture")
    (folder / module.stem).write_bytes(base64.b64decode(text[1]))
print(f"{len(modules)} files in {folder}")
PYTHON
if ! [ -e "$target/photographs/skimage/data/gravel.png" ]; then
    pip3 install --quiet --no-deps --target "$target/photographs" scikit-image
fi
