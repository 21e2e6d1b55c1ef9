// Charts of pages other than a run's: lines and dots, from the page's data.
"use strict";

const kKinds = {
  /** `series`: [name, colour, values] each; `y`: title of its axis. */
  lines: ({labels, series, y, marks = []}) => ({
    type: "line",
    plugins: [marksDrawn(marks)],
    data: {
      labels,
      datasets: series.map(([label, ink, data]) => ({
        label, data, borderColor: colour(ink), backgroundColor: colour(ink), borderWidth: 2,
        pointRadius: 0, pointHitRadius: 8,
      })),
    },
    options: {scales: {x: axis(), y: axis({title: axisTitle(y), ticks: kFewTicks})}},
  }),

  /** `points`: [x, y, label] each. */
  dots: ({points, x, y}) => ({
    type: "scatter",
    data: {
      datasets: [{
        data: points.map(([x, y, what]) => ({x, y, what})), backgroundColor: colour("charge"),
        pointRadius: 4,
      }],
    },
    options: {
      interaction: {mode: "nearest"},
      plugins: {legend: {display: false}, tooltip: {callbacks: {label: ({raw}) => raw.what}}},
      scales: {x: axis({title: axisTitle(x)}), y: axis({title: axisTitle(y), ticks: kFewTicks})},
    },
  }),
};

for (const {id, kind, ...shown} of JSON.parse(document.getElementById("data").textContent)) {
  drawChart(id, () => kKinds[kind](shown));
}
onColourScheme(redrawCharts);
document.documentElement.dataset.ready = "true";
