// Field descriptors of the log tables: a member of a struct, accessed as an integer, so that one
// loop writes all members, and its place and name in each output. A member is named by its path:
//   member<&CycleRecord::price, &PriceReport::fetch_us>()
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>
#include <utility>

#include "edge/core/base/check.h"
#include "edge/core/control/control_types.h"

namespace bess {

// Stable codes of enumerators on disk: of a reason the code in its table, of the others the value.
// Their enumerators are only appended, so that old logs keep their meaning.

constexpr int count_of(Mode) { return kModeCount; }
constexpr int count_of(Action) { return kActionCount; }
constexpr int count_of(Reason) { return kReasonCount; }
constexpr int count_of(Status) { return kStatusCount; }
constexpr int count_of(OutlookSource) { return kOutlookSourceCount; }

constexpr std::string_view name_of(Mode mode) { return mode_name(mode); }
constexpr std::string_view name_of(Action action) { return action_name(action); }
constexpr std::string_view name_of(Reason reason) { return reason_name(reason); }
constexpr std::string_view name_of(Status status) { return status_name(status); }
constexpr std::string_view name_of(OutlookSource source) { return outlook_source_name(source); }

template <typename Enum>
std::int64_t code_of(Enum enumerator) {
  BESS_CHECK(static_cast<int>(enumerator) < count_of(enumerator));
  if constexpr (std::is_same_v<Enum, Reason>) return info_of(enumerator).code;
  return static_cast<std::int64_t>(enumerator);
}

/// Requires a code of this version.
template <typename Enum>
Enum with_code(std::int64_t code) {
  if constexpr (std::is_same_v<Enum, Reason>) {
    code = std::ranges::find(kReasons, code, &ReasonInfo::code) - std::begin(kReasons);
  }
  return static_cast<Enum>(code);
}

/// False for a code of a later version.
template <typename Enum>
bool set_by_code(std::int64_t code, Enum& enumerator) {
  if (code < 0 || code >= count_of(Enum{})) return false;
  enumerator = with_code<Enum>(code);
  return true;
}

/// Name in texts, null-terminated.
template <typename Enum>
const char* name_of_code(std::int64_t code) {
  return name_of(with_code<Enum>(code)).data();
}

/// Meaning of the integer: number, 0 or 1, seconds since 1970, stable code of an enumerator.
enum class MemberKind : std::uint8_t { kNumber, kFlag, kUtc, kName };

template <typename Source>
struct MemberAccess {
  MemberKind kind;
  std::size_t bytes;  ///< on disk
  std::int64_t (*read)(const Source&);
  bool (*set)(Source&, std::int64_t);       ///< false: a code of a later version
  const char* (*name_of)(std::int64_t);     ///< name of a code; null for other kinds
  bool (*exists)(const Source&) = nullptr;  ///< null: always

  /// The value exists only while the flag at this path is set, or the enumerator is not the first.
  template <auto... kFlagPath>
  [[nodiscard]] constexpr MemberAccess given() const {
    MemberAccess conditional = *this;
    conditional.exists = [](const Source& source) -> bool {
      return static_cast<bool>((source.*....*kFlagPath));
    };
    return conditional;
  }
};

namespace detail {

template <typename Source, typename Member>
Source source_of(Member Source::*);
template <auto kFirst, auto...>
struct PathStart {
  using Source = decltype(source_of(kFirst));
};

}  // namespace detail

/// Struct at the start of a path.
template <auto... kPath>
using SourceOf = typename detail::PathStart<kPath...>::Source;

template <auto... kPath>
std::int64_t read_member(const SourceOf<kPath...>& source) {
  const auto& value = (source.*....*kPath);
  if constexpr (std::is_enum_v<std::remove_cvref_t<decltype(value)>>) {
    return code_of(value);
  } else {
    return static_cast<std::int64_t>(value);
  }
}

template <auto... kPath>
bool set_member(SourceOf<kPath...>& source, std::int64_t integer) {
  auto& value = (source.*....*kPath);
  using Value = std::remove_reference_t<decltype(value)>;
  if constexpr (std::is_enum_v<Value>) {
    return set_by_code(integer, value);
  } else {
    value = static_cast<Value>(integer);
    return true;
  }
}

template <auto... kPath>
consteval auto member() {
  using Source = SourceOf<kPath...>;
  using Value = std::remove_reference_t<decltype((std::declval<Source&>().*....*kPath))>;
  MemberAccess<Source> access{MemberKind::kNumber, sizeof(Value), read_member<kPath...>,
                              set_member<kPath...>, nullptr};
  if constexpr (std::is_same_v<Value, bool>) access.kind = MemberKind::kFlag;
  if constexpr (std::is_enum_v<Value>) {
    static_assert(sizeof(Value) == 1, "a code is one byte on disk");
    access.kind = MemberKind::kName;
    access.name_of = name_of_code<Value>;
  }
  return access;
}

/// For seconds since 1970, written as a time.
template <auto... kPath>
consteval auto utc_member() {
  auto access = member<kPath...>();
  access.kind = MemberKind::kUtc;
  return access;
}

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
