#!/usr/bin/env python3
"""Reconstructs the scenes of NeRF-synthetic and writes the table of scores that papers print.

    python3 scripts/nerf_synthetic.py NERF_SYNTHETIC OUT [SCENE ...] [-- OPTION ...]

NERF_SYNTHETIC is the unpacked archive of Mildenhall et al. 2020. It has a folder for each scene (chair, drums, ficus,
hotdog, lego, materials, mic, ship), each with transforms_train.json, transforms_test.json and the images. SCENE may
also name other scenes with the same layout. OPTIONs are passed to `item3d reconstruct`, for example --threads 8.

Each scene is reconstructed from its training views and scored on its test views (200 in the archive), at their full
size. OUT/SCENE has the results of `item3d reconstruct`. OUT/table.md and OUT/table.json have the values of each scene
and their means: PSNR and SSIM over white, the intersection over union of the masks, time and memory.

After an interruption, the same command continues. It keeps finished scenes and resumes the interrupted one, whose time
is then that of the last start only. If a scene fails, the table has its error message, the script continues with the
other scenes, and its exit code is 1. The script needs only Python."""
import argparse
import json
import os
import pathlib
import signal
import struct
import subprocess
import sys

SCENES = ('chair', 'drums', 'ficus', 'hotdog', 'lego', 'materials', 'mic', 'ship')
PUBLISHED = {'train': 100, 'test': 200, 'size': (800, 800)}
ITEM3D = pathlib.Path(__file__).resolve().parent.parent / 'build' / 'item3d'


def size_of_png(path):
    with open(path, 'rb') as file:
        head = file.read(24)
    return struct.unpack('>II', head[16:24]) if head[:8] == b'\x89PNG\r\n\x1a\n' else None


def differences(folder):
    """Returns a text about the differences of a scene from the published ones in number and size of views."""
    words = []
    for split in ('train', 'test'):
        frames = json.loads((folder / f'transforms_{split}.json').read_text())['frames']
        if len(frames) != PUBLISHED[split]:
            words.append(f'{len(frames)} {split} views')
        picture = folder / (frames[0]['file_path'] + '.png')
        if split == 'train' and picture.is_file() and size_of_png(picture) != PUBLISHED['size']:
            words.append('{} x {}'.format(*(size_of_png(picture) or (0, 0))))
    return ', '.join(words)


def row_of(summary, remark):
    test = summary['scores']['test']
    return {'psnr': test['psnr'], 'ssim': test['ssim'], 'masks': test['mask_overlap'], 'views': summary['dataset']['test'],
            'minutes': summary['seconds']['total'] / 60, 'gigabytes': summary['peak_memory_bytes'] / 1e9,
            'version': summary['version'], 'threads': summary['settings']['threads'], 'remark': remark}


def reconstruct(source, out, options):
    """Reconstructs a scene. Returns its summary and an empty text, or None and the error message."""
    done = out / 'reconstruct.json'
    if not done.is_file():
        command = [str(ITEM3D), 'reconstruct', str(source), '-o', str(out), '--resume', *options]
        print('+', ' '.join(command), flush=True)
        run = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, errors='replace')
        last = ''
        try:
            for line in run.stderr:
                sys.stderr.write(line)
                last = line.strip() or last
            code = run.wait()
        except KeyboardInterrupt:  # in a terminal Ctrl-C also reached the program, which writes its checkpoint
            run.send_signal(signal.SIGINT)
            run.wait()
            code = 130
        if code == 130 or code < 0:
            sys.exit(f'{source.name}: interrupted; run the same command again to continue')
        if code != 0:
            return None, last.split('\r')[-1] or f'exit code {code}'
    return json.loads(done.read_text()), ''


def write(path, text):
    partial = path.with_name(path.name + '.partial')
    partial.write_text(text)
    os.replace(partial, path)


def write_table(out, rows, failures, options):
    names = ('psnr', 'ssim', 'masks', 'minutes', 'gigabytes')
    means = {name: sum(row[name] for row in rows.values()) / len(rows) for name in names} if rows else {}
    write(out / 'table.json', json.dumps({'options': options, 'scenes': rows, 'mean': means, 'failures': failures}, indent=1) + '\n')
    lines = ['| scene | PSNR | SSIM | masks (IoU) | minutes | GB | |', '|---|---|---|---|---|---|---|']
    for scene, row in [*rows.items(), *([('mean', means)] if len(rows) > 1 else [])]:
        lines.append('| {} | {:.2f} dB | {:.3f} | {:.4f} | {:.0f} | {:.2f} | {} |'.format(
            scene, *(row[name] for name in names), row.get('remark', '')))
    lines += [f'| {scene} | | | | | | {line} |' for scene, line in failures.items()]
    text = '\n'.join(lines) + '\n'
    write(out / 'table.md', text)
    return text


def check_options(out, options):
    """Fails if the table was started with other options, because all rows of a table must have the same options."""
    path = out / 'options.json'
    if path.is_file():
        before = json.loads(path.read_text())
        if before != options:
            sys.exit(f'{out}: was begun with options {" ".join(before) or "(none)"}; give the same, or another folder')
    write(path, json.dumps(options) + '\n')


def main():
    arguments = sys.argv[1:]
    split = arguments.index('--') if '--' in arguments else len(arguments)
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('source', type=pathlib.Path, help='folder of the scenes')
    parser.add_argument('out', type=pathlib.Path, help='folder for all results')
    parser.add_argument('scene', nargs='*', help='scenes to reconstruct; default: all')
    asked = parser.parse_args(arguments[:split])
    options = arguments[split + 1:]
    if not ITEM3D.is_file():
        sys.exit(f'{ITEM3D}: does not exist; build it (make)')
    is_there = {scene: (asked.source / scene / 'transforms_train.json').is_file() for scene in asked.scene or SCENES}
    missing = [scene for scene, there in is_there.items() if not there]
    if asked.scene and missing or not any(is_there.values()):
        sys.exit(f'{asked.source}: no transforms_train.json in {", ".join(missing)}')
    if missing:
        print(f'not in {asked.source}: {", ".join(missing)}', file=sys.stderr)
    asked.out.mkdir(parents=True, exist_ok=True)
    check_options(asked.out, options)
    rows, failures = {}, {}
    for scene in (scene for scene, there in is_there.items() if there):
        if not (asked.source / scene / 'transforms_test.json').is_file():
            failures[scene] = 'no transforms_test.json'
            continue
        summary, line = reconstruct(asked.source / scene, asked.out / scene, options)
        if summary is None or not summary['scores']['test']:
            failures[scene] = line or 'no test view has a picture'
        else:
            rows[scene] = row_of(summary, differences(asked.source / scene))
        write_table(asked.out, rows, failures, options)
    print(write_table(asked.out, rows, failures, options), end='')
    print(f'{asked.out / "table.md"}, {asked.out / "table.json"}', file=sys.stderr)
    sys.exit(1 if failures else 0)


if __name__ == '__main__':
    main()
