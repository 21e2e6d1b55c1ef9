#include "edge/app/program/service_notify.h"

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace bess {

ServiceNotify::ServiceNotify() {
  const char* const name = std::getenv("NOTIFY_SOCKET");
  if (name == nullptr || (name[0] != '/' && name[0] != '@')) return;
  const std::size_t length = std::strlen(name);
  if (length >= sizeof address_.sun_path) return;
  address_.sun_family = AF_UNIX;
  std::memcpy(address_.sun_path, name, length);
  if (name[0] == '@') address_.sun_path[0] = '\0';  // abstract namespace: no file, no final 0
  address_bytes_ = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + length);
  fd_ = FileDescriptor(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
}

void ServiceNotify::extend_start(std::int64_t seconds) const {
  char text[64];
  std::snprintf(text, sizeof text, "EXTEND_TIMEOUT_USEC=%lld",
                static_cast<long long>(seconds) * 1'000'000);
  send(text);
}

void ServiceNotify::ready() const { send("READY=1\nSTATUS=waiting for the first tick"); }

void ServiceNotify::stopping() const { send("STOPPING=1\nSTATUS=releasing the battery"); }

void ServiceNotify::cycle_done(const CycleRecord& r) {
  const bool is_good = r.missed_ticks == missed_ticks_before_;
  missed_ticks_before_ = r.missed_ticks;
  char text[256];
  std::snprintf(
      text, sizeof text, "%sSTATUS=%s: %d W ordered (%s), SoC %d.%d %%, battery %s, prices %s",
      is_good ? "WATCHDOG=1\n" : "", mode_name(r.mode).data(), r.ordered_power_w,
      reason_name(r.reason).data(), r.measurement.soc_e4 / 100, r.measurement.soc_e4 % 100 / 10,
      status_name(r.battery_status).data(), status_name(r.price.status).data());
  send(text);
}

void ServiceNotify::send(const char* text) const {
  if (fd_.get() < 0) return;
  const auto* to = reinterpret_cast<const sockaddr*>(&address_);
  const ssize_t ignored =
      sendto(fd_.get(), text, std::strlen(text), MSG_DONTWAIT | MSG_NOSIGNAL, to, address_bytes_);
  static_cast<void>(ignored);
}

}  // namespace bess
