// Lattices, logits and options for tests of every correction layer.
#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "shared/action.h"
#include "shared/units_and_limits.h"
#include "workstation/base/random.h"
#include "workstation/correction/distillation/correction_layer.h"

namespace bess {

inline LatticeAxes even_axes(int prices, int socs) {
  LatticeAxes axes;
  for (int i = 0; i < prices; ++i) {
    const int price = kLatticePriceMinEurPerMwh + i * (kPriceCount - 1) / std::max(1, prices - 1);
    axes.price_eur_per_mwh.push_back(price);
    axes.mapped_price.push_back((price - kLatticePriceMinEurPerMwh) / double{kPriceCount - 1});
  }
  for (int j = 0; j < socs; ++j) axes.soc.push_back(j / double{std::max(1.0, socs - 1.0)});
  return axes;
}

inline Eigen::MatrixXd random_logits(Eigen::Index columns, Random& random, double spread) {
  Eigen::MatrixXd logits(kActionCount, columns);
  for (double& z : logits.reshaped()) z = spread * random.normal();
  return logits;
}

struct LayerCase {
  const char* name;
  CorrectionOptions options;
  int prices, socs;
};

inline const LayerCase kLayerCases[] = {
    {"defaults", {}, 16, 8},
    {"thresholds inside the lattice", {{-120, 640}, 1.0, 0.2, 0.4}, 16, 8},
    {"thresholds outside the lattice", {{-600, 2000}, 1.0, 0.2, 0.4}, 16, 8},
    {"one threshold outside", {{-600, 800}, 1.0, 0.2, 0.4}, 12, 5},
    {"neighbouring thresholds", {{500, 501}, 1.0, 0.2, 0.4}, 11, 4},
    {"no slope", {{-500, 1500}, 0.5, 0, 0}, 8, 8},
    {"steep slopes, bounds that would cross", {{-300, 1200}, 0.1, 50, 3}, 9, 6},
    {"one price", {{-500, 1500}, 1.0, 0.2, 0.4}, 1, 6},
    {"one SoC", {{-500, 1500}, 1.0, 0.2, 0.4}, 16, 1},
};

}  // namespace bess
