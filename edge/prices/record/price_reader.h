// Price reader: prices published by bess-prices, read on the control thread with a deadline and
// without allocation. Whatever happens to bess-prices, the newest row ages here.
#pragma once

#include <cstdint>
#include <span>

#include "edge/core/control/control_types.h"
#include "edge/core/control/outlook.h"
#include "edge/prices/record/newest_row.h"
#include "edge/prices/record/published_prices.h"
#include "shared/file_descriptor.h"
#include "shared/fixed_text.h"
#include "shared/scaled_clock.h"

namespace bess {

class PriceReader {
 public:
  struct Settings {
    FixedText<639> path;
    const OutlookModel* model = nullptr;  ///< for a student by outlook
  };
  PriceReader(const Settings& settings, const ScaledClock& clock);

  // Interface of ControlLoop (control_loop.h); bess-prices starts at the tick by itself.
  void request(std::int64_t minute_utc_s, std::int64_t start_monotonic_ns,
               std::int64_t deadline_monotonic_ns);
  bool wait(std::int64_t until_monotonic_ns);
  PriceReport latest();

  /// Waits up to a wall time for a first answer; returns its status.
  Status first_answer(std::int64_t patience_ns);
  /// Waits for the price level of the last hours.
  PublishedHistory await_history(std::int64_t patience_ns);
  /// Waits for a plan; null for other contexts of the student.
  OutlookExchange* await_outlook(std::int64_t patience_ns);

 private:
  void read();
  void take(const PublishedPrices& published);
  void take_plan(std::span<const char> bytes, std::int64_t outlook_number);
  [[nodiscard]] Status refusal_of(const PublishedPrices& published) const;
  void await_change(std::int64_t until_monotonic_ns);
  template <typename IsThere>
  bool await(std::int64_t until_monotonic_ns, const IsThere& is_there);

  const Settings settings_;
  const ScaledClock clock_;
  NewestRow newest_;
  OutlookExchange exchange_;
  PublishedPrices published_;
  PublishedOutlook outlook_;
  std::uint32_t model_hash_ = 0;
  Status reading_ = Status::kNoFetcher;  ///< kOk: there is a valid record
  std::int64_t wanted_minute_utc_s_ = 0;
  std::int64_t taken_answers_ = -1;
  std::int64_t taken_outlook_ = 0;
  FileDescriptor notices_;  ///< inotify
  int watch_ = -1;
  char bytes_[kPublishedBytesMax];
};

}  // namespace bess
