// What others would have earned (rivals.h) beside what was earned, for people and programs.
#pragma once

#include <string>

#include "edge/account/rivals.h"
#include "edge/account/statement.h"
#include "shared/host/json.h"

namespace bess {

struct Comparison {
  Rivals rivals;
  QuartileRule rule;
  int decided = 0;
  int decided_otherwise = 0;
  const Statement& battery;

  /// That much the battery has earned more, with the same charge at both ends.
  [[nodiscard]] double ahead_eur(const Rival& rival) const;
  /// Standard error of that over days, as if they were independent; NaN of seven and fewer.
  [[nodiscard]] double error_eur(const Rival& rival) const;
  /// Lines, ended.
  [[nodiscard]] std::string text() const;
  [[nodiscard]] Json json() const;
};

}  // namespace bess
