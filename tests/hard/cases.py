"""The command line of programs that examine named cases, one after another."""
import argparse
import sys
import tempfile
from pathlib import Path


def run_cases(description, cases, examine):
    """Examines the cases named on the command line, or all: `examine(options, case, folder)` returns faults in words. Exits with 1
    when there were any."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", metavar="CASE", help=", ".join(cases))
    parser.add_argument("--program", required=True, help="the amontons executable")
    parser.add_argument("--mpirun", default="mpirun --oversubscribe --bind-to none", help="how ranks are started")
    options = parser.parse_args()
    options.program = str(Path(options.program).resolve())
    failed = 0
    with tempfile.TemporaryDirectory() as root:
        for case in options.cases or cases:
            faults = examine(options, case, root)
            failed += bool(faults)
            print(f"{'FAIL' if faults else 'ok  '} {case} {'; '.join(faults)}", flush=True)
    sys.exit(1 if failed else 0)
