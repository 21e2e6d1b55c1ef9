// Test server on loopback with byte-exact answers, plain or over TLS.
#pragma once

#include <openssl/ssl.h>
#include <poll.h>
#include <signal.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>

#include "tests/support/loopback_socket.h"

namespace bess {

/// One connection, as the test's handler sees it.
class TestConnection {
 public:
  TestConnection(int fd, SSL* tls) : fd_(fd), tls_(tls) {}

  /// Bytes up to the empty line; false if the client has gone.
  bool read_request(std::string& request) {
    request.clear();
    char c = 0;
    while (request.find("\r\n\r\n") == std::string::npos) {
      const auto got = tls_ != nullptr ? SSL_read(tls_, &c, 1) : recv(fd_, &c, 1, 0);
      if (got <= 0) return false;
      request += c;
    }
    return true;
  }
  bool send(const std::string& text) {
    const auto size = static_cast<int>(text.size());
    const auto sent = tls_ != nullptr ? SSL_write(tls_, text.data(), size)
                                      : ::send(fd_, text.data(), text.size(), MSG_NOSIGNAL);
    return sent == size;
  }
  /// A good answer to one request.
  bool answer(const std::string& body, const std::string& first_lines = "HTTP/1.1 200 OK\r\n") {
    return send(first_lines + "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body);
  }

 private:
  int fd_;
  SSL* tls_;
};

class TestServer {
 public:
  /// Called for every request; false closes the connection.
  using Handler = std::function<bool(TestConnection&, const std::string& request)>;
  struct Options {
    const char* address = "127.0.0.1";
    std::uint16_t port = 0;        ///< 0 = any free one
    std::string certificate, key;  ///< PEM files; empty = no TLS
  };

  TestServer(Handler handler, const Options& options) : handler_(std::move(handler)) {
    signal(SIGPIPE, SIG_IGN);  // OpenSSL writes to clients that have gone
    sockaddr_in place = loopback_address(options.port, options.address);
    listen_fd_ = bind_socket(place);
    if (listen_fd_ < 0) return;
    listen(listen_fd_, 16);
    port_ = ntohs(place.sin_port);
    if (!options.certificate.empty()) {
      context_ = SSL_CTX_new(TLS_server_method());
      SSL_CTX_use_certificate_file(context_, options.certificate.c_str(), SSL_FILETYPE_PEM);
      SSL_CTX_use_PrivateKey_file(context_, options.key.c_str(), SSL_FILETYPE_PEM);
    }
    thread_ = std::thread([this] { run(); });
  }
  explicit TestServer(Handler handler) : TestServer(std::move(handler), Options{}) {}
  TestServer(const TestServer&) = delete;
  TestServer& operator=(const TestServer&) = delete;
  ~TestServer() {
    stopping_ = true;
    shutdown(listen_fd_, SHUT_RDWR);
    shutdown(client_fd_, SHUT_RDWR);
    if (thread_.joinable()) thread_.join();
    close(listen_fd_);
    SSL_CTX_free(context_);
  }

  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] int requests() const { return requests_; }
  /// For handlers without an answer: waits until the client or the server gives up.
  void wait_for_end() const {
    pollfd waiting{.fd = client_fd_, .events = POLLRDHUP, .revents = 0};
    poll(&waiting, 1, 20'000);
  }
  [[nodiscard]] bool is_stopping() const { return stopping_; }

 private:
  void run() {
    while (!stopping_) {
      const int fd = accept4(listen_fd_, nullptr, nullptr, SOCK_CLOEXEC);
      if (fd < 0) return;
      client_fd_ = fd;
      serve(fd);
      client_fd_ = -1;
      close(fd);
    }
  }
  void serve(int fd) {
    SSL* tls = nullptr;
    if (context_ != nullptr) {
      tls = SSL_new(context_);
      SSL_set_fd(tls, fd);
    }
    if (tls == nullptr || SSL_accept(tls) == 1) {
      TestConnection connection(fd, tls);
      std::string request;
      while (!stopping_ && connection.read_request(request)) {
        ++requests_;
        if (!handler_(connection, request)) break;
      }
    }
    SSL_free(tls);
  }

  Handler handler_;
  SSL_CTX* context_ = nullptr;
  int listen_fd_ = -1;
  std::atomic<int> client_fd_ = -1;
  std::uint16_t port_ = 0;
  std::atomic<int> requests_ = 0;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace bess
