#!/usr/bin/python3
"""Documents lead to each other: every link leads to a file, every page of docs/ is in its index, and what is named as a path is there. [DOOR-073]

usage: documents.py PROJECT
"""
import pathlib
import re
import sys

LINK = re.compile(r"\[[^\]]*\]\(([^)#\s]+)(?:#[^)]*)?\)")
PATH = re.compile(r"`((?:firmware|plant_sim|rig_bridge|config|tests|docs)/[\w./-]+\.\w+)`")


def main():
    root = pathlib.Path(sys.argv[1])
    pages = [*root.glob("*.md"), *root.glob("docs/*.md")]
    wrong = []
    for page in pages:
        text = page.read_text()
        for link in LINK.findall(text):
            if "://" not in link and not (page.parent / link).exists():
                wrong.append(f"{page.relative_to(root)}: no file {link}")
        wrong += [f"{page.relative_to(root)}: no file {path}" for path in PATH.findall(text) if not (root / path).exists()]
    index = set(LINK.findall((root / "docs/README.md").read_text()))
    wrong += [f"docs/README.md: {page.name} is missing" for page in root.glob("docs/*.md") if page.name not in index | {"README.md"}]
    print(*wrong, f"{len(pages)} pages, {len(wrong)} mistakes", sep="\n")
    return 1 if wrong or not pages else 0


if __name__ == "__main__":
    sys.exit(main())
