#include "tools/hil_runner/scenario/scenario_expectation.h"

#include <algorithm>
#include <cmath>

#include "edge/control/control_types.h"
#include "shared/units_and_limits.h"
#include "tools/hil_runner/scenario/scenario_reader.h"

namespace bess {
namespace {

bool is_reason(std::string_view name) {
  for (int i = 0; i < kReasonCount; ++i) {
    if (reason_name(static_cast<Reason>(i)) == name) return true;
  }
  return false;
}

/// key = [least, most]
void read_range(TomlTable& table, std::string_view key, const char* unit, double& range_min,
                double& range_max) {
  const TomlArray* const range = table.array(key);
  if (range == nullptr) return;
  const auto least = range->size() == 2 ? (*range)[0].number() : std::nullopt;
  const auto most = least ? (*range)[1].number() : std::nullopt;
  if (!most || *least > *most) return table.fail(key, fmt::format("must be [least, most]{}", unit));
  range_min = *least;
  range_max = *most;
}

/// A command that its own range of power rules out.
bool is_ruled_out(const Expectation& expectation) {
  using enum Expectation::Command;
  const bool may_be_zero = expectation.power_w_min <= 0 && expectation.power_w_max >= 0;
  switch (expectation.command) {
    case kAny:
    case kDriven:
      return false;
    case kCharge:
      return expectation.power_w_max <= 0;
    case kDischarge:
      return expectation.power_w_min >= 0;
    case kZero:
    case kNone:
    case kNotDriven:
      return !may_be_zero;
  }
  return false;
}

/// What no run could break, and what none could keep.
void check_expectation(TomlTable& table, const Scenario& scenario, const Expectation& e) {
  if (!table.ok()) return;
  constexpr double kStepMin = kSecondsPerStep / 60.0;
  const double first_tick_min = std::ceil(e.span.from_min / kStepMin) * kStepMin;
  if (first_tick_min >= std::min(e.span.to_min, scenario.minutes)) {
    table.fail(table.has("to_min") ? "to_min" : "from_min",
               fmt::format("leaves no tick: they are {:g} minutes apart from 0 on", kStepMin));
  }
  const double power_w = scenario.battery.physics.power_w_max;
  if (table.has("power_w") && e.power_w_min <= -power_w && e.power_w_max >= power_w) {
    table.fail("power_w", fmt::format("leaves nothing out: the battery has {:g} W", power_w));
  }
  if (e.command == Expectation::Command::kAny && !table.has("power_w") && e.reason.empty() &&
      e.no_reason.empty() && e.outlook == OutlookSource::kNone) {
    table.fail("command", "or power_w, reason, no_reason or outlook: else nothing is expected");
  }
  if (table.has("quarter_hours") && e.outlook == OutlookSource::kNone)
    table.fail("quarter_hours", "comes with an outlook");
  if (is_ruled_out(e)) table.fail("power_w", "rules out its command");
  if (!e.reason.empty() && e.reason == e.no_reason) table.fail("no_reason", "rules out its reason");
}

}  // namespace

void read_expectation(TomlTable table, Scenario& scenario) {
  Expectation expectation;
  read_span(table, scenario.minutes, expectation.span);
  int command = 0;
  table.choice("command", command,
               {"any", "charge", "discharge", "zero", "none", "driven", "not_driven"});
  expectation.command = static_cast<Expectation::Command>(command);
  read_range(table, "power_w", ", in W", expectation.power_w_min, expectation.power_w_max);
  int outlook = 0;
  table.choice("outlook", outlook, {"any", "planned", "usual", "late", "missing"});
  expectation.outlook = static_cast<OutlookSource>(outlook);
  read_range(table, "quarter_hours", "", expectation.quarter_hours_min,
             expectation.quarter_hours_max);
  read_text(table, "reason", expectation.reason);
  read_text(table, "no_reason", expectation.no_reason);
  const std::pair<const char*, const std::string*> reasons[] = {
      {"reason", &expectation.reason}, {"no_reason", &expectation.no_reason}};
  for (const auto& [key, name] : reasons) {
    if (table.ok() && !name->empty() && !is_reason(*name)) {
      table.fail(key, "is no reason of the guard (edge/README.md lists them)");
    }
  }
  check_expectation(table, scenario, expectation);
  table.finish();
  scenario.expectations.push_back(std::move(expectation));
}

}  // namespace bess
