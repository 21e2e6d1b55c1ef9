#include "tools/hil_runner/run/agreement.h"

#include <fmt/core.h>

#include <bit>
#include <fstream>

#include "edge/records/log/record_codec.h"
#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "shared/signature.h"

namespace bess {

namespace {

std::int64_t bits(double value) { return std::bit_cast<std::int64_t>(value); }

void add(const CycleRecord& c, Signature& signature) {
  const BatteryMeasurement& m = c.measurement;
  signature.add({c.utc_s, std::int64_t{c.has_measurement}, std::int64_t{m.soc_e4},
                 std::int64_t{m.power_w}, std::int64_t{c.price.has_row}, c.price.minute_utc_s,
                 std::int64_t{c.price.price_centi_eur_per_mwh}, std::int64_t{c.context_class},
                 std::int64_t{c.has_student_action}, static_cast<std::int64_t>(c.student_action),
                 std::int64_t{c.ordered_power_w}, static_cast<std::int64_t>(c.mode),
                 std::int64_t{c.written}});
  if (c.outlook.source != OutlookSource::kNone) {
    signature.add(static_cast<std::int64_t>(c.outlook.source));
    signature.add(c.outlook.break_even_centi);
  }
  for (const char letter : reason_name(c.reason)) signature.add(letter);
}

/// Checksum of all fields of the edge's records, and of all bytes that it sent with their times.
std::uint64_t pinned_number_of(const Evidence& evidence) {
  Signature signature;
  RecordBytes bytes;
  for (const CycleRecord& cycle : evidence.log) {
    encode_record(cycle, 0, bytes);
    for (const std::uint8_t byte : bytes) signature.add(byte);
  }
  signature.add(static_cast<std::int64_t>(evidence.sent));
  signature.add(evidence.edge_exit_code);
  return signature.value();
}

}  // namespace

std::uint64_t signature_of(const Evidence& evidence) {
  Signature signature;
  for (const DispatchEvent& e : evidence.orders) {
    signature.add({e.utc_ns, static_cast<std::int64_t>(e.kind), bits(e.power_w), e.duration_s,
                   bits(e.soc_frac)});
  }
  for (const MinuteRecord& m : evidence.minutes) {
    signature.add({m.minute_utc_s, bits(m.energy_wh), bits(m.soc_frac)});
  }
  for (const CycleRecord& cycle : evidence.log) add(cycle, signature);
  return signature.value();
}

PinnedRuns::PinnedRuns(const std::string& path, bool renews) : path_(path), renews_(renews) {
  std::ifstream file(path);
  if (!file && !renews) fail("{}: cannot be read; create it with BESS_UPDATE_GOLDEN=1", path);
  for (std::string name, number; file >> name >> number;) numbers_[name] = number;
}

std::vector<Finding> PinnedRuns::judge(const Outcome& outcome) {
  const std::string number = fmt::format("{:016x}", pinned_number_of(outcome.evidence));
  std::string& pinned = numbers_[outcome.scenario.name];
  if (renews_) pinned = number;
  if (pinned == number) return {};
  return {{.rule = "pinned",
           .utc_s = outcome.scenario.start_utc_s,
           .expected = pinned.empty() ? "a line in " + path_ : "the run " + pinned,
           .seen = fmt::format("the run {}; if intended, BESS_UPDATE_GOLDEN=1 updates {}", number,
                               path_)}};
}

void PinnedRuns::write() const {
  if (!renews_) return;
  std::string text;
  for (const auto& [name, number] : numbers_) text += fmt::format("{} {}\n", name, number);
  write_file(path_, text);
}

}  // namespace bess
