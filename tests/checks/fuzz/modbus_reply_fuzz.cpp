// Modbus replies: the frame check for TCP and RTU, then the whole link against a server on loopback
// that sends these bytes. A reply is good only if an independent decoder of the standard accepts
// it.
//   input: framing and function, count, address (2), bytes at a time, then the reply; the top bit
//   of the first byte puts the right transaction id or checksum into the reply, so that the rest is
//   reached
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <thread>
#include <vector>

#include "edge/device/battery/modbus_link.h"
#include "tests/checks/fuzz/fuzz_target.h"

namespace bess {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr int kInputHeader = 5;
constexpr std::uint16_t kUntouched = 0xA5A5;

struct Question {
  Framing framing;
  ModbusRequest request;
  bool mend;
  int chunk;
  std::uint16_t values[kWriteRegistersMax];
};

Question question_of(const std::uint8_t* data) {
  constexpr std::uint8_t kFunctions[] = {3, 4, 6, 16};
  Question q{};
  q.framing = (data[0] & 1) != 0 ? Framing::kRtu : Framing::kTcp;
  q.mend = (data[0] & 0x80) != 0;
  q.request.unit = 85;
  q.request.function = kFunctions[data[0] >> 1 & 3];
  q.request.count = q.request.function == 6 ? 1 : 1 + data[1] % kWriteRegistersMax;
  const int address = data[2] << 8 | data[3];
  q.request.address = static_cast<std::uint16_t>(std::min(address, 0x1'0000 - q.request.count));
  q.request.transaction = 0x1234;
  q.chunk = 1 + data[4];
  for (int i = 0; i < kWriteRegistersMax; ++i) q.values[i] = static_cast<std::uint16_t>(i * 257);
  return q;
}

int crc(const Bytes& bytes, std::size_t size) {
  int value = 0xFFFF;
  for (std::size_t i = 0; i < size; ++i) {
    value ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) value = value % 2 == 1 ? value / 2 ^ 0xA001 : value / 2;
  }
  return value;
}

void mend(const Question& q, int transaction, Bytes& reply) {
  if (!q.mend || reply.size() < 3) return;
  if (q.framing == Framing::kTcp) {
    reply[0] = static_cast<std::uint8_t>(transaction >> 8);
    reply[1] = static_cast<std::uint8_t>(transaction);
    return;
  }
  const int right = crc(reply, reply.size() - 2);
  reply[reply.size() - 2] = static_cast<std::uint8_t>(right);
  reply[reply.size() - 1] = static_cast<std::uint8_t>(right >> 8);
}

/// The only reply that means success, with the registers found in `reply`.
Bytes good_reply(const Question& q, int transaction, const Bytes& reply) {
  const ModbusRequest& r = q.request;
  const std::size_t header = q.framing == Framing::kTcp ? 6 : 0;
  const auto high = [](int word) { return static_cast<std::uint8_t>(word >> 8); };
  const auto low = [](int word) { return static_cast<std::uint8_t>(word); };
  Bytes good;
  if (header != 0) {
    const int length = r.is_write() ? 6 : 3 + 2 * r.count;
    good = {high(transaction), low(transaction), 0, 0, high(length), low(length)};
  }
  good.insert(good.end(), {low(r.unit), r.function});
  if (r.is_write()) {
    const int last = r.function == 6 ? q.values[0] : r.count;
    good.insert(good.end(), {high(r.address), low(r.address), high(last), low(last)});
  } else {
    good.push_back(low(2 * r.count));
    for (std::size_t i = header + 3; i < header + 3 + 2 * std::size_t(r.count); ++i) {
      good.push_back(i < reply.size() ? reply[i] : 0);
    }
  }
  if (header != 0) return good;
  const int sum = crc(good, good.size());
  good.insert(good.end(), {low(sum), high(sum)});
  return good;
}

/// An accepted reply must begin with the good bytes; the bytes after it belong to no reply.
void judge(const Question& q, int transaction, const Bytes& reply, Status status,
           const std::uint16_t* registers) {
  const Bytes good = good_reply(q, transaction, reply);
  const bool is_good =
      reply.size() >= good.size() && std::equal(good.begin(), good.end(), reply.begin());
  must((status == Status::kOk) == is_good, "good exactly if it is the reply to the request");
  const std::size_t data = q.framing == Framing::kTcp ? 9 : 3;
  for (int i = 0; i < q.request.count && !q.request.is_write(); ++i) {
    const std::size_t at = data + 2 * static_cast<std::size_t>(i);
    const int expected = is_good ? reply[at] << 8 | reply[at + 1] : kUntouched;
    must(registers[i] == expected, "the reply's registers, or untouched ones");
  }
}

void check_frames(Question& q, Bytes reply) {
  q.request.values = q.values;
  mend(q, q.request.transaction, reply);
  ModbusFrame frame;
  std::size_t used = 0;
  int missing = missing_bytes(q.framing, q.request, frame);
  while (missing > 0 && used < reply.size()) {
    must(frame.size + missing <= kFrameBytesMax, "never more than a frame holds");
    const int left = static_cast<int>(reply.size() - used);
    const int now = std::min({missing, left, q.chunk});
    std::copy_n(reply.begin() + static_cast<std::ptrdiff_t>(used), now, frame.bytes + frame.size);
    frame.size += now;
    used += static_cast<std::size_t>(now);
    missing = missing_bytes(q.framing, q.request, frame);
  }
  std::uint16_t registers[kReadRegistersMax];
  std::fill_n(registers, kReadRegistersMax, kUntouched);
  const ReplyCheck check = check_reply(q.framing, q.request, frame, registers);
  must(check.exception == 0 || check.status != Status::kOk, "an exception is not a success");
  judge(q, q.request.transaction, reply, check.status, registers);
}

/// Answers each request with the bytes of this input, then closes: the link must not wait for more.
class Server {
 public:
  Server() : fd_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    if (bind(fd_, reinterpret_cast<sockaddr*>(&address), size) != 0 || listen(fd_, 8) != 0 ||
        getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
      std::abort();
    }
    port_ = ntohs(address.sin_port);
    std::thread([this] { run(); }).detach();
  }
  [[nodiscard]] int port() const { return port_; }
  void answer_with(const Question& question, const Bytes& reply) {
    const std::lock_guard lock(mutex_);
    question_ = question;
    reply_ = reply;
    sent_.clear();  // a request that never arrives gets no reply
  }
  /// Transaction id and reply bytes of the last request.
  Bytes last(int& transaction) {
    const std::lock_guard lock(mutex_);
    transaction = transaction_;
    return sent_;
  }

 private:
  void run() {
    while (true) {
      const int client = accept(fd_, nullptr, nullptr);
      std::uint8_t request[kFrameBytesMax];
      if (recv(client, request, sizeof request, 0) > 2) {
        const std::lock_guard lock(mutex_);
        transaction_ = request[0] << 8 | request[1];
        sent_ = reply_;
        mend(question_, transaction_, sent_);
        static_cast<void>(send(client, sent_.data(), sent_.size(), MSG_NOSIGNAL));
      }
      close(client);
    }
  }

  int fd_;
  int port_;
  std::mutex mutex_;
  Question question_{};
  Bytes reply_, sent_;
  int transaction_ = 0;
};

void check_link(const Question& q, const Bytes& reply) {
  static Server& server = *new Server;  // its thread never ends
  static const BatteryLinkSettings settings = [] {
    BatteryLinkSettings s;
    s.port = server.port();
    s.response_timeout_ms = 10'000;
    return s;
  }();
  static ModbusLink link(settings, {}, ScaledClock{.scale = 100'000});
  link.close();
  server.answer_with(q, reply);
  std::uint16_t registers[kReadRegistersMax];
  std::fill_n(registers, kReadRegistersMax, kUntouched);
  const ModbusRequest& r = q.request;
  const Status status = r.is_write() ? link.write(r.unit, r.function, r.address, q.values, r.count)
                                     : link.read({.unit = r.unit,
                                                  .address = r.address,
                                                  .count = static_cast<std::uint16_t>(r.count),
                                                  .function = r.function},
                                                 registers);
  must(status != Status::kTimeout, "the server closes: nothing to wait for");
  int transaction = 0;
  const Bytes sent = server.last(transaction);
  judge(q, transaction, sent, status, registers);
}

}  // namespace
}  // namespace bess

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace bess;
  if (size < kInputHeader) return 0;
  Question question = question_of(data);
  const Bytes reply(data + kInputHeader, data + size);
  check_frames(question, reply);
  if (question.framing == Framing::kTcp) check_link(question, reply);
  return 0;
}
