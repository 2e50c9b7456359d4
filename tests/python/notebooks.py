#!/usr/bin/python3
"""[STUDY-850] Notebooks run from beginning to end and say what stands in them.

Usage: notebooks.py DIRECTORY_OF_THE_MODULE, from the project root. --write keeps the new outputs.
"""
import os
import pathlib
import sys

import nbclient
import nbformat

os.environ["PYTHONPATH"] = str(pathlib.Path(sys.argv[1]).resolve())
os.environ["PYDEVD_DISABLE_FILE_VALIDATION"] = "1"  # the kernel's debugger, which nobody uses, warns otherwise


def said(cell):
    assert all(output.output_type == "stream" and output.name == "stdout" for output in cell.get("outputs", [])), cell.outputs
    return "".join(output.text for output in cell.get("outputs", []))


def keep(page, notebook):
    """Without what differs from run to run."""
    for cell in notebook.cells:
        cell.metadata.clear()
        if text := said(cell):
            cell.outputs = [nbformat.v4.new_output("stream", name="stdout", text=text)]
    nbformat.write(notebook, page)


pages = sorted(pathlib.Path("docs/user/notebooks").glob("*.ipynb"))
assert pages
for page in pages:
    notebook = nbformat.read(page, as_version=4)
    nbformat.validate(notebook)
    stated = [said(cell) for cell in notebook.cells]
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3", resources={"metadata": {"path": str(page.parent)}}).execute()
    if "--write" in sys.argv:
        keep(page, notebook)
        continue
    assert any(stated)
    for cell, before in zip(notebook.cells, stated):
        assert said(cell) == before, f"{page}, {cell.id}: {said(cell)!r} instead of {before!r}"
