#!/usr/bin/env bash
# Draws a glTF model made by Blender and compares it with Cycles, and its shading normals with MikkTSpace's.
#
#   bash host-tests/programs/gltf_reference.sh [--roughxel PROGRAM] [--keep FOLDER] [--samples N] [--fit]
#
# Needs python3.11 with venv, for which Blender's package is made. It takes 1 GB of disk and three minutes, with --fit some eight.
# It is not part of continuous integration. It fails if PSNR is below 30 dB or a normal is off by more than 0.2 degrees.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
roughxel=$here/../../target/release/roughxel
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
folder=$T/files
more=()
while [ $# -gt 0 ]; do
    case $1 in
    --roughxel) roughxel=$(realpath "$2"); shift ;;
    --keep) folder=$(realpath "$2"); shift ;;
    --samples) more+=(--samples "$2"); shift ;;
    --fit) more+=(--fit) ;;
    *) sed -n 's/^# \{0,1\}//p' "$0" | head -6; exit 2 ;;
    esac
    shift
done
[ -x "$roughxel" ] || { echo "no program: run cargo build --release, or name one with --roughxel" >&2; exit 2; }
python3.11 -m venv "$T/blender"
nice "$T/blender/bin/pip" -q --disable-pip-version-check install bpy==5.0.1
# Blender tells its progress on stdout, too.
PYTHONDONTWRITEBYTECODE=1 nice "$T/blender/bin/python" "$here/gltf_reference.py" "$roughxel" "$folder" ${more[@]+"${more[@]}"} |
    grep -E '^(smooth|bumpy|  [a-z]+:|alpha)'
