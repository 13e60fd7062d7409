"""The notebooks run from top to bottom, from an empty folder."""

import os
from pathlib import Path

import pytest

NOTEBOOKS = sorted((Path(__file__).parent.parent / "notebooks").glob("*.ipynb"))


@pytest.fixture
def command(tmp_path, monkeypatch):
    """The command line of these tests, as `appell` on the path."""
    command = os.environ.get("APPELL_COMMAND")
    if command:
        folder = tmp_path / "bin"
        folder.mkdir()
        (folder / "appell").symlink_to(Path(command).absolute())
        monkeypatch.setenv("PATH", str(folder), prepend=os.pathsep)
    return command


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path, tmp_path, command):
    nbformat = pytest.importorskip("nbformat")
    client = pytest.importorskip("nbclient")
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    assert all(not cell.get("outputs") for cell in notebook.cells)
    if any("import mujoco" in cell.source for cell in notebook.cells):
        pytest.importorskip("mujoco")
    client.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    kinds = {kind for output in outputs for kind in output.get("data", {})}
    assert {"text/html", "text/plain"} <= kinds
    if command and any("shutil.which" in cell.source for cell in notebook.cells):
        assert any("# Drafted from the recordings" in output.get("text", "") for output in outputs)


def test_there_are_notebooks():
    assert len(NOTEBOOKS) == 4
