#include "edge/companion/orders.h"

#include <charconv>
#include <cstdint>
#include <string_view>

namespace bess {
namespace {

constexpr std::int64_t kPowerWMax = 1'000'000'000;
constexpr std::int64_t kMinutesMax = 7 * 24 * 60;

std::string_view field(const OrderFields& fields, std::string_view name) {
  const auto found = fields.find(name);
  return found == fields.end() ? std::string_view() : std::string_view(found->second);
}

bool is_whole(std::string_view text, std::int64_t min, std::int64_t max) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return !text.empty() && error == std::errc{} && end == text.data() + text.size() &&
         value >= min && value <= max;
}

Order refuse(const char* complaint) { return {{}, complaint}; }

Order read_hold(const OrderFields& fields) {
  const std::string_view power_w = field(fields, "power_w");
  const std::string_view minutes = field(fields, "minutes");
  if (!is_whole(power_w, -kPowerWMax, kPowerWMax)) {
    return refuse("the power must be a whole number of W: positive charges, negative discharges");
  }
  if (!is_whole(minutes, 2, kMinutesMax)) return refuse("hold for 2 to 10080 minutes");
  return {{"hold", std::string(power_w), "--for", std::string(minutes) + "m"}, ""};
}

Order read_limit(const OrderFields& fields) {
  Order order{{"limit"}, ""};
  for (const auto& [name, option] :
       {std::pair("charge_w", "--charge"), std::pair("discharge_w", "--discharge")}) {
    const std::string_view power_w = field(fields, name);
    if (power_w.empty()) continue;
    if (!is_whole(power_w, 0, kPowerWMax))
      return refuse("a limit is a whole number of W, 0 or more");
    order.words.insert(order.words.end(), {option, std::string(power_w)});
  }
  const std::string_view minutes = field(fields, "minutes");
  if (order.words.size() == 1) return refuse("limit the charge, the discharge, or both");
  if (!is_whole(minutes, 1, kMinutesMax)) return refuse("limit for 1 to 10080 minutes");
  order.words.insert(order.words.end(), {"--for", std::string(minutes) + "m"});
  return order;
}

}  // namespace

Order read_order(const OrderFields& fields) {
  const std::string_view order = field(fields, "order");
  if (order == "hold") return read_hold(fields);
  if (order == "release") return {{"hold", "--release"}, ""};
  if (order == "limit") return read_limit(fields);
  if (order == "unlimit") return {{"limit", "--clear"}, ""};
  if (order == "clear") return {{"clear", "--yes"}, ""};
  return refuse("an order is hold, release, limit, unlimit or clear");
}

}  // namespace bess
