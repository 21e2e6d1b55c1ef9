// Unanswered requests on RTU, which has no transaction id: replies to an old and a new request
// differ only in shape (function and count). A slave answers in order, so a good reply of another
// shape proves that old replies have passed. A read of the same shape at another address must wait
// until no old reply can arrive; at the same address an old reply is only older. (libmodbus alone
// would return the previous request's registers as valid, forever.)
#pragma once

#include <cstdint>

#include "edge/core/base/static_vector.h"
#include "edge/device/battery/modbus_frame.h"

namespace bess {

class UnansweredRequests {
 public:
  /// Maximum delay of a reply after its request; longer delays are not detected.
  explicit UnansweredRequests(std::int64_t late_reply_ns_max) : late_ns_max_(late_reply_ns_max) {}

  /// Sent at `sent_ns`, without a reliable reply.
  void add(ModbusRequest request, std::int64_t sent_ns) {
    request.values = nullptr;  // owned by the caller
    if (!requests_.try_push_back(request)) crowded_ = true;
    last_sent_ns_ = sent_ns;
  }
  /// A good reply: proof of synchronisation, or possibly an old reply.
  void on_answered(const ModbusRequest& request, std::int64_t sent_ns) {
    bool perhaps_old = crowded_;
    for (const ModbusRequest& old : requests_) perhaps_old |= same_shape(old, request);
    if (perhaps_old) {
      last_sent_ns_ = sent_ns;
    } else {
      clear();
    }
  }
  /// Earliest instant at which the reply to this read is unambiguous.
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
  bool crowded_ = false;  ///< list overflow: every read has to wait
  StaticVector<ModbusRequest, 8> requests_;
};

}  // namespace bess
