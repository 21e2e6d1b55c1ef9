// Charts of bess-hil runs, by UTC, with faults as bands and events as dashed lines.
"use strict";

const kTickSteps = [1, 2, 5, 10, 15, 30, 60, 120, 180, 360];  // minutes
const kTicks = 8;
const kMarkColours = {battery: "discharge", prices: "muted", event: "mark"};
const kNameRows = 3;  // of marks, above the chart
const kNameRowPx = 15;
const kAxisPx = 80;  // also in a narrow window, where Chart.js would leave less

const utcText = (utc_s) => new Date(1000 * utc_s).toISOString();
const clock = (utc_s) => utcText(utc_s).slice(11, 16);

function setTimeTicks(scale) {
  const minutes = (scale.max - scale.min) / 60;
  const step_s = 60 * kTickSteps.find((step) => minutes <= kTicks * step);
  scale.ticks = [];
  for (let at = Math.ceil(scale.min / step_s) * step_s; at <= scale.max; at += step_s) {
    scale.ticks.push({value: at});
  }
}

const runMarks = (marks) => ({
  id: "run-marks",
  beforeDatasetsDraw({ctx, chartArea: {top, bottom, left, right}, scales: {x}}) {
    ctx.save();
    ctx.setLineDash([4, 4]);
    ctx.font = "12px " + Chart.defaults.font.family;
    marks.forEach(({kind, name, from_utc_s, to_utc_s}, index) => {
      const from = x.getPixelForValue(from_utc_s), to = x.getPixelForValue(to_utc_s);
      ctx.fillStyle = ctx.strokeStyle = colour(kMarkColours[kind]);
      if (kind === "event") {
        ctx.beginPath();
        ctx.moveTo(from, top);
        ctx.lineTo(from, bottom);
        ctx.stroke();
      } else {
        ctx.globalAlpha = 0.25;
        ctx.fillRect(from, top, to - from, bottom - top);
        ctx.globalAlpha = 1;
      }
      const isLate = from > (left + right) / 2;
      ctx.textAlign = isLate ? "right" : "left";
      ctx.fillStyle = colour("ink");
      ctx.fillText(name, from, top - 6 - kNameRowPx * (index % kNameRows),
                   isLate ? from - left : right - from);
    });
    ctx.restore();
  },
});

function runChart(run) {
  const line = (label, yAxisID, ink, data, options) => ({
    label, yAxisID, data, borderColor: colour(ink), backgroundColor: colour(ink), borderWidth: 1.6,
    pointRadius: 0, stepped: true, ...options});
  const title = (text) => ({display: true, text, color: colour("muted")});
  const panel = (text, options) => axis({
    type: "linear", axis: "y", stack: "run", offset: true, title: title(text),
    ticks: {maxTicksLimit: 5}, afterFit: (scale) => { scale.width = kAxisPx; }, ...options});
  return {
    type: "line",
    plugins: [runMarks(run.marks)],
    data: {datasets: [
      line("price", "price", "ink", run.price_eur_per_mwh),
      line("power ordered", "power", "charge", run.ordered_w),
      line("power measured", "power", "soft", run.measured_w, {fill: "origin", borderWidth: 0}),
      line("SoC", "soc", "good", run.soc_percent, {stepped: false}),
      line("mode", "mode", "ink", run.mode)]},
    options: {
      layout: {padding: {top: kNameRowPx * Math.min(kNameRows, run.marks.length) + 6}},
      interaction: {mode: "nearest", axis: "x", intersect: false},
      scales: {
        x: axis({type: "linear", min: run.from_utc_s, max: run.to_utc_s,
                 title: title("UTC, from " + utcText(run.from_utc_s).slice(0, 10)),
                 afterBuildTicks: setTimeTicks, ticks: {callback: clock}}),
        mode: panel("mode", {type: "category", labels: run.modes, reverse: true}),
        soc: panel("SoC, %", {min: 0, max: 100}),
        power: panel("power, W", {suggestedMin: -run.power_w_max, suggestedMax: run.power_w_max}),
        price: panel("EUR/MWh"),
      },
      plugins: {
        legend: {position: "bottom", labels: {color: colour("ink"), boxWidth: 14, boxHeight: 10}},
        tooltip: {callbacks: {title: ([item]) => clock(item.parsed.x)}},
      },
    },
  };
}

for (const canvas of document.querySelectorAll("canvas")) {
  const run = JSON.parse(canvas.nextElementSibling.textContent);
  canvas.setAttribute("aria-label", ["Price, power, state of charge and mode of the edge",
                                     ...run.marks.map(({name}) => name)].join("; "));
  drawChart(canvas.id, () => runChart(run));
}
onColourScheme(redrawCharts);
document.documentElement.dataset.ready = "true";
