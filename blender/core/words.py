"""Completion of sentences from the words that a prior knows."""
from __future__ import annotations

import json
import subprocess
import threading
from pathlib import Path

from .program import Program

SECONDS_TO_ANSWER = 60


class Vocabulary:
    """The words of priors. For each prior, a thread asks the program once, so that the user interface does not wait."""

    def __init__(self) -> None:
        self._words: dict[tuple[Path, str], list[str]] = {}
        self._asked: dict[tuple[Path, str], threading.Thread] = {}

    def ask(self, program: Program, prior: str) -> list[str]:
        """Returns a prior's words, or [] until the program has answered."""
        key = (program.path, prior)
        if key not in self._asked:
            thread = threading.Thread(target=self._fetch, args=key, daemon=True)
            self._asked[key] = thread
            thread.start()
        return self._words.get(key, [])

    def wait(self, program: Program, prior: str) -> list[str]:
        """Waits until the program has answered, and returns the words."""
        self.ask(program, prior)
        self._asked[program.path, prior].join()
        return self._words.get((program.path, prior), [])

    def _fetch(self, program: Path, prior: str) -> None:
        command = [str(program), "prior", "info", *([prior] if prior else []), "--json"]
        try:
            answer = subprocess.run(command, capture_output=True, timeout=SECONDS_TO_ANSWER, check=True)
            words = json.loads(answer.stdout).get("words", [])
        except (OSError, ValueError, subprocess.SubprocessError):
            words = []
        self._words[program, prior] = [word for word in words if isinstance(word, str)]


def complete(sentence: str, words: list[str], most: int = 40) -> list[str]:
    """Returns the sentence with each known completion of its last word."""
    head, space, tail = sentence.rpartition(" ")
    start = tail.lower()
    if not start:
        return []
    found = [word for word in words if word.startswith(start) and word != start]
    return [f"{head}{space}{word}" for word in found[:most]]


def unknown(sentence: str, words: list[str]) -> list[str]:
    """Returns the words of a sentence that a prior does not know, or [] if the prior has no list of words."""
    if not words:
        return []
    known = set(words)
    return [word for word in sentence.lower().replace(",", " ").split() if word not in known]
