// systemd notifications (sd_notify(3)): ready, alive, status line, stopping. One datagram to the
// socket of NOTIFY_SOCKET; without it every call does nothing. Never waits, never allocates.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <cstdint>

#include "edge/core/control/control_types.h"
#include "shared/file_descriptor.h"

namespace bess {

class ServiceNotify {
 public:
  ServiceNotify();

  /// Extends the start timeout of the unit.
  void extend_start(std::int64_t seconds) const;
  void ready() const;
  /// After each control cycle: the status line, and WATCHDOG=1 if no tick was missed since the last
  /// one. A missing battery or price is a mode of the controller, which a restart would not
  /// correct.
  void cycle_done(const CycleRecord& record);
  void stopping() const;

 private:
  void send(const char* text) const;

  FileDescriptor fd_;
  sockaddr_un address_{};
  socklen_t address_bytes_ = 0;
  std::int32_t missed_ticks_before_ = 0;
};

}  // namespace bess
