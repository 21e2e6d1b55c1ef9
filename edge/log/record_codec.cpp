#include "edge/log/record_codec.h"

#include <iterator>
#include <type_traits>

#include "edge/base/check.h"
#include "shared/crc32.h"

namespace bess {
namespace {

constexpr std::size_t kCrcOffset = kRecordBytes - 4;

// The code on disk is the place in these lists. They only ever grow at the end, whatever order the
// enumerations have in the program: what was logged a year ago must keep its meaning.
constexpr Mode kModeCodes[] = {Mode::kStart, Mode::kRunning, Mode::kHolding, Mode::kSafe,
                               Mode::kStopping};
constexpr Action kActionCodes[] = {Action::kDischarge, Action::kIdle, Action::kCharge};
constexpr Reason kReasonCodes[] = {
    Reason::kStopRequested,    Reason::kClock,       Reason::kLink,     Reason::kAlarm,
    Reason::kTemperature,      Reason::kOffGrid,     Reason::kNoPrice,  Reason::kPriceAge,
    Reason::kPriceQuarterHour, Reason::kSocFull,     Reason::kSocEmpty, Reason::kPowerLimit,
    Reason::kPriceLow,         Reason::kPriceHigh,   Reason::kStudent,  Reason::kHandOver,
    Reason::kWrongDirection,   Reason::kCycleBudget, Reason::kRamp};
constexpr Status kStatusCodes[] = {
    Status::kOk,         Status::kNotConnected,   Status::kTimeout,     Status::kBusException,
    Status::kBusBusy,    Status::kNotPermitted,   Status::kBadReply,    Status::kImplausible,
    Status::kNotApplied, Status::kNotExpressible, Status::kWriteBudget, Status::kNameUnresolved,
    Status::kTlsRefused, Status::kHttpError,      Status::kMalformed,   Status::kNoRow,
    Status::kTooLarge,   Status::kNoMemory};
static_assert(std::size(kModeCodes) == kModeCount && std::size(kActionCodes) == kActionCount &&
                  std::size(kReasonCodes) == kReasonCount &&
                  std::size(kStatusCodes) == kStatusCount,
              "a new enumerator needs a code: append it to its list");

class Writer {
 public:
  explicit Writer(RecordBytes& bytes) : bytes_(bytes) {}
  template <typename T>
  void integer(const T& value) {
    BESS_CHECK(offset_ + sizeof(T) <= kCrcOffset);
    const auto bits = static_cast<std::uint64_t>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bytes_[offset_++] = static_cast<std::uint8_t>(bits >> (8 * i));
    }
  }
  template <typename T, std::size_t kCount>
  void code(const T& value, const T (&codes)[kCount]) {
    std::uint8_t code = 0;
    while (codes[code] != value) BESS_CHECK(++code < kCount);
    integer(code);
  }

 private:
  RecordBytes& bytes_;
  std::size_t offset_ = 0;
};

class Reader {
 public:
  explicit Reader(const RecordBytes& bytes) : bytes_(bytes) {}
  template <typename T>
  void integer(T& value) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bits |= std::uint64_t{bytes_[offset_++]} << (8 * i);
    }
    value = static_cast<T>(bits);
  }
  template <typename T, std::size_t kCount>
  void code(T& value, const T (&codes)[kCount]) {
    std::uint8_t code = 0;
    integer(code);
    if (code < kCount) {
      value = codes[code];
    } else {
      all_known_ = false;
    }
  }
  [[nodiscard]] bool all_known() const { return all_known_; }

 private:
  const RecordBytes& bytes_;
  std::size_t offset_ = 0;
  bool all_known_ = true;
};

template <typename Archive, typename Measurement>
void visit_measurement(Archive& a, Measurement& m) {
  a.integer(m.soc_e4);
  a.integer(m.power_w);
  a.integer(m.capacity_wh);
  a.integer(m.charge_w_max);
  a.integer(m.discharge_w_max);
  a.integer(m.temperature_min_deci_c);
  a.integer(m.temperature_max_deci_c);
  a.integer(m.alarm);
  a.integer(m.off_grid);
  a.integer(m.dispatch_active);
  a.integer(m.has_order_power);
  a.integer(m.order_power_w);
}

template <typename Archive, typename Price>
void visit_price(Archive& a, Price& p) {
  a.integer(p.has_row);
  a.integer(p.minute_utc_s);
  a.integer(p.price_centi_eur_per_mwh);
  a.integer(p.received_monotonic_ns);
  a.integer(p.fetch_us);
  a.code(p.status, kStatusCodes);
  a.integer(p.large_step);
}

template <typename Archive, typename Counters>
void visit_counters(Archive& a, Counters& c) {
  a.integer(c.requests);
  a.integer(c.failed_requests);
  a.integer(c.reconnects);
  a.integer(c.register_writes);
  a.integer(c.unchanged_orders);
  a.integer(c.flash_day);
  a.integer(c.flash_writes_today);
}

/// Every field once, for both directions. New fields go to the end.
template <typename Archive, typename Record>
void visit_fields(Archive& a, Record& r) {
  a.integer(r.utc_s);
  a.integer(r.cycle);
  a.code(r.mode, kModeCodes);
  a.integer(r.has_measurement);
  visit_measurement(a, r.measurement);
  visit_price(a, r.price);
  a.integer(r.price_age_s);
  a.integer(r.has_student_action);
  a.code(r.student_action, kActionCodes);
  a.integer(r.ordered_power_w);
  a.code(r.reason, kReasonCodes);
  a.code(r.battery_status, kStatusCodes);
  a.integer(r.written);
  a.integer(r.decision_us);
  a.integer(r.write_us);
  a.integer(r.total_us);
  a.integer(r.missed_ticks);
  visit_counters(a, r.counters);
  a.integer(r.deadline_misses);
  a.integer(r.unanswered_orders);
  a.integer(r.throughput.local_day);
  a.integer(r.throughput.soc_moved_e4);
}

std::uint32_t crc_of(const RecordBytes& bytes) {
  Crc32 crc;
  crc.add_bytes(bytes.data(), kCrcOffset);
  return crc.value();
}

}  // namespace

void encode_record(const CycleRecord& record, std::uint64_t sequence, RecordBytes& bytes) {
  bytes.fill(0);
  Writer writer(bytes);
  writer.integer(sequence);
  visit_fields(writer, record);
  const std::uint32_t crc = crc_of(bytes);
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[kCrcOffset + i] = static_cast<std::uint8_t>(crc >> (8 * i));
  }
}

bool decode_record(const RecordBytes& bytes, CycleRecord& record, std::uint64_t& sequence) {
  std::uint32_t crc = 0;
  for (std::size_t i = 0; i < 4; ++i) crc |= std::uint32_t{bytes[kCrcOffset + i]} << (8 * i);
  if (crc != crc_of(bytes)) return false;
  Reader reader(bytes);
  record = CycleRecord{};
  reader.integer(sequence);
  visit_fields(reader, record);
  return reader.all_known();
}

}  // namespace bess
