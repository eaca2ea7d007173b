"""Simulates a power cut: restores a folder to what the disk would contain, from the record of journal.c.

There are three models of a disk, from the mildest to the strictest:

    data      All names survive. A file has the contents of its last sync. A file that was never synced is empty or has
              a part of its contents.
    journal   As data, but the last changes of names are lost too, back to a random point after the last sync. A file
              system with a journal behaves so.
    strict    As data, but a name survives only if its folder was synced after the name was created.
"""
import pathlib
import shutil

MODELS = ("data", "journal", "strict")


class Node:
    """A file, a folder or a symbolic link of the simulated disk."""

    def __init__(self, kind, content=None):
        self.kind, self.content = kind, content
        self.entries = {}  # of a folder: its entries as programs see them
        self.kept = {}     # of a folder: its entries at its last sync


def read_tree(folder):
    """Reads a folder into a tree of nodes, all of whose contents count as synced."""
    node = Node("folder")
    for path in folder.iterdir():
        if path.is_symlink():
            node.entries[path.name] = Node("link", str(path.readlink()))
        elif path.is_dir():
            node.entries[path.name] = read_tree(path)
        else:
            node.entries[path.name] = Node("file", path.read_bytes())
    node.kept = dict(node.entries)
    return node


class Disk:
    def __init__(self, root, before):
        self.root, self.tree = root, before

    def parent(self, path):
        """Returns the node of a path's folder and the path's last name, or None if the tree lacks the folder."""
        parts = pathlib.PurePath(path).relative_to(self.root).parts
        if not parts:
            return None
        node = self.tree
        for part in parts[:-1]:
            node = node.entries.get(part)
            if node is None or node.kind != "folder":
                return None
        return node, parts[-1]

    def find(self, path):
        place = self.parent(path)
        return place[0].entries.get(place[1]) if place else self.tree

    def apply(self, what, first, second):
        if what == "folder":
            node = self.find(first)
            if node is not None:
                node.kept = dict(node.entries)
            return
        if what == "sync":
            node = self.find(first)
            if node is not None:
                node.content = pathlib.Path(second).read_bytes()
            return
        place = self.parent(first)
        if place is None:
            return
        folder, name = place
        if what in ("create", "mkdir"):
            folder.entries.setdefault(name, Node("file" if what == "create" else "folder"))
        elif what == "symlink":
            folder.entries[name] = Node("link", second)
        elif what == "remove":
            folder.entries.pop(name, None)
        elif what == "rename":
            node = folder.entries.pop(name, None)
            target = self.parent(second) if second else None
            if node is not None and target:
                target[0].entries[target[1]] = node


def write_tree(node, folder, strict, guess):
    folder.mkdir(parents=True, exist_ok=True)
    for name, child in (node.kept if strict else node.entries).items():
        path = folder / name
        if child.kind == "folder":
            write_tree(child, path, strict, guess)
        elif child.kind == "link":
            path.symlink_to(child.content)
        else:
            path.write_bytes(child.content if child.content is not None else guess(name))


def cut(root, record, before, model, draw):
    """Replaces the contents of `root` by what the disk would contain.

    record: folder that journal.c has written. before: read_tree(root) at the start of the record. model: one of MODELS.
    draw: a random.Random. Returns the number of lost events.
    """
    path = record / "events"
    lines = path.read_text().split("\n")[:-1] if path.exists() else []
    events = [line.split("\t") for line in lines]
    lost = 0
    if model == "journal":
        last = max((i for i, event in enumerate(events) if event[0] in ("sync", "folder")), default=-1)
        keep = draw.randint(last + 1, len(events))
        lost = len(events) - keep
        events = events[:keep]
    written = {each.name: each.read_bytes() for each in root.rglob("*")
               if each.is_file() and not each.is_symlink()}

    def guess(name):
        data = written.get(name, b"")
        return data[:draw.choice([0, len(data) // 2, max(len(data) - 1, 0)])]

    disk = Disk(root, before)
    for event in events:
        disk.apply(*event)
    shutil.rmtree(root, ignore_errors=True)
    write_tree(disk.tree, root, model == "strict", guess)
    return lost
