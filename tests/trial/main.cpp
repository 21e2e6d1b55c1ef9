// Prints what the supervision makes of every fault and of every honest battery of the trial, as
// tables of Markdown or as CSV. Measures and asserts nothing: trial_test does.
//
//   supervision_trial faults         each fault at SoC 45 %: constant, at some ticks, the SoC in
//                                    whole percent, the controller killed after each cycle
//   supervision_trial ends           each fault near full and near empty
//   supervision_trial honest [DAYS]  each variant of a healthy battery
//   supervision_trial rare           faults too rare for the counts: what they move until found
//   supervision_trial csv            every fault, schedule, kind of orders and SoC
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "tests/trial/rare_faults.h"
#include "tests/trial/trial_run.h"

namespace bess::trial {
namespace {

struct Schedule {
  const char* name;
  FaultTimes times;
};
constexpr Schedule kSchedules[] = {{"always", {.every = 1}},
                                   {"every 2nd", {.every = 2}},
                                   {"every 3rd", {.every = 3}},
                                   {"at random 0.3", {.probability = 0.3}}};

std::string told(const FaultResult& r) {
  std::string text = r.weak_answers >= 2 ? " weak" : "";
  if (r.told_cycles == 0) return text;
  text += " told " + std::to_string(r.told_cycles);
  if (r.told.energy_share_percent != 0) {
    text += " (" + std::to_string(r.told.energy_share_percent) + " %)";
  }
  if (r.told.rest_loss_w != 0) text += " (" + std::to_string(r.told.rest_loss_w) + " W)";
  return text;
}

std::string cell(const FaultResult& r) {
  char text[120];
  if (r.reason == Reason::kStudent) {
    std::snprintf(text, sizeof text, "- %.0f/%.0f Wh", r.against_order_wh, r.moved_wh);
    return text + told(r);
  }
  std::snprintf(text, sizeof text, "%d %s%s %.0f/%.0f Wh, then %d", r.cycles,
                reason_name(r.reason).data(), r.is_trip ? "" : "*", r.against_order_wh, r.moved_wh,
                r.driven_after);
  return text + told(r);
}

void print_header(const char* first) {
  std::printf("| %s |", first);
  for (const Orders orders : kAllOrders) std::printf(" %s |", orders_name(orders).data());
  std::printf("\n|---|");
  for (std::size_t i = 0; i < std::size(kAllOrders); ++i) std::printf("---|");
  std::printf("\n");
}

void print_row(const std::string& name, FaultCase c) {
  std::printf("| %s |", name.c_str());
  for (const Orders orders : kAllOrders) {
    c.orders = orders;
    std::printf(" %s |", cell(try_fault(c)).c_str());
  }
  std::printf("\n");
}

constexpr const char* kLegend =
    "Cycles until it was found, as what (* a pause, else a trip), energy against the order / moved "
    "until then, cycles\ndriven of the next 30. \"-\": not stopped in 60 cycles (real day: 720). "
    "\"weak\": told as weak answers; \"told N\": after N\ncycles as energy that does not arrive "
    "(%), "
    "or is lost at rest (W).\n\n";

void print_table(const std::string& title, FaultCase c) {
  print_header(title.c_str());
  for (const TrialFault& fault : trial_faults()) {
    c.fault = &fault;
    print_row(fault.name, c);
  }
  std::printf("\n");
}

void print_faults() {
  std::fputs(kLegend, stdout);
  for (const Schedule& schedule : kSchedules) {
    print_table(std::string("SoC 45 %, ") + schedule.name, {.times = schedule.times});
  }
  print_table("SoC 45 % in whole percent", {.nature = {.soc_step_e4 = 100}});
  print_table("SoC 45 %, brought up to date every 2 min, told", {.nature = {.soc_refresh_s = 120}});
  print_table("SoC 45 %, brought up to date every 5 min, told", {.nature = {.soc_refresh_s = 300}});
  print_table("SoC 45 %, controller killed after each cycle", {.is_killed = true});
}

void print_ends() {
  std::fputs(kLegend, stdout);
  for (const int percent : {9, 12, 85, 97}) {
    print_table("SoC " + std::to_string(percent) + " %, always", {.soc_frac = percent / 100.0});
  }
}

void print_rare() {
  std::printf("| fault | rhythm |");
  for (const Orders orders : kRareOrders) std::printf(" %s |", orders_name(orders).data());
  std::printf("\n|---|---|---|---|---|---|\n");
  for (const char* fault : kRareFaults) {
    for (const Rhythm& rhythm : kRhythms) {
      std::printf("| %s | %s |", fault, rhythm.name);
      for (const Orders orders : kRareOrders) {
        std::printf(" %s |", say_rare(try_rare(fault, rhythm, orders)).c_str());
      }
      std::printf("\n");
    }
  }
}

void print_honest(int days) {
  std::printf("%d days each of real prices.\n\n", days);
  std::printf(
      "| variant | trips | cycles lost | by reason | driven | weak | told | most of wrong energy | "
      "seen of it |\n");
  std::printf("|---|---|---|---|---|---|---|---|---|\n");
  for (const HonestVariant& variant : honest_variants()) {
    const HonestDays r = live_honest_days(variant, days);
    std::string reasons;
    for (int i = 0; i < kReasonCount; ++i) {
      if (r.lost[i] == 0) continue;
      reasons +=
          std::string(reason_name(static_cast<Reason>(i))) + " " + std::to_string(r.lost[i]) + " ";
    }
    std::string trips = std::to_string(r.trips);
    if (r.trips > 0) {
      trips += " (" + std::string(reason_name(r.first_trip)) + " first in cycle " +
               std::to_string(r.first_trip_cycle) + ")";
    }
    const Oddities& o = r.oddities;
    std::printf("| %s | %s | %d of %d | %s| %d | %d | %d (%d %%, %d W) | %.1f %% | ", variant.name,
                trips.c_str(), r.lost_in_all(), r.cycles, reasons.c_str(), r.driven, r.weak_cycles,
                r.told_cycles, r.told.energy_share_percent, r.told.rest_loss_w,
                r.wrong_energy_e6_max / 1e4);
    std::printf(
        "calibrations %d restarts %d late %d derated %.0f h forced %.1f h balancing %.1f h |\n",
        o.calibrations, o.restarts, o.late_answers, static_cast<double>(o.derated_s) / 3'600,
        static_cast<double>(o.forced_charge_s) / 3'600, static_cast<double>(o.balancing_s) / 3'600);
  }
}

void print_csv() {
  std::printf(
      "fault,schedule,orders,soc,cycles,reason,trip,against_order_wh,moved_wh,driven_after,"
      "moved_after_wh,weak_answers,told_cycles,told_percent,told_w,soc_end\n");
  for (const double soc : {0.09, 0.12, 0.45, 0.85, 0.97}) {
    for (const Schedule& schedule : kSchedules) {
      for (const TrialFault& fault : trial_faults()) {
        for (const Orders orders : kAllOrders) {
          const FaultResult r = try_fault(
              {.fault = &fault, .times = schedule.times, .orders = orders, .soc_frac = soc});
          std::printf("%s,%s,%s,%.2f,%d,%s,%d,%.0f,%.0f,%d,%.0f,%d,%d,%d,%d,%.3f\n", fault.name,
                      schedule.name, orders_name(orders).data(), soc, r.cycles,
                      r.reason == Reason::kStudent ? "" : reason_name(r.reason).data(), r.is_trip,
                      r.against_order_wh, r.moved_wh, r.driven_after, r.moved_after_wh,
                      r.weak_answers, r.told_cycles, r.told.energy_share_percent,
                      r.told.rest_loss_w, r.soc_frac);
        }
      }
    }
  }
}

int run(int argc, char** argv) {
  const std::string_view what = argc > 1 ? argv[1] : "";
  if (what == "faults") {
    print_faults();
  } else if (what == "ends") {
    print_ends();
  } else if (what == "rare") {
    print_rare();
  } else if (what == "honest") {
    print_honest(argc > 2 ? std::atoi(argv[2]) : 30);
  } else if (what == "csv") {
    print_csv();
  } else {
    std::fprintf(stderr, "usage: supervision_trial faults|ends|rare|honest [DAYS]|csv\n");
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace bess::trial

int main(int argc, char** argv) { return bess::trial::run(argc, argv); }
