#include "item3d/batch/gallery_page.h"

namespace item3d {

// The page creates its cards on scrolling, 60 at a time, so that a batch of thousands of jobs opens
// without delay.
const std::string_view gallery_page = R"HTML(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{{TITLE}}</title>
<style>
:root { --paper: #f6f4f0; --card: #fffefb; --ink: #26241f; --soft: #716c61; --line: #e2ddd2;
  --accent: #b4451f; --well: #ebe7de; color-scheme: light dark; }
@media (prefers-color-scheme: dark) { :root { --paper: #1a1917; --card: #232220; --ink: #ece8df;
  --soft: #a09a8d; --line: #37342f; --accent: #e8825a; --well: #2b2926; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink);
  font: 14px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, sans-serif; }
main { max-width: 1400px; margin: 0 auto; padding: 36px 24px 60px; }
h1 { font: 500 34px/1.2 "Palatino Linotype", Palatino, Georgia, serif; margin: 0 0 6px; }
.soft { color: var(--soft); }
form { display: flex; flex-wrap: wrap; gap: 12px; margin: 18px 0; }
input, select { font: inherit; color: inherit; background: var(--card);
  border: 1px solid var(--line); border-radius: 6px; padding: 6px 10px; }
input { flex: 1 1 240px; }
#cards { display: grid; grid-template-columns: repeat(auto-fill, minmax(276px, 1fr)); gap: 14px; }
article { background: var(--card); border: 1px solid var(--line); border-radius: 8px;
  padding: 10px; overflow: hidden; }
article.failed { border-color: var(--accent); }
.pair { display: grid; grid-template-columns: 1fr 1fr; gap: 6px; background: var(--well);
  border-radius: 5px; min-height: 128px; }
.pair img { width: 100%; aspect-ratio: 1; object-fit: contain; border-radius: 5px; }
h2 { font-size: 14px; margin: 8px 0 2px; overflow-wrap: anywhere; }
p { margin: 2px 0; overflow-wrap: anywhere; }
.failed .message { color: var(--accent); }
a { color: var(--accent); margin-right: 10px; }
dl { display: grid; grid-template-columns: 1fr auto; gap: 0 10px; margin: 4px 0; }
dd { margin: 0; font-variant-numeric: tabular-nums; }
</style>
</head>
<body>
<main>
<h1>{{HEADING}}</h1>
<p class="soft" id="counts"></p>
<form>
<input id="words" type="search" placeholder="Filter by name, sentence or message" aria-label="Filter">
<select id="state" aria-label="State"><option value="">all states</option></select>
<select id="order" aria-label="Order"><option value="">failures first</option></select>
</form>
<div id="cards"></div>
<div id="end"></div>
<noscript>This page needs JavaScript; results.csv contains the same table.</noscript>
</main>
<script type="application/json" id="data">{{CARDS}}</script>
<script>
"use strict";
const jobs = JSON.parse(document.getElementById("data").textContent);
const rank = {failed: 0, waiting: 2, done: 1};
const find = id => document.getElementById(id);
const cards = find("cards"), words = find("words"), state = find("state"), order = find("order");
const counts = {}, scores = new Set();
for (const job of jobs) {
  counts[job.state] = (counts[job.state] || 0) + 1;
  for (const name in job.scores || {}) scores.add(name);
}
find("counts").textContent = jobs.length + " jobs: " +
  Object.keys(counts).sort((a, b) => rank[a] - rank[b]).map(s => counts[s] + " " + s).join(", ");
const offer = (select, value, text) => {
  const option = document.createElement("option");
  option.value = value;
  option.textContent = text;
  select.append(option);
};
for (const name in counts) offer(state, name, name + " (" + counts[name] + ")");
for (const name of scores) {
  offer(order, "-" + name, name + ", highest first");
  offer(order, "+" + name, name + ", lowest first");
}
offer(order, "seconds", "seconds, longest first");
const add = (parent, tag, text, name) => {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  if (name) element.className = name;
  parent.append(element);
  return element;
};
const link = (parent, address, text) => { if (address) add(parent, "a", text).href = address; };
const card = job => {
  const box = add(cards, "article", undefined, job.state);
  if (job.after) {
    const pair = add(box, "div", undefined, "pair");
    for (const [address, text] of [[job.before, "before"], [job.after, "after"]]) {
      if (!address) continue;
      const image = add(pair, "img");
      image.loading = "lazy";
      image.decoding = "async";
      image.alt = text;
      image.src = address;
    }
  }
  add(box, "h2", job.title);
  if (job.to) add(box, "p", job.from + " \u2192 " + job.to);
  if (job.options) add(box, "p", job.options, "soft");
  if (job.message) add(box, "p", job.message, "message");
  for (const warning of job.warnings || []) add(box, "p", "warning: " + warning, "soft");
  const list = add(box, "dl");
  const row = (name, value) => { add(list, "dt", name, "soft"); add(list, "dd", value); };
  for (const name in job.scores || {}) row(name, job.scores[name].toFixed(3));
  if (job.state !== "waiting") row("seconds", job.seconds.toFixed(0));
  if (job.attempts > 1) row("attempts", job.attempts);
  if (job.state === "waiting") row("state", "waiting");
  const links = add(box, "p");
  link(links, job.page, "report");
  link(links, job.model, "model");
};
let shown = [], made = 0;
const more = () => { for (const last = Math.min(made + 60, shown.length); made < last; ++made) card(shown[made]); };
const value = (job, name) => (job.scores || {})[name];
const show = () => {
  const parts = words.value.toLowerCase().split(/\s+/).filter(Boolean);
  shown = jobs.filter(job => (!state.value || job.state === state.value) && parts.every(part =>
    [job.title, job.from, job.to, job.options, job.message, ...(job.warnings || [])].some(text => (text || "").toLowerCase().includes(part))));
  const name = order.value.slice(1);
  if (order.value === "") shown.sort((a, b) => rank[a.state] - rank[b.state]);
  else if (order.value === "seconds") shown.sort((a, b) => b.seconds - a.seconds);
  else shown.sort((a, b) => {
    const x = value(a, name), y = value(b, name);
    if (x === undefined || y === undefined) return (x === undefined) - (y === undefined);
    return order.value[0] === "-" ? y - x : x - y;
  });
  cards.replaceChildren();
  made = 0;
  more();
};
words.oninput = state.onchange = order.onchange = show;
document.querySelector("form").onsubmit = event => event.preventDefault();
show();
new IntersectionObserver(entries => { if (entries.some(entry => entry.isIntersecting)) more(); },
  {rootMargin: "800px"}).observe(find("end"));
</script>
</body>
</html>
)HTML";

}  // namespace item3d
