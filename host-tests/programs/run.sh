#!/usr/bin/env bash
# Installs released programs in a temporary folder, writes files with them, draws each and compares with numpy.
#
#   bash host-tests/programs/run.sh [--roughxel PROGRAM] [--write docs/programs.md] [--only TEXT]
#
# Needs python3.11 with venv (Blender's package is for 3.11 alone; other versions leave its rows out), npm and node 20.
# It downloads about 1 GB and takes two to five minutes. It is not part of continuous integration.
# It fails if a picture is wrong. A file that is refused is no failure if the message names its kind.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
roughxel=$here/../../target/release/roughxel
more=()
while [ $# -gt 0 ]; do
    case $1 in
    --roughxel) roughxel=$(realpath "$2") ;;
    --write) more+=(--write "$(realpath "$2")") ;;
    --only) more+=(--only "$2") ;;
    *) sed -n 's/^# \{0,1\}//p' "$0" | head -8; exit 2 ;;
    esac
    shift 2
done
[ -x "$roughxel" ] || { echo "no program: run cargo build --release, or name one with --roughxel" >&2; exit 2; }
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
mkdir "$T/files" "$T/node"
export PYTHONDONTWRITEBYTECODE=1
python=$(command -v python3.11 || command -v python3)
pip() { nice "$1/bin/pip" -q --disable-pip-version-check install "${@:2}"; }

"$python" -m venv "$T/main"
pip "$T/main" numpy==2.4.6 OpenEXR==3.5.3 OpenImageIO==3.2.2.0 opencv-python-headless==5.0.0.93 pillow==12.3.0 tifffile==2026.3.3 \
    imageio==2.38.1 imagecodecs==2026.3.6 trimesh==5.2.0 pymeshlab==2025.7.post1 meshio==5.3.5 pyvista==0.49.1 pygltflib==1.16.5 usd-core==26.11
# Blender and Open3D share an older numpy.
"$python" -m venv "$T/blender"
versions='{}'
if pip "$T/blender" bpy==5.0.1 open3d==0.20.0; then
    nice "$T/blender/bin/python" "$here/blender.py" "$T/files" >"$T/blender.log" 2>&1 || { cat "$T/blender.log" >&2; exit 1; }
    versions=$(cat "$T/files/blender.json")
fi
cp "$here/scenes.mjs" "$T/node"
cd "$T/node"
echo '{"private":true,"type":"module"}' >package.json
nice npm install --silent --no-audit --no-fund three@0.187.0 @gltf-transform/core@4.5.1 @gltf-transform/functions@4.5.1 \
    @gltf-transform/extensions@4.5.1 mikktspace@1.1.1 ktx-parse@2.0.0
nice "$T/main/bin/python" "$here/check.py" - "$T/files" --prepare
nice node scenes.mjs "$T/files"
versions=$("$T/main/bin/python" -c '
import json, pathlib, sys
known = json.loads(sys.argv[1])
for package in ["three", "@gltf-transform/core", "ktx-parse"]:
    known[package] = json.loads(pathlib.Path("node_modules", package, "package.json").read_text())["version"]
print(json.dumps(known))' "$versions")
nice "$T/main/bin/python" "$here/check.py" "$roughxel" "$T/files" --versions "$versions" ${more[@]+"${more[@]}"}
