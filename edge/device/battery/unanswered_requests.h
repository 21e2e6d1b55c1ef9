// RTU has no transaction id: the reply to an old request can be told from the reply to a new one
// only by its shape (function and count). These are the requests that got no answer and may still
// get one. A slave answers in order, so a good reply of another shape proves that the old ones have
// come and gone. A read of the same shape at another address has to wait until no old answer can
// come any more; at the same address an old answer is only that much older. (libmodbus alone
// returns the previous question's registers here, as valid and for ever.)
#pragma once

#include <cstdint>

#include "edge/core/base/static_vector.h"
#include "edge/device/battery/modbus_frame.h"

namespace bess {

class UnansweredRequests {
 public:
  /// No answer comes later than this after its request; a longer delay is beyond what can be told.
  explicit UnansweredRequests(std::int64_t late_reply_ns_max) : late_ns_max_(late_reply_ns_max) {}

  /// Sent at `sent_ns`, and no answer came, or none that can be trusted.
  void add(ModbusRequest request, std::int64_t sent_ns) {
    request.values = nullptr;  // the caller's
    if (!requests_.try_push_back(request)) crowded_ = true;
    last_sent_ns_ = sent_ns;
  }
  /// A good reply has come: the proof that the line is in step, or perhaps an old answer.
  void on_answered(const ModbusRequest& request, std::int64_t sent_ns) {
    bool perhaps_old = crowded_;
    for (const ModbusRequest& old : requests_) perhaps_old |= same_shape(old, request);
    if (perhaps_old) {
      last_sent_ns_ = sent_ns;
    } else {
      clear();
    }
  }
  /// Earliest instant at which the reply to this read can mean nothing else.
  [[nodiscard]] std::int64_t earliest_ns(const ModbusRequest& request) const {
    bool mistakable = crowded_;
    for (const ModbusRequest& old : requests_) {
      const bool same_place = old.unit == request.unit && old.address == request.address;
      mistakable |= same_shape(old, request) && !same_place;
    }
    return mistakable ? last_sent_ns_ + late_ns_max_ : 0;
  }
  void forget_old(std::int64_t now_ns) {
    if (now_ns >= last_sent_ns_ + late_ns_max_) clear();
  }
  [[nodiscard]] bool empty() const { return requests_.empty(); }

 private:
  static bool same_shape(const ModbusRequest& a, const ModbusRequest& b) {
    return a.function == b.function && a.count == b.count;
  }
  void clear() {
    requests_.clear();
    crowded_ = false;
  }

  std::int64_t late_ns_max_;
  std::int64_t last_sent_ns_ = 0;
  bool crowded_ = false;  ///< more than the list holds: every read has to wait
  StaticVector<ModbusRequest, 8> requests_;
};

}  // namespace bess
