// Under which key status.json holds a member of CycleRecord or RunTotals: for who reads it back.
#pragma once

#include <type_traits>

#include "edge/log/run_fields.h"

namespace bess {

inline constexpr const char* kLastSection = "last";
inline constexpr const char* kTotalsSection = "totals";

struct StatusKey {
  const char* section;
  const char* name;
};

/// Where status.json holds the member at this path of CycleRecord or RunTotals. Does not compile
/// for a member that is not in it.
template <auto... kPath>
consteval StatusKey status_key() {
  const auto find = [](const auto& fields) -> StatusKey {
    for (const auto& field : fields) {
      if (field.access.id != path_id<kPath...>()) continue;
      if (field.place_in(&Places::last) > 0) return {kLastSection, field.name_in(&Places::last)};
      if (field.place_in(&Places::totals) > 0)
        return {kTotalsSection, field.name_in(&Places::totals)};
    }
    check_failed("no such key", __FILE__, __LINE__);
  };
  if constexpr (std::is_same_v<SourceOf<kPath...>, RunTotals>) {
    return find(kRunFields);
  } else {
    return find(kRecordFields);
  }
}

}  // namespace bess
