"""Tests of the functions that run commands, with a stand-in for the program, and with the program if it exists."""
import dataclasses
import logging
import os
import pathlib
import re
import stat
import subprocess
import sys
import textwrap
import time

import pytest
import torch

import files
import item3d

ROOT = pathlib.Path(__file__).resolve().parents[2]
MUG = ROOT / 'assets/demo/mug.glb'


@pytest.fixture
def stand_in(tmp_path, monkeypatch):
    """Returns a function that makes Python code the program; it can use arguments and progress(stage, done, total)."""
    def make(code):
        path = tmp_path / 'item3d'
        path.write_text(f'#!{sys.executable}\n' + textwrap.dedent('''
            import json, os, signal, sys, time
            arguments = sys.argv[1:]
            def progress(stage, done, total, left=None):
                path = arguments[arguments.index('--progress-file') + 1]
                with open(path + '.part', 'w') as file:
                    json.dump(dict(stage=stage, done=done, total=total, seconds_left=left), file)
                os.rename(path + '.part', path)
            ''') + textwrap.dedent(code))
        path.chmod(path.stat().st_mode | stat.S_IEXEC)
        monkeypatch.setenv('ITEM3D_PROGRAM', str(path))
    return make


def test_arguments_and_result(stand_in):
    stand_in('print(json.dumps(dict(arguments=arguments)))')
    settings = item3d.EditSettings(iterations=5, keep=['normal', 'occlusion'], timesteps=(0.1, 0.9),
                                   region=['named=black', 'all'], resume=True, material='a b')
    found = item3d.edit('mug.glb', 'a mug', 'a "cup"', output=pathlib.Path('out'), settings=settings,
                        seed=3)['arguments']
    assert found[:8] == ['edit', 'mug.glb', '--from', 'a mug', '--to', 'a "cup"', '-o', 'out']
    assert found[8:-3] == ['--resume', '--iterations', '5', '--timesteps', '0.1,0.9', '--keep',
                           'normal,occlusion', '--material', 'a b', '--seed', '3', '--region', 'named=black',
                           '--region', 'all']
    assert found[-3:-1] == ['--json', '--progress-file']
    assert not os.path.exists(os.path.dirname(found[-1]))
    assert item3d.relight('m.glb', output='o', source='a', target='b', sky=8.0)['arguments'][4:10] == [
        '--sky', '8.0', '--from', 'a', '--to', 'b']
    assert item3d.reconstruct(output='o', from_images='p')['arguments'][:5] == [
        'reconstruct', '-o', 'o', '--from-images', 'p']
    assert item3d.score('a', 'b', 'c', 'd', views=2)['arguments'][:9] == [
        'score', 'a', 'b', '--from', 'c', '--to', 'd', '--views', '2']
    assert item3d.caption('a.png')['arguments'][:2] == ['caption', 'a.png']
    assert item3d.region('m', ['auto', 'all'], output='o', source='a')['arguments'][:10] == [
        'region', 'm', '-o', 'o', '--region', 'auto', '--region', 'all', '--from', 'a']
    assert item3d.layers('m', 'gold:0.5', output='o.glb')['arguments'][:5] == ['layers', 'm', 'gold:0.5', '-o', 'o.glb']


@pytest.mark.parametrize('code, error', [
    (1, item3d.InternalError), (2, item3d.UsageError), (3, item3d.InputError), (4, item3d.ResourceError),
    (130, item3d.Interrupted), (77, item3d.InternalError)])
def test_exit_codes_are_exceptions(stand_in, code, error):
    stand_in(f'''
        print('a note', file=sys.stderr)
        print('item3d: error: mug.glb: not found; give a file', file=sys.stderr)
        sys.exit({code})
    ''')
    with pytest.raises(error, match='^mug.glb: not found; give a file$') as raised:
        item3d.caption('mug.glb')
    assert raised.value.code == code and isinstance(raised.value, item3d.Error)


def test_a_crash_stays_outside(stand_in):
    stand_in('os.kill(os.getpid(), signal.SIGKILL)')
    with pytest.raises(item3d.InternalError, match='caption was killed by signal 9'):
        item3d.caption('a')


def test_no_json(stand_in):
    stand_in('print("usage")')
    with pytest.raises(item3d.InternalError, match='printed no JSON'):
        item3d.caption('a')


def test_progress_and_result(stand_in):
    stand_in('''
        for i in range(3):
            progress('edit', i, 3, 1.5)
            time.sleep(0.5)
        print('{"files": 1}')
    ''')
    with item3d.start_edit('m', 'a', 'b', output='o') as job:
        seen = list(job)
    assert [p.done for p in seen] == [0, 1, 2]
    assert seen[0] == item3d.Progress('edit', 0, 3, 1.5) and job.result() == {'files': 1}
    assert not job.running


def test_a_preview_while_it_runs(stand_in, tmp_path):
    stand_in('''
        folder = arguments[arguments.index('-o') + 1]
        progress('edit', 1, 2)
        open(folder + '/preview.png', 'w').close()
        progress('edit', 2, 2)
        print('{}')
    ''')
    with item3d.start_edit('m', 'a', 'b', output=tmp_path) as job:
        job.result()
        assert job.preview() == str(tmp_path / 'preview.png')
    assert item3d.start_relight('m', output=tmp_path / 'none').preview() is None


def test_stop_lets_the_command_end_by_itself(stand_in, tmp_path):
    stand_in(f'''
        def end(*_):
            open({str(tmp_path / "checkpoint")!r}, "w").close()
            print('item3d: interrupted: a checkpoint was saved at iteration 1 of 9', file=sys.stderr, flush=True)
            sys.exit(130)
        signal.signal(signal.SIGTERM, end)
        progress('edit', 1, 9)
        time.sleep(60)
    ''')
    job = item3d.start_edit('m', 'a', 'b', output='o')
    begin = time.monotonic()
    with pytest.raises(item3d.Interrupted, match='edit was stopped and wrote a checkpoint; resume=True continues it'):
        for _ in job:
            job.stop()
    assert (tmp_path / 'checkpoint').exists() and time.monotonic() - begin < 30
    job.stop()


def test_a_command_that_is_stopped_before_it_handles_signals(stand_in):
    stand_in('progress("edit", 0, 1); time.sleep(60)')
    job = item3d.start_edit('m', 'a', 'b', output='o')
    next(iter(job))
    job.stop()
    with pytest.raises(item3d.Interrupted, match='edit was stopped and has no checkpoint'):
        job.result()


def test_leaving_the_block_stops_the_command(stand_in):
    stand_in('signal.signal(signal.SIGTERM, signal.SIG_IGN); progress("edit", 0, 1); time.sleep(60)')
    with item3d.start_edit('m', 'a', 'b', output='o') as job:
        next(iter(job))
        job.stop(timeout=0.2)
    assert not job.running


def test_messages_are_logged(stand_in, caplog):
    stand_in('''
        print('warning: no UVs', file=sys.stderr)
        print('reading', file=sys.stderr)
        print('{}')
    ''')
    with caplog.at_level(logging.INFO, 'item3d'):
        item3d.caption('a')
    assert [(r.levelname, r.message) for r in caplog.records] == [
        ('WARNING', 'warning: no UVs'), ('INFO', 'reading')]


def test_a_program_that_is_missing(monkeypatch, tmp_path):
    monkeypatch.setenv('ITEM3D_PROGRAM', str(tmp_path / 'none'))
    with pytest.raises(item3d.ProgramMissing, match='does not exist'):
        item3d.caption('a')
    (tmp_path / 'none').write_text('')
    with pytest.raises(item3d.ProgramMissing, match='cannot be executed'):
        item3d.caption('a')


def test_settings_that_do_not_exist():
    with pytest.raises(TypeError, match=r'EditSettings has no iteration; did you mean iterations\?'):
        item3d.edit('m', 'a', 'b', output='o', iteration=3)
    with pytest.raises(TypeError, match='EditSettings has no zzz; it has adjust, '):
        item3d.edit('m', 'a', 'b', output='o', zzz=3)
    with pytest.raises(TypeError, match='iterations must be int'):
        item3d.edit('m', 'a', 'b', output='o', iterations=True)
    with pytest.raises(TypeError, match="resume must be bool.*found 'yes'"):
        item3d.edit('m', 'a', 'b', output='o', resume='yes')
    with pytest.raises(TypeError, match='a file or a sentence was expected, found int'):
        item3d.edit(3, 'a', 'b', output='o')
    with pytest.raises(TypeError, match='settings must be EditSettings, found dict'):
        item3d.edit('m', 'a', 'b', output='o', settings={})


# With the program. -------------------------------------------------------------------------------

@pytest.fixture
def program():
    try:
        return item3d.find_program()
    except item3d.ProgramMissing as error:
        pytest.skip(str(error))


@pytest.mark.parametrize('command, kind', [
    ('edit', item3d.EditSettings), ('relight', item3d.RelightSettings),
    ('reconstruct', item3d.ReconstructSettings), ('score', item3d.ScoreSettings),
    ('caption', item3d.CaptionSettings), ('region', item3d.RegionSettings),
    ('layers', item3d.LayersSettings)])
def test_settings_are_the_options(program, command, kind):
    text = subprocess.run([program, command, '--help-all' if command in ('edit', 'reconstruct', 'relight') else '--help'], capture_output=True, text=True, check=True).stdout
    options = set(re.findall(r'^  (?:-\w, |    )--([a-z0-9-]+)', text, re.MULTILINE))
    fields = {f.metadata.get('option', f.name.replace('_', '-')) for f in dataclasses.fields(kind)}
    own = {'help', 'help-all', 'json', 'progress-file', 'quiet', 'output', 'plan'}
    arguments = {'from', 'to'} if command in ('edit', 'score') else set()
    assert fields == options - own - arguments


def test_every_setting_of_the_reference_has_a_field():
    table = (ROOT / 'docs/reference/settings.md').read_text()
    options = set(re.findall(r'^\| `\w+` \| `--([a-z0-9-]+)`', table, re.MULTILINE)) - {'from', 'to'}
    fields = {f.name.replace('_', '-') for f in dataclasses.fields(item3d.EditSettings)}
    assert len(options) > 30 and options <= fields


@pytest.mark.parametrize('size', [(16, 32), (40, 80)])  # one block of the file, and three
def test_a_light_is_read_exactly(program, tmp_path, size):
    torch.manual_seed(5)
    stored = files.write_radiance(tmp_path / 'light.hdr', torch.rand(*size, 3) * 4)
    assert torch.equal(item3d.load_light(tmp_path / 'light.hdr'), stored)
    assert torch.equal(item3d.load_light(tmp_path / 'light.hdr', exposure=1), 2 * stored)
    turned = item3d.load_light(tmp_path / 'light.hdr', rotate=90)
    assert torch.allclose(turned, stored.roll(size[1] // 4, 1), atol=1e-5)
    with pytest.raises(item3d.InputError, match='neither a preset nor an existing file'):
        item3d.load_light('lamp')


def test_a_caption_and_an_input_that_is_missing(program, tmp_path):
    result = item3d.caption(MUG, views=1, beams=1)
    assert 'mug' in str(result)
    with pytest.raises(item3d.InputError, match='none.glb'):
        item3d.caption(tmp_path / 'none.glb')
    with pytest.raises(item3d.InputError):
        item3d.edit(MUG, 'a red mug', 'a golden mug', output=tmp_path / 'e', timesteps=(0.9, 0.1))


def test_a_short_edit_with_progress(program, tmp_path):
    # The stage must last longer than the job's 0.2 s between two looks at the progress, also on a fast machine.
    settings = item3d.EditSettings(iterations=60, texture_size=64, resolution=64, batch=1,
                                   image_size=32, detail='off', timesteps=(0.1, 0.9), keep=['normal'])
    with item3d.start_edit(MUG, 'a red mug', 'a golden mug', output=tmp_path / 'edit',
                           settings=settings) as job:
        stages = {progress.stage for progress in job}
    assert job.result() and 'edit' in stages
    assert (tmp_path / 'edit/model.glb').exists()

    item3d.layers(MUG, [f'{tmp_path}/edit:0.5', f'{tmp_path}/edit:0.5:roughness'], output=tmp_path / 'half.glb')
    assert (tmp_path / 'half.glb').read_bytes()[:4] == b'glTF'


def test_a_region_and_its_names(program, tmp_path):
    names = item3d.region(MUG, output=tmp_path / 'names', size=64)
    found = item3d.region(MUG, 'named=red', output=tmp_path / 'red', settings=item3d.RegionSettings(size=64))
    assert (tmp_path / 'red/region.png').exists()
    assert names['names']['material'] == ['glaze'] and 'materials' not in names
    assert (tmp_path / 'red' / found['materials'][0]['mask']).exists()
    with pytest.raises(item3d.InputError, match='no such material; it has glaze'):
        item3d.region(MUG, ['material=none'], output=tmp_path / 'none')
