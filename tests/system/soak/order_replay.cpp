// Order replay: recomputes every control cycle of a log from its recorded integers, and compares
// the orders bit by bit between a Raspberry Pi and this machine.
//   order_replay EDGE.TOML EDGE.CSV
//   exit 0 every order is the same   1 one differs, or the log is not a run in control   2 usage
// An independent run on each machine would not do: the battery's state of charge depends on the
// millisecond at which an order arrives, so the inputs would differ.
#include <cstdio>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "edge/app/settings/edge_config.h"
#include "edge/core/control/decision_signature.h"
#include "shared/local_time.h"
#include "shared/signature.h"
#include "shared/utc_text.h"
#include "tests/support/csv_rows.h"

namespace bess {
namespace {

std::int64_t utc_of(const CsvRow& row, const char* column) {
  std::int64_t utc_s = 0;
  if (!parse_utc(row.at(column), utc_s)) throw std::runtime_error("not a time: " + row.at(column));
  return utc_s;
}

/// Inputs of the guard: the simulated site has no alarm, and limits that never bind.
GuardInputs inputs_of(const CsvRow& row) {
  return undisturbed_inputs(
      utc_of(row, "utc"), std::stoi(row.at("soc_e4")),
      PriceLevel{.centi_q16 = std::stoll(row.at("price_level_centi_q16")), .row_minute_utc_s = 1}
          .centi_eur_per_mwh(),
      utc_of(row, "price_minute_utc"), std::stoi(row.at("price_centi_eur_per_mwh")));
}

bool is_same(const CsvRow& row, const GuardInputs& in, const GuardDecision& decision) {
  const bool same = row.at("student_action") == action_name(in.student_action) &&
                    row.at("reason") == reason_name(decision.reason) &&
                    std::stoi(row.at("ordered_power_w")) == decision.power_w;
  if (!same) {
    std::fprintf(stderr, "order_replay: %s: logged %s, %s W, %s; here %s, %d W, %s\n",
                 row.at("utc").c_str(), row.at("student_action").c_str(),
                 row.at("ordered_power_w").c_str(), row.at("reason").c_str(),
                 action_name(in.student_action).data(), decision.power_w,
                 reason_name(decision.reason).data());
  }
  return same;
}

int replay(const EdgeConfig& config, const std::vector<CsvRow>& log) {
  SafetyGuard guard(config.control.guard);
  std::map<std::int32_t, int> orders;
  Signature signature;
  for (const CsvRow& row : log) {
    if (row.at("mode") == "stopping") continue;
    if (row.at("mode") != "running" || row.at("written") != "1") {
      std::fprintf(stderr, "order_replay: %s: not running, or nothing written\n",
                   row.at("utc").c_str());
      return 1;
    }
    const GuardInputs in = inputs_of(row);
    const GuardDecision decision = guard.decide(in);
    if (!is_same(row, in, decision)) return 1;
    signature.add(in.now_utc_s);
    signature.add(decision.power_w);
    ++orders[decision.power_w];
  }
  std::printf("orders signature=%016llx", static_cast<unsigned long long>(signature.value()));
  for (const auto& [power_w, count] : orders) std::printf(" %+dW=%d", power_w, count);
  std::printf("\n");
  return 0;
}

}  // namespace
}  // namespace bess

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "order_replay EDGE.TOML EDGE.CSV\n");
    return 2;
  }
  bess::set_market_time_zone();
  static bess::EdgeConfig config;
  std::string error;
  if (!bess::load_edge_config(argv[1], config, error)) {
    std::fprintf(stderr, "order_replay: %s\n", error.c_str());
    return 1;
  }
  try {
    return bess::replay(config, bess::read_csv(argv[2]));
  } catch (const std::exception& damaged) {
    std::fprintf(stderr, "order_replay: %s: %s\n", argv[2], damaged.what());
    return 1;
  }
}
