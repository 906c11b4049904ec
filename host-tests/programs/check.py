"""Draws the files of all rows, prints the table and, with --write FILE, writes it as a document."""
import argparse
import json
import sys
from pathlib import Path

from bench import ROWS, folder_of, judge
import environments, meshes, pictures  # noqa: F401  (their rows)

HEAD = """# Files of other programs

Each file below is written by a released program. Files that are read are drawn by `roughxel render` and compared with numpy.
The scripts are in [`host-tests/programs`](../host-tests/programs). The files have no other source than these programs.
Make this page with `bash host-tests/programs/run.sh --write docs/programs.md`. The differences are the same on every machine.

The difference is the largest of all pixels and channels, in codes of 255, and its limit.
Pixels on an edge do not count: a hundredth of a pixel would decide them.
*Refused* is a message that names the kind of the file; the table quotes it. *Unnamed* is a message that does not name it.
*Wrong* is a mistake of the reader.

"""


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("roughxel")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--prepare", action="store_true", help="write the pictures that scenes.mjs needs, and nothing else")
    parser.add_argument("--versions", type=json.loads, default={})
    parser.add_argument("--write", type=Path)
    parser.add_argument("--only", default="")
    asked = parser.parse_args()
    if asked.prepare:
        pictures.prepare(folder_of(asked.folder))
        return 0
    lines, counts, programs = [], {}, set()
    for row in ROWS:
        if asked.only not in f"{row.program} {row.file}":
            continue
        try:
            difference, verdict, remark = judge(asked.roughxel, folder_of(asked.folder), row)
        except Exception as error:
            difference, verdict, remark = "–", "FAILED", f"{type(error).__name__}: {error}"
        counts[verdict] = counts.get(verdict, 0) + 1
        programs.add(row.program)
        cells = [row.program, row.version(asked.versions), f"`{row.file}`", row.compared, difference, verdict, remark]
        lines.append("| " + " | ".join(cells) + " |")
        print("\t".join(cells), flush=True)
    verdicts = ", ".join(f"{number} {verdict.lower()}" for verdict, number in sorted(counts.items(), key=lambda pair: -pair[1]))
    total = f"{len(lines)} files of {len(programs)} programs: {verdicts}."
    print(total)
    if asked.write:
        head = "| program | version | file | what is compared | difference | verdict | message |\n|---|---|---|---|---|---|---|\n"
        asked.write.write_text(HEAD + total + "\n\n" + head + "\n".join(lines) + "\n")
    return 1 if any(verdict in counts for verdict in ("WRONG", "UNNAMED", "FAILED")) else 0


sys.exit(main())
