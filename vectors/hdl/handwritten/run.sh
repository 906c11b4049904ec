#!/bin/sh
# Runs the hand-written modules in Icarus Verilog: run.sh [STAGE [SET.json...]]
# Without arguments all stages (normalise perturb reflect cube_face) on the sets of `smoke` that have their fields.
# Exit code 0: every field of every vector is right.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
vectors=$(cd "$here/../.." && pwd)
stages=${1:-normalise perturb reflect cube_face}
[ $# -eq 0 ] || shift
[ $# -gt 0 ] || set -- "$vectors"/smoke/*.json
build=$(mktemp -d)
trap 'rm -r "$build"' EXIT
: >"$build/log"
runs=0
for stage in $stages; do
    case $stage in
        normalise | perturb) field=offset_1 ;;
        *) field=reflected_x ;;
    esac
    for set in "$@"; do
        grep -q "\"name\": \"$field\"" "$set" || continue
        python3 "$here/fields.py" "$set" "$vectors/rom" "$build/fields.vh"
        iverilog -g2005 -s "${stage}_tb" -I "$build" -I "$here" -y "$here" -o "$build/bench" "$here/${stage}_tb.v"
        runs=$((runs + 1))
        vvp -n "$build/bench" | tee -a "$build/log"
    done
done
awk -v runs="$runs" '/^(PASS|FAIL|NONE) / { done++; wrong += $1 == "FAIL"; vectors += $4; fields += $6 }
    END { print runs " runs, " vectors + 0 " vectors, " fields + 0 " fields, " wrong + 0 " runs with an error"
          exit !(fields > 0 && wrong == 0 && done == runs) }' "$build/log"
