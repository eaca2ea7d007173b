"""Runs the examples of docs/python.md in order, most of them with a stand-in for the program."""
import pathlib
import re
import shutil
import stat
import subprocess
import sys

import pytest
import torch

import item3d

PAGE = pathlib.Path(__file__).resolve().parents[2] / 'docs/python.md'


def examples(with_program):
    """Returns the examples that need the results of the real program, or the other examples."""
    found = re.findall(r'^```python\n(.*?)^```', PAGE.read_text(), re.MULTILINE | re.DOTALL)
    assert len(found) == 9
    return [each for each in found if with_program == ('item3d.load(' in each or 'item3d.Guidance(' in each)]


def run(sources, names):
    for source in sources:
        exec(compile(source, str(PAGE), 'exec'), names)


def test_examples(tmp_path, monkeypatch):
    program = tmp_path / 'item3d'
    program.write_text(f'#!{sys.executable}\nprint("{{}}")\n')
    program.chmod(program.stat().st_mode | stat.S_IEXEC)
    monkeypatch.setenv('ITEM3D_PROGRAM', str(program))
    monkeypatch.chdir(tmp_path)
    torch.manual_seed(0)
    run(examples(with_program=False), {})


def test_examples_with_the_program(tmp_path, monkeypatch):
    try:
        program = item3d.find_program()
    except item3d.ProgramMissing as error:
        pytest.skip(str(error))
    if subprocess.run([program, 'guidance', '--help'], capture_output=True).returncode != 0:
        pytest.skip('a program without the command guidance')
    shutil.copy(PAGE.parents[1] / 'assets/demo/mug.glb', tmp_path)
    monkeypatch.chdir(tmp_path)
    run(examples(with_program=True), {'item3d': item3d, 'torch': torch})
