// The record of published_prices.h, changed by several threads of bess-prices and rewritten after
// each change.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "edge/prices/published_prices.h"

namespace bess {

class PricePublisher {
 public:
  explicit PricePublisher(std::string path) : path_(std::move(path)) {}

  /// `change(prices)`, then the file. A failure to write is logged once.
  template <typename Change>
  void publish(const Change& change) {
    const std::lock_guard lock(mutex_);
    change(prices_);
    write();
  }
  /// A new plan.
  void publish_outlook(OutlookBoard& board);

 private:
  void write();

  const std::string path_;
  std::mutex mutex_;
  PublishedPrices prices_;
  std::unique_ptr<PublishedOutlook> outlook_;
  bool is_failing_ = false;
};

}  // namespace bess
