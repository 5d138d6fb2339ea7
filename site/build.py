"""Builds the documentation site into a folder that needs no server and no network.

    python -m venv venv && venv/bin/pip install -r site/requirements.txt
    venv/bin/python site/build.py --out target/site      # then open target/site/index.html

The C reference needs Doxygen (`apt-get install doxygen`), and the Rust reference needs Cargo.

The pages are the repository's own documents under their own paths, so that their links hold here
and there. A link to a file that is no page leads to a copy of the file.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from html import escape
from pathlib import Path
from xml.etree import ElementTree

import latex2mathml.converter

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
        text = maths(text)
        if target == Path("docs/model.md"):
            text = subscripts(text)
        (into / target).write_text(weighted(target, text))


def maths(text: str) -> str:
    """Turns the equations of a page into MathML, which needs no script and no request."""

    def typeset(block: re.Match[str]) -> str:
        tex, _, number = block[1].strip().partition(r"\tag{")
        mathml = latex2mathml.converter.convert(tex.strip(), display="block")
        number = number.rstrip("}")
        return f'<div class="equation" id="eq-{number}">{mathml}<span>({number})</span></div>\n'

    return re.sub(r"^```math\n(.*?)^```$", typeset, text, flags=re.MULTILINE | re.DOTALL)


# A symbol with a subscript, such as P_d; code, equations and the targets of links are no such text.
SUBSCRIPT = re.compile(r"(?<![\w/#])([A-Za-zΑ-ω]|SoC|η̄)_([A-Za-z]+(?:,comm)?)(?![\w/])")
VERBATIM = re.compile(
    r"(^```.*?^```$|`[^`\n]*`|\]\([^)]*\)|<div class=.equation.*?</div>)", re.M | re.S
)


def subscripts(text: str) -> str:
    """Sets the subscripts of a page's symbols."""
    parts = VERBATIM.split(text)
    parts[::2] = [SUBSCRIPT.sub(r"\1<sub>\2</sub>", part) for part in parts[::2]]
    return "".join(parts)


def weighted(page: Path, text: str) -> str:
    """Sets how far up a page stands in the search: the model before the laboratory's notes."""
    weights = {"docs/model.md": 4, "reference/fields.md": 3}
    notes = ("lab", "verification", "ARCHITECTURE.md", "CHANGELOG.md", "CONTRIBUTING.md")
    weight = weights.get(page.as_posix(), 0.1 if page.parts[0] in notes else 1)
    return text if weight == 1 else f"---\nsearch:\n  boost: {weight}\n---\n\n{text}"


def described(page: Path) -> tuple[str, str]:
    """Returns the title of a generated page, and the sentence that describes it."""
    text = page.read_text()
    title = re.search(r"<title>(.*?)</title>", text, re.DOTALL)
    sentence = re.search(r'<meta name="description" content="(.*?)"', text, re.DOTALL)
    return title[1] if title else page.stem, sentence[1] if sentence else ""


def c_functions(reference: Path, tags: Path) -> list[dict[str, str]]:
    """Returns an entry of the search for each function and type of the C reference."""
    entries = []
    for member in ElementTree.parse(tags).iter("member"):
        name, file, anchor = (member.findtext(key) for key in ("name", "anchorfile", "anchor"))
        if name and file and anchor and member.get("kind") in ("function", "typedef"):
            text = f"{member.findtext('type', '')} {name}{member.findtext('arglist', '')}"
            location = f"reference/{reference.name}/{file}#{anchor}"
            entries.append({"location": location, "title": name, "text": escape(f"C: {text}")})
    return entries


def rust_items(reference: Path) -> list[dict[str, str]]:
    """Returns an entry of the search for each item of the Rust reference."""
    kinds = ("struct", "enum", "trait", "fn", "macro", "constant", "type")
    pages = [page for kind in kinds for page in reference.glob(f"jcas_*/**/{kind}.*.html")]
    entries = []
    for page in sorted(pages):
        title, text = described(page)
        location = f"reference/{page.relative_to(reference.parent).as_posix()}"
        entries.append({"location": location, "title": title, "text": f"Rust: {text}"})
    return entries


def add_to_search(site: Path, entries: list[dict[str, str]]) -> None:
    """Adds entries to the index of the search, in both forms in which MkDocs writes it."""
    index = json.loads((site / "search" / "search_index.json").read_text())
    index["docs"] += entries
    text = json.dumps(index, ensure_ascii=False, separators=(",", ":"))
    (site / "search" / "search_index.json").write_text(text)
    (site / "search" / "search_index.js").write_text(f"var __index = {text}")


def own_reference(into: Path) -> None:
    """Writes the pages of all fields, commands and policies, from the command itself."""
    command = ["cargo", "run", "--locked", "--quiet", "-p", "jcas-cli", "--example", "reference"]
    subprocess.run([*command, "--", str(into)], cwd=ROOT, check=True)


def c_reference(into: Path, tags: Path) -> None:
    """Writes the C reference by Doxygen, and a list of what is in it."""
    settings = (SITE / "Doxyfile").read_text()
    settings += f'INPUT = "{ROOT / "include" / "jcas.h"}"\nOUTPUT_DIRECTORY = "{into}"\n'
    settings += f'GENERATE_TAGFILE = "{tags}"\n'
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
        own_reference(pages / "reference")
        c_reference(pages / "reference", work / "c.tags")
        rust_reference(pages / "reference")
        shutil.copytree(ROOT / "python" / "src", work / "python")
        shutil.copy(SITE / "mkdocs.yml", work)
        # Not --quiet: it hides warnings from --strict too.
        command = [sys.executable, "-m", "mkdocs", "build", "--strict"]
        settings = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
        run = subprocess.run(command, cwd=work, env=settings, capture_output=True, text=True)
        if run.returncode != 0:
            sys.exit(run.stderr)
        reference = work / "site" / "reference"
        entries = c_functions(reference / "c", work / "c.tags") + rust_items(reference / "rust")
        add_to_search(work / "site", entries)
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
