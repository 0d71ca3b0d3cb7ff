"""`python -m tools.hostile`: run the trials for so long each, print their table, and fail where one found a fault."""

from __future__ import annotations

import argparse
import sys

from tools.hostile.extent import Extent
from tools.hostile.row import Row, as_markdown


def main() -> int:
    """Run the trials; exit status 1 where a fault was found."""
    parser = argparse.ArgumentParser(prog="make hostile", description=__doc__)
    parser.add_argument("--seconds", type=float, default=20.0, help="how long each trial goes on (default %(default)s)")
    parser.add_argument("--times", type=int, help="how often each trial is made instead, the same on every run")
    parser.add_argument("--first", type=int, default=0, help="number of the first recording that is diagnosed")
    parser.add_argument("--seed", type=int, default=1, help="what the trials are drawn from (default %(default)s)")
    parser.add_argument("trials", nargs="*", help="some of the trials (default all)")
    arguments = parser.parse_args()
    from tools.hostile.commands import try_commands
    from tools.hostile.diagnosed import try_named, try_planted
    from tools.hostile.files import try_files
    from tools.hostile.kills import try_kills
    from tools.hostile.nodes import try_nodes
    from tools.hostile.recordings import try_faults, try_mistakes, try_sound

    trials = {
        "files": try_files, "kills": try_kills, "commands": try_commands, "nodes": try_nodes,
        "sound": try_sound, "mistakes": try_mistakes, "faults": try_faults,
        "named": try_named, "planted": try_planted,
    }  # fmt: skip
    unknown = [name for name in arguments.trials if name not in trials]
    if unknown:
        parser.error(f"there is no trial {unknown[0]}; give some of {', '.join(trials)}, or none for all")
    rows: list[Row] = []
    extent = Extent(arguments.seconds, arguments.times, arguments.first)
    for name in arguments.trials or trials:
        print(f"{name} ...", file=sys.stderr, flush=True)
        rows += trials[name](extent, arguments.seed)
    print(as_markdown(rows))
    for row in rows:
        for failure in row.failures[:3]:
            print(f"\n{row.tried}: {failure}", file=sys.stderr)
    return 1 if any(row.failures for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
