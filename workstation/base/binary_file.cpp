#include "workstation/base/binary_file.h"

#include "shared/crc32.h"
#include "shared/host/file.h"

namespace bess {
namespace {

std::uint32_t crc_of(std::string_view bytes) {
  Crc32 crc;
  crc.add_bytes(bytes.data(), bytes.size());
  return crc.value();
}

}  // namespace

void BinaryWriter::save(const std::filesystem::path& path) {
  put(crc_of(bytes_));
  write_file(path, bytes_);
}

BinaryReader::BinaryReader(const std::filesystem::path& path, std::string_view magic,
                           std::uint32_t version, std::string_view kind, std::string_view remedy,
                           std::uint32_t version_min)
    : name_(path.string()), kind_(kind), remedy_(remedy), bytes_(read_file(path)), rest_(bytes_) {
  if (!rest_.starts_with(magic)) fail("{}: not a {}; {}", name_, kind_, remedy_);
  rest_.remove_prefix(magic.size());
  version_ = take<std::uint32_t>();
  if (version_min == 0) version_min = version;
  if (version_ > version || version_ < version_min) {
    const std::string read = version_min == version
                                 ? std::to_string(version)
                                 : std::to_string(version_min) + " to " + std::to_string(version);
    fail("{}: {} version {}, this program reads {}; {}", name_, kind_, version_, read, remedy_);
  }
  std::uint32_t checksum = 0;
  if (rest_.size() < sizeof checksum) damaged("is truncated");
  std::memcpy(&checksum, rest_.data() + rest_.size() - sizeof checksum, sizeof checksum);
  rest_.remove_suffix(sizeof checksum);
  const std::string_view body = std::string_view(bytes_).substr(0, bytes_.size() - sizeof checksum);
  if (checksum != crc_of(body)) {
    fail("{}: {} is damaged (checksum differs); {}", name_, kind_, remedy_);
  }
}

}  // namespace bess
