#include "edge/storage/run_identity.h"

#include <unistd.h>

#include "edge/control/policy.h"
#include "edge/storage/storage_health.h"

namespace bess {

RunIdentity identity_of_run(const EdgeConfig& config) {
  RunIdentity identity;
  identity.name = config.battery.name;
  identity.version = BESS_VERSION;
  identity.student_hash = student_hash();
  identity.student_provenance = student_provenance();
  identity.trained_from = student_training().first_day;
  identity.trained_until = student_training().last_day;
  identity.context = context_name(student_context().kind);
  identity.map = config.battery.map.name.view();
  identity.variant = config.battery.map.variant.view();
  for (const RegisterPoint& point : config.battery.map.points) {
    identity.point_names.push_back(point.name);
  }
  identity.battery = battery_place(config.battery);
  identity.control = config.control.control;
  identity.pid = getpid();
  identity.start_utc_s = config.clock.now_utc_ns() / kNanosecondsPerSecond;
  identity.wear = card_wear_of(config.state.folder.c_str());
  identity.cadence_ms = kSecondsPerStep * 1'000 / config.clock.scale;
  return identity;
}

}  // namespace bess
