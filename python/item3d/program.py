"""Functions that run the program's commands.

Each command runs in a separate process. This process therefore does not load a second LibTorch, and a crash of a
command does not end it. A function such as `edit` waits for the end of the command:

    result = item3d.edit('mug.glb', 'a red mug', 'a golden mug', output='golden')

`start_edit` returns a `Job` at once. Iterating over the job gives its progress, and it can be stopped at any time:

    with item3d.start_edit('mug.glb', 'a red mug', 'a golden mug', output='golden') as job:
        for progress in job:
            print(progress.stage, progress.done, progress.total)
    print(job.result()['files'])
"""
from __future__ import annotations

import dataclasses
import difflib
import json
import logging
import os
import shutil
import signal
import subprocess
import tempfile
import threading
from typing import Any, Iterator, Sequence

from .settings import (CaptionSettings, EditSettings, LayersSettings, ReconstructSettings, RegionSettings,
                       RelightSettings, ScoreSettings)

_log = logging.getLogger('item3d')


class Error(RuntimeError):
    """A command failed. str(error) is its error message without "item3d: error:", `code` its exit code."""

    def __init__(self, message: str, code: int):
        super().__init__(message)
        self.code = code


class UsageError(Error):
    """Unknown options, or options that exclude each other (code 2)."""


class InputError(Error):
    """A missing or broken file, an unwritable folder, a value out of range (code 3)."""


class ResourceError(Error):
    """Disk space, memory or a device is missing (code 4)."""


class Interrupted(Error):
    """The command was stopped after it had written its checkpoint (code 130)."""


class InternalError(Error):
    """A bug of item3d, or the process was killed (all other codes)."""


class ProgramMissing(Error):
    """No program was found, or it cannot be started."""


_ERRORS = {2: UsageError, 3: InputError, 4: ResourceError, 130: Interrupted}


@dataclasses.dataclass(frozen=True)
class Progress:
    """Progress of a command."""

    stage: str
    """Name of the stage: 'load', 'fit', 'edit', 'paint', 'detail', 'bake', 'report', ..."""
    done: int
    """Number of finished steps of the stage."""
    total: int
    """Number of all steps of the stage; 0: unknown."""
    seconds_left: float | None
    """Seconds until the end of the stage; None: unknown."""


def find_program() -> str:
    """Returns the path of the program.

    It is the first of: the environment variable ITEM3D_PROGRAM, the program of the Python package item3d-program, the
    program on PATH, and the program that was built beside these sources. Raises ProgramMissing if there is none.
    """
    named = os.environ.get('ITEM3D_PROGRAM')
    if named:
        if not os.access(named, os.X_OK):
            cause = 'cannot be executed' if os.path.exists(named) else 'does not exist'
            raise ProgramMissing(f'ITEM3D_PROGRAM={named} {cause}', 127)
        return named
    try:
        import item3d_program
        return item3d_program.program()
    except ImportError:
        pass
    found = shutil.which('item3d')
    if found:
        return found
    built = os.path.abspath(os.path.join(os.path.dirname(__file__), '..', '..', 'build', 'item3d'))
    if os.access(built, os.X_OK):
        return built
    raise ProgramMissing('no item3d program was found: install item3d-program, put item3d on PATH, or set '
                         'ITEM3D_PROGRAM to it', 127)


def options_of(settings) -> list[str]:
    """Returns a dataclass of settings as command-line options.

    None and False are left out, and True gives an option without a value. A sequence gives the option once for each of
    its values, or once with all values joined by commas if the field says so.
    """
    result = []
    for field in dataclasses.fields(settings):
        value = getattr(settings, field.name)
        if value is not None and isinstance(value, bool) != str(field.type).startswith('bool'):
            raise TypeError(f'{type(settings).__name__}: {field.name} must be {field.type}, found {value!r}')
        name = '--' + field.metadata.get('option', field.name.replace('_', '-'))
        if value is None or value is False:
            continue
        if value is True:
            result.append(name)
        elif isinstance(value, (list, tuple)) and field.metadata.get('joined'):
            result += [name, ','.join(map(str, value))]
        elif isinstance(value, (list, tuple)):
            for one in value:
                result += [name, str(one)]
        else:
            result += [name, str(value)]
    return result


def _argument(value) -> str:
    """Returns a path or a string as an argument of a command."""
    try:
        return os.fspath(value)
    except TypeError:
        raise TypeError(f'a file or a sentence was expected, found {type(value).__name__} (models are given by their '
                        'file)') from None


def failure(command: Sequence[str], code: int, lines: Sequence[str]) -> Error:
    """Returns the exception for a command that ended with exit code `code`. lines: its lines on stderr."""
    marked = [line.split('error: ', 1)[1] for line in lines if 'error: ' in line]
    if code in (-signal.SIGINT, -signal.SIGTERM):
        code = 130  # stopped while the program did not handle signals
    if code < 0:
        message = f'{command[1]} was killed by signal {-code}'
    elif marked:
        message = marked[-1]
    elif code == 130:
        saved = [line for line in lines if 'checkpoint' in line]
        message = f'{command[1]} was stopped' + (' and wrote a checkpoint; resume=True continues it' if saved else
                                                 ' and has no checkpoint')
    else:
        message = '\n'.join(lines[-3:]) or (f'{command[1]} ended with code {code} and said nothing; check that '
                                            f'{command[0]} is item3d')
    return _ERRORS.get(code, InternalError)(message, code)


def log_message(line: str) -> None:
    """Sends a line of a command's stderr to the logger `item3d`."""
    _log.log(logging.WARNING if line.startswith('warning: ') else logging.INFO, '%s', line)


class Job:
    """A running command.

    Iterating over a job yields its progress at each change, until the command ends, and then raises the errors of
    result(). Leaving a `with` block stops the command if it is still running.
    """

    def __init__(self, arguments: Sequence[str], program: str | None = None, output=None):
        """Starts a command.

        arguments: the program's arguments without --json and --progress-file. output: the folder of its results.
        """
        self.output = output
        self._lines: list[str] = []
        self._stdout = ''
        self.command = [program or find_program(), *map(_argument, arguments), '--json', '--progress-file']
        # The folder is removed when the command has ended, and at the latest when this program ends.
        self._folder = tempfile.TemporaryDirectory(prefix='item3d-', ignore_cleanup_errors=True)
        self._progress_file = os.path.join(self._folder.name, 'progress.json')
        self.command.append(self._progress_file)
        _log.debug('%s', ' '.join(self.command))
        try:
            # The command has its own process group, so Ctrl-C does not reach it directly but through stop(), which
            # waits for its checkpoint.
            self._process = subprocess.Popen(
                self.command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                text=True, encoding='utf-8', errors='replace', start_new_session=True)
        except OSError as error:
            self._folder.cleanup()
            raise ProgramMissing(f'{self.command[0]} cannot be started: {error.strerror}', 127) from None
        self._readers = [threading.Thread(target=self._read_messages, daemon=True),
                         threading.Thread(target=self._read_result, daemon=True)]
        for reader in self._readers:
            reader.start()

    def _read_messages(self) -> None:
        for line in self._process.stderr:
            line = line.rstrip('\r\n')
            self._lines.append(line)
            log_message(line)

    def _read_result(self) -> None:
        self._stdout = self._process.stdout.read()

    @property
    def running(self) -> bool:
        return self._process.poll() is None

    def progress(self) -> Progress | None:
        """Returns the progress of the command, or None if there is none yet."""
        try:
            with open(self._progress_file, encoding='utf-8') as file:
                read = json.load(file)
            return Progress(str(read['stage']), int(read['done']), int(read['total']), read['seconds_left'])
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def preview(self) -> str | None:
        """Returns the path of an image of the current model, or None if there is no such image.

        The command replaces the image every few seconds. The file is never incomplete.
        """
        path = os.path.join(os.fspath(self.output), 'preview.png') if self.output is not None else ''
        return path if os.path.exists(path) else None

    def __iter__(self) -> Iterator[Progress]:
        last = None
        while True:
            running = self.running
            now = self.progress()
            if now is not None and now != last:
                last = now
                yield now
            if not running:
                break
            try:
                self._process.wait(0.2)
            except subprocess.TimeoutExpired:
                pass
        self.result()

    def stop(self, timeout: float = 60) -> None:
        """Stops the command and waits until it has written its checkpoint, if it has begun to optimize.

        A command that still runs after `timeout` seconds is killed. Does nothing if the command has ended.
        """
        if self.running:
            self._signal(signal.SIGTERM)
            try:
                self._process.wait(timeout)
            except subprocess.TimeoutExpired:
                self._signal(signal.SIGKILL)
                self._process.wait()
        self._end()

    def _signal(self, number: int) -> None:
        try:
            os.killpg(self._process.pid, number)
        except ProcessLookupError:
            pass

    def _end(self) -> None:
        for reader in self._readers:
            reader.join()
        self._folder.cleanup()

    def result(self) -> dict[str, Any]:
        """Waits for the command and returns its JSON output.

        Raises UsageError, InputError, ResourceError, Interrupted or InternalError if the command failed.
        """
        try:
            code = self._process.wait()
        except KeyboardInterrupt:
            self.stop()
            raise KeyboardInterrupt(str(failure(self.command, 130, self._lines))) from None
        self._end()
        if code == 0:
            try:
                return json.loads(self._stdout)
            except ValueError:
                raise InternalError(f'{self.command[0]} printed no JSON; check that it is item3d and not too old',
                                    1) from None
        raise failure(self.command, code, self._lines)

    def __enter__(self) -> Job:
        return self

    def __exit__(self, *_) -> None:
        self.stop()


def settings_of(kind, settings, changes):
    settings = kind() if settings is None else settings
    if not isinstance(settings, kind):
        raise TypeError(f'settings must be {kind.__name__}, found {type(settings).__name__}')
    try:
        return dataclasses.replace(settings, **changes)
    except TypeError:
        names = {field.name for field in dataclasses.fields(kind)}
        unknown = sorted(set(changes) - names)
        close = [near for name in unknown for near in difflib.get_close_matches(name, names, 1)]
        advice = f'did you mean {", ".join(close)}?' if close else f'it has {", ".join(sorted(names))}'
        raise TypeError(f'{kind.__name__} has no {", ".join(unknown)}; {advice}') from None


def start_edit(model, source: str, target: str, *, output, settings: EditSettings | None = None,
               **changes) -> Job:
    """Starts `item3d edit`.

    source, target: sentences that describe the model as it is and as it should be. output: folder for the results.
    settings: settings of the edit; None: the program's defaults. changes: single settings that override `settings`.
    """
    settings = settings_of(EditSettings, settings, changes)
    return Job(['edit', model, '--from', source, '--to', target, '-o', output, *options_of(settings)], output=output)


def edit(model, source: str, target: str, *, output, settings: EditSettings | None = None,
         **changes) -> dict[str, Any]:
    """Edits a model and returns the output of `item3d edit --json`. The arguments are those of start_edit()."""
    return _finished(start_edit(model, source, target, output=output, settings=settings, **changes))


def start_relight(model, *, output, settings: RelightSettings | None = None, **changes) -> Job:
    """Starts `item3d relight`."""
    settings = settings_of(RelightSettings, settings, changes)
    return Job(['relight', model, '-o', output, *options_of(settings)], output=output)


def relight(model, *, output, settings: RelightSettings | None = None, **changes) -> dict[str, Any]:
    """Shows a model under another light and returns the output of `item3d relight --json`."""
    return _finished(start_relight(model, output=output, settings=settings, **changes))


def start_reconstruct(dataset=None, *, output, settings: ReconstructSettings | None = None, **changes) -> Job:
    """Starts `item3d reconstruct`. dataset: folder of a dataset; without it, the setting from_images names a folder."""
    settings = settings_of(ReconstructSettings, settings, changes)
    given = [] if dataset is None else [dataset]
    return Job(['reconstruct', *given, '-o', output, *options_of(settings)], output=output)


def reconstruct(dataset=None, *, output, settings: ReconstructSettings | None = None,
                **changes) -> dict[str, Any]:
    """Reconstructs a model from photographs and returns the output of `item3d reconstruct --json`."""
    return _finished(start_reconstruct(dataset, output=output, settings=settings, **changes))


def score(before, after, source: str, target: str, *, settings: ScoreSettings | None = None,
          **changes) -> dict[str, Any]:
    """Measures with CLIP how well an edit follows its sentences. Returns the output of `item3d score --json`."""
    settings = settings_of(ScoreSettings, settings, changes)
    return _finished(Job(['score', before, after, '--from', source, '--to', target, *options_of(settings)]))


def caption(path, *, settings: CaptionSettings | None = None, **changes) -> dict[str, Any]:
    """Describes an image or a model in words. Returns the output of `item3d caption --json`."""
    settings = settings_of(CaptionSettings, settings, changes)
    return _finished(Job(['caption', path, *options_of(settings)]))


def region(model, region=None, *, output, settings: RegionSettings | None = None, **changes) -> dict[str, Any]:
    """Shows the part of a model that selectors select. Returns the output of `item3d region --json`.

    region: a selector such as 'material=glaze', or a list of selectors. None: the result lists the names that can be
    selected. output: folder for the results.
    """
    if region is not None:
        changes['region'] = region
    settings = settings_of(RegionSettings, settings, changes)
    return _finished(Job(['region', model, '-o', output, *options_of(settings)]))


def layers(model, layers, *, output, settings: LayersSettings | None = None, **changes) -> dict[str, Any]:
    """Applies edits as layers to the model that they were made from. Returns the output of `item3d layers --json`.

    layers: the folder of an edit, or 'FOLDER:STRENGTH[:CHANNEL,...]', or a list of these. output: path of the model to
    write.
    """
    settings = settings_of(LayersSettings, settings, changes)
    given = [layers] if isinstance(layers, (str, os.PathLike)) else list(layers)
    return _finished(Job(['layers', model, *given, '-o', output, *options_of(settings)]))


def run_command(arguments: Sequence[str]) -> dict[str, Any]:
    """Runs a command and returns its JSON output. Raises the errors of Job.result()."""
    return _finished(Job(arguments))


def _finished(job: Job) -> dict[str, Any]:
    with job:
        return job.result()
