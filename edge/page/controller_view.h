// Everything that the page shows, asked for together: what `bess-edge` answers, and the day's
// records of the decision log. It takes no lock and asks nothing of the controller itself, which
// does not know that somebody looks.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "edge/page/day_chart.h"
#include "edge/page/decision_map.h"
#include "edge/page/page_settings.h"
#include "shared/host/json.h"

namespace bess {

/// What one command of bess-edge says.
struct Answer {
  Json json = Json::object();
  std::string trouble;  ///< empty when there is one; else why there is none
};

struct ControllerView {
  std::int64_t made_monotonic_ns = 0;
  std::int64_t made_utc_s = 0;
  Answer status;
  Answer why;
  Answer month;
  Answer history;
  std::string metrics;                   ///< Prometheus text; empty when there are none
  std::vector<CycleRecord> day_records;  ///< of the newest day that the log knows
  DaySpan day{};
  std::optional<DecisionMap> map;  ///< none while nothing was decided
  PresentPoint now{};
};

ControllerView look_at_controller(const PageSettings& settings);

/// The newest view, shared by all who ask: however many they are, the controller's files are read
/// once every `refresh_s`.
class ControllerViews {
 public:
  explicit ControllerViews(const PageSettings& settings) : settings_(settings) {}

  /// Older than `refresh_s` only while another thread makes a new one.
  std::shared_ptr<const ControllerView> newest();
  /// Something was ordered: the next who asks gets a new one.
  void expire();

 private:
  [[nodiscard]] bool is_fresh() const;

  const PageSettings& settings_;
  std::mutex making_;
  std::mutex view_lock_;
  std::shared_ptr<const ControllerView> view_;
  bool is_expired_ = false;
};

}  // namespace bess
