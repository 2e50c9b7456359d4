#!/usr/bin/python3
"""Documents lead to each other: every link leads to a file or a heading, every file of docs/ is linked from its index or from a page, and what a page, a
program, a test or a configuration file names as a path is there. [DOOR-073]

usage: documents.py PROJECT
"""
import pathlib
import re
import sys

LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
PATH = re.compile(r"`((?:firmware|plant_sim|rig_bridge|config|tests|docs)/[\w./-]+\.\w+)`")
DOCUMENT = re.compile(r"docs/[\w/]*\w\.(?:md|csv|png|svg)\b")
SOURCES = {".cpp", ".hpp", ".py", ".sh", ".bash", ".toml", ".txt", ".cmake", ""}


def anchors(page):
    """As GitHub makes them of headings."""
    text = re.sub(r"^(```|    ).*$", "", page.read_text(), flags=re.M)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in re.findall(r"^#+ (.*)$", text, re.M)}


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    pages = sorted([*root.glob("*.md"), *root.glob("docs/**/*.md")])
    wrong, linked = [], {}
    for page in pages:
        text, name = page.read_text(), page.relative_to(root)
        for link in LINK.findall(text):
            if "://" in link:
                continue
            file, _, anchor = link.partition("#")
            target = (page.parent / file).resolve() if file else page
            linked.setdefault(target, set()).add(page)
            if not target.exists():
                wrong.append(f"{name}: no file {link}")
            elif anchor and anchor not in anchors(target):
                wrong.append(f"{name}: no heading {link}")
        wrong += [f"{name}: no file {path}" for path in PATH.findall(text) if not (root / path).exists()]
    index = root / "docs/README.md"
    for file in (path for path in root.glob("docs/**/*") if path.is_file() and path != index):
        # A page is found from the index, a picture or table from a page, the tables of one folder by the folder.
        by = linked.get(file, set()) if file.suffix == ".md" else linked.get(file, set()) | linked.get(file.parent, set())
        if not by or file.suffix == ".md" and index not in by:
            wrong.append(f"{file.relative_to(root)}: linked from {'the index' if file.suffix == '.md' else 'nowhere'}: no")
    for folder in ("firmware", "rig_bridge", "plant_sim", "config", "tests"):
        for file in (path for path in (root / folder).rglob("*") if path.is_file() and path.suffix in SOURCES and path.stat().st_size < 100_000):
            named = DOCUMENT.findall(file.read_text(errors="replace"))
            wrong += [f"{file.relative_to(root)}: no file {path}" for path in named if not (root / path).exists()]
    wrong += [f"rig: no file {path}" for path in DOCUMENT.findall((root / "rig").read_text()) if not (root / path).exists()]
    print(*wrong, f"{len(pages)} pages, {len(wrong)} mistakes", sep="\n")
    return 1 if wrong or not pages else 0


if __name__ == "__main__":
    sys.exit(main())
