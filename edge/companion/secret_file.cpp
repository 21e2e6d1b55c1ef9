#include "edge/companion/secret_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "shared/file_descriptor.h"

namespace bess {

std::string read_secret(TomlTable& table, const SecretFile& file, std::string& text) {
  std::string path = table.resolved(file.name);
  const auto fail = [&](std::string_view what) {
    table.fail(file.key, std::string("= ").append(path).append(what));
    return path;
  };
  const FileDescriptor descriptor(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat info {};
  if (descriptor.get() < 0 || fstat(descriptor.get(), &info) != 0) {
    return fail(std::string(" cannot be opened: ") + strerror(errno));
  }
  if ((info.st_mode & S_IRWXO) != 0) return fail(" is readable for others: chmod o-rwx it");
  text.resize(file.bytes_max + 1);
  const ssize_t size = read(descriptor.get(), text.data(), text.size());
  text.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
  if (size < 0 || text.size() > file.bytes_max) return fail(std::string(" ").append(file.shape));
  return path;
}

}  // namespace bess
