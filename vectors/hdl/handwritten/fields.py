#!/usr/bin/env python3
"""Writes what a bench has to know of a vector set as Verilog: fields.py SET.json ROM_DIR OUT.vh"""
import json
import os
import sys


def main() -> None:
    manifest_path, rom, out = sys.argv[1:4]
    with open(manifest_path, encoding="utf-8") as file:
        manifest = json.load(file)
    if (manifest["schema"], manifest["format_version"]) != ("roughxel-vectors", 3):
        sys.exit(f"{manifest_path}: not a vector set of format 3")
    knobs = manifest["profile"]["knobs"]
    seed_bits = knobs["reciprocal"]["seed_bits"]
    words = os.path.join(os.path.dirname(manifest_path), manifest["files"][0]["name"])
    lines = [f"localparam P = {knobs['fraction_bits']};",
             f"localparam K = {seed_bits};",
             f"localparam STEPS = {knobs['reciprocal']['steps']};",
             f"localparam WORD_BITS = {manifest['word_bits']};",
             f"localparam COUNT = {manifest['count']};",
             f'`define SET_NAME "{manifest["set"]}_{manifest["profile"]["name"]}"',
             f'`define WORDS "{words}"',
             f'`define SEEDS "{rom}/reciprocal_{seed_bits}.hex"']
    # The place of each field in the word.
    lines += [f"localparam {field['name'].upper()} = {field['lsb']};" for field in manifest["fields"]]
    with open(out, "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


main()
