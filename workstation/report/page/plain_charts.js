// The charts of pages other than a run's: lines over days, dots. The page's data says what they
// show.
"use strict";

/** Upright lines where something changed; `marks`: [place among the labels, what changed] each. */
const marksDrawn = marks => ({
  id: "marks",
  afterDatasetsDraw({ctx, chartArea: {top, bottom}, scales: {x}}) {
    ctx.save();
    ctx.strokeStyle = ctx.fillStyle = colour("muted");
    ctx.setLineDash([4, 4]);
    for (const [place, what] of marks) {
      const at = x.getPixelForValue(place), toTheLeft = at > (x.left + x.right) / 2;
      ctx.beginPath();
      ctx.moveTo(at, top);
      ctx.lineTo(at, bottom);
      ctx.stroke();
      ctx.textAlign = toTheLeft ? "right" : "left";
      ctx.fillText(what, at + (toTheLeft ? -4 : 4), bottom - 6);
    }
    ctx.restore();
  },
});

const kKinds = {
  /** `series`: [name, colour, values] each. */
  lines: ({labels, series, marks = []}) => ({
    type: "line",
    plugins: [marksDrawn(marks)],
    data: {
      labels,
      datasets: series.map(([label, ink, data]) => ({
        label, data, borderColor: colour(ink), backgroundColor: colour(ink), borderWidth: 2,
        pointRadius: 0, pointHitRadius: 8,
      })),
    },
    options: {scales: {x: axis(), y: axis({ticks: kFewTicks})}},
  }),

  /** `points`: [x, y, what it is] each. */
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

function axisTitle(text) {
  return {display: true, text, color: colour("muted")};
}

for (const {id, kind, ...shown} of JSON.parse(document.getElementById("data").textContent)) {
  drawChart(id, () => kKinds[kind](shown));
}
onColourScheme(redrawCharts);
document.documentElement.dataset.ready = "true";
