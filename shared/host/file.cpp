#include "shared/host/file.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstring>
#include <optional>
#include <utility>

#include "shared/file_descriptor.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"

namespace bess {

namespace {

namespace fs = std::filesystem;

/// Path of a name, whether the file exists or not.
fs::path place_of(const fs::path& path) {
  std::error_code error;
  const fs::path place = fs::weakly_canonical(fs::absolute(path), error);
  return error ? fs::absolute(path).lexically_normal() : place;
}

bool is_same_file(const fs::path& a, const fs::path& b) {
  if (a.empty() || b.empty() || is_special_file(a) || is_special_file(b)) return false;
  std::error_code error;
  return fs::equivalent(a, b, error) || place_of(a) == place_of(b);
}

struct Slot {
  std::atomic<bool> is_taken{false};
  std::atomic<bool> is_named{false};
  char path[PATH_MAX];
};
std::array<Slot, 16> slots;  // more than the usual number of writing threads
std::atomic<bool> is_ending{false};

/// Opens for reading. Waits for the writer of a pipe, but not forever.
int open_to_read(const fs::path& path) {
  const int fd = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  struct stat info {};
  if (fd < 0 || fstat(fd, &info) != 0 || !S_ISFIFO(info.st_mode)) return fd;
  constexpr int kWriterWait_ms = 10'000;
  pollfd waiting{.fd = fd, .events = POLLIN, .revents = 0};
  if (poll(&waiting, 1, kWriterWait_ms) == 0) {
    close(fd);
    fail("{}: pipe without data for {} s; start its writer, or use a file", path.string(),
         kWriterWait_ms / 1000);
  }
  fcntl(fd, F_SETFL, fcntl(fd, F_GETFL) & ~O_NONBLOCK);
  return fd;
}

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

/// Removes files `target.part.PID` of processes that no longer run.
void remove_stale_parts(const fs::path& target) {
  const std::string prefix = target.filename().string() + ".part.";
  std::error_code error;
  const fs::path folder = target.has_parent_path() ? target.parent_path() : ".";
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix)) continue;
    pid_t pid = 0;
    const bool is_pid = read_number(std::string_view(name).substr(prefix.size()), pid);
    if (is_pid && kill(pid, 0) != 0 && errno == ESRCH) fs::remove(entry.path(), error);
  }
}

/// Target of a symbolic link; the link itself remains.
fs::path resolved(const fs::path& path) {
  std::error_code error;
  if (!fs::is_symlink(fs::symlink_status(path, error))) return path;
  const fs::path target = fs::weakly_canonical(path, error);
  if (error) fail("{}: cannot write here: {}", path.string(), errno_text(error.value()));
  return target;
}

/// Temporary file in the same folder with the permissions of the file that it replaces, removed
/// unless committed. A device or pipe is written directly.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& name) : target_(resolved(name)) {
    if (is_special_file(target_)) {
      fd_ = open(target_.c_str(), O_WRONLY | O_CLOEXEC);
    } else {
      remove_stale_parts(target_);
      beside_ = target_.string() + ".part." + std::to_string(getpid());
      unlink(beside_.c_str());  // also a link, which is never followed
      unfinished_.emplace(beside_);
      fd_ = open(beside_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644);
      unfinished_->made();
    }
    if (fd_ < 0) fail("{}: cannot write here: {}", target_.string(), errno_text(errno));
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
  std::string beside_;  ///< temporary file; empty for a device, and after commit
  std::optional<UnfinishedFile> unfinished_;
  int fd_ = -1;
};

/// Refuses "-", which would become a file of that name.
void require_a_name(const fs::path& path) {
  if (path.empty()) fail("the name of the output file is empty; give a name");
  if (*path.begin() != "-") return;
  fail(
      "{}: standard output is not supported, because complete files are renamed; give a file name "
      "(./- for a file named -)",
      path.string());
}

void create_parent(const fs::path& path) {
  require_a_name(path);
  if (!path.has_parent_path()) return;
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (!error) return;
  for (fs::path at = path.parent_path(); at.has_relative_path(); at = at.parent_path()) {
    std::error_code ignored;
    if (!fs::exists(at, ignored) || fs::is_directory(at, ignored)) continue;
    fail("{}: is a file, not a folder; choose another name", at.string());
  }
  fail("{}: cannot create: {}", path.parent_path().string(), error.message());
}

/// Content of a plain or gzip file (one or more members) during reading, bounded: a small gzip file
/// can unpack to gigabytes.
class GzipFile {
 public:
  /// `head`: the first bytes of the file, which show its kind.
  GzipFile(std::string name, std::size_t bytes_max, std::string_view head)
      : name_(std::move(name)), bytes_max_(bytes_max), is_gzip_(head.starts_with(kMark)) {
    constexpr int kGzipWindowBits = 15 + 16;
    if (is_gzip_ && inflateInit2(&stream_, kGzipWindowBits) != Z_OK) {
      fail("zlib cannot start unpacking");
    }
  }
  GzipFile(const GzipFile&) = delete;
  GzipFile& operator=(const GzipFile&) = delete;
  ~GzipFile() {
    if (is_gzip_) inflateEnd(&stream_);
  }

  void add(std::string_view bytes) {
    if (!is_gzip_) return append(bytes);
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream_.avail_in = static_cast<uInt>(bytes.size());
    while (stream_.avail_in > 0) {
      if (is_member_over_) begin_member();
      stream_.next_out = reinterpret_cast<Bytef*>(unpacked_.data());
      stream_.avail_out = static_cast<uInt>(unpacked_.size());
      const int status = inflate(&stream_, Z_NO_FLUSH);
      if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR) {
        damaged(stream_.msg == nullptr ? "no gzip data" : stream_.msg);
      }
      append(std::string_view(unpacked_).substr(0, unpacked_.size() - stream_.avail_out));
      is_member_over_ = status == Z_STREAM_END;
    }
  }
  /// Content after all bytes were added.
  std::string finish() {
    if (is_gzip_ && !is_member_over_) damaged("unexpected end");
    return std::move(contents_);
  }
  [[nodiscard]] bool is_gzip() const { return is_gzip_; }

 private:
  static constexpr std::string_view kMark = "\x1F\x8B";

  /// gzip files may be concatenated; other bytes are an error.
  void begin_member() {
    if (*stream_.next_in != static_cast<Bytef>(kMark[0])) {
      fail("{}: extra bytes after the gzip data; download or copy it again", name_);
    }
    if (inflateReset(&stream_) != Z_OK) fail("zlib cannot continue unpacking");
    is_member_over_ = false;
  }

  void append(std::string_view bytes) {
    if (contents_.size() + bytes.size() > bytes_max_) {
      fail("{}: larger than {}{}: unexpected file type", name_, size_text(bytes_max_),
           is_gzip_ ? " once unpacked" : "");
    }
    contents_ += bytes;
  }
  static std::string size_text(std::size_t bytes) {
    constexpr std::size_t kMiB = std::size_t{1} << 20;
    return bytes >= kMiB ? std::to_string(bytes / kMiB) + " MiB"
                         : std::to_string(bytes / 1024) + " KiB";
  }
  [[noreturn]] void damaged(const char* reason) const {
    fail("{}: truncated or damaged gzip file ({}); download or copy it again", name_, reason);
  }

  std::string name_;
  std::size_t bytes_max_;
  bool is_gzip_;
  std::string contents_;
  std::string unpacked_ = std::string(1 << 16, '\0');
  z_stream stream_{};
  bool is_member_over_ = false;
};

/// Fills the buffer, unless the file ends before.
std::string_view read_chunk(int fd, const fs::path& path, std::string& buffer) {
  std::size_t size = 0;
  while (size < buffer.size()) {
    const ssize_t got = ::read(fd, buffer.data() + size, buffer.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail("{}: cannot read: {}", path.string(), std::strerror(errno));
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  return std::string_view(buffer).substr(0, size);
}

bool starts_with_any_case(std::string_view text, std::string_view lower) {
  return equals_ignoring_case(text.substr(0, lower.size()), lower);
}

bool is_web_page(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return false;
  text.remove_prefix(first);
  return starts_with_any_case(text, "<!doctype html") || starts_with_any_case(text, "<html");
}

}  // namespace

void require_distinct(const std::vector<NamedPath>& outputs, const std::vector<NamedPath>& inputs) {
  for (auto output = outputs.begin(); output != outputs.end(); ++output) {
    for (const NamedPath& input : inputs) {
      if (!is_same_file(output->path, input.path)) continue;
      fail("{} {}: would replace the input {} {}; use another name", output->option,
           output->path.string(), input.option, input.path.string());
    }
    for (auto other = outputs.begin(); other != output; ++other) {
      if (!is_same_file(output->path, other->path)) continue;
      fail("{} {}: would replace the output of {}; use different names", output->option,
           output->path.string(), other->option);
    }
  }
}

std::vector<NamedPath> named_paths(const std::string& option, const std::vector<std::string>& paths,
                                   const std::vector<NamedPath>& others) {
  std::vector<NamedPath> named = named_files(option, {}, paths);
  named.insert(named.end(), others.begin(), others.end());
  return named;
}

std::vector<NamedPath> named_files(const std::string& option, const std::filesystem::path& folder,
                                   const std::vector<std::string>& names) {
  std::vector<NamedPath> named;
  for (const std::string& name : names) named.push_back({option, folder / name});
  return named;
}

UnfinishedFile::UnfinishedFile(const std::string& path) : path_(path) {
  if (path.empty() || path.size() >= PATH_MAX) return;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    if (slots[i].is_taken.exchange(true)) continue;
    std::memcpy(slots[i].path, path.c_str(), path.size() + 1);
    slots[i].is_named = true;
    slot_ = static_cast<int>(i);
    return;
  }
}

UnfinishedFile::~UnfinishedFile() {
  if (slot_ < 0) return;
  Slot& slot = slots[static_cast<std::size_t>(slot_)];
  slot.is_named = false;
  slot.is_taken = false;
}

void UnfinishedFile::made() const {
  if (!is_ending) return;
  unlink(path_.c_str());
  for (;;) pause();
}

void remove_unfinished_files() {
  is_ending = true;
  for (const Slot& slot : slots) {
    if (slot.is_named) unlink(slot.path);
  }
}

bool is_special_file(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

std::string read_file(const fs::path& path, std::size_t bytes_max) {
  const FileDescriptor file(open_to_read(path));
  if (file.get() < 0) fail("{}: cannot open: {}", path.string(), errno_text(errno));
  struct stat info {};
  if (fstat(file.get(), &info) == 0 && S_ISDIR(info.st_mode)) {
    fail("{}: is a folder, not a file", path.string());
  }
  std::string buffer(1 << 20, '\0');
  std::string_view chunk = read_chunk(file.get(), path, buffer);
  GzipFile whole(path.string(), bytes_max, chunk);
  whole.add(chunk);
  while (chunk.size() == buffer.size()) {
    chunk = read_chunk(file.get(), path, buffer);
    whole.add(chunk);
  }
  std::string contents = whole.finish();
  if (!whole.is_gzip() && is_gzip_name(path) && contents.find('\0') != contents.npos) {
    fail("{}: gzip by name but not by content; download or copy it again", path.string());
  }
  return contents;
}

std::string_view plain_text(std::string_view text, std::string_view name) {
  using namespace std::string_view_literals;
  if (text.starts_with("\x1F\x8B")) {
    fail("{}: contains gzip data (compressed twice, or sent without Content-Encoding): use gunzip",
         name);
  }
  if (text.starts_with("PK\x03\x04")) fail("{}: a ZIP archive: unzip it first", name);
  if (text.starts_with("\xFF\xFE"sv) || text.starts_with("\xFE\xFF"sv)) {
    fail("{}: UTF-16 text: save it as UTF-8", name);
  }
  if (text.find('\0') != std::string_view::npos) {
    fail("{}: contains NUL bytes, possibly UTF-16: save it as UTF-8", name);
  }
  if (text.find('\r') != std::string_view::npos && text.find('\n') == std::string_view::npos) {
    fail("{}: lines end with CR only: save it with LF or CR LF", name);
  }
  text = without_byte_order_mark(text);
  if (is_web_page(text)) {
    fail("{}: a web page, not data (maintenance or a proxy's log-in?)", name);
  }
  return text;
}

void require_writable(const fs::path& path) {
  create_parent(path);
  std::error_code ignored;  // errors show when the file is created
  if (fs::is_directory(path, ignored)) fail("{}: is a folder, not a file", path.string());
  if (is_special_file(path)) return;  // opening a pipe waits for its reader
  const TemporaryFile probe(path);    // created and removed
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
