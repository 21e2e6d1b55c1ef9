#include "shared/host/file.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>

#include "shared/host/unfinished_files.h"
#include "shared/host/user_error.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

bool is_gzip_name(const fs::path& path) { return path.extension() == ".gz"; }

std::string gzip(std::string_view contents) {
  z_stream stream{};
  constexpr int kGzipWindowBits = 15 + 16;
  if (deflateInit2(&stream, 6, Z_DEFLATED, kGzipWindowBits, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
    fail("zlib cannot start compressing");
  }
  std::string out(deflateBound(&stream, contents.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(contents.data()));
  stream.avail_in = static_cast<uInt>(contents.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int status = deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  if (status != Z_STREAM_END) fail("zlib failed to compress ({})", status);
  return out;
}

/// Removes what a killed process left beside `target`: `target.part.PID` of a PID that runs no more.
void remove_stale_parts(const fs::path& target) {
  const std::string prefix = target.filename().string() + ".part.";
  std::error_code error;
  const fs::path folder = target.has_parent_path() ? target.parent_path() : ".";
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix)) continue;
    pid_t pid = 0;
    const char* end = name.data() + name.size();
    const auto [stop, bad] = std::from_chars(name.data() + prefix.size(), end, pid);
    const bool gone = bad == std::errc{} && stop == end && kill(pid, 0) != 0 && errno == ESRCH;
    if (gone) fs::remove(entry.path(), error);
  }
}

/// What a symbolic link leads to: the link itself stays.
fs::path resolved(const fs::path& path) {
  std::error_code error;
  if (!fs::is_symlink(fs::symlink_status(path, error))) return path;
  const fs::path target = fs::weakly_canonical(path, error);
  return error ? path : target;
}

/// What will be found under a name once it is committed: a temporary file beside it, which takes the
/// permissions of the file that it replaces and disappears unless it is committed; or the device or
/// pipe of that name itself, which is written to at once.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& name) : target_(resolved(name)) {
    if (is_special_file(target_)) {
      fd_ = open(target_.c_str(), O_WRONLY | O_CLOEXEC);
    } else {
      remove_stale_parts(target_);
      beside_ = target_.string() + ".part." + std::to_string(getpid());
      unlink(beside_.c_str());  // whatever was put there, a link as well: never followed
      unfinished_.emplace(beside_);
      fd_ = open(beside_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644);
      unfinished_->made();
    }
    if (fd_ < 0) fail("{}: cannot write here: {}", target_.string(), std::strerror(errno));
    struct stat before {};
    if (!beside_.empty() && stat(target_.c_str(), &before) == 0) {
      fchmod(fd_, before.st_mode & 07777);
    }
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (fd_ >= 0) close(fd_);
    if (!beside_.empty()) unlink(beside_.c_str());
  }

  void write(std::string_view contents) {
    while (!contents.empty()) {
      const ssize_t written = ::write(fd_, contents.data(), contents.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) give_up();
      contents.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  void commit() {
    const bool is_file = !beside_.empty();  // a pipe cannot be synced
    if (is_file && fsync(fd_) != 0 && errno != EINVAL) give_up();
    const int status = close(fd_);
    fd_ = -1;
    if (status != 0) give_up();
    if (is_file && rename(beside_.c_str(), target_.c_str()) != 0) give_up();
    beside_.clear();
  }

 private:
  [[noreturn]] void give_up() const {
    fail("{}: writing failed: {}; nothing was changed", target_.string(), std::strerror(errno));
  }

  fs::path target_;
  std::string beside_;  ///< the temporary file; empty for a device, and once committed
  std::optional<UnfinishedFile> unfinished_;
  int fd_ = -1;
};

/// What many programs take for their output would become a file of that name.
void require_a_name(const fs::path& path) {
  if (path.empty()) fail("the name of the file to write is empty; give one");
  if (*path.begin() != "-") return;
  fail(
      "{}: means the standard output elsewhere; what is written here is renamed once complete, so "
      "give a file's name (./- for one called -)",
      path.string());
}

void create_parent(const fs::path& path) {
  require_a_name(path);
  if (!path.has_parent_path()) return;
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (error) fail("{}: cannot create: {}", path.parent_path().string(), error.message());
}

}  // namespace

bool is_special_file(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

std::string read_file(const fs::path& path) {
  if (fs::is_directory(path)) fail("{}: is a folder, not a file", path.string());
  gzFile file = gzopen(path.c_str(), "rb");  // reads plain files as they are
  if (file == nullptr) fail("{}: cannot open: {}", path.string(), std::strerror(errno));
  std::string contents;
  constexpr std::size_t kChunk = 1 << 20;
  int got = 0;
  do {
    const std::size_t size = contents.size();
    contents.resize(size + kChunk);
    got = gzread(file, contents.data() + size, kChunk);
    contents.resize(size + static_cast<std::size_t>(std::max(got, 0)));
  } while (got > 0);
  const bool is_plain = gzdirect(file) == 1;
  int status = Z_OK;
  const std::string reason = gzerror(file, &status);
  const int close_status = gzclose(file);
  if (got < 0 || close_status == Z_BUF_ERROR || status == Z_BUF_ERROR) {
    fail("{}: truncated or damaged gzip file ({}); fetch or copy it again", path.string(),
         reason.empty() ? "unexpected end" : reason);
  }
  if (is_plain && is_gzip_name(path) && contents.find('\0') != contents.npos) {
    fail("{}: its name says gzip, its content is not; fetch or copy it again", path.string());
  }
  return contents;
}

void require_writable(const fs::path& path) {
  create_parent(path);
  if (fs::is_directory(path)) fail("{}: is a folder, not a file", path.string());
  if (is_special_file(path)) return;  // opening a pipe would wait for its reader
  const TemporaryFile probe(path);    // made and removed again
}

void write_file(const fs::path& path, std::string_view contents) {
  create_parent(path);
  TemporaryFile file(path);
  if (is_gzip_name(path)) {
    file.write(gzip(contents));
  } else {
    file.write(contents);
  }
  file.commit();
}

}  // namespace bess
