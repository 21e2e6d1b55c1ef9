#include "edge/program/device_session.h"

#include "edge/log/journal.h"
#include "edge/memory/heap_seal.h"
#include "edge/program/startup.h"

namespace bess {

bool DeviceSession::begin(const EdgeConfig& config) {
  if (!check_student() || !prepare_memory()) return false;
  FileMessage error;
  if (!lock_battery(config, locks_, error)) {
    report(JournalLevel::kError, "%s", error.c_str());
    return false;
  }
  prepare_process();
  clock_.emplace(config.clock);
  return true;
}

}  // namespace bess
