#!/usr/bin/env python3
"""Tests `item3d mcp` with the client of the Model Context Protocol's Python SDK.

    python3 tests/mcp/client.py build/item3d
"""

import asyncio
import json
import os
import shutil
import sys
import tempfile
from pathlib import Path

from mcp import ClientSession, StdioServerParameters
from mcp.client.stdio import stdio_client

ROOT = Path(__file__).resolve().parents[2]
SHORT = {"detail": "off", "light-augment": "off"}


def kinds(answer):
    return [part.type for part in answer.content]


def failed(answer):
    return answer.is_error if hasattr(answer, "is_error") else answer.isError


def value(answer):
    assert not failed(answer), answer.content[0].text
    return json.loads(answer.content[0].text)


async def use(session):
    await session.initialize()
    tools = {tool.name for tool in (await session.list_tools()).tools}
    assert {"describe", "render", "edit", "region", "relight", "score", "variants"} <= tools, tools

    answer = await session.call_tool("describe", {"model": "mug.glb"})
    assert value(answer), answer
    assert kinds(answer).count("image") == 2, kinds(answer)
    answer = await session.call_tool("render", {"model": "mug.glb", "views": 2, "size": "128x128"})
    assert kinds(answer).count("image") == 2, kinds(answer)
    outside = await session.call_tool("render", {"model": "/etc/passwd"})
    assert failed(outside) and "/etc/passwd" in outside.content[0].text, outside

    steps = []

    async def progress(done, total, message):
        steps.append((done, total, message))

    words = {"from": "a red mug", "to": "a blue mug"}
    answer = await session.call_tool(
        "edit", {"model": "mug.glb", **words, "iterations": 10, "settings": SHORT}, progress_callback=progress)
    folder = value(answer)["folder"]
    assert steps and all(a[0] < b[0] for a, b in zip(steps, steps[1:])), steps
    assert "image" in kinds(answer) and "resource_link" in kinds(answer), kinds(answer)
    assert (Path(folder) / "model.glb").is_file()
    scores = value(await session.call_tool("score", {"before": "mug.glb", "after": folder + "/model.glb", **words}))
    assert scores, scores
    value(await session.call_tool("variants", {"model": "mug.glb", "edits": [folder]}))
    answer = await session.call_tool("region", {"model": "mug.glb", "region": ["words=the handle"]})
    assert "image" in kinds(answer), kinds(answer)
    answer = await session.call_tool("relight", {"model": "mug.glb", "light": "sunset"})
    assert "image" in kinds(answer), kinds(answer)
    missing = await session.call_tool("edit", {"model": "mug.glb", "from": "a red mug"})
    assert failed(missing), missing
    assert value(await session.call_tool("describe", {"model": "mug.glb"})), "the server goes on after a failure"


async def main(program):
    with tempfile.TemporaryDirectory() as folder:
        models = Path(folder) / "models"
        models.mkdir()
        shutil.copy(ROOT / "assets" / "demo" / "mug.glb", models)
        server = StdioServerParameters(
            command=str(Path(program).resolve()), args=["mcp", str(models), "-o", folder + "/results"],
            env={**os.environ, "ITEM3D_ASSETS": str(ROOT / "assets")})
        async with stdio_client(server) as (read, write), ClientSession(read, write) as session:
            await use(session)
    print("test-agents: all tools answer as an agent needs them")


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1]))
