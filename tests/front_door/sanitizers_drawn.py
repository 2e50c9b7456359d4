#!/usr/bin/python3
"""Which tests have sanitizers: all of them, or the third that a text draws; which of the tests in guests there are. [DOOR-060]

usage: sanitizers_drawn.py FOLDER     the build with the address sanitizer is configured in FOLDER
"""
import pathlib
import re
import sys

from lint_tidy import ROOT, output_of
from tiers import check, listed


def drawn_by(text, folder):
    output_of(["cmake", "--preset", "asan", "-S", ROOT, "-B", folder, f"-DANTISKID_DRAW={text}"])
    return listed(folder, "-L", "^inprocess$").keys(), listed(folder, "-R", "^vcan[.]").keys()


def check_guests(every, drawn):
    """A half or a quarter of each row of like tests; of the others all."""
    families = {"bridge_campaign_": 2, "recover_": 4, "energy_": 2, "power_cut_": 2, "peers_": 4, "crew_": 4, "unattended_": 2}
    for family, one_in in families.items():
        like, chosen = ({name for name in names if name.startswith(f"vcan.{family}")} for names in (every, drawn))
        check(f"one in {one_in} of {family}", len(like) >= 2 and chosen < like and len(chosen) == len(like) // one_in, chosen)
    others = {name for name in every if not name.startswith(tuple(f"vcan.{family}" for family in families))}
    check("all of the others", others and others < drawn, others - drawn)


def filters(folder):
    """What the tests are told to leave out."""
    return {word for file in pathlib.Path(folder).rglob("CTestTestfile.cmake") for word in re.findall('"(~.*?)"', file.read_text())}


def main():
    folder = sys.argv[1]
    (every, guests), (one, of_one), (same, of_same), (other, of_other) = (drawn_by(text, folder) for text in ("", "one", "one", "another"))
    check("nothing is drawn without a text", len(every) > 100, len(every))
    check("a third is, about", one < every and other < every and 0.2 < len(one) / len(every) < 0.45, (len(one), len(every)))
    check("the same text draws the same", one == same)
    check("another draws others", one != other and len(one | other) > len(one))
    check("in guests, too", of_one == of_same and of_one != of_other)
    check_guests(guests, of_one)
    check_guests(guests, of_other)
    # An exclusion alone chooses the hidden cases, too, which take minutes.
    check("cases that hold figures are left out, and hidden ones", filters(folder) == {"~[figures]~[.]"}, filters(folder))


if __name__ == "__main__":
    main()
