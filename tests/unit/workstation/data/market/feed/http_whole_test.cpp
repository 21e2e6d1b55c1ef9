// Completeness of an answer, by HTTP/1 and by HTTP/2 behind nghttpx, plain and compressed: a
// complete one must be accepted, a truncated one must be retried.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <zlib.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <random>

#include "shared/host/child_process.h"
#include "shared/host/file.h"
#include "tests/support/dated_certificate.h"
#include "tests/support/fake_elia.h"
#include "tests/support/market_test_support.h"
#include "tests/support/test_server.h"
#include "workstation/data/market/feed/elia_fetch.h"

namespace bess {
namespace {

/// A proxy with HTTP/2 over TLS to its clients and HTTP/1.1 to the server.
class Http2Front {
 public:
  static constexpr const char* kProgram = "/usr/sbin/nghttpx";

  explicit Http2Front(std::uint16_t backend)
      : port_(free_port()),
        process_({kProgram, "--conf=/dev/null", "--workers=1", "--errorlog-file=/dev/null",
                  "--frontend=127.0.0.1," + std::to_string(port_),
                  "--backend=127.0.0.1," + std::to_string(backend), certificate_.key(),
                  certificate_.certificate()}) {
    setenv("SSL_CERT_FILE", certificate_.ca().c_str(), 1);
    await_listener(port_);
  }
  Http2Front(const Http2Front&) = delete;
  Http2Front& operator=(const Http2Front&) = delete;
  ~Http2Front() { unsetenv("SSL_CERT_FILE"); }
  [[nodiscard]] std::string url() const { return "https://127.0.0.1:" + std::to_string(port_); }

 private:
  DatedCertificate certificate_{"IP:127.0.0.1", -DatedCertificate::kDayS, DatedCertificate::kDayS};
  std::uint16_t port_;
  ChildProcess process_;
};

enum class Packing { kNone, kGzip, kDeflate };
enum class Framing { kLength, kChunks, kClosing };
enum class Fault { kNone, kCutTransfer, kCutInside };

/// The bytes of `text` with a Content-Encoding.
std::string packed(const std::string& text, Packing packing) {
  if (packing == Packing::kNone) return text;
  constexpr int kGzipWindow = 31, kZlibWindow = 15, kMemory = 8;
  z_stream stream{};
  deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED,
               packing == Packing::kGzip ? kGzipWindow : kZlibWindow, kMemory, Z_DEFAULT_STRATEGY);
  std::string bytes(deflateBound(&stream, text.size()), '\0');
  std::string copy = text;
  stream.next_in = reinterpret_cast<Bytef*>(copy.data());
  stream.avail_in = static_cast<uInt>(copy.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  bytes.resize(stream.total_out);
  deflateEnd(&stream);
  return bytes;
}

/// All bytes of an answer, after which the connection is closed.
std::string answer_of(const std::string& text, Packing packing, Framing framing, Fault fault,
                      std::mt19937& draws) {
  std::string body = packed(text, packing);
  // Only the end is cut in some cases; the text before it is never complete.
  const auto cut = [&] { return body.size() / 2 + draws() % (body.size() / 2 - 40); };
  if (fault == Fault::kCutInside) body.resize(cut());
  std::string head = "HTTP/1.1 200 OK\r\nConnection: close\r\n";
  if (packing == Packing::kGzip) head += "Content-Encoding: gzip\r\n";
  if (packing == Packing::kDeflate) head += "Content-Encoding: deflate\r\n";
  if (framing == Framing::kChunks) head += "Transfer-Encoding: chunked\r\n";
  if (framing == Framing::kLength) head += fmt::format("Content-Length: {}\r\n", body.size());
  const std::size_t size = body.size();
  if (fault == Fault::kCutTransfer) body.resize(cut());
  if (framing == Framing::kChunks) {
    body = fmt::format("{:x}\r\n", size) + body;
    if (fault != Fault::kCutTransfer) body += "\r\n0\r\n\r\n";
  }
  return head + "\r\n" + body;
}

/// Long and without a pattern, so that half of the compressed data is half of the text.
std::string digits(std::mt19937& draws) {
  std::string text;
  while (text.size() < 4'000) text += std::to_string(draws());
  return "1" + text;
}

struct TextCase {
  const char* name;
  std::string text;
  bool tells_its_end;
};

/// Answer to a client with compression, and to one without.
struct ServedAnswer {
  std::string packed, plain;
  bool answer(TestConnection& connection, const std::string& request) const {
    const bool wants_plain = request.find("ccept-Encoding: identity") != request.npos;
    connection.send(wants_plain ? plain : packed);
    return false;
  }
};

/// Every compression, framing, text and fault at `url`, whose answers come from `said`. A server
/// that always compresses leaves a text without an end of its own ambiguous.
void expect_all(const std::string& url, ServedAnswer& said, bool may_close) {
  std::mt19937 draws(7);
  const std::string row = "time;price\n2025-06-01T10:00:00Z;" + digits(draws);
  const std::vector<TextCase> texts{{"JSON", "{\"price\":[\"" + digits(draws) + "\"]}", true},
                                    {"JSON in lines", "[\n\"" + digits(draws) + "\",\n1\n]", true},
                                    {"CSV", row + "\n", true},
                                    {"CSV without its last line end", row, false}};
  const std::atomic<bool> interrupted{false};
  for (const Packing packing : {Packing::kNone, Packing::kGzip, Packing::kDeflate}) {
    for (const Framing framing : {Framing::kLength, Framing::kChunks, Framing::kClosing}) {
      for (const Fault fault : {Fault::kNone, Fault::kCutTransfer, Fault::kCutInside}) {
        for (const TextCase& c : texts) {
          if (framing == Framing::kClosing && !may_close) continue;
          if (packing == Packing::kNone && fault == Fault::kCutInside) continue;
          SCOPED_TRACE(fmt::format("{}, packing {}, framing {}, fault {}", c.name,
                                   static_cast<int>(packing), static_cast<int>(framing),
                                   static_cast<int>(fault)));
          said.packed = answer_of(c.text, packing, framing, fault, draws);
          const bool unpacks = draws() % 2 == 0;
          const Fault plain_fault = fault == Fault::kCutInside ? Fault::kNone : fault;
          said.plain = unpacks ? answer_of(c.text, Packing::kNone, framing, plain_fault, draws)
                               : said.packed;
          const HttpOutcome outcome = http_get(url, interrupted, {.deadline_s = 20});
          const bool is_plain = packing == Packing::kNone || unpacks;
          const bool can_tell = c.tells_its_end || (is_plain && framing != Framing::kClosing);
          const bool is_taken = (unpacks ? plain_fault : fault) == Fault::kNone && can_tell;
          EXPECT_EQ(outcome.kind,
                    is_taken ? HttpOutcome::Kind::kDone : HttpOutcome::Kind::kTransient)
              << outcome.reason;
          EXPECT_TRUE(outcome.body == (is_taken ? c.text : "")) << outcome.body.size();
        }
      }
    }
  }
}

TEST(HttpCompleteness, ByHttp1) {
  ServedAnswer said;
  const TestServer server([&said](TestConnection& connection, const std::string& request) {
    return said.answer(connection, request);
  });
  expect_all("http://127.0.0.1:" + std::to_string(server.port()), said, true);
}

TEST(HttpCompleteness, ByHttp2) {
  if (access(Http2Front::kProgram, X_OK) != 0) {
    GTEST_SKIP() << "no nghttp2-proxy here; tools/setup --test installs it";
  }
  ServedAnswer said;
  const TestServer server([&said](TestConnection& connection, const std::string& request) {
    EXPECT_THAT(request, testing::HasSubstr("Via: 2 ")) << "not asked by HTTP/2";
    return said.answer(connection, request);
  });
  const Http2Front front(server.port());
  expect_all(front.url(), said, false);  // a proxy takes a closed connection for the end
}

// Download program, killed at each request: an earlier file stays until the new one is complete,
// and the next run continues and cleans up.

namespace fs = std::filesystem;

/// Delays one request of the program, so that it is interrupted while it waits for the answer.
class Gate {
 public:
  /// The `number`-th request from now on, 1 the next, is not answered before let_go().
  void hold(int number) {
    const std::lock_guard lock(mutex_);
    passing_ = number - 1;
    is_closed_ = true;
    is_reached_ = false;
  }
  [[nodiscard]] bool is_reached_within(std::chrono::seconds longest) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, longest, [this] { return is_reached_; });
  }
  void let_go() {
    const std::lock_guard lock(mutex_);
    is_closed_ = false;
    ++openings_;
    changed_.notify_all();
  }
  /// For each request, on the server's thread.
  void pass() {
    std::unique_lock lock(mutex_);
    if (!is_closed_ || passing_-- > 0) return;
    is_reached_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this, before = openings_] { return openings_ != before; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int openings_ = 0;
  int passing_ = 0;  ///< requests before the delayed one
  bool is_closed_ = false;
  bool is_reached_ = false;
};

class KilledFetch : public testing::Test {
 protected:
  /// Two months are four windows, minutes and quarter-hours.
  static constexpr int kWindows = 4;

  [[nodiscard]] std::vector<std::string> command(const fs::path& out) const {
    return {BESS_TRAIN_PROGRAM, "prices", "fetch",      "--from",     "2023-03-01",    "--to",
            "2023-04-30",       "--out",  out.string(), "--base-url", elia_.base_url()};
  }

  static fs::path kept_windows_of(const fs::path& out) { return out.string() + ".fetch"; }
  static int windows_kept(const fs::path& out) {
    std::error_code absent;
    const fs::directory_iterator files(kept_windows_of(out), absent);
    return static_cast<int>(std::distance(begin(files), end(files)));
  }

  Gate gate_;
  FakeElia elia_{[this](const EliaRequest& ask, EliaAnswer&) {
    if (!ask.wants_total) gate_.pass();
  }};
  ScratchFolder folder_;
};

TEST_F(KilledFetch, AtEachWindowKeepsThoseBefore) {
  const fs::path out = folder_ / "prices.csv.gz";
  write_file(out, "of before");
  for (int kept = 1; kept < kWindows; ++kept) {
    gate_.hold(2);  // one new window arrives, the next does not
    ChildProcess fetch(command(out));
    ASSERT_TRUE(gate_.is_reached_within(std::chrono::seconds(60)));
    fetch.signal(SIGKILL);
    ASSERT_EQ(fetch.wait(), 128 + SIGKILL);
    gate_.let_go();
    ASSERT_EQ(windows_kept(out), kept);
    ASSERT_EQ(read_file(out), "of before");
  }
  ASSERT_EQ(ChildProcess(command(out)).wait(), 0);
  EXPECT_EQ(std::ranges::count(read_file(out).substr(read_file(out).find("minute_utc")), '\n'),
            1 + (31 + 30) * 1440 - 60);
  EXPECT_EQ(std::distance(fs::directory_iterator(out.parent_path()), {}), 1) << "left behind";
  const std::map<std::string, int> requests = elia_.requests();
  EXPECT_EQ(requests.at("ods046") + requests.at("ods047"), kWindows + (kWindows - 1))
      << "a stored window is not fetched again";
}

TEST_F(KilledFetch, CtrlCWritesNoFile) {
  const fs::path out = folder_ / "prices.csv";
  gate_.hold(1);
  ChildProcess fetch(command(out));
  ASSERT_TRUE(gate_.is_reached_within(std::chrono::seconds(60)));
  fetch.signal(SIGINT);
  EXPECT_EQ(fetch.wait(), 3) << fetch.read_all();
  gate_.let_go();
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace bess
