#pragma once

namespace lab::report {

/// The style of every page: system fonts, numbers that line up, a dark side, and paper.
inline constexpr const char* kStyle = R"css(:root {
  --paper: #fff; --tint: #f6f7f9; --ink: #1d2127; --soft: #5b6470; --line: #dde1e6; --grid: #eceef1; --frame: #a3a9b1;
  --blue: #0072b2; --orange: #e69f00; --red: #d55e00; --green: #009e73; --purple: #cc79a7; --sky: #56b4e9; --brown: #8c5a2b; --grey: #7f7f7f;
  --good: #0b6e4f; --bad: #b3261e; --band: #e4f2ea;
}
@media (prefers-color-scheme: dark) {
  :root {
    --paper: #14171b; --tint: #1c2026; --ink: #e6e8eb; --soft: #9ba3ad; --line: #323840; --grid: #23282f; --frame: #5a626c;
    --blue: #4fa8e0; --orange: #f0b429; --red: #f0803c; --green: #3cc79c; --purple: #dd9cc0; --sky: #8acbf2; --brown: #c08a55; --grey: #a0a0a0;
    --good: #3cc79c; --bad: #ff8a80; --band: #1d3329;
  }
}
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 15px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", sans-serif; }
main { max-width: 1120px; margin: 0 auto; padding: 2.2rem 1.4rem 4rem; }
h1 { font-size: 1.75rem; font-weight: 650; letter-spacing: -.01em; line-height: 1.2; margin: 0; overflow-wrap: anywhere; }
h2 { font-size: 1.1rem; font-weight: 650; margin: 2.6rem 0 .8rem; padding-bottom: .35rem; border-bottom: 1px solid var(--line); }
p { margin: .4rem 0 .8rem; max-width: 46rem; }
.title { display: flex; flex-wrap: wrap; align-items: center; gap: .4rem .9rem; }
.about { color: var(--soft); margin: .45rem 0 0; }
.badge { font-size: .8rem; font-weight: 650; letter-spacing: .02em; padding: .15rem .65rem; border-radius: 1rem; border: 1.5px solid; white-space: nowrap; }
.good { color: var(--good); } .bad { color: var(--bad); } .soft { color: var(--soft); }
.missing { color: var(--soft); font-style: italic; }
.key { display: grid; grid-template-columns: repeat(auto-fit, minmax(148px, 1fr)); gap: 0 1.2rem; margin: 1.5rem 0 0; }
.key div { border-top: 2px solid var(--line); padding: .5rem 0 .8rem; }
.key dt { color: var(--soft); font-size: .8rem; }
.key dd { margin: 0; font-size: 1.3rem; font-weight: 600; font-variant-numeric: tabular-nums; white-space: nowrap; }
.key small { font-size: .8rem; font-weight: 400; color: var(--soft); }
.scroll { overflow-x: auto; margin: .4rem 0 1rem; }
table { border-collapse: collapse; font-size: .87rem; font-variant-numeric: tabular-nums; }
th, td { text-align: right; padding: .3rem .8rem; border-bottom: 1px solid var(--line); vertical-align: baseline; white-space: nowrap; }
th { font-weight: 600; color: var(--soft); font-size: .8rem; white-space: normal; vertical-align: bottom; }
.narrow th, .narrow td { padding: .3rem .55rem; }
th:first-child, td:first-child { padding-left: 0; }
.w { text-align: left; }
td.w { white-space: normal; overflow-wrap: break-word; }
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(310px, 1fr)); gap: .4rem 1.4rem; }
.plots.one { grid-template-columns: 1fr; }
.plots.two { grid-template-columns: repeat(auto-fit, minmax(min(100%, 440px), 1fr)); }
figure { margin: 0 0 .9rem; break-inside: avoid; min-width: 0; }
figcaption { font-size: .87rem; font-weight: 600; display: flex; flex-wrap: wrap; gap: 0 .9rem; align-items: baseline; overflow-wrap: anywhere; }
figcaption span { font-weight: 400; color: var(--soft); }
.legend { display: flex; flex-wrap: wrap; gap: .1rem 1.1rem; font-size: .83rem; color: var(--soft); margin: 0 0 .5rem; padding: 0; list-style: none; }
.legend svg { display: inline; width: 22px; height: 8px; vertical-align: middle; margin-right: .4rem; }
svg { display: block; width: 100%; height: auto; }
svg g, svg path { fill: none; stroke-linecap: round; stroke-linejoin: round; }
svg .t { fill: var(--soft); stroke: none; font: 11px system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", sans-serif; }
svg .grid { stroke: var(--grid); } svg .frame { stroke: var(--frame); } svg .band { fill: var(--band); stroke: none; }
.s-blue { stroke: var(--blue); } .s-orange { stroke: var(--orange); } .s-red { stroke: var(--red); } .s-green { stroke: var(--green); }
.s-purple { stroke: var(--purple); } .s-sky { stroke: var(--sky); } .s-brown { stroke: var(--brown); } .s-grey { stroke: var(--grey); }
svg .f-blue { fill: var(--blue); } svg .f-orange { fill: var(--orange); } svg .f-red { fill: var(--red); } svg .f-green { fill: var(--green); }
svg .f-purple { fill: var(--purple); } svg .f-sky { fill: var(--sky); } svg .f-brown { fill: var(--brown); } svg .f-grey { fill: var(--grey); }
.film { display: grid; grid-template-columns: repeat(auto-fit, minmax(240px, 1fr)); gap: 4px; }
.film img { width: 100%; height: auto; border-radius: 6px; display: block; }
pre { background: var(--tint); border: 1px solid var(--line); border-radius: 8px; padding: .9rem 1.1rem; overflow-x: auto; font: 12.5px/1.5 ui-monospace, SFMono-Regular, Menlo, Consolas, monospace; margin: .4rem 0 1rem; }
code { font: .93em ui-monospace, SFMono-Regular, Menlo, Consolas, monospace; }
section > p code { overflow-wrap: anywhere; }
.maps { display: flex; flex-wrap: wrap; gap: .4rem 1.4rem; } .maps svg { flex: 0 1 530px; max-width: 100%; }
.metrics { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(480px, 100%), 1fr)); gap: 0 2rem; }
.dot { fill: var(--blue); fill-opacity: .7; } svg .way { stroke: var(--blue); stroke-width: 1.5; } svg .cross { stroke: var(--bad); stroke-width: 2; }
.columns { display: grid; grid-template-columns: repeat(auto-fit, minmax(310px, 1fr)); gap: 0 2.4rem; align-items: start; }
@media (max-width: 600px) {
  .plots.one { overflow-x: auto; } .plots.one svg { min-width: 640px; }
  main { padding: 1.3rem 1rem 3rem; } th, td { padding: .3rem .55rem; }
  figure.film { overflow-x: auto; } figure.film img { width: 680px; }
}
@media print {
  :root { --paper: #fff; --tint: #fff; --ink: #000; --soft: #444; --line: #bbb; --grid: #e6e6e6; --frame: #888; --band: #e4f2ea;
    --blue: #0072b2; --orange: #e69f00; --red: #d55e00; --green: #009e73; --purple: #cc79a7; --sky: #56b4e9; --brown: #8c5a2b; --grey: #7f7f7f; --good: #0b6e4f; --bad: #b3261e; }
  @page { margin: 15mm 14mm; }
  body { font-size: 9.5pt; } main { max-width: none; padding: 0; }
  h2 { break-after: avoid; margin-top: 1.6rem; } tr, .key { break-inside: avoid; } thead { display: table-header-group; }
  .plots { grid-template-columns: repeat(3, 1fr); } .plots.two { grid-template-columns: repeat(2, 1fr); } .plots.one { grid-template-columns: 1fr; }
  .legend, section > p { break-after: avoid; } .film img { width: 88%; } .scroll { overflow: visible; } pre { white-space: pre-wrap; overflow-wrap: anywhere; font-size: 8pt; }
  .metrics { grid-template-columns: 1fr 1fr; } .maps svg { flex-basis: 47%; } .metrics section { break-inside: avoid; } .metrics svg { flex-basis: 100%; }
  svg { -webkit-print-color-adjust: exact; print-color-adjust: exact; }
  th, td { padding: .2rem .5rem; } .narrow { font-size: 8pt; } .narrow th, .narrow td { padding: .2rem .35rem; }
}
)css";

}  // namespace lab::report
