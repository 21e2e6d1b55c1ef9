// Page test site: the configuration of a battery, and a decision log, without a controller. The
// answers on its page come from the real bess-edge.
#pragma once

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "edge/companions/page/page_settings.h"
#include "edge/core/control/policy.h"
#include "edge/records/log/ring_log.h"
#include "shared/local_time.h"
#include "shared/scaled_clock.h"
#include "shared/utc_text.h"
#include "tests/support/temporary_folder.h"

namespace bess {

class PageSite {
 public:
  static constexpr std::int64_t kStart =
      1'679'785'200;  ///< 2023-03-25T23:00:00Z, midnight in Brussels

  explicit PageSite(int cycles = 400) {
    set_market_time_zone();
    write_log(cycles);
    config_ = folder.write(
        "edge.toml",
        "contact = \"Ann & Bo, +32 2\"\n[battery]\nname = \"garage-1\"\nmap = \"" BESS_SOURCE_DIR
        "/edge/device/maps/alphaess.toml\"\n[price]\nurl = \"https://example.org/rows\"\n"
        "[simulation]\ntime_scale = 1\nutc_start = \"" +
            std::string(utc_text(kStart + cycles * kSecondsPerStep).view()) +
            "\"\nanchor_monotonic_ns = " + std::to_string(clock_ns(CLOCK_MONOTONIC)) +
            "\n[page]\nport = 1\n");
  }

  [[nodiscard]] const std::string& config() const { return config_; }
  /// Of that configuration, on a free port.
  [[nodiscard]] PageSettings settings() const {
    PageSettings settings;
    std::string error;
    EXPECT_TRUE(load_page_settings(config_, settings, error)) << error;
    settings.port = 0;
    return settings;
  }

  TemporaryFolder folder;

 private:
  /// Prices as a wave over the day, decisions of the student.
  void write_log(int cycles) const {
    std::filesystem::create_directory(folder.file("state"));
    RingLog ring;
    FileMessage error;
    ASSERT_TRUE(ring.open(folder.file("state/decisions.ring").c_str(), 35 * 720, error))
        << error.c_str();
    std::int32_t soc_e4 = 5'000;
    for (int i = 0; i < cycles; ++i) {
      CycleRecord record;
      record.utc_s = kStart + i * kSecondsPerStep;
      record.cycle = i + 1;
      record.mode = Mode::kRunning;
      record.has_measurement = true;
      record.measurement.soc_e4 = soc_e4;
      record.measurement.capacity_wh = 8'000;
      record.price.has_row = true;
      record.price.minute_utc_s = record.utc_s - 60;
      record.price.price_centi_eur_per_mwh =
          static_cast<std::int32_t>(8'000 + 20'000 * std::sin(i / 23.0));
      record.price_age_s = 2;
      record.context_class = 6;
      record.has_student_action = true;
      record.student_action = decide_with_student(make_lattice_state(
          local_minute_of(record.utc_s), 6, soc_e4, record.price.price_centi_eur_per_mwh));
      record.ordered_power_w = 4'000 * power_sign(record.student_action);
      record.measurement.power_w = record.ordered_power_w;
      record.reason = Reason::kStudent;
      record.battery_status = Status::kOk;
      record.written = true;
      soc_e4 += record.ordered_power_w * 10'000 / 8'000 / 30;
      soc_e4 = std::clamp(soc_e4, 1'000, 10'000);
      ASSERT_TRUE(ring.append(record));
    }
  }

  std::string config_;
};

}  // namespace bess
