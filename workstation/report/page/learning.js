// Training curves of teacher and student, and histogram of prices.
"use strict";

/**
 * Lines over numbers; `series`: [name, points, colour, dash, radius, axis] each, points [x, y]; a
 * radius gives points without a line; `x`, `y`: titles; `scales`: more axes.
 */
function drawLines(id, series, x, y, scales = () => ({})) {
  drawChart(id, () => ({
    type: "line",
    data: {
      datasets: series.map(([label, points, ink, dash, radius, yAxisID = "y"]) => ({
        label, data: points.map(([x, y]) => ({x, y})), borderColor: colour(ink),
        backgroundColor: colour(ink),
        pointRadius: radius || (points.length > 40 ? 0 : 2), borderWidth: 2, borderDash: dash || [],
        showLine: !radius, order: radius ? 0 : 1, yAxisID,
      })),
    },
    options: {
      parsing: false, interaction: {mode: "nearest", axis: "x", intersect: false},
      scales: {x: axis({type: "linear", title: axisTitle(x), ticks: {precision: 0}}),
               y: axis({title: axisTitle(y), ticks: kFewTicks}), ...scales()},
    },
  }));
}

/** `training`: [step, profit, 1 if selected, loss]; step 0 of a residual teacher is the SDP. */
function drawTraining({training}) {
  // An SDP is not trained.
  document.getElementById("training-figure").hidden = training.length < 2;
  if (training.length < 2) return;
  const kept = training.find((point) => point[2] === 1);
  const level = (profit) =>
    [training[0], training[training.length - 1]].map(([step]) => [step, profit]);
  const began = training[0][0] === 0
    ? [["program (SDP, step 0)", level(training[0][1]), "line-4", [6, 4], 0]] : [];
  document.getElementById("program-kept").hidden = kept[0] !== 0;
  const losses = training.filter((point) => point[3] > 0).map((point) => [point[0], point[3]]);
  const loss = losses.length > 0 ? [["loss", losses, "line-3", [1, 2], 0, "loss"]] : [];
  const lossAxis = () => axis({type: "logarithmic", axis: "y", position: "right", ticks: kFewTicks,
                               title: axisTitle("loss"), grid: {drawOnChartArea: false}});
  drawLines("chart-training", [
    ["checkpoint", training, "line-1"], ["selected", [kept], "line-2", undefined, 6], ...began,
    ...loss], "gradient steps", kProfitUnit,
            () => loss.length > 0 ? {loss: lossAxis()} : {});
}

/**
 * Every checked student: [epoch, profit on validation days, "chosen" | "disobeys" |
 * "passed over"].
 */
function drawCheckpoints({checkpoints}) {
  document.getElementById("checkpoints-figure").hidden = checkpoints.length === 0;
  if (checkpoints.length === 0) return;
  const of = (state) => checkpoints.filter((point) => point[2] === state);
  drawLines("chart-checkpoints", [
    ["checkpoint", checkpoints, "line-1"], ["violations", of("disobeys"), "muted", undefined, 6],
    ["selected", of("chosen"), "line-2", undefined, 6]], "epoch", kProfitUnit);
}

function drawDistillation({distil, by_construction}) {
  document.getElementById("distil-figure").hidden = distil.length === 0;
  if (distil.length === 0) return;
  const column = (c) => distil.map((row) => [row[0], row[c]]);
  document.getElementById("distil-note").textContent = by_construction
    ? "loss by epoch; monotone by construction" : "losses by epoch, logarithmic";
  const visited = ["on visited states", column(3), "line-1"];
  const losses = [["distance to the teacher", column(1), "line-3"],
                  ["correction loss", column(2), "line-2"], visited];
  drawLines("chart-distil", by_construction ? [visited] : losses.map(
    ([name, points, ink]) => [name, points.filter(([, y]) => y > 0), ink]),
            "epoch", "loss", () => (by_construction ? {} : {
              y: axis({type: "logarithmic", title: axisTitle("loss")})}));
}

function drawPriceHistogram({low, bin, train, test, outside_train, outside_test}) {
  document.getElementById("prices-note").textContent =
    `; without the far tails: ${outside_train.toFixed(2)} % of the training and ` +
    `${outside_test.toFixed(2)} % of the test prices`;
  drawChart("chart-prices", () => ({
    type: "bar",
    data: {
      labels: train.map((_, b) => trueMinus(low + b * bin)),
      datasets: [
        {type: "line", label: "test days", data: test, borderColor: colour("ink"),
         backgroundColor: colour("ink"),
         borderWidth: 2, pointRadius: 0, stepped: "middle", order: 0},
        {label: "training days", data: train, backgroundColor: colour("soft"), barPercentage: 1,
         categoryPercentage: 1,
         order: 1},
      ],
    },
    options: {scales: {x: axis({title: axisTitle("observed price, EUR/MWh")}),
                       y: axis({title: axisTitle("% of decisions")})}},
  }));
}
