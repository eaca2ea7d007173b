#include "item3d/report/html_style.h"

namespace item3d {

const std::string_view html_style = R"CSS(
:root {
  --paper: #f6f4f0; --card: #fffefb; --ink: #26241f; --soft: #716c61; --line: #e2ddd2;
  --accent: #b4451f; --well: #ebe7de;
  --c0: #b4451f; --c1: #2d6a86; --c2: #7a8a2a; --c3: #7c4a88; --c4: #b58a1e; --c5: #4b5563;
  --serif: "Iowan Old Style", "Palatino Linotype", Palatino, "Book Antiqua", Georgia, serif;
  --sans: system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif;
  color-scheme: light dark;
}
@media (prefers-color-scheme: dark) {
  :root {
    --paper: #1a1917; --card: #232220; --ink: #ece8df; --soft: #a09a8d; --line: #37342f;
    --accent: #e8825a; --well: #2b2926;
    --c0: #e8825a; --c1: #6db3d1; --c2: #b3c45c; --c3: #bd8cc9; --c4: #dfb650; --c5: #9aa4b2;
  }
}
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 15px/1.55 var(--sans);
  -webkit-font-smoothing: antialiased; }
main { max-width: 1080px; margin: 0 auto; padding: 56px 28px 72px; }
a { color: var(--accent); text-underline-offset: 3px; text-decoration-thickness: 1px; }
h1, h2 { font-family: var(--serif); font-weight: 500; letter-spacing: -.01em; }
h1 { font-size: 40px; line-height: 1.15; margin: 0; }
h2 { font-size: 23px; margin: 0 0 18px; }
section { margin-top: 60px; }
section + section { border-top: 1px solid var(--line); padding-top: 38px; }
.kicker { font-size: 12px; letter-spacing: .13em; text-transform: uppercase; color: var(--soft);
  margin: 0 0 14px; }
.sentences { font-family: var(--serif); font-size: 38px; line-height: 1.2; margin: 0;
  font-weight: 500; overflow-wrap: anywhere; }
.sentences del { text-decoration: none; color: var(--soft); display: block; }
.sentences ins { text-decoration: none; display: block; }
.sentences ins::before { content: "\2192\00a0"; color: var(--accent); }
.lede { color: var(--soft); margin: 16px 0 0; max-width: 68ch; }
.actions { display: flex; flex-wrap: wrap; gap: 10px; margin: 26px 0 0; padding: 0; list-style: none; }
.actions a { display: block; padding: 8px 16px; border: 1px solid var(--line); border-radius: 999px;
  text-decoration: none; color: var(--ink); background: var(--card); }
.actions a:hover { border-color: var(--accent); color: var(--accent); }
.actions li:first-child a { background: var(--ink); color: var(--paper); border-color: var(--ink); }
.actions li:first-child a:hover { background: var(--accent); border-color: var(--accent); }
.warnings { margin: 26px 0 0; padding: 12px 16px 12px 34px; border-left: 3px solid var(--accent);
  background: var(--card); border-radius: 0 8px 8px 0; }
.scores { display: grid; grid-template-columns: repeat(auto-fit, minmax(150px, 1fr)); gap: 1px;
  background: var(--card); border: 1px solid var(--line); border-radius: 12px; overflow: hidden;
  margin: 0; }
.scores div { padding: 16px 18px; box-shadow: 0 0 0 1px var(--line); }
.scores dt { color: var(--soft); font-size: 13px; }
.scores dd { margin: 2px 0 0; font-family: var(--serif); font-size: 26px;
  font-variant-numeric: tabular-nums; }
.scores small { display: block; font: 13px/1.4 var(--sans); color: var(--soft); }
figure { margin: 0; min-width: 0; }
figure img { display: block; width: 100%; height: auto; border-radius: 10px; background: var(--well); }
figcaption { color: var(--soft); font-size: 13px; margin-top: 8px; }
.checkered img { background: repeating-conic-gradient(var(--well) 0 25%, var(--card) 0 50%) 0 / 20px 20px; }
.gallery { display: grid; gap: 32px 20px;
  grid-template-columns: repeat(auto-fill, minmax(min(100%, var(--least)), 1fr)); }
.gallery + .gallery { margin-top: 20px; }
.comparison > div { position: relative; overflow: hidden; border-radius: 12px; background: var(--well); }
.comparison img { border-radius: 0; }
.comparison .over { position: absolute; inset: 0; height: 100%; clip-path: inset(0 0 0 var(--cut)); }
.comparison .rule { position: absolute; top: 0; bottom: 0; left: var(--cut); width: 2px;
  margin-left: -1px; background: #fff; box-shadow: 0 0 0 1px rgba(0,0,0,.18); pointer-events: none; }
.comparison .rule::after { content: "\2194"; position: absolute; top: 50%; left: 50%; width: 30px;
  height: 30px; margin: -15px; border-radius: 50%; background: #fff; color: #333; font-size: 16px;
  line-height: 29px; text-align: center; box-shadow: 0 1px 5px rgba(0,0,0,.35); }
.comparison .tag { position: absolute; bottom: 10px; padding: 2px 9px; border-radius: 999px;
  background: rgba(20,18,15,.55); color: #fff; font-size: 12px; pointer-events: none; }
.comparison .left { left: 10px; } .comparison .right { right: 10px; }
.comparison input { position: absolute; inset: 0; width: 100%; height: 100%; margin: 0; opacity: 0;
  cursor: ew-resize; touch-action: pan-y; }
.comparison input:focus-visible { opacity: 1; outline: 2px solid var(--accent); background: none;
  appearance: none; }
.pair { display: grid; grid-template-columns: 1fr 1fr; gap: 6px; }
.pair > b { grid-column: 1 / -1; font-weight: 600; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: 7px 14px 7px 0; border-bottom: 1px solid var(--line);
  vertical-align: top; overflow-wrap: anywhere; }
th { font-weight: 400; color: var(--soft); }
.columns { columns: 2 320px; column-gap: 48px; }
.columns table { display: block; } .columns tbody { display: block; }
.columns tr { display: grid; grid-template-columns: 11em 1fr; break-inside: avoid; }
.timeline { list-style: none; margin: 0; padding: 0; display: grid; gap: 22px 0;
  grid-template-columns: repeat(auto-fill, minmax(146px, 1fr)); }
.timeline li { border-top: 2px solid var(--line); padding: 8px 14px 0 0; position: relative; }
.timeline li::before { content: ""; position: absolute; top: -5px; left: 0; width: 8px; height: 8px;
  border-radius: 50%; background: var(--accent); }
.timeline b { display: block; font-size: 13px; font-weight: 600; margin-bottom: 6px;
  font-variant-numeric: tabular-nums; }
.timeline q { display: -webkit-box; -webkit-box-orient: vertical; -webkit-line-clamp: 4;
  overflow: hidden; font: italic 15px/1.3 var(--serif); margin-top: 8px; overflow-wrap: anywhere; }
.timeline dl { display: grid; grid-template-columns: auto 1fr; gap: 0 8px; margin: 6px 0 0;
  font-size: 12px; color: var(--soft); }
.timeline dd { margin: 0; text-align: right; font-variant-numeric: tabular-nums; }
.timeline + p { color: var(--soft); font-size: 13px; max-width: 80ch; margin: 18px 0 36px; }
.charts { display: grid; gap: 30px; grid-template-columns: repeat(auto-fit, minmax(min(100%, 430px), 1fr)); }
.chart svg { display: block; width: 100%; height: auto; overflow: visible; }
.chart h3 { font-size: 14px; font-weight: 600; margin: 0; }
.chart ul { list-style: none; display: flex; flex-wrap: wrap; gap: 4px 16px; padding: 0;
  margin: 2px 0 8px; font-size: 13px; color: var(--soft); }
.chart li::before { content: ""; display: inline-block; width: 14px; height: 3px; border-radius: 2px;
  background: var(--c); margin-right: 6px; vertical-align: 4px; }
.chart text { font: 11px var(--sans); fill: var(--soft); }
.chart .axis { stroke: var(--line); }
.chart path { fill: none; stroke: var(--c); stroke-width: 1.8; stroke-linejoin: round; }
.chart path.raw { stroke-width: 1; opacity: .28; }
.timings { list-style: none; margin: 0; padding: 0; display: grid; gap: 7px; }
.timings li { display: grid; grid-template-columns: 9em 1fr 7em 3.5em; gap: 14px; align-items: center; }
.timings i { height: 8px; border-radius: 4px; background: var(--well); position: relative; }
.timings i::after { content: ""; position: absolute; inset: 0 auto 0 0; width: var(--part);
  min-width: 2px; border-radius: 4px; background: var(--c1); }
.timings b { font-weight: 400; text-align: right; font-variant-numeric: tabular-nums; }
.parts li { grid-template-columns: 9em 1fr 4em 13em; } .parts em { text-align: left !important; }
.timings em { font-style: normal; color: var(--soft); text-align: right; }
footer { margin-top: 60px; padding-top: 20px; border-top: 1px solid var(--line); color: var(--soft);
  font-size: 13px; overflow-wrap: anywhere; }
code { font: 13px/1.5 ui-monospace, SFMono-Regular, Menlo, Consolas, monospace; }
@media (max-width: 640px) {
  main { padding: 32px 18px 48px; } .sentences { font-size: 27px; } h1 { font-size: 30px; }
  .timings li { grid-template-columns: 6em 1fr 6em; } .timings em { display: none; }
}
@media print { body { background: #fff; } section { break-inside: avoid; } .actions { display: none; } }
)CSS";

const std::string_view html_script = R"JS(
for (const range of document.querySelectorAll('.comparison input'))
  range.addEventListener('input', () =>
    range.closest('.comparison').style.setProperty('--cut', range.value + '%'));
)JS";

}  // namespace item3d
