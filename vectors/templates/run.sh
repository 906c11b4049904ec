#!/bin/sh
# Runs the bench of the set @SET@: sh run.sh TOOL [OPTION...]
#   TOOL             icarus, verilator, cpp (Verilator with a driver in C++), ghdl (VHDL), cocotb (cocotb 2 in Icarus),
#                    dpi (Verilator, random inputs against the C library)
#   --stop N         ends at the N-th vector that differs (10)
#   --got FILE       not dpi: writes the device's words for `roughxel vectors check`, all of them; --stop ends what is printed
#   --outputs-only   compares what leaves the datapath alone, for a device that does not show its stages
#   --stalls         both sides of the handshake pause at random
#   --timeout N      cycles without an output after which it gives up (10000)
#   --built          runs what was built with this tool before, on the words as they are now: as many, of the same fields
#   --library FILE   dpi: the C library (libroughxel_c.a in this folder)
#   --count N        dpi: as many inputs (100000)
#   --seed N         dpi: other inputs (1)
#   --playback       ghdl: no device, the expected words in its place, to try the bench itself
#   --altered N      with --playback: one bit of vector N is wrong
# Modules of rtl are found by name; rtl/*.vhd are compiled with the VHDL. OPT is the C++ compiler's (-O1). Exit code 0: every field
# of every vector is right; 3: vectors differ, each difference is printed; 1: the comparison could not be made; 2: usage.
set -u
usage() {
    echo "usage: sh run.sh icarus|verilator|cpp|ghdl|cocotb|dpi [--stop N] [--got FILE] [--outputs-only] [--stalls] [--timeout N] [--built]" \
        "[--library FILE] [--count N] [--seed N] [--playback [--altered N]]" >&2
    exit 2
}
from=$PWD
cd "$(dirname "$0")" || exit 1
[ $# -gt 0 ] || usage
tool=$1
shift
stop=10 timeout=10000 outputs_only=0 stalls=0 built=0 playback=false altered=-1
library=$PWD/libroughxel_c.a count=100000 seed=1 only_dpi=0 got=
while [ $# -gt 0 ]; do
    case $1 in
        --stop | --timeout | --altered | --count | --seed)
            case ${2:-} in '' | *[!0-9]*) usage ;; esac
            case $1 in
                --stop) stop=$2 ;;
                --timeout) timeout=$2 ;;
                --altered) altered=$2 ;;
                --count) count=$2 only_dpi=1 ;;
                *) seed=$2 only_dpi=1 ;;
            esac
            shift ;;
        --library)
            case ${2:-} in '') usage ;; /*) library=$2 ;; *) library=$from/$2 ;; esac
            only_dpi=1
            shift ;;
        --got)
            case ${2:-} in '') usage ;; /*) got=$2 ;; *) got=$from/$2 ;; esac
            shift ;;
        --outputs-only) outputs_only=1 ;;
        --stalls) stalls=1 ;;
        --built) built=1 ;;
        --playback) playback=true ;;
        *) usage ;;
    esac
    shift
done
if [ "$stop" -eq 0 ] || [ "$timeout" -eq 0 ] || [ "$count" -eq 0 ]; then usage; fi
case $only_dpi-$tool in 0-* | 1-dpi) ;; *) usage ;; esac
case $playback-$altered-$tool in true-*-ghdl | false--1-*) ;; *) usage ;; esac
case $got-$tool in ?*-dpi) usage ;; esac

plus="+stop=$stop +timeout=$timeout"
[ $outputs_only -eq 0 ] || plus="$plus +outputs_only"
[ $stalls -eq 0 ] || plus="$plus +stalls"
build=build/$tool
make="OPT_FAST=${OPT:--O1} OPT_SLOW=-O0 OPT_GLOBAL=${OPT:--O1} VM_PARALLEL_BUILDS=0"
sources="@NAME@_pkg.sv @NAME@_device.sv"
case $tool in icarus | verilator | cpp | ghdl | cocotb | dpi) ;; *) usage ;; esac
if [ $tool = dpi ]; then
    if [ ! -e @NAME@_dpi.sv ]; then
        echo "ERROR no bench of a stage: the C library has whole datapaths"
        exit 1
    elif [ ! -e "$library" ]; then
        echo "ERROR $library is not there; vectors/README.md of the source repository says how the C library is built, --library FILE names it"
        exit 1
    fi
    plus="$plus +count=$count +seed=$seed"
fi
# What was built of another device is taken for this one only where that is asked for.
if [ $built -eq 0 ]; then
    rm -rf "$build"
    mkdir -p "$build" || exit 1
elif [ ! -d "$build" ]; then
    echo "ERROR nothing was built with $tool: run it without --built first"
    exit 1
fi

compile() {
    case $tool in
        icarus) iverilog -g2012 -s @NAME@_tb -y rtl -Y .sv -o $build/bench $sources @NAME@_tb.sv ;;
        verilator)
            verilator --binary --timing -Wno-fatal --Mdir $build -MAKEFLAGS "$make" -y rtl +libext+.v+.sv \
                --top-module @NAME@_tb $sources @NAME@_tb.sv -o bench ;;
        cpp)
            verilator --cc --exe --build -Wno-fatal --Mdir $build -CFLAGS -std=c++17 -MAKEFLAGS "$make" -y rtl +libext+.v+.sv \
                --x-assign fast --x-initial fast --top-module @NAME@_device $sources ../../@NAME@_main.cpp -o bench ;;
        dpi)
            verilator --binary --timing -Wno-fatal --Mdir $build -MAKEFLAGS "$make" -y rtl +libext+.v+.sv \
                --top-module @NAME@_dpi roughxel_dpi.sv $sources @NAME@_dpi.sv "$library" -o bench ;;
        ghdl)
            set -- *.vhd
            for file in rtl/*.vhd; do [ ! -e "$file" ] || set -- "$@" "$file"; done
            ghdl -i --std=08 --workdir=$build "$@" && ghdl -m --std=08 --workdir=$build @NAME@_tb ;;
    esac
}

run() {
    case $tool in
        icarus) vvp -n $build/bench $plus ${got:+"+got=$got"} ;;
        verilator | dpi) $build/bench $plus ${got:+"+got=$got"} ;;
        cpp) $build/bench words.hex $(echo "$plus" | tr -d +) ${got:+"got=$got"} ;;
        ghdl)
            [ $outputs_only -eq 0 ] && outputs_only=false || outputs_only=true
            [ $stalls -eq 0 ] && stalls=false || stalls=true
            ghdl -r --std=08 --workdir=$build @NAME@_tb -gSTOP=$stop -gTIMEOUT=$timeout -gOUTPUTS_ONLY=$outputs_only \
                -gSTALLS=$stalls -gPLAYBACK=$playback -gALTERED=$altered ${got:+"-gGOT=$got"} --ieee-asserts=disable-at-0 ;;
        cocotb)
            STOP=$stop TIMEOUT=$timeout OUTPUTS_ONLY=$outputs_only STALLS=$stalls BUILD=$build GOT=$got python3 test_@NAME@.py ;;
    esac
}

if [ $built -eq 0 ] && ! compile >$build/compile.log 2>&1; then
    cat $build/compile.log
    echo "ERROR the bench does not compile with $tool"
    exit 1
fi
{ run 2>&1; } >$build/run.log
cat $build/run.log
# Of a failing assertion every tool makes another exit code; the lines are the same.
if grep -q '^ERROR' $build/run.log; then exit 1; fi
if grep -q '^FAIL @SET@:' $build/run.log; then exit 3; fi
grep -q '^PASS @SET@:' $build/run.log || exit 1
