// Student in the browser, bit-identical to the controller's (shared/nn/student_net.h): JavaScript's
// bit operations and Math.imul are 32-bit two's complement, and the exporter proves that no
// accumulator overflows. No floating point is used.
"use strict";

const kHidden1 = 64;
const kHidden2 = 32;
const kActions = ["discharge", "idle", "charge"];
const kActivationMax = 32767;

/** Added before a right shift, to round to nearest, halves up. */
function halfOf(shift) {
  return shift === 0 ? 0 : 1 << (shift - 1);
}

/** Index of the largest of three logits; ties give the lower action. */
function argmaxAction(logits) {
  let best = 0;
  for (let a = 1; a < kActions.length; ++a) if (logits[a] > logits[best]) best = a;
  return best;
}

class Student {
  /** `net`: context, price_map, and layer1..3 with weight (input-major), bias, shift. */
  constructor(net, lattice) {
    this.lattice = lattice;
    this.priceMap = Int16Array.from(net.price_map);
    this.weight1 = Int16Array.from(net.layer1.weight);  // 5 x 64
    this.bias1 = Int32Array.from(net.layer1.bias);
    this.shift1 = net.layer1.shift;
    this.weight2 = Int16Array.from(net.layer2.weight);  // 64 x 32
    this.bias2 = Int32Array.from(net.layer2.bias);
    this.shift2 = net.layer2.shift;
    this.weight3 = Int16Array.from(net.layer3.weight);  // 32 x 3
    this.bias3 = Int32Array.from(net.layer3.bias);
    this.rowSums = new Int32Array(kHidden1);
    this.sums2 = new Int32Array(kHidden2);
    this.logits = new Int32Array(kActions.length);
  }

  /** Sums of the first layer without the price, which are constant in a row of a map. */
  beginRow(context, socIndex) {
    const l = this.lattice;
    const inputs = [context.minute * l.minute_scale, context.quarterHour * l.quarter_hour_scale,
                    (context.contextClass - 1) * l.context_scale, socIndex * l.soc_scale];
    this.rowSums.set(this.bias1);
    for (let i = 0; i < inputs.length; ++i) {
      const at = i * kHidden1;
      for (let o = 0; o < kHidden1; ++o) {
        this.rowSums[o] = (this.rowSums[o] + Math.imul(this.weight1[at + o], inputs[i])) | 0;
      }
    }
  }

  /**
   * Action 0..2 of the row's state at `price`, EUR/MWh of the lattice; also sets `logits`.
   */
  decideInRow(price) {
    const x = this.priceMap[price - this.lattice.price_min];
    const sums2 = this.sums2, weight2 = this.weight2, logits = this.logits;
    const priceAt = 4 * kHidden1, half1 = halfOf(this.shift1), half2 = halfOf(this.shift2);
    sums2.set(this.bias2);
    for (let i = 0; i < kHidden1; ++i) {
      const sum = (this.rowSums[i] + Math.imul(this.weight1[priceAt + i], x)) | 0;
      let h = (sum + half1) >> this.shift1;
      if (h <= 0) continue;
      if (h > kActivationMax) h = kActivationMax;
      const at = i * kHidden2;
      for (let o = 0; o < kHidden2; ++o) {
        sums2[o] = (sums2[o] + Math.imul(weight2[at + o], h)) | 0;
      }
    }
    logits.set(this.bias3);
    for (let i = 0; i < kHidden2; ++i) {
      let h = (sums2[i] + half2) >> this.shift2;
      if (h <= 0) continue;
      if (h > kActivationMax) h = kActivationMax;
      for (let a = 0; a < kActions.length; ++a) {
        logits[a] = (logits[a] + Math.imul(this.weight3[i * kActions.length + a], h)) | 0;
      }
    }
    return argmaxAction(logits);
  }

  /** Action of one lattice state. */
  decide(context, socIndex, price) {
    this.beginRow(context, socIndex);
    return this.decideInRow(price);
  }
}

/**
 * Violations of properties in a map. `grid[soc * width + column]`, columns from `priceFirst` on.
 * Returns lists of cells: `order` with the neighbour towards which the action increases ("price" or
 * "soc"), and `threshold`.
 */
function violationsOf(grid, width, priceFirst, thresholds) {
  const order = [], threshold = [];
  const rows = grid.length / width;
  for (let soc = 0; soc < rows; ++soc) {
    for (let column = 0; column < width; ++column) {
      const action = grid[soc * width + column], price = priceFirst + column;
      if (column + 1 < width && grid[soc * width + column + 1] > action) {
        order.push({soc, column, towards: "price"});
      }
      if (soc + 1 < rows && grid[(soc + 1) * width + column] > action) {
        order.push({soc, column, towards: "soc"});
      }
      if (price <= thresholds.low && action !== 2) threshold.push({soc, column});
      if (price >= thresholds.high && action !== 0) threshold.push({soc, column});
    }
  }
  return {order, threshold};
}
