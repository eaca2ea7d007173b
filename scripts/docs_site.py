"""Hooks of MkDocs (mkdocs.yml) that convert docs/ into a site: further files, links, and lists in GitHub's syntax.

README.md and CONTRIBUTING.md become pages of about/. Links between pages become links of the site. Links to other files
of the repository become relative links from build/docs, where the site is. The environment variable ITEM3D_DOCS_DEPS
names another folder of dependencies than .deps.
"""
import os
import pathlib
import posixpath
import re

from mkdocs.structure.files import File

ROOT = pathlib.Path(__file__).resolve().parents[1]
SITE = "build/docs"
OUTSIDE = {"README.md": "about/README.md", "CONTRIBUTING.md": "about/CONTRIBUTING.md"}
DEPENDENCIES = ROOT / ".deps"
PARTS = {
    "site/katex.min.css": "katex/katex.min.css",
    "site/katex.min.js": "katex/katex.min.js",
    "site/auto-render.min.js": "katex/auto-render.min.js",
    "site/iframe-worker.js": "katex/iframe-worker.js",
}
MATHEMATICS = """
document.addEventListener('DOMContentLoaded', () => {
  for (const element of document.querySelectorAll('.arithmatex'))
    renderMathInElement(element, {delimiters: [
      {left: '\\\\(', right: '\\\\)', display: false}, {left: '\\\\[', right: '\\\\]', display: true}]});
});
"""


def on_files(files, config):
    for source, page in OUTSIDE.items():
        files.append(File.generated(config, page, content=(ROOT / source).read_text()))
    dependencies = pathlib.Path(os.environ.get("ITEM3D_DOCS_DEPS", DEPENDENCIES))
    for page, part in PARTS.items():
        files.append(File.generated(config, page, abs_src_path=str(dependencies / part)))
    for font in sorted((dependencies / "katex/fonts").glob("*.woff2")):
        files.append(File.generated(config, f"site/fonts/{font.name}", abs_src_path=str(font)))
    files.append(File.generated(config, "site/mathematics.js", content=MATHEMATICS))
    return files


def source_of(page):
    """Returns the page's path in the repository."""
    names = {page: source for source, page in OUTSIDE.items()}
    return names.get(page.file.src_uri, "docs/" + page.file.src_uri)


def moved_link(target, page):
    """Converts the target of a link from the repository to the site."""
    if re.match(r"[a-z]+:|#|$", target):
        return target
    path, _, anchor = target.partition("#")
    path = posixpath.normpath(posixpath.join(posixpath.dirname(source_of(page)), path))
    here = posixpath.dirname(page.file.src_uri)
    if path in OUTSIDE:
        moved = posixpath.relpath(OUTSIDE[path], here or ".")
    elif path == "docs":
        moved = posixpath.relpath("README.md", here or ".")
    elif path.startswith("docs/"):
        moved = posixpath.relpath(path.removeprefix("docs/"), here or ".")
    else:
        if not (ROOT / path).exists():
            raise SystemExit(f"{source_of(page)}: links to {target}, which does not exist")
        # MkDocs does not change links with a scheme; on_page_content() removes this scheme again.
        return "repository:" + posixpath.relpath(path, posixpath.join(SITE, here))
    return moved + ("#" + anchor if anchor else "")


def as_python_markdown(text):
    """Adapts lists to Python-Markdown: a blank line before each list, and contents of items indented by four spaces."""
    lines, added, in_fence, item = [], 0, False, None
    for line in text.split("\n"):
        indent = len(line) - len(line.lstrip(" "))
        marker = None if in_fence else re.match(r"(\d+\.|[-*]) +(?=\S)", line)
        if marker:
            if lines and lines[-1].strip() and item is None:
                lines.append("")
            item, added = len(marker[0]), 4 - len(marker[0])
            line = marker[1] + " " * (4 - len(marker[1])) + line[len(marker[0]):]
        elif item is not None and indent >= item and line.strip():
            line = " " * added + line
        elif item is not None and line.strip() and (not lines[-1].strip() or indent == 0 and re.match(r"[#|`]", line)):
            item, added = None, 0
        if re.match(r"\s*```", line):
            in_fence = not in_fence
        lines.append(line)
    return "\n".join(lines)


def on_page_markdown(markdown, page, config, files):
    pieces = re.split(r"(^ *```.*?^ *```$)", markdown, flags=re.M | re.S)
    for i in range(0, len(pieces), 2):
        pieces[i] = re.sub(r"(\]\()([^)\s]+)(\))", lambda found: found[1] + moved_link(found[2], page) + found[3], pieces[i])
    return as_python_markdown("".join(pieces))


def on_page_content(html, page, config, files):
    return html.replace('"repository:', '"')
