// Cached output of bess-edge commands for all page clients: each command runs at most once every
// `refresh_s`, and one at a time. Takes no lock and does not disturb the controller.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "edge/companions/page/page_settings.h"
#include "edge/records/why/margins.h"
#include "shared/host/json.h"

namespace bess {

/// Decisions of the student at one minute and context: for every state of charge, the highest price
/// at which it charges and the lowest at which it discharges. Two prices describe a column, because
/// the student is proved monotone in the price.
using DecisionMap = std::array<Margins, kSocCount>;  ///< by SoC, in steps of 0.5 %

/// For minute and context of `at`; its price and SoC are ignored.
DecisionMap make_decision_map(LatticeState at, const PriceThresholds& thresholds);

/// Map of the control cycle in `why --json`; no columns without a student decision, or with a
/// student of another build.
Json decision_map_of(JsonValue why);

struct Answer {
  std::string text;
  std::string trouble;  ///< why there is no text, or empty
  std::int64_t made_monotonic_ns = 0;

  [[nodiscard]] std::int64_t age_ns() const;
};

/// Output of a command. With `is_json`, other output is an error.
Answer ask_controller(const PageSettings& settings, std::vector<std::string> words, bool is_json);

class CachedAnswer {
 public:
  using Make = std::function<Answer()>;
  CachedAnswer(std::int64_t keep_s, Make make) : keep_s_(keep_s), make_(std::move(make)) {}

  /// Older than `keep_s` only while another thread fetches a new one.
  std::shared_ptr<const Answer> newest();

 private:
  /// Null if absent or too old.
  std::shared_ptr<const Answer> fresh();

  const std::int64_t keep_s_;
  const Make make_;
  std::mutex making_;
  std::mutex lock_;  ///< for `kept_`
  std::shared_ptr<const Answer> kept_;
};

}  // namespace bess
