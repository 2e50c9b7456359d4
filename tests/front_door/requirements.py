#!/usr/bin/python3
"""Every requirement in docs/engineering/requirements.md has a test that carries its tag; every tag in tests/, and every id that another page of docs/
names, is a requirement. Each row of docs/engineering/hazards.md and docs/engineering/threat_model.md names one that shows it.

usage: requirements.py [ROOT]
"""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
prefixes = "CAN|CFG|CTL|RT|RIG|BRG|WEAR|STUDY|DOOR"
document = root / "docs/engineering/requirements.md"
required = re.findall(rf"^\| ((?:{prefixes})-\d{{3}}) \|", document.read_text(), re.M)
tagged = {}
for path in sorted((root / "tests").rglob("*")):
    if path.suffix not in {".cpp", ".py", ".sh"}:
        continue
    for number, line in enumerate(path.read_text().splitlines(), 1):
        for tag in re.findall(rf"\[((?:{prefixes})-\d{{3}})\]", line):
            tagged.setdefault(tag, f"{path.relative_to(root)}:{number}")

wrong = [f"{document}: {i} is there {required.count(i)} times" for i in sorted(set(required)) if required.count(i) > 1]
wrong += [f"{document}: {i} has no test" for i in sorted(set(required) - set(tagged))]
wrong += [f"{tagged[tag]}: [{tag}] is no requirement in {document}" for tag in sorted(set(tagged) - set(required))]
for page in sorted(set((root / "docs").rglob("*.md")) - {document}):
    for number, line in enumerate(page.read_text().splitlines(), 1):
        named = set(re.findall(rf"\b(?:{prefixes})-\d{{3}}\b", line))
        wrong += [f"{page.relative_to(root)}:{number}: {i} is no requirement" for i in sorted(named - set(required))]
for page in (root / "docs/engineering/hazards.md", root / "docs/engineering/threat_model.md"):  # what is claimed there is shown
    lines = page.read_text().splitlines() if page.exists() else []
    wrong += [f"{page.relative_to(root)}:{number}: shown by no requirement" for number, line in enumerate(lines, 1)
              if line.startswith("| ") and not line.endswith(" shown by |") and not re.search(rf"(?:{prefixes})-\d{{3}}", line.split("|")[-2])]
if not required:
    wrong.append(f"{document}: no requirements found")
print("\n".join(wrong) or f"{len(required)} requirements, each with a test")
sys.exit(bool(wrong))
