// Demands never_rises_with, never_falls_with: direction of the action along one input. Violated by
// each pair of neighbours between which the action moves the other way.
#include <fmt/core.h>

#include <array>

#include "shared/host/toml_reader.h"
#include "workstation/correction/rules/rule.h"

namespace bess {
namespace {

struct InputName {
  std::string_view key, text;
};
constexpr InputName kInputs[kRuleInputCount] = {{"minute", "the minute of the quarter-hour"},
                                                {"quarter_hour", "the quarter-hour"},
                                                {"context_class", "the context class"},
                                                {"soc", "the SoC"},
                                                {"price", "the price"}};

class DirectionDemand final : public PredicateDemand<DirectionDemand> {
 public:
  explicit DirectionDemand(const Direction& direction) : direction_(direction) {}

  [[nodiscard]] std::string text(const std::string& /*where*/) const override {
    return fmt::format("the action never {} with {}", verb(), input().text);
  }
  [[nodiscard]] std::string line(const RuleBox& /*box*/) const override {
    return fmt::format("never_{}_with = \"{}\"\n", verb(), input().key);
  }
  [[nodiscard]] Direction direction() const override { return direction_; }
  [[nodiscard]] std::optional<RuleInput> pairs_along() const override { return direction_.input; }

  [[nodiscard]] auto predicate() const {
    const auto flip =
        static_cast<std::int8_t>(direction_.sign < 0 ? -1 : 0);  // negation without multiplication
    return [=](std::int8_t here, std::int8_t neighbour) {
      return static_cast<std::int8_t>(((neighbour - here) ^ flip) - flip) < 0;
    };
  }

 private:
  [[nodiscard]] const char* verb() const { return direction_.sign > 0 ? "falls" : "rises"; }
  [[nodiscard]] const InputName& input() const {
    return kInputs[static_cast<std::size_t>(direction_.input)];
  }

  Direction direction_;
};

constexpr std::array<std::string_view, 2> kKeys{"never_rises_with", "never_falls_with"};

void read(TomlTable& table, std::string_view key, Rule& rule) {
  int input = 0;
  table.choice(key, input,
               {kInputs[0].key, kInputs[1].key, kInputs[2].key, kInputs[3].key, kInputs[4].key});
  const Direction direction{static_cast<RuleInput>(input), key == "never_rises_with" ? -1 : 1};
  rule.demand = direction_demand(direction);
  if (rule.box != RuleBox{}) {
    table.fail(key, "applies everywhere: remove hours, months, classes, SoC and price");
  }
  if (input >= static_cast<int>(RuleInput::kSoc) && direction.sign > 0) {
    table.fail(key, "contradicts property 3: the action never rises with price or SoC");
  }
  if (rule.enforce) {
    table.fail("enforce", "needs a demand on single states: the guard sees one state at a time");
  }
}

}  // namespace

DemandPointer direction_demand(const Direction& direction) {
  return std::make_shared<DirectionDemand>(direction);
}

DemandKind direction_kind() { return {kKeys, read}; }

}  // namespace bess
