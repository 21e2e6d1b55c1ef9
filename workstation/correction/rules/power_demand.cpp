// Demand power_max: limit of the power in the box, enforced by the guard. It does not bind the
// student, which decides directions only.
#include <fmt/core.h>

#include <array>

#include "shared/host/toml_reader.h"
#include "workstation/correction/rules/rule.h"

namespace bess {
namespace {

class PowerDemand final : public PredicateDemand<PowerDemand> {
 public:
  explicit PowerDemand(std::int32_t permille_max) : permille_max_(permille_max) {}

  [[nodiscard]] std::string text(const std::string& where) const override {
    return fmt::format("{}: at most {:g} % of the rated power", where, permille_max_ / 10.0);
  }
  [[nodiscard]] std::string line(const RuleBox& /*box*/) const override {
    return fmt::format("power_max = {:g}\n", permille_max_ / double{kFullPowerPermille});
  }
  [[nodiscard]] std::int32_t power_permille_max() const override { return permille_max_; }
  [[nodiscard]] bool binds_student() const override { return false; }
  [[nodiscard]] auto predicate() const {
    return [](std::int8_t /*here*/, std::int8_t /*neighbour*/) { return false; };
  }

 private:
  std::int32_t permille_max_;
};

constexpr std::array<std::string_view, 1> kKeys{"power_max"};

void read(TomlTable& table, std::string_view key, Rule& rule) {
  std::int32_t permille_max = kFullPowerPermille;
  table.scaled(key, permille_max, kFullPowerPermille, 0, 1);
  if (permille_max == kFullPowerPermille) table.fail(key, "is no limit: use less than 1");
  if (!rule.enforce) table.fail(key, "applies to the guard only: add enforce = true");
  rule.demand = std::make_shared<PowerDemand>(permille_max);
}

}  // namespace

DemandKind power_kind() { return {kKeys, read}; }

}  // namespace bess
