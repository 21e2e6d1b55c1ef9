// What `bess-edge` answers, shared by all who look: however many they are, each of its commands
// runs at most once every `refresh_s`, and never twice at a time. It takes no lock and asks nothing
// of the controller itself, which does not know that somebody looks.
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

// What the student does around the present: at this minute and in this context, the prices up to
// which it charges and from which it discharges, at every state of charge. Its own integers; it is
// proved to be monotone in the price, so that two prices tell all of a column.

struct DecisionMap {
  struct Column {
    std::int32_t charge_up_to_centi = 0;  ///< EUR/MWh / 100
    std::int32_t discharge_from_centi = 0;
  };
  std::array<Column, kSocCount> columns{};  ///< by SoC, in steps of 0.5 %
};

/// At the minute and in the context of `at`, whose price and SoC do not matter.
DecisionMap make_decision_map(LatticeState at, const PriceThresholds& thresholds, Policy policy);

Json decision_map_json(const DecisionMap& map);

/// The map of the cycle in `why --json`; without columns where the student was not asked, or it was
/// another build's student.
Json decision_map_of(JsonValue why);

struct Answer {
  std::string text;
  std::string trouble;  ///< empty when there is a text; else why there is none
  std::int64_t made_monotonic_ns = 0;

  [[nodiscard]] std::int64_t age_ns() const;
};

/// What a command prints; of a command that prints JSON, nothing else is an answer.
Answer ask_controller(const PageSettings& settings, std::vector<std::string> words, bool is_json);

class KeptAnswer {
 public:
  using Make = std::function<Answer()>;
  KeptAnswer(std::int64_t keep_s, Make make) : keep_s_(keep_s), make_(std::move(make)) {}

  /// Older than `keep_s` only while another thread makes a new one.
  std::shared_ptr<const Answer> newest();

 private:
  /// Null when there is none, or it is too old.
  std::shared_ptr<const Answer> fresh();

  const std::int64_t keep_s_;
  const Make make_;
  std::mutex making_;
  std::mutex lock_;  ///< of what follows
  std::shared_ptr<const Answer> kept_;
};

}  // namespace bess
