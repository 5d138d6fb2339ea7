"""Executes a notebook from beginning to end; the exit status says whether every cell ran.

    python python/run_notebook.py examples/tour.ipynb [--save]

With --save the outputs are written into the notebook.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import nbformat
from nbclient import NotebookClient


def main() -> None:
    """Execute the notebook that the command line names."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("notebook", type=Path)
    parser.add_argument("--save", action="store_true", help="write the outputs into the notebook")
    options = parser.parse_args()
    notebook = nbformat.read(options.notebook, as_version=4)
    NotebookClient(
        notebook, timeout=300, resources={"metadata": {"path": str(options.notebook.parent)}}
    ).execute()
    if options.save:
        nbformat.write(notebook, options.notebook)
    cells = sum(cell.cell_type == "code" for cell in notebook.cells)
    print(f"{options.notebook}: {cells} cells ran")


if __name__ == "__main__":
    main()
