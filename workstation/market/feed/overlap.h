// Minute files that are joined must agree where they overlap: both claim to be the market.
// Downloads are another matter, a later one corrects an earlier one.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "workstation/market/feed/market_rows.h"
#include "workstation/market/series/plausibility.h"

namespace bess {

class Overlap {
 public:
  /// Compares the rows of a minute file with those of the files before it.
  void add(const std::string& name, const MarketRows& rows);
  /// One error when any two disagree, otherwise none.
  [[nodiscard]] std::vector<Finding> findings() const;

 private:
  struct Price {
    double eur_per_mwh;
    std::size_t file;  ///< index into names_
  };
  using Prices = std::unordered_map<std::int64_t, Price>;
  void add_price(Prices& known, const char* column, std::int64_t utc_s, double eur_per_mwh);

  std::vector<std::string> names_;
  Prices minutes_, quarter_hours_;
  std::size_t disagreements_ = 0;
  Finding first_{};
};

}  // namespace bess
