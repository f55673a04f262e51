"""Runs a notebook from its own folder and fails where a cell does: notebook.py NOTEBOOK PLACE.

The notebook with its results goes to the folder PLACE; the given one stays as it is.
"""

import json
import os
import sys
import time
from pathlib import Path

import nbformat
from nbclient import NotebookClient

notebook, place = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()

# A kernel of this environment alone, whatever others are installed.
kernel = place / "jupyter" / "kernels" / "tour"
kernel.mkdir(parents=True, exist_ok=True)
command = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
(kernel / "kernel.json").write_text(json.dumps({"argv": command, "display_name": "tour", "language": "python"}))
os.environ["JUPYTER_PATH"] = str(place / "jupyter")

cells = nbformat.read(notebook, as_version=4)
start = time.monotonic()
client = NotebookClient(cells, timeout=300, kernel_name="tour", resources={"metadata": {"path": str(notebook.parent)}})
client.execute()
nbformat.write(cells, place / notebook.name)
count = sum(cell.cell_type == "code" for cell in cells.cells)
print(f"{notebook.name}: {count} cells in {time.monotonic() - start:.1f} s")
