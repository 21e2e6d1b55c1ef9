// Looks every second at the files through which people speak to the controller, and publishes what
// they say: the hold, and whether a trip was cleared. A thread of its own, because a card that
// stands still must not keep the control thread waiting. After `start` it allocates nothing.
#pragma once

#include <semaphore.h>

#include <atomic>
#include <cstdint>

#include "edge/app/storage/operator_files.h"
#include "edge/app/storage/recall.h"
#include "edge/core/control/hold.h"
#include "edge/core/memory/plain_thread.h"
#include "shared/fixed_text.h"

namespace bess {

class HoldWatch {
 public:
  HoldWatch();
  HoldWatch(const HoldWatch&) = delete;
  HoldWatch& operator=(const HoldWatch&) = delete;
  ~HoldWatch();

  /// Reads the files once, so that the first cycle knows it, then goes on in the background.
  /// `time_scale`: simulated time is looked at as often as it passes.
  void start(const BothPlaces& paths, const BothPlaces& cleared, std::int32_t time_scale);
  [[nodiscard]] const HoldMailbox& mailbox() const { return mailbox_; }

  /// From the control thread, which never waits here: whether a person has cleared the trip of this
  /// instant, as far as it is known by now. It is looked for from the first question on.
  bool is_cleared(std::int64_t trip_utc_s);

 private:
  void run();
  void look();

  void tell_of_losses(const HoldReading& reading);

  BothPlaces paths_;
  HoldReading told_;
  BothPlaces cleared_;
  std::atomic<std::int64_t> asked_trip_utc_s_{0};
  std::atomic<std::int64_t> cleared_trip_utc_s_{0};
  std::int64_t period_ns_ = 0;
  HoldMailbox mailbox_;
  sem_t ending_;
  PlainThread thread_;
};

}  // namespace bess
