// The page's HTTP server, with patience: a request is read whole, within five seconds altogether,
// before anything is done about it, and an answer must be taken within five. Connections that wait
// to say something are in each other's way only: where an address has more than four of them, or
// all together are more than eight, each has half a second. So some dozens that say nothing, or a
// byte now and then, hold up nobody else for longer than a second or two.
#pragma once

#include <httplib.h>

#include <map>
#include <mutex>
#include <string>

namespace bess {

class FrontDoor final : public httplib::Server {
 public:
  static constexpr int kThreads = 16;
  static constexpr std::size_t kBodyBytesMax = 4'096;

  FrontDoor();
  /// Once it is bound: the library's own queue of five sends whoever comes sixth away for a second.
  void lengthen_queue();

 private:
  /// One request a connection.
  bool process_and_close_socket(int socket) override;
  /// Empty where none came in time, or one that is too long.
  std::string read_request(int socket, const std::string& address);
  [[nodiscard]] bool is_crowded(const std::string& address);

  std::mutex lock_;
  std::map<std::string, int> waiting_;  ///< connections by address
};

}  // namespace bess
