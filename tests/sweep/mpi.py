#!/usr/bin/python3
"""rig-lab sweep under mpirun: two processes give the bytes of one. [STUDY-148]

usage: mpi.py RIG_LAB MPIRUN
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "study"))
import team  # noqa: E402

team.same_bytes(*sys.argv[1:3], ["sweep", "--references", "0.2,0.24", "--landings", "4", "--no-pictures"], ["--references", "7"],
                "--references")
