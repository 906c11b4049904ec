#!/bin/sh
# Compiles a source of Verilator's own library once for all models with the same flags: sh keep_objects.sh COMPILER FLAG... SOURCE, as make
# says where OBJCACHE names this. Objects are kept in the folder ROUGHXEL_OBJECTS; other sources are compiled as they are.
set -u
for source; do :; done
case $source in */include/verilated*.cpp) ;; *) exec "$@" ;; esac
output='' before=''
for argument; do
    [ "$before" != -o ] || output=$argument
    before=$argument
done
include=$(dirname "$source")
key=$({ echo "$@"; "$1" --version; cat "$source" "$include"/verilated*.h; } | cksum | tr ' ' -)
kept=$ROUGHXEL_OBJECTS/$key.o
# Whoever needs it while it is compiled waits.
exec 9>"$kept.lock"
if command -v flock >/dev/null; then flock 9; fi
if [ ! -e "$kept" ]; then
    "$@" || exit
    cp "$output" "$kept.$$" && mv "$kept.$$" "$kept"
else
    cp "$kept" "$output"
fi
