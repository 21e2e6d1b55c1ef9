// What systemd is told (sd_notify(3)): ready, alive, status line, stopping. One datagram to the
// socket named in NOTIFY_SOCKET; without it every call does nothing. Never waits, never allocates.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <cstdint>

#include "edge/core/control/control_types.h"

namespace bess {

class ServiceNotify {
 public:
  ServiceNotify();
  ServiceNotify(const ServiceNotify&) = delete;
  ServiceNotify& operator=(const ServiceNotify&) = delete;
  ~ServiceNotify();

  /// The start may take this much longer than the unit says.
  void extend_start(std::int64_t seconds) const;
  void ready() const;
  /// After each cycle: the status line, and WATCHDOG=1 when the cycle was good. Good means that the
  /// controller itself works: it finished in time, no tick was missed since the last one. A battery
  /// or a price server that is away is a mode of the controller; a restart would not mend it.
  void cycle_done(const CycleRecord& record);
  void stopping() const;

 private:
  void send(const char* text) const;

  int fd_ = -1;
  sockaddr_un address_{};
  socklen_t address_bytes_ = 0;
  std::int32_t missed_ticks_before_ = 0;
};

}  // namespace bess
