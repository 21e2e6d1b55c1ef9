// What a broker may order, where [notify] mqtt_orders allows it: a hold, and its end. Taken by
// libmosquitto's thread and carried out by the notifier's, as commands of bess-edge with that
// command's checks.
//   bess/v1/NAME/hold/set         ON | OFF: hold the power below for mqtt_hold_minutes, or release
//   bess/v1/NAME/hold_power/set   W, positive charges; of a hold in force at once, else of the next
// Retained messages are not followed: an order counts when it is given, not when somebody comes.
#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include "edge/companion/orders.h"
#include "edge/notify/bell.h"

namespace bess {

inline constexpr const char* kHoldTopic = "hold/set";
inline constexpr const char* kHoldPowerTopic = "hold_power/set";

struct MqttOrder {
  std::string topic_end;  ///< kHoldTopic or kHoldPowerTopic
  std::string payload;
};

/// Between the two threads. What is not taken soon is too old to be followed: few are kept.
class MqttOrderBox {
 public:
  static constexpr std::size_t kOrdersMax = 8;
  static constexpr std::size_t kPayloadMax = 64;

  explicit MqttOrderBox(const Bell& bell) : bell_(bell) {}
  /// By the broker's thread; left out when too many wait.
  void add(MqttOrder order);
  std::optional<MqttOrder> take();

 private:
  const Bell& bell_;
  std::mutex mutex_;
  std::deque<MqttOrder> orders_;
};

/// What the broker's orders come to, one after the other.
class HoldDesk {
 public:
  HoldDesk(std::int32_t minutes, std::int32_t power_w_max)
      : minutes_(minutes), power_w_max_(power_w_max) {}
  [[nodiscard]] std::int32_t power_w() const { return power_w_; }
  /// Without words and complaint: noted for the next hold.
  Order follow(const MqttOrder& order, bool is_held);

 private:
  std::int32_t minutes_;
  std::int32_t power_w_max_;
  std::int32_t power_w_ = 0;
};

}  // namespace bess
