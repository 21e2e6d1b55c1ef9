// Looks at the hold file every second and publishes what it says: a thread of its own, on a static stack,
// because a card that stands still must not keep the control thread waiting. After `start` it allocates
// nothing.
#pragma once

#include <semaphore.h>

#include <cstdint>

#include "edge/control/hold.h"
#include "edge/memory/static_thread.h"
#include "shared/fixed_text.h"

namespace bess {

class HoldWatch {
 public:
  HoldWatch();
  HoldWatch(const HoldWatch&) = delete;
  HoldWatch& operator=(const HoldWatch&) = delete;
  ~HoldWatch();

  /// Reads the file once, so that the first cycle knows it, then goes on in the background.
  /// `time_scale`: simulated time is looked at as often as it passes.
  void start(const char* path, std::int32_t time_scale);
  [[nodiscard]] const HoldMailbox& mailbox() const { return mailbox_; }

 private:
  static constexpr std::size_t kStackBytes = 256 * 1024;  // for sanitizers: it uses a few KiB

  void run();

  FixedText<639> path_;
  std::int64_t period_ns_ = 0;
  HoldMailbox mailbox_;
  sem_t ending_;
  StaticThread<kStackBytes> thread_;
};

}  // namespace bess
