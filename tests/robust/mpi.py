#!/usr/bin/python3
"""rig-lab robust under mpirun: two processes give the bytes of one. [STUDY-602]

usage: mpi.py RIG_LAB MPIRUN
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "study"))
import team  # noqa: E402

team.same_bytes(*sys.argv[1:3], ["robust", "--families", "paper,speed", "--draws", "3", "--seed", "5", "--no-pictures"],
                ["--ranges", "/nowhere.toml"], "/nowhere.toml")
