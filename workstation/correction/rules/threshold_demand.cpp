// Demands charge_at_or_below, discharge_at_or_above: threshold of property 1 or 2 at another price.
// The property itself is unchanged.
#include <fmt/core.h>

#include <array>

#include "shared/host/toml_reader.h"
#include "workstation/correction/rules/rule.h"

namespace bess {
namespace {

class ThresholdDemand final : public PredicateDemand<ThresholdDemand> {
 public:
  explicit ThresholdDemand(Action action) : action_(action) {}

  [[nodiscard]] std::string text(const std::string& where) const override {
    return fmt::format("{}: the action is {}", where, action_name(action_));
  }
  [[nodiscard]] std::string line(const RuleBox& box) const override {
    return action_ == Action::kCharge
               ? fmt::format("charge_at_or_below = {}\n", box.price_max_eur_per_mwh)
               : fmt::format("discharge_at_or_above = {}\n", box.price_min_eur_per_mwh);
  }
  [[nodiscard]] ActionSet actions() const override { return action_bit(action_); }
  [[nodiscard]] auto predicate() const {
    const auto action = static_cast<std::int8_t>(action_);
    return [=](std::int8_t here, std::int8_t /*neighbour*/) { return here != action; };
  }

 private:
  Action action_;
};

constexpr std::array<std::string_view, 2> kKeys{"charge_at_or_below", "discharge_at_or_above"};

void read(TomlTable& table, std::string_view key, Rule& rule) {
  if (rule.box != RuleBox{}) {
    table.fail(key, "applies at every hour and SoC: to restrict it use is = with a box");
  }
  const bool charges = key == "charge_at_or_below";
  auto& price = charges ? rule.box.price_max_eur_per_mwh : rule.box.price_min_eur_per_mwh;
  table.integer(key, price, -kThresholdMaxEurPerMwh, kThresholdMaxEurPerMwh);
  rule.demand = std::make_shared<ThresholdDemand>(charges ? Action::kCharge : Action::kDischarge);
  rule.is_threshold = true;
  if (rule.enforce) {
    table.fail("enforce",
               "is not for thresholds: the guard has its own, [guard] low_price_eur_per_mwh and "
               "high_price_eur_per_mwh of bess-edge.toml");
  }
}

}  // namespace

DemandKind threshold_kind() { return {kKeys, read}; }

}  // namespace bess
