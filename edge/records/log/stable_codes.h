// Stable codes of enumerators on disk: the position in these lists. Append only, independent of the
// order in the enumeration, so that old logs keep their meaning.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>

#include "edge/core/base/check.h"
#include "edge/core/control/control_types.h"

namespace bess {

template <typename Enum>
struct StableCodes;

template <>
struct StableCodes<Mode> {
  static constexpr Mode kList[] = {Mode::kStart, Mode::kRunning, Mode::kHolding, Mode::kSafe,
                                   Mode::kStopping};
  static constexpr auto kNameOf = mode_name;
};

template <>
struct StableCodes<Action> {
  static constexpr Action kList[] = {Action::kDischarge, Action::kIdle, Action::kCharge};
  static constexpr auto kNameOf = action_name;
};

/// Reasons ordered by the code in their table.
constexpr std::array<Reason, kReasonCount> reasons_by_code() {
  std::array<Reason, kReasonCount> list{};
  for (int i = 0; i < kReasonCount; ++i) {
    list[static_cast<std::size_t>(kReasons[i].code)] = static_cast<Reason>(i);
  }
  return list;
}

template <>
struct StableCodes<Reason> {
  static constexpr std::array<Reason, kReasonCount> kList = reasons_by_code();
  static constexpr auto kNameOf = reason_name;
};

template <>
struct StableCodes<Status> {
  static constexpr Status kList[] = {
      Status::kOk,         Status::kNotConnected,   Status::kTimeout,     Status::kBusException,
      Status::kBusBusy,    Status::kNotPermitted,   Status::kBadReply,    Status::kImplausible,
      Status::kNotApplied, Status::kNotExpressible, Status::kWriteBudget, Status::kNameUnresolved,
      Status::kTlsRefused, Status::kHttpError,      Status::kMalformed,   Status::kNoRow,
      Status::kTooLarge,   Status::kNoMemory,       Status::kTooLate,     Status::kServerBusy,
      Status::kNoFetcher,  Status::kOtherVersion,   Status::kDoubtfulUnit};
  static constexpr auto kNameOf = status_name;
};

template <>
struct StableCodes<OutlookSource> {
  static constexpr OutlookSource kList[] = {OutlookSource::kNone, OutlookSource::kPlanned,
                                            OutlookSource::kUsual, OutlookSource::kLate,
                                            OutlookSource::kMissing};
  static constexpr auto kNameOf = outlook_source_name;
};

template <typename Enum>
inline constexpr std::size_t kCodeCount = std::size(StableCodes<Enum>::kList);
static_assert(kCodeCount<Mode> == kModeCount && kCodeCount<Action> == kActionCount &&
                  kCodeCount<Reason> == kReasonCount && kCodeCount<Status> == kStatusCount &&
                  kCodeCount<OutlookSource> == kOutlookSourceCount,
              "a new enumerator needs a code: append it to its list");

template <typename Enum>
std::int64_t code_of(const Enum& enumerator) {
  std::size_t code = 0;
  while (StableCodes<Enum>::kList[code] != enumerator) BESS_CHECK(++code < kCodeCount<Enum>);
  return static_cast<std::int64_t>(code);
}

/// False for a code of a later version.
template <typename Enum>
bool set_by_code(std::int64_t code, Enum& enumerator) {
  if (code < 0 || code >= static_cast<std::int64_t>(kCodeCount<Enum>)) return false;
  enumerator = StableCodes<Enum>::kList[static_cast<std::size_t>(code)];
  return true;
}

/// Name in texts, null-terminated.
template <typename Enum>
const char* name_of_code(std::int64_t code) {
  return StableCodes<Enum>::kNameOf(StableCodes<Enum>::kList[static_cast<std::size_t>(code)])
      .data();
}

}  // namespace bess
