"""`python -m paper`: runs lists of experiments, and writes the figures and the page."""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

from . import experiments
from .experiments import ExperimentError
from .run import RunError, Tools, describe, missing, run_list
from .tables import RUNS, read

ROOT = Path(__file__).parent.parent.parent
INTERRUPTED = 130
EXAMPLES = """\
examples (in the folder lab/):
  python -m paper list
  python -m paper run b-symmetric
  python -m paper run b-symmetric --dry-run | head -3    # the commands of a run, to repeat it
  python -m paper report
"""


def parser() -> argparse.ArgumentParser:
    """The command line."""
    shape = argparse.RawDescriptionHelpFormatter
    top = argparse.ArgumentParser("python -m paper", description=__doc__, epilog=EXAMPLES)
    top.formatter_class = shape
    commands = top.add_subparsers(required=True, metavar="COMMAND", dest="command")
    commands.add_parser("list", help="list the experiments, and how many runs are missing")
    run = commands.add_parser(
        "run",
        help="do what the tables lack of some lists",
        description="Trains and evaluates what lab/results/runs.csv lacks, one run after the "
        "other. Ctrl-C stops; the same command resumes.",
    )
    run.add_argument("lists", nargs="+", metavar="LIST", help="names of lists, see `list`")
    target = ROOT / "target" / "release" / "jcas"
    run.add_argument("--jcas", default=str(target), help="the command jcas (%(default)s)")
    target = ROOT / "lab" / "target" / "release" / "jcas-lab"
    run.add_argument("--lab", default=str(target), help="the command jcas-lab (%(default)s)")
    folder = ROOT / "lab" / "target" / "paper"
    run.add_argument("--folder", type=Path, default=folder, help="of the trainings (%(default)s)")
    run.add_argument("--sources", help="the commit that the commands come from (default: HEAD)")
    run.add_argument("--threads", type=int, default=0, help="0 for one on each core (%(default)s)")
    run.add_argument("--dry-run", action="store_true", help="print the commands alone")
    commands.add_parser("report", help="write lab/results.md and its figures from the tables")
    return top


def head() -> str:
    """The commit of the sources, marked where they differ from it."""
    command = ["git", "-C", str(ROOT), "describe", "--always", "--dirty", "--exclude", "*"]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()


def main(arguments: list[str] | None = None) -> int:
    """Runs a command and returns the exit status."""
    options = parser().parse_args(arguments)
    try:
        if options.command == "report":
            from . import page

            page.write()
        elif options.command == "list":
            present = read(RUNS)
            for name in experiments.names():
                runs = experiments.read(name)
                print(f"{name:18} {len(missing(runs, present)):4} of {len(runs):4} runs missing")
        else:
            runs = [run for name in options.lists for run in experiments.read(name)]
            sources = options.sources or head()
            tools = Tools(options.jcas, options.lab, options.folder, sources, options.threads)
            if options.dry_run:
                for run in missing(runs, read(RUNS)):
                    print("\n".join(describe(run, tools)))
            else:
                run_list(runs, tools)
    except (ExperimentError, RunError, OSError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("stopped; the same command resumes", file=sys.stderr)
        return INTERRUPTED
    return 0


if __name__ == "__main__":
    sys.exit(main())
