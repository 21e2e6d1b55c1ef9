// Field descriptors of the log tables: member, and place and name in each output.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "edge/records/log/member_access.h"

namespace bess {

/// Position of a field in one output, and its name there if different. Outputs are written by
/// rising position; 0 = absent.
struct Place {
  constexpr Place(int place = 0, const char* other_name = nullptr)  // NOLINT: implicit on purpose
      : at(place), name(other_name) {}

  int at;
  const char* name;
};

struct Places {
  Place journal{};
  Place csv{};      ///< column; append new ones at the end, because CSV files are continued
  Place last{};     ///< in that section of status.json; the tens are its line
  Place totals{};   ///< as `last`
  Place metrics{};  ///< the tens are their MetricGroup
};

/// Between the groups run_status.cpp writes metrics of several fields.
enum class MetricGroup { kSite = 1, kBus, kRun, kPeople, kConnection, kOutlook };

using Output = Place Places::*;

constexpr int tens(int place) { return place / 10; }

struct Metric {
  const char* help = "";
  double divisor = 1;  ///< from the integer to the unit in the metric's name
};

template <typename Source>
struct Field {
  MemberAccess<Source> access;
  const char* name = "";
  Places in{};
  Metric metric{};

  [[nodiscard]] constexpr int place_in(Output output) const { return (in.*output).at; }
  [[nodiscard]] constexpr const char* name_in(Output output) const {
    return (in.*output).name != nullptr ? (in.*output).name : name;
  }
  [[nodiscard]] bool exists_in(const Source& source) const {
    return access.exists == nullptr || access.exists(source);
  }
};

/// Fields of a table in one output, in its order. Two at one position do not compile.
template <const auto& kFields, Output kOutput>
consteval auto in_order() {
  const auto is_shown = [](const auto& field) { return field.place_in(kOutput) > 0; };
  constexpr auto kCount = std::count_if(kFields.begin(), kFields.end(), is_shown);
  std::array<decltype(kFields.data()), static_cast<std::size_t>(kCount)> order{};
  std::size_t size = 0;
  for (const auto& field : kFields) {
    if (is_shown(field)) order[size++] = &field;
  }
  std::sort(order.begin(), order.end(), [](const auto* a, const auto* b) {
    return a->place_in(kOutput) < b->place_in(kOutput);
  });
  for (std::size_t i = 1; i < order.size(); ++i) {
    BESS_CHECK(order[i - 1]->place_in(kOutput) < order[i]->place_in(kOutput));
  }
  return order;
}

}  // namespace bess
