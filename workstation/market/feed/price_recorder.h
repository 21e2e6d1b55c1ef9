// Follows the live minutes of Elia, price (ods161) and system imbalance (ods169), into a folder of
// recorded days. The archives keep the minutes' last values; when each was there for the first
// time, and what it said then, nobody keeps.
//
// A look asks for the newest 60 rows, the hour that the source promises, and pages back when it
// does not meet what is known: at the start, and after an outage. A row's arrival counts as seen
// when the look before it reached as far back, did not show it, and was at most two polls ago;
// otherwise it was found. No row arrives before its minute has ended: one that seems to, by up to a
// minute, is left for a later look; by more, one of the two clocks is wrong, and no row of that
// answer is taken. At the first look that is an error, later an outage. Nothing of the network ends
// a recorder: it backs off, waits as told, says once that there is trouble and once that it is
// over.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "workstation/market/feed/recorded_day.h"

namespace bess {

struct RecorderClock {
  std::function<std::int64_t()> utc_s;
  std::function<double()> steady_s;
  /// Returns early when interrupted.
  std::function<void(double seconds, const std::atomic<bool>& interrupted)> sleep;
};

/// What a recorder has to say while it runs.
struct RecorderEvent {
  enum class Kind {
    kRecorded,  ///< lines were appended
    kOutage,    ///< no answer that can be used; the recorder goes on trying
    kOver,      ///< the outage is
    kMended,    ///< a file that a crash had torn
    kClock,     ///< this computer's clock cannot be right
    kDay,       ///< a day is over
  };
  Kind kind;
  std::string subject;  ///< data set or file
  std::string text;
};

struct RecordRequest {
  std::filesystem::path folder;
  std::string base_url;  ///< the API root that ends in /api/explore/v2.1
  double poll_s = 20;
  double deadline_s = 10;  ///< of a request
  std::optional<std::int64_t> until_utc_s{};
  RecorderClock clock;
  std::function<void(const RecorderEvent&)> tell;
};

struct RecordSummary {
  std::size_t lines = 0;   ///< appended
  std::size_t prices = 0;  ///< minutes that got their first price
  std::size_t imbalances = 0;
  std::size_t revised = 0;  ///< values of either that another one replaced
  Lateness lateness;        ///< of the first prices
  std::string trouble;      ///< of prices that are not answered at its end; else empty
  bool answered = false;    ///< prices were, at least once
};

/// Until `until_utc_s` or interrupted. Throws UserError when the folder is another recorder's or
/// cannot be written, or when the first answer says that there is no such data set, or has rows of
/// the future.
RecordSummary record_prices(const RecordRequest& request, const std::atomic<bool>& interrupted);

}  // namespace bess
