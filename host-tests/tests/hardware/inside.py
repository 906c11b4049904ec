"""Holds section 8 of SPEC.md, the values that no tap shows, to the Python model.

    python3 inside.py VECTORS            # the folder of SPEC.md, roughxel_model.py and smoke; exit code 3 where a value differs
    python3 inside.py VECTORS --write    # writes the values anew, where the sets are others on purpose

A value is what a local variable of a function of the model holds when the function returns, or what it returns (`ret`), in one of its calls,
counted from 0: `enter 0 ret`. A block is its mantissas and its exponent; `word` and `words` are mantissas alone, `int` is a number as it is.
"""

import collections
import os
import re
import sys

SOURCES = {
    "random_standard": """
        enter: n | enter 0 ret
        enter: v | enter 1 ret
        enter: h | enter 2 ret
        frame: c = h×n | normalise 3 ret
        frame: d = n×c | normalise 4 ret
        frame: `inverse_length` | inverse_root 0 ret
        frame: `normal_length` | scaled 0 ret
        frame: `ratio` | main_direction 0 ratio
        frame: E₁ | perturb 0 frame 0
        frame: E₂ | frame 0 tangent
        perturb: n_mod | perturb 0 ret
        roughness: d₁E₁ | roughness_anisotropic 0 ret 0
        roughness: d₂E₁ + d₃E₂ | roughness_anisotropic 0 ret 1
        reflect: `scalars` | reflect 0 scalars
        reflect: r | reflect 0 ret 0
        cube_face: 1/(2m) | word cube_face 0 h
        cube_face: face, s, t | int cube_face 0 ret 0, words cube_face 0 ret 1
        columns (∂x): u, w, e | align 0 ret
        columns (∂x): `four` | derivative 0 four
        columns (∂x): dr | normalise 21 ret
        columns (∂x): across | across 0 ret
        columns: q₁ | pixel_columns 0 columns 0
        columns: q₂ | pixel_columns 0 columns 1
        columns: q₃ | pixel_columns 0 columns 2
        columns: q₄ | pixel_columns 0 columns 3
        ellipse: q₁/√12 | ellipse 0 columns 0
        ellipse: q₂/√12 | ellipse 0 columns 1
        ellipse: aligned | align 4 ret
        ellipse: minors 12 13 14 23 24 34 | ellipse 0 minors
        ellipse: a b c | ellipse 0 ret 0
        ellipse: det | axes 0 determinant
        axes: (a − c, 2b) | axes 0 double
        axes: length | axes 0 h
        axes: λ₁² | axes 0 square
        axes: 1/λ₁ | axes 0 inverse
        axes: √det | normalise 46 ret
        axes: λ₁ | axes 0 major
        axes: λ₂ | axes 0 minor
        axes: direction | words direction 0 ret
        map_scale: edge, log₂ texels, last level | int map_scale 0 edge, int map_scale 0 ret 0, int map_scale 0 ret 1
        probes: length of a step | probes 0 length
        probes: N, step, lod | field probes, field step_s, field step_t, field lod
    """,
    "random_highlight_standard": """
        enter: n | enter 0 ret
        enter: v | enter 1 ret
        enter: l | enter 3 ret
        perturb: n_mod | perturb 0 ret
        roughness, scaled: 1 | scaled 1 ret
        roughness, scaled: 2 | scaled 2 ret
        half: inverse root of l | inverse_root 2 ret
        half: inverse root of v | inverse_root 3 ret
        half: h | half 0 ret
        enter.shininess: m | enter_shininess 0 ret 0
        enter.shininess: √m | enter_shininess 0 ret 1
        highlight.spread: `inverse` | inverse_root 4 ret
        highlight.spread: `scale` | scaled 3 self
        highlight.spread: q₁ | highlight 0 spread 0
        highlight.spread: q₂ | highlight 0 spread 1
        highlight.spread: `parts[0]` | sum_of_squares 0 parts 0
        highlight.spread: `parts[1]` | sum_of_squares 0 parts 1
        highlight.spread: `parts[2]` | sum_of_squares 0 parts 2
        highlight.spread: `growth` | spread_highlight 0 growth
        highlight.spread: `amplitude` | highlight 0 amplitude
        highlight: g | highlight 0 g
        highlight: c | highlight 0 cos
        highlight: 1/c | highlight 0 inverse
        highlight: g·q₁ | highlight 0 parts 1
        highlight: g·q₂ | highlight 0 parts 2
        highlight: x | highlight 0 x
        highlight: log₂(1 + x) | log2_one_plus 0 ret
        highlight: fall, 24 fraction bits | minus exp2 0 x
        highlight: power | highlight 0 power
        highlight: f | field f
    """,
    "random_peak_standard": """
        enter: n | enter 0 ret
        enter: v | enter 1 ret
        enter: l | enter 3 ret
        frame: E₁ | surface 0 frame 0
        frame: E₂ | frame 0 tangent
        half: h | half 0 ret
        local.components of h | local_components 0 ret
        local.components of l | local_components 1 ret
        local.components of v | local_components 2 ret
        local.unit | words local_unit 0 ret
        horizon.slopes of l | word slopes 0 out 0 0, word slopes 0 out 1 0
        horizon.ramps of l | int ramps 0 out 0, int ramps 0 out 1
        horizon.slopes of v | word slopes 1 out 0 0, word slopes 1 out 1 0
        horizon.ramps of v | int ramps 1 out 0, int ramps 1 out 1
        horizon.correlated | int correlated 0 ret
        peaks.weight | int peak 0 weight
        peaks: N − H | words dot 14 a
        peaks: exponent | short_number 0 ret
        peaks: −log₂ cos | minus_log2_one_minus 0 ret
        peaks: power | cosine_power 0 ret
        peaks: amplitude | scaled 3 ret
        peaks: peak | field peak
    """,
}


def traced(model, run):
    """The variables of every call of the model's functions, by name and number."""
    calls, counts = {}, collections.Counter()

    def enter(frame, _event, _argument):
        if frame.f_code.co_filename != model.__file__:
            return None
        key = frame.f_code.co_name, counts[frame.f_code.co_name]
        counts[key[0]] += 1

        def leave(frame, event, argument):
            if event == "return":
                calls[key] = {**frame.f_locals, "ret": argument}
            return leave
        return leave

    sys.settrace(enter)
    try:
        fields = run()
    finally:
        sys.settrace(None)
    return calls, fields


def flat(value):
    """The integers of lists in lists."""
    return [value] if isinstance(value, int) else [number for part in value for number in flat(part)]


def values(source, calls, fields, drop):
    """The integers that a source names."""
    kind, *path = source.split()
    if kind == "field":
        return [fields[path[0]]]
    if kind not in ("int", "word", "words", "minus"):
        kind, path = "block", [kind, *path]
    value = calls[path[0], int(path[1])][path[2]]
    for place in path[3:]:
        value = value[int(place)]
    if kind == "int":
        return [value]
    if kind == "minus":
        return [-value]
    if kind == "block":
        return [mantissa >> drop for mantissa in flat(value[0])] + [value[1]]
    return [mantissa >> drop for mantissa in flat(value)]


def main():
    folder = sys.argv[1]
    sys.path.insert(0, folder)
    import roughxel_model as model
    path = os.path.join(folder, "SPEC.md")
    with open(path, encoding="utf-8") as file:
        lines = file.read().split("\n")
    rows, checked, different = {}, 0, 0
    for place, line in enumerate(lines):
        title = re.fullmatch(r"Vector (\d+) of `(\w+)`:", line)
        if title:
            manifest_path = os.path.join(folder, "smoke", title[2] + ".json")
            manifest = model.read_manifest(manifest_path)
            vector = list(model.load(manifest_path))[int(title[1])]
            drop = model.Profile.from_knobs(manifest["profile"]["knobs"]).dropped
            model.evaluate(manifest, vector)        # what is kept from call to call is there
            calls, fields = traced(model, lambda: model.evaluate(manifest, vector))
            rows = dict(row.strip().split(" | ") for row in SOURCES[title[2]].strip().split("\n"))
            continue
        label, _, cell = line.strip("| ").partition(" | ")
        if label not in rows:
            continue
        numbers = [number for source in rows.pop(label).split(", ") for number in values(source, calls, fields, drop)]
        places = len(re.findall(r"-?\d+", cell))
        if places != len(numbers):
            sys.exit(f"{label}: {places} numbers for {numbers}")
        rest = iter(numbers)
        right = f"| {label} | {re.sub(r'-?[0-9]+', lambda _: str(next(rest)), cell)} |"
        checked += 1
        if right != line:
            different += 1
            print(f"{path}:{place + 1}: {line}, but the model has {right}")
            lines[place] = right
    if checked != sum(len(table.strip().split("\n")) for table in SOURCES.values()):
        sys.exit(f"only {checked} values are there")
    if "--write" in sys.argv:
        with open(path, "w", encoding="utf-8") as file:
            file.write("\n".join(lines))
    elif different:
        sys.exit(3)


main()
