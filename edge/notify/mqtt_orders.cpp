#include "edge/notify/mqtt_orders.h"

#include <charconv>

namespace bess {

void MqttOrderBox::add(MqttOrder order) {
  {
    const std::lock_guard lock(mutex_);
    if (orders_.size() >= kOrdersMax) return;
    if (order.payload.size() > kPayloadMax) order.payload = "?";  // refused, and said
    orders_.push_back(std::move(order));
  }
  bell_.ring();
}

std::optional<MqttOrder> MqttOrderBox::take() {
  const std::lock_guard lock(mutex_);
  if (orders_.empty()) return std::nullopt;
  MqttOrder oldest = std::move(orders_.front());
  orders_.pop_front();
  return oldest;
}

Order HoldDesk::follow(const MqttOrder& order, bool is_held) {
  const auto hold = [&](const std::string& power_w) {
    return read_order(
        {{"order", "hold"}, {"power_w", power_w}, {"minutes", std::to_string(minutes_)}});
  };
  if (order.topic_end == kHoldPowerTopic) {
    Order asked = hold(order.payload);
    if (!asked.complaint.empty()) return asked;
    std::int32_t power_w = 0;
    std::from_chars(order.payload.data(), order.payload.data() + order.payload.size(), power_w);
    if (power_w < -power_w_max_ || power_w > power_w_max_) {
      return {{}, "hold_power/set: " + order.payload + " W is beyond [battery] power_w"};
    }
    power_w_ = power_w;
    return is_held ? asked : Order{};
  }
  if (order.topic_end == kHoldTopic && order.payload == "ON") return hold(std::to_string(power_w_));
  if (order.topic_end == kHoldTopic && order.payload == "OFF") {
    return read_order({{"order", "release"}});
  }
  return {{}, "hold/set takes ON or OFF, hold_power/set a whole number of W"};
}

}  // namespace bess
