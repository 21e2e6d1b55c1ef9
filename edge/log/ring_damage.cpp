#include "edge/log/ring_damage.h"

namespace bess {

void describe_damage(const RingDamage& damage, const char* path, TextBuffer& line) {
  line.add("%s is damaged", path);
  if (damage.is_set_aside) {
    line.add(": nothing in it can be understood; it is set aside as .old, a new one begins");
    return;
  }
  if (damage.header == RingDamage::Header::kFromCopy) {
    line.add("; its header was broken, its copy counts");
  } else if (damage.header == RingDamage::Header::kFromRecords) {
    line.add("; header and copy were broken, and are made anew by the records");
  }
  const auto broken = static_cast<long long>(damage.broken_records);
  if (broken > 0) line.add("; %lld %s lost", broken, broken == 1 ? "record is" : "records are");
  if (damage.missing_records > 0) {
    line.add("; its end is cut off: the places of %lld records are gone",
             static_cast<long long>(damage.missing_records));
  }
  if (damage.newest_lost > 0) {
    line.add("; perhaps %lld of the newest: the last one before counts",
             static_cast<long long>(damage.newest_lost));
  }
}

}  // namespace bess
