"""Runs all cells of the notebooks, with smaller numbers in the cell with the tag "parameters" (as papermill does)."""
import json
import pathlib
import sys
import types

import pytest

import item3d

FOLDER = pathlib.Path(__file__).resolve().parents[1] / 'notebooks'


def program_has(command):
    try:
        import subprocess
        return subprocess.run([item3d.find_program(), command, '--help'], capture_output=True).returncode == 0
    except item3d.ProgramMissing:
        return False


def run(name, monkeypatch, **parameters):
    """Runs a notebook's cells in its folder and returns their names."""
    if not program_has('tensors'):
        pytest.skip('no item3d program that has the command tensors')
    display = types.ModuleType('IPython.display')
    display.Image = lambda path: pathlib.Path(path).read_bytes()
    display.display = lambda image: None
    monkeypatch.setitem(sys.modules, 'IPython', types.ModuleType('IPython'))
    monkeypatch.setitem(sys.modules, 'IPython.display', display)
    monkeypatch.chdir(FOLDER)
    names = {}
    for cell in json.loads((FOLDER / name).read_text())['cells']:
        assert cell.get('outputs', []) == [], f'{name}: outputs are not committed'
        if cell['cell_type'] == 'code':
            exec(compile(''.join(cell['source']), name, 'exec'), names)
            if 'parameters' in cell['metadata'].get('tags', []):
                assert set(parameters) <= set(names)
                names.update(parameters)
    return names


def test_edit_a_model(monkeypatch, tmp_path):
    names = run('edit_a_model.ipynb', monkeypatch, iterations=4, output=str(tmp_path / 'golden'))
    assert 'edit' in names['stages'] and (tmp_path / 'golden/half.glb').exists()


def test_texture_from_photographs(monkeypatch):
    names = run('texture_from_photographs.ipynb', monkeypatch, views=4, pixels=64, texels=64, steps=40)
    assert names['losses'][-1] < 0.1 * names['losses'][0]


def test_direction_on_images(monkeypatch):
    names = run('direction_on_images.ipynb', monkeypatch, steps=12, learning_rate=0.03)
    assert names['after'][1] > names['before'][1] + 0.03  # gold has more green than red paint


def test_compare_with_diffusers(monkeypatch, tmp_path):
    pytest.importorskip('diffusers')
    names = run('compare_with_diffusers.ipynb', monkeypatch, steps=3, folder=str(tmp_path / 'prior'))
    assert set(names['errors']) == {'sds', 'rdl'}
    for errors in names['errors'].values():
        assert len(errors) == 3 and max(errors) < 1e-3
