#include "edge/program/threshold_note.h"

namespace bess {
namespace {

/// One threshold as both have it.
struct Pair {
  const char* key;
  const char* action;
  std::int32_t guard;
  std::int32_t proved;
  bool guard_reaches_further;  ///< it acts at prices at which the student need not
  bool binds_student;
};

const char* who_answers(const Pair& pair) {
  if (pair.guard_reaches_further) return "the guard alone makes it ";
  return pair.binds_student ? "the student's proof alone makes it " : "nothing makes it ";
}

void add_difference(const Pair& pair, std::string& text) {
  if (pair.guard == pair.proved) return;
  if (!text.empty()) text += "; ";
  text.append(pair.key).append(" = ").append(std::to_string(pair.guard));
  text.append(", the student is proved for ").append(std::to_string(pair.proved));
  text.append(": between them ").append(who_answers(pair)).append(pair.action);
}

std::string agreement(const PriceThresholds& both) {
  std::string text = "charge at or below " + std::to_string(both.low_eur_per_mwh);
  text.append(guard_alone_note(both.low_binds_student()));
  text.append(", discharge at or above ").append(std::to_string(both.high_eur_per_mwh));
  text.append(guard_alone_note(both.high_binds_student()));
  return text.append(" EUR/MWh, as the student is proved for");
}

}  // namespace

ThresholdNote compare_thresholds(const PriceThresholds& guard, const PriceThresholds& proved) {
  if (guard == proved) return {true, agreement(guard)};
  ThresholdNote note;
  add_difference(
      {"[guard] low_price_eur_per_mwh", "charge", guard.low_eur_per_mwh, proved.low_eur_per_mwh,
       guard.low_eur_per_mwh > proved.low_eur_per_mwh, proved.low_binds_student()},
      note.text);
  add_difference({"[guard] high_price_eur_per_mwh", "discharge", guard.high_eur_per_mwh,
                  proved.high_eur_per_mwh, guard.high_eur_per_mwh < proved.high_eur_per_mwh,
                  proved.high_binds_student()},
                 note.text);
  return note;
}

}  // namespace bess
