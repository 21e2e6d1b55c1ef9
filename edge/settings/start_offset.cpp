#include "edge/settings/start_offset.h"

#include <fcntl.h>
#include <unistd.h>

#include "shared/crc32.h"
#include "shared/file_descriptor.h"

namespace bess {

std::int32_t start_offset_ms(std::int32_t spread_s, std::string_view machine_id,
                             std::string_view battery_place) {
  Crc32 crc;
  crc.add_bytes(machine_id.data(), machine_id.size());
  crc.add_bytes(battery_place.data(), battery_place.size());
  // The whole range of the checksum laid over the spread.
  return static_cast<std::int32_t>(
      std::uint64_t{crc.value()} * 1'000 * static_cast<std::uint64_t>(spread_s) >> 32);
}

FixedText<64> machine_id() {
  char text[64] = {};
  const FileDescriptor file(open("/etc/machine-id", O_RDONLY | O_CLOEXEC));
  const ssize_t size = file.get() < 0 ? 0 : read(file.get(), text, 32);
  if (size != 32 && gethostname(text, sizeof text - 1) != 0) return {};
  return {static_cast<const char*>(text)};
}

}  // namespace bess
