#include "edge/page/front_door.h"

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <charconv>
#include <numeric>
#include <string_view>

#include "shared/file_descriptor.h"

namespace bess {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPatience = 5s;
constexpr auto kCrowdedPatience = 500ms;
constexpr auto kLookEvery = 100ms;
constexpr int kOfAnAddress = 4;
constexpr int kOfAll = 8;
constexpr std::size_t kHeaderBytesMax = 32'768;

/// "127.0.0.1"; empty when it has gone.
std::string address_of(int socket) {
  sockaddr_storage name{};
  socklen_t size = sizeof name;
  char host[NI_MAXHOST] = "";
  auto* const address = reinterpret_cast<sockaddr*>(&name);
  if (getpeername(socket, address, &size) != 0) return "";
  getnameinfo(address, size, host, sizeof host, nullptr, 0, NI_NUMERICHOST);
  return host;
}

/// Of the header's field; 0 where there is none. What is no number the server refuses.
std::size_t body_bytes(std::string_view header) {
  constexpr std::string_view kField = "\ncontent-length:";
  const auto alike = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == b;
  };
  const auto found = std::search(header.begin(), header.end(), kField.begin(), kField.end(), alike);
  if (found == header.end()) return 0;
  std::string_view value(found + kField.size(), header.end());
  value.remove_prefix(std::min(value.find_first_not_of(' '), value.size()));
  std::size_t bytes = 0;
  std::from_chars(value.data(), value.data() + value.size(), bytes);
  return bytes;
}

/// With its body, as far as that is not refused anyway.
bool is_whole(std::string_view request) {
  const std::size_t end = request.find("\r\n\r\n");
  if (end == request.npos) return false;
  const std::size_t body = body_bytes(request.substr(0, end));
  return body > FrontDoor::kBodyBytesMax || request.size() >= end + 4 + body;
}

bool wait_for(int socket, short events, Clock::time_point until) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
  pollfd asked{.fd = socket, .events = events, .revents = 0};
  return left > 0 && poll(&asked, 1, static_cast<int>(left)) > 0;
}

void send_all(int socket, std::string_view text) {
  const auto until = Clock::now() + kPatience;
  while (!text.empty() && wait_for(socket, POLLOUT, until)) {
    const ssize_t sent = send(socket, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(sent));
  }
}

/// A request that was read, and the answer until it is sent.
class Talk final : public httplib::Stream {
 public:
  Talk(std::string_view request, std::string address, int socket)
      : request_(request), address_(std::move(address)), socket_(socket) {}

  [[nodiscard]] const std::string& answer() const { return answer_; }

  [[nodiscard]] bool is_readable() const override { return !request_.empty(); }
  [[nodiscard]] bool is_writable() const override { return true; }
  ssize_t read(char* to, std::size_t size) override {
    const std::size_t taken = request_.copy(to, size);
    request_.remove_prefix(taken);
    return static_cast<ssize_t>(taken);
  }
  ssize_t write(const char* from, std::size_t size) override {
    answer_.append(from, size);
    return static_cast<ssize_t>(size);
  }
  void get_remote_ip_and_port(std::string& ip, int& port) const override {
    ip = address_;
    port = 0;
  }
  void get_local_ip_and_port(std::string& ip, int& port) const override {
    ip.clear();
    port = 0;
  }
  [[nodiscard]] int socket() const override { return socket_; }

 private:
  std::string_view request_;
  std::string answer_;
  std::string address_;
  int socket_;
};

}  // namespace

FrontDoor::FrontDoor() {
  new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  set_payload_max_length(kBodyBytesMax);
}

void FrontDoor::lengthen_queue() {
  constexpr int kQueued = 128;
  ::listen(svr_sock_, kQueued);
}

bool FrontDoor::is_crowded(const std::string& address) {
  const std::scoped_lock lock(lock_);
  const int all = std::accumulate(waiting_.begin(), waiting_.end(), 0,
                                  [](int sum, const auto& of) { return sum + of.second; });
  return waiting_[address] > kOfAnAddress || all > kOfAll;
}

std::string FrontDoor::read_request(int socket, const std::string& address) {
  std::string said;
  const auto since = Clock::now();
  while (said.size() < kHeaderBytesMax + kBodyBytesMax) {
    const auto until = since + (is_crowded(address) ? kCrowdedPatience : kPatience);
    if (Clock::now() >= until || svr_sock_ == INVALID_SOCKET) return "";
    if (!wait_for(socket, POLLIN, std::min(until, Clock::now() + kLookEvery))) continue;
    char bytes[4'096];
    const ssize_t got = recv(socket, bytes, sizeof bytes, MSG_DONTWAIT);
    if (got <= 0) return "";
    said.append(bytes, static_cast<std::size_t>(got));
    if (is_whole(said)) return said;
  }
  return "";
}

bool FrontDoor::process_and_close_socket(int socket) {
  const FileDescriptor closed_behind(socket);
  const std::string address = address_of(socket);
  const auto count = [&](int change) {
    const std::scoped_lock lock(lock_);
    if ((waiting_[address] += change) == 0) waiting_.erase(address);
  };
  count(+1);
  const std::string request = read_request(socket, address);
  count(-1);
  if (request.empty()) return false;
  Talk talk(request, address, socket);
  bool is_closed = false;
  process_request(talk, true, is_closed, nullptr);
  send_all(socket, talk.answer());
  shutdown(socket, SHUT_RDWR);
  return true;
}

}  // namespace bess
