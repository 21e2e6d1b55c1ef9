#!/usr/bin/env python3
"""list_skips.py KNOWN JUNIT...: lists the skipped tests of these runs of ctest, with reasons.

KNOWN lists the accepted reasons (see known.txt in this folder); JUNIT is the output of
`ctest --output-junit`. Exit code 1 if a test was skipped for another reason, or without one.
"""

import pathlib
import re
import sys
import xml.etree.ElementTree as xml


def known_reasons(path):
    lines = (line.strip() for line in pathlib.Path(path).read_text().splitlines())
    return [re.compile(line) for line in lines if line and not line.startswith("#")]


def reason_of(case):
    """The line in which GoogleTest or a script gives the reason; empty if there is none."""
    lines = [line.strip() for line in (case.findtext("system-out") or "").splitlines()]
    after = [lines[i + 1] for i, line in enumerate(lines[:-1]) if line.endswith(": Skipped")]
    scripts = [line for line in lines
               if line and not line.startswith(("[", "Note: Google Test filter", "Running main()"))]
    return (after or scripts or [""])[-1]


def main():
    if len(sys.argv) < 3:
        print(__doc__, file=sys.stderr)
        return 2
    known = known_reasons(sys.argv[1])
    unknown = 0
    by_reason = {}
    for path in sys.argv[2:]:
        for case in xml.parse(path).getroot().iter("testcase"):
            if case.find("skipped") is not None:
                by_reason.setdefault(reason_of(case), []).append(case.get("name"))
    for reason, names in sorted(by_reason.items()):
        is_known = any(pattern.search(reason) for pattern in known)
        unknown += 0 if is_known else len(names)
        shown = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
        print(
            f"{'skipped' if is_known else 'SKIPPED, for no known reason'}: "
            f"{reason or 'it does not say why'}: {shown}")
    if unknown:
        print(f"{unknown} tests were skipped for a reason that {sys.argv[1]} does not name",
              file=sys.stderr)
    return 1 if unknown else 0


if __name__ == "__main__":
    sys.exit(main())
