"""Writes the summary of a run of the suite as one self-contained HTML page."""
import collections
import html

STYLE = """
:root { --ink: #1d232b; --soft: #66707c; --line: #dfe3e8; --ground: #fbfbfa; --good: #2f7d4f; --bad: #b3372f }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e8ea; --soft: #97a1ac; --line: #333a42;
    --ground: #15181b; --good: #6cc391; --bad: #ef8279 } }
body { margin: 3rem auto; max-width: 60rem; padding: 0 1.25rem; background: var(--ground); color: var(--ink);
    font: 16px/1.55 system-ui, sans-serif }
h1 { font-size: 1.9rem; margin: 0 } h2 { font-size: 1.2rem; margin: 2.6rem 0 .5rem }
p { margin: .4rem 0 } .soft { color: var(--soft) } .good { color: var(--good) } .bad { color: var(--bad) }
.marks { display: flex; gap: 2.5rem; margin: 1.6rem 0 0; flex-wrap: wrap }
.marks b { display: block; font-size: 1.9rem; line-height: 1.2; font-variant-numeric: tabular-nums }
table { border-collapse: collapse; width: 100%; font-size: .92rem; font-variant-numeric: tabular-nums }
th, td { text-align: left; padding: .35rem .8rem .35rem 0; border-bottom: 1px solid var(--line);
    vertical-align: top } th { color: var(--soft); font-weight: 500 } td.n, th.n { text-align: right }
pre { white-space: pre-wrap; font-size: .85rem; color: var(--soft); margin: .2rem 0 0 }
svg { width: 100%; height: 9rem; display: block; margin: .6rem 0 }
"""


def table(head, rows):
    """Returns an HTML table. head: for each column, its title and whether it has numbers. Cells are HTML."""
    def line(tag, cells):
        return "<tr>" + "".join(f'<{tag}{" class=n" if number else ""}>{cell}</{tag}>'
                                for cell, (_, number) in zip(cells, head)) + "</tr>"
    return ("<table>" + line("th", [title for title, _ in head]) +
            "".join(line("td", row) for row in rows) + "</table>")


def verdict(faults):
    return '<span class="good">none</span>' if not faults else f'<span class="bad">{faults}</span>'


def kills(results):
    rows = []
    for name, result in results.items():
        rounds = result["rounds"]
        rows.append([name, len(rounds), sum(len(each["moments"]) for each in rounds),
                     sum(each["resumed"] for each in rounds), result["products"],
                     f'{result["undisturbed_seconds"]:.1f} s',
                     verdict(sum(bool(each["faults"]) for each in rounds))])
    return table([("command", 0), ("rounds", 1), ("kills", 1), ("with a checkpoint", 1),
                  ("products compared", 1), ("undisturbed", 1), ("rounds with faults", 1)], rows)


def cuts(results):
    rows = []
    for name, rounds in results.items():
        models = collections.Counter(each["model"] for each in rounds)
        rows.append([name, len(rounds), *(models[model] for model in ("data", "journal", "strict")),
                     sum(each["after_its_end"] for each in rounds),
                     sum(each["begun_anew"] for each in rounds),
                     verdict(sum(bool(each["faults"]) for each in rounds))])
    return table([("command", 0), ("cuts", 1), ("data", 1), ("journal", 1), ("strict", 1),
                  ("after the end", 1), ("started again", 1), ("faults", 1)], rows)


def starved(cases):
    commands = sorted({case["command"] for case in cases})
    kinds = list(dict.fromkeys(case["kind"] for case in cases))
    rows = []
    for kind in kinds:
        cells = [kind]
        for command in commands:
            here = [case for case in cases if case["kind"] == kind and case["command"] == command]
            bad = sum(bool(case["faults"]) for case in here)
            cells.append(f'{len(here)} <span class="bad">({bad})</span>' if bad else str(len(here) or ""))
        codes = collections.Counter(case["code"] for case in cases if case["kind"] == kind)
        cells.append(", ".join(f"{code}: {count}" for code, count in sorted(codes.items())))
        rows.append(cells)
    return table([("resource", 0), *((command, 1) for command in commands),
                  ("exit codes (negative: a signal)", 0)], rows)


def numbers(cases):
    kinds = list(dict.fromkeys((case["kind"], case["command"]) for case in cases))
    rows = []
    for kind, command in kinds:
        here = [case for case in cases if (case["kind"], case["command"]) == (kind, command)]
        codes = collections.Counter(case["code"] for case in here)
        rows.append([kind, command, len(here), codes[0], codes[3], verdict(sum(bool(case["faults"]) for case in here))])
    return table([("number in", 0), ("command", 0), ("runs", 1), ("with a result", 1), ("refused", 1),
                  ("faults", 1)], rows)


def sizes(runs):
    rows = [[run["name"], f'{run["model_bytes"] / 1e6:.1f} MB', f'{run["seconds"]:.0f} s',
             f'{run["bytes"] / 1e9:.2f} GB', html.escape(run["said"]), verdict(len(run["faults"]))] for run in runs]
    return table([("model", 0), ("file", 1), ("edit", 1), ("memory at most", 1), ("error", 0), ("faults", 1)], rows)


def chart(samples):
    """Returns an SVG chart of the resident memory over the number of edits or requests."""
    if len(samples) < 2:
        return ""
    top, last = max(memory for _, memory, _ in samples) * 1.1, samples[-1][0]
    points = " ".join(f"{1000 * number / last:.1f},{140 - 140 * memory / top:.1f}"
                      for number, memory, _ in samples)
    return (f'<svg viewBox="0 0 1000 142" preserveAspectRatio="none"><polyline points="{points}" '
            'fill="none" stroke="currentColor" stroke-width="1.5" vector-effect="non-scaling-stroke"/>'
            '<line x1="0" y1="141" x2="1000" y2="141" stroke="var(--line)"/></svg>')


def long_run(run):
    return (f'<h3>{html.escape(run["name"])}</h3>{chart(run["samples"])}'
            f'<p>{run["count"]} {run["unit"]}s. Resident memory {run["first_bytes"] / 1e6:.1f} MB after the first '
            f'tenth, {run["last_bytes"] / 1e6:.1f} MB at the end, {run["largest_bytes"] / 1e6:.1f} MB at most: '
            f'{run["bytes_each"] / 1e3:+.2f} kB for each {run["unit"]} by least squares. Open files '
            f'{run["files_first"]}, {run["files_last"]}, at most {run["files_most"]}.</p>')


def faults(results):
    lines = []
    for result in results["kills"].values():
        lines += [("kill", each) for each in result["rounds"] if each["faults"]]
    for rounds in results["cuts"].values():
        lines += [("power cut", each) for each in rounds if each["faults"]]
    lines += [("starved", each) for each in results["starved"] if each["faults"]]
    lines += [("number", each) for each in results["numbers"] if each["faults"]]
    lines += [("size", each) for each in results["sizes"] if each["faults"]]
    lines += [("long run", each) for each in results["long"] if each["faults"]]
    return "".join(
        f'<p><span class="bad">{kind}: {html.escape(each.get("command", each.get("name", "")))}</span> '
        f'{html.escape(str(each.get("what", each.get("seed", ""))))}'
        f'<pre>{html.escape(chr(10).join(map(str, each["faults"])))}</pre></p>' for kind, each in lines), len(lines)


def write(path, results):
    listed, count = faults(results)
    rounds = sum(len(result["rounds"]) for result in results["kills"].values())
    cut = sum(len(each) for each in results["cuts"].values())
    marks = [(rounds, "rounds of kill -9"), (cut, "power cuts"), (len(results["starved"]), "starved runs"),
             (len(results["numbers"]), "runs with extreme numbers"),
             (sum(run["count"] for run in results["long"]), "edits and requests at a stretch"),
             (count, "faults")]
    body = [f"<h1>item3d under torture</h1><p class=soft>{html.escape(results['machine'])}, "
            f"{results['date']}, item3d {results['version']}</p><div class=marks>"]
    body += [f'<div class="{"bad" if name == "faults" and number else ""}"><b>{number}</b>{name}</div>'
             for number, name in marks]
    body.append("</div>")
    if results["kills"]:
        body += ["<h2>Killed and resumed</h2><p class=soft>Each run is killed at a random moment and resumed; in one "
                 "round of three the resumed run is killed too. The products must have the same bytes as those of an "
                 "undisturbed run.</p>", kills(results["kills"])]
    if results["cuts"]:
        body += ["<h2>Power cuts</h2><p class=soft>Contents that were not synced are lost. Data: all names survive. "
                 "Journal: the last changes of names are lost too. Strict: a name survives only if its folder was "
                 "synced.</p>", cuts(results["cuts"])]
    if results["starved"]:
        body += ["<h2>Starved</h2><p class=soft>Number of runs of each command, and in brackets the number "
                 "with faults.</p>",
                 starved(results["starved"])]
    if results["numbers"]:
        body += ["<h2>Extreme numbers</h2><p class=soft>Inputs with NaN, infinity, huge or denormal numbers. No result "
                 "may have a number that is not finite.</p>", numbers(results["numbers"])]
    if results["sizes"]:
        body += ["<h2>Extreme sizes</h2>", sizes(results["sizes"])]
    if results["long"]:
        body += ["<h2>At a stretch</h2>", *(long_run(run) for run in results["long"])]
    if count:
        body += ["<h2>Faults</h2>", listed]
    path.write_text("<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'>"
                    f"<title>item3d under torture</title><style>{STYLE}</style><body>{''.join(body)}</body></html>\n")
