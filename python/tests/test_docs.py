"""The examples of docs/python.md run, one after the other; the program is a stand-in."""
import pathlib
import re
import stat
import sys

import torch

PAGE = pathlib.Path(__file__).resolve().parents[2] / 'docs/python.md'


def test_examples(tmp_path, monkeypatch):
    program = tmp_path / 'item3d'
    program.write_text(f'#!{sys.executable}\nprint("{{}}")\n')
    program.chmod(program.stat().st_mode | stat.S_IEXEC)
    monkeypatch.setenv('ITEM3D_PROGRAM', str(program))
    monkeypatch.chdir(tmp_path)
    torch.manual_seed(0)
    examples = re.findall(r'^```python\n(.*?)^```', PAGE.read_text(), re.MULTILINE | re.DOTALL)
    assert len(examples) == 6
    names = {}
    for example in examples:
        exec(compile(example, str(PAGE), 'exec'), names)
