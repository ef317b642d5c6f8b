/** \file
 * \brief The style sheet of all pages.
 */
#pragma once

namespace bayesian_icp::html {

inline const char* const style = R"css(
:root { color-scheme: light dark; --text: #1c1f23; --page: #ffffff; --faint: #5b6570;
  --line: #d5dade; --panel: #f5f7f9; --good: #00694c; --caution: #8a5a00; --bad: #a8321e; }
@media screen and (prefers-color-scheme: dark) {
  :root { --text: #e6e9ec; --page: #15181c; --faint: #a3adb7; --line: #3a424a;
    --panel: #1e2328; --good: #4fd1a5; --caution: #f0b84a; --bad: #ff8f78; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--text);
  font: 1rem/1.5 system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif; }
main { max-width: 68rem; margin: 0 auto; padding: 1rem; overflow-wrap: anywhere; }
h1 { font-size: 1.4rem; line-height: 1.25; margin: .5rem 0 1rem; }
h2 { font-size: 1.15rem; margin: 2.2rem 0 .5rem; padding-top: .6rem;
  border-top: 1px solid var(--line); }
p, ul { max-width: 46rem; margin: .5rem 0; }
ul { padding-left: 1.3rem; }
.box { border: 1px solid var(--line); border-left: .4rem solid; border-radius: .4rem;
  background: var(--panel); padding: .7rem 1rem; margin: .8rem 0; }
.box p { font-size: 1.08rem; max-width: none; }
.box .tone { font-size: 1.2rem; }
.good { border-left-color: var(--good); } .good .tone { color: var(--good); }
.caution { border-left-color: var(--caution); } .caution .tone { color: var(--caution); }
.bad { border-left-color: var(--bad); } .bad .tone { color: var(--bad); }
.scroll { overflow-x: auto; max-width: 100%; overflow-wrap: normal; }
table { border-collapse: collapse; font-size: .92rem; font-variant-numeric: tabular-nums;
  margin: .4rem 0; }
caption { text-align: left; color: var(--faint); padding-bottom: .3rem; }
th, td { padding: .25rem .7rem .25rem 0; border-bottom: 1px solid var(--line);
  text-align: right; white-space: nowrap; vertical-align: top; }
th { text-align: left; font-weight: 600; } th.number { text-align: right; }
td.words { text-align: left; }
td.words:last-child { white-space: normal; min-width: 13rem; }
caption span { display: inline-block; max-width: calc(100vw - 2rem); white-space: normal; }
pre { background: var(--panel); border: 1px solid var(--line); border-radius: .4rem;
  padding: .7rem; margin: .5rem 0; white-space: pre-wrap; overflow-wrap: anywhere;
  font-size: .85rem; }
.grid { display: grid; gap: .6rem 1.2rem;
  grid-template-columns: repeat(auto-fill, minmax(min(100%, 19rem), 1fr)); }
.pairs { grid-template-columns: repeat(auto-fill, minmax(min(100%, 24rem), 1fr)); }
.legend { list-style: none; padding: 0; display: flex; flex-wrap: wrap; gap: .2rem 1rem;
  font-size: .9rem; }
.swatch { display: inline-block; width: .8rem; height: .8rem; border-radius: 50%;
  margin-right: .4rem; print-color-adjust: exact; -webkit-print-color-adjust: exact; }
figure { margin: .6rem 0; min-width: 0; }
figcaption { color: var(--faint); font-size: .9rem; max-width: 46rem; }
figure svg { display: block; width: 100%; height: auto; }
figure .scroll svg { min-width: 40rem; }
details { margin: .6rem 0; } summary { cursor: pointer; font-weight: 600; }
@media print { body { font-size: 10pt; } main { max-width: none; padding: 0; }
  figure, table, .box, pre { break-inside: avoid; } h2 { break-after: avoid; }
  .scroll { overflow: visible; } figure .scroll svg { min-width: 0; }
  .grid { grid-template-columns: repeat(3, 1fr); }
  td, th { white-space: normal; }
  ::details-content { content-visibility: visible; block-size: auto; } }
)css";

} // namespace bayesian_icp::html
