#include "workstation/report/figures/regime_marks.h"

#include <algorithm>

#include "workstation/market/series/price_regime.h"

namespace bess {

Json regime_marks(const std::vector<std::string>& dates) {
  Json marks = Json::list();
  for (const PriceRegime& regime : price_regimes()) {
    const auto from = std::lower_bound(dates.begin(), dates.end(), regime.from_date);
    if (from == dates.begin() || from == dates.end()) continue;
    Json mark = Json::list();
    mark.add(static_cast<std::size_t>(from - dates.begin()));
    mark.add(regime.change);
    marks.add(std::move(mark));
  }
  return marks;
}

}  // namespace bess
