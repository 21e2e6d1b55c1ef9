// Published prices as bess-edge reads them: rows, plans, damage, wrong prices, silence.
#include "edge/prices/record/price_reader.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <random>
#include <thread>

#include "edge/prices/fetch/price_fetcher.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

constexpr std::int64_t kMillisecondNs = 1'000'000;

class PriceReaderTest : public ::testing::Test {
 protected:
  static std::int64_t minute_now() { return clock_ns(CLOCK_REALTIME) / 60'000'000'000 * 60 - 60; }
  void publish(const PriceRow& row, Status status = Status::kOk) {
    publisher_.publish([&](PublishedPrices& prices) {
      ++prices.answers;
      prices.status = status;
      prices.row = row;
      prices.received_monotonic_ns = clock_ns(CLOCK_MONOTONIC);
      prices.served_minute_utc_s = row.minute_utc_s;
    });
  }
  static std::int64_t in_ms(int ms) { return clock_ns(CLOCK_MONOTONIC) + ms * kMillisecondNs; }

  TemporaryFolder folder_;
  std::string path_ = folder_.file("prices");
  PricePublisher publisher_{path_};
  PriceReader reader_{{.path = FixedText<639>(path_)}, {}};
};

TEST_F(PriceReaderTest, TakesARowAndIsWokenByIt) {
  reader_.request(minute_now(), 0, 0);
  EXPECT_FALSE(reader_.wait(in_ms(50)));
  EXPECT_EQ(reader_.latest().status, Status::kNoFetcher);
  std::thread other([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    publish({.minute_utc_s = minute_now(), .price_centi_eur_per_mwh = 4'200});
  });
  const std::int64_t begin_ns = clock_ns(CLOCK_MONOTONIC);
  EXPECT_TRUE(reader_.wait(in_ms(10'000)));
  EXPECT_LT(clock_ns(CLOCK_MONOTONIC) - begin_ns, 5'000 * kMillisecondNs);
  other.join();
  const PriceReport report = reader_.latest();
  EXPECT_TRUE(report.has_row);
  EXPECT_EQ(report.status, Status::kOk);
  EXPECT_EQ(report.price_centi_eur_per_mwh, 4'200);
}

TEST_F(PriceReaderTest, AFailureKeepsTheRowAndNamesItself) {
  publish({.minute_utc_s = minute_now(), .price_centi_eur_per_mwh = 4'200});
  static_cast<void>(reader_.latest());
  publish({.minute_utc_s = minute_now(), .price_centi_eur_per_mwh = 1}, Status::kTimeout);
  const PriceReport report = reader_.latest();
  EXPECT_EQ(report.status, Status::kTimeout);
  EXPECT_EQ(report.price_centi_eur_per_mwh, 4'200);
}

TEST_F(PriceReaderTest, AFalseRowIsNoRow) {
  const PriceRow lies[] = {{.minute_utc_s = minute_now() + 3'600, .price_centi_eur_per_mwh = 1},
                           {.minute_utc_s = minute_now() + 7, .price_centi_eur_per_mwh = 1},
                           {.minute_utc_s = -60, .price_centi_eur_per_mwh = 1},
                           {.minute_utc_s = minute_now(), .price_centi_eur_per_mwh = INT32_MIN},
                           {.minute_utc_s = minute_now(), .price_centi_eur_per_mwh = INT32_MAX}};
  for (const PriceRow& lie : lies) {
    publish(lie);
    EXPECT_FALSE(reader_.latest().has_row);
    EXPECT_EQ(reader_.latest().status, Status::kImplausible);
  }
}

TEST_F(PriceReaderTest, ATimeOfReceiptInTheFutureIsNow) {
  publisher_.publish([&](PublishedPrices& prices) {
    ++prices.answers;
    prices.status = Status::kOk;
    prices.row = {.minute_utc_s = minute_now(), .price_centi_eur_per_mwh = 5};
    prices.received_monotonic_ns = INT64_MAX;
  });
  const std::int64_t received_ns = reader_.latest().received_monotonic_ns;
  EXPECT_LE(received_ns, clock_ns(CLOCK_MONOTONIC));
}

TEST_F(PriceReaderTest, AnotherVersionAndDamageAreNoPrices) {
  publish({.minute_utc_s = minute_now(), .price_centi_eur_per_mwh = 4'200});
  const std::string good = text_of_file(path_);
  const auto status_of = [&](const std::string& bytes) {
    std::filesystem::remove(path_);
    std::ofstream(path_, std::ios::binary) << bytes;
    PriceReader reader({.path = FixedText<639>(path_)}, {});
    const PriceReport report = reader.latest();
    EXPECT_EQ(report.has_row, report.status == Status::kOk);
    return report.status;
  };
  EXPECT_EQ(status_of(good), Status::kOk);
  std::string other = good;
  other[0] = static_cast<char>(other[0] + 1);
  EXPECT_EQ(status_of(other), Status::kOtherVersion);
  for (std::size_t size = 4; size < good.size(); size += 7) {
    EXPECT_EQ(status_of(good.substr(0, size)), Status::kMalformed) << size;
  }
  std::mt19937 random(20'261'127);
  for (int i = 0; i < 200; ++i) {
    std::string torn = good;
    const std::size_t at = 4 + random() % (torn.size() - 4);
    torn[at] = static_cast<char>(torn[at] ^ (1 << random() % 8));
    EXPECT_EQ(status_of(torn), Status::kMalformed) << at;
  }
}

TEST_F(PriceReaderTest, AStudentByOutlookNeedsAPlanOfItsOwnModel) {
  static const OutlookModel model{.constant_centi = 1};
  PriceReader reader({.path = FixedText<639>(path_), .model = &model}, {});
  publish({.minute_utc_s = minute_now(), .price_centi_eur_per_mwh = 4'200});
  EXPECT_EQ(reader.latest().status, Status::kOtherVersion);
  publisher_.publish([](PublishedPrices& prices) { prices.model_hash = model.hash(); });
  EXPECT_FALSE(reader.latest().has_row);
  static OutlookExchange exchange;
  exchange.model = &model;
  publisher_.publish_outlook(exchange);
  EXPECT_EQ(reader.latest().status, Status::kOk);
  EXPECT_TRUE(reader.latest().has_row);
}

TEST_F(PriceReaderTest, OneThatIsSilentForCyclesIsReported) {
  // Simulated time is fast enough for three control cycles in a moment.
  const ScaledClock fast{.anchor_monotonic_ns = clock_ns(CLOCK_MONOTONIC) - kNanosecondsPerSecond,
                         .anchor_utc_s = minute_now(),
                         .scale = 10'000};
  PriceReader reader({.path = FixedText<639>(path_)}, fast);
  publish({.minute_utc_s = minute_now(), .price_centi_eur_per_mwh = 4'200});
  static_cast<void>(reader.latest());
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(reader.latest().status, Status::kNoFetcher);
  EXPECT_TRUE(reader.latest().has_row);
}

/// Read during writes, thousands of times: never half of one and half of another.
TEST_F(PriceReaderTest, IsNeverTorn) {
  std::atomic<bool> is_over = false;
  std::thread writer([&] {
    for (int i = 1; i <= 3'000; ++i) {
      publish({.minute_utc_s = minute_now(), .price_centi_eur_per_mwh = i});
    }
    is_over = true;
  });
  while (!is_over) {
    const PriceReport report = reader_.latest();
    EXPECT_TRUE(report.status == Status::kOk || report.status == Status::kNoFetcher ||
                report.status == Status::kNoRow)
        << status_name(report.status);
  }
  writer.join();
  EXPECT_EQ(reader_.latest().price_centi_eur_per_mwh, 3'000);
}

}  // namespace
}  // namespace bess
