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
    """Text alone: whether a picture is the same to the last bit is up to fonts."""
    outputs = cell.get("outputs", [])
    assert all(o.output_type == "display_data" and "image/png" in o.data if o.output_type != "stream" else o.name == "stdout" for o in outputs), outputs
    return "".join(o.text for o in outputs if o.output_type == "stream")


def drawn(cell):
    return [nbformat.v4.new_output("display_data", {"image/png": o.data["image/png"]}) for o in cell.get("outputs", []) if o.output_type == "display_data"]


def keep(page, notebook):
    """Without what differs from run to run."""
    for cell in notebook.cells:
        cell.metadata.clear()
        if cell.cell_type == "code":
            text = said(cell)
            cell.outputs = drawn(cell) + ([nbformat.v4.new_output("stream", name="stdout", text=text)] if text else [])
    nbformat.write(notebook, page)


pages = sorted(pathlib.Path("docs/user/notebooks").glob("*.ipynb"))
assert pages
for page in pages:
    notebook = nbformat.read(page, as_version=4)
    nbformat.validate(notebook)
    stated = [(said(cell), len(drawn(cell))) for cell in notebook.cells]
    nbclient.NotebookClient(notebook, kernel_name="python3", resources={"metadata": {"path": str(page.parent)}}).execute()
    if "--write" in sys.argv:
        keep(page, notebook)
        continue
    assert any(text for text, _ in stated)
    for cell, before in zip(notebook.cells, stated):
        now = said(cell), len(drawn(cell))
        assert now == before, f"{page}, {cell.id}: {now!r} instead of {before!r}"
