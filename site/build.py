"""Builds the documentation site into a folder that needs no server and no network.

    python -m venv venv && venv/bin/pip install -r site/requirements.txt
    venv/bin/python site/build.py --out target/site      # then open target/site/index.html

The C reference needs Doxygen (`apt-get install doxygen`), and the Rust reference needs Cargo.

The pages are the repository's own documents under their own paths, so that their links hold here
and there. A link to a file that is no page leads to a copy of the file.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SITE = ROOT / "site"
LINK = re.compile(r"(?<=\]\()([^)\s#]+)(?=[)#])")
# The pages from which links are followed.
PAGES = ("docs/*.md", "python/README.md", "examples/ns3/README.md", "policies/README.md")
PAGES += ("lab/*.md", "verification/*.md")
PAGES += ("ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md")
# The libraries of the Rust reference.
CRATES = ("jcas-core", "jcas-policy", "jcas-plan", "jcas-simd", "jcas-trace", "jcas-episode")


def copy_pages(into: Path) -> None:
    """Copies the pages to their paths in the repository, and all files that they link to.

    A link to a folder leads to its README. MkDocs refuses links that lead nowhere.
    """
    waiting = {page.relative_to(ROOT): page for pattern in PAGES for page in ROOT.glob(pattern)}
    waiting |= {page.relative_to(SITE): page for page in SITE.glob("**/*.md")}
    seen = set(waiting)
    while waiting:
        target, source = waiting.popitem()
        (into / target).parent.mkdir(parents=True, exist_ok=True)
        if source.suffix != ".md":
            shutil.copy(source, into / target)
            continue
        text = source.read_text()
        for link in set(LINK.findall(text)):
            path = (ROOT / target.parent / link).resolve()
            if path.is_dir():
                path /= "README.md"
                text = text.replace(f"]({link})", f"]({link.rstrip('/')}/README.md)")
            if path.is_file() and path.relative_to(ROOT) not in seen:
                seen.add(path.relative_to(ROOT))
                waiting[path.relative_to(ROOT)] = path
        (into / target).write_text(text)


def c_reference(into: Path) -> None:
    """Writes the C reference by Doxygen."""
    settings = (SITE / "Doxyfile").read_text()
    settings += f'INPUT = "{ROOT / "include" / "jcas.h"}"\nOUTPUT_DIRECTORY = "{into}"\n'
    settings += f'HTML_EXTRA_STYLESHEET = "{SITE / "assets" / "c_reference.css"}"\n'
    subprocess.run(["doxygen", "-"], input=settings, text=True, check=True)


def rust_reference(into: Path) -> None:
    """Writes the Rust reference by rustdoc, without pages of earlier runs."""
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).absolute() / "rustdoc"
    pages = target / "doc"
    if pages.exists():
        shutil.rmtree(pages)
    command = ["cargo", "doc", "--locked", "--quiet", "--no-deps", "--all-features"]
    command += [f"--package={crate}" for crate in CRATES] + ["--target-dir", str(target)]
    settings = os.environ | {"RUSTDOCFLAGS": "-D warnings"}
    subprocess.run(command, cwd=ROOT, env=settings, check=True)
    shutil.copytree(pages, into / "rust")


def build(out: Path) -> None:
    """Builds the site in a temporary folder and then puts it in its place."""
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        pages = work / "pages"
        copy_pages(pages)
        shutil.copytree(SITE / "assets", pages / "assets")
        c_reference(pages / "reference")
        rust_reference(pages / "reference")
        shutil.copytree(ROOT / "python" / "src", work / "python")
        shutil.copy(SITE / "mkdocs.yml", work)
        # Not --quiet: it hides warnings from --strict too.
        command = [sys.executable, "-m", "mkdocs", "build", "--strict"]
        settings = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
        run = subprocess.run(command, cwd=work, env=settings, capture_output=True, text=True)
        if run.returncode != 0:
            sys.exit(run.stderr)
        if out.exists():
            shutil.rmtree(out)
        out.parent.mkdir(parents=True, exist_ok=True)
        shutil.move(work / "site", out)


def main() -> None:
    parser = argparse.ArgumentParser(description="Builds the documentation site.")
    default = ROOT / "target" / "site"
    parser.add_argument("--out", type=Path, default=default, help="folder to write")
    out = parser.parse_args().out
    build(out)
    print(f"open {out / 'index.html'}")


if __name__ == "__main__":
    main()
