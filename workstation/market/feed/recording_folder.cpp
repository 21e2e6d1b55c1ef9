#include "workstation/market/feed/recording_folder.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <utility>

#include "shared/file_descriptor.h"
#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/market/feed/market_files.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLockName = ".recorder.lock";
constexpr std::int64_t kLateRows_s = 3600;  // a day's last rows arrive after its end

/// A new name is on the disk only when its folder is.
void sync_folder(const fs::path& folder) {
  const FileDescriptor fd(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() >= 0) fsync(fd.get());  // some file systems cannot
}

std::string provenance_of(const LocalDate& day, std::int64_t minutes, const std::string& source) {
  return fmt::format(
      "Recorded by bess-train {} prices record from {}\n"
      "{}\n"
      "Local day {} in Brussels, {} minutes: ods161 (indicative imbalance price, EUR/MWh) and "
      "ods169 "
      "(system imbalance, MW, negative = short)\n"
      "A line holds what arrived of a minute; further lines of it add to it or revise it; of its "
      "prices the first counts. A price that arrived empty was published without one\n"
      "arrival: seen = the look before did not show it yet; found = it may have been there for "
      "long",
      BESS_VERSION, source, attribution_of({MarketSource::kElia}), format_local_date(day), minutes);
}

/// The recorder that ends takes its lock file away: a lock on what is no longer there is none.
bool is_still_there(int fd, const std::string& path) {
  struct stat held {};
  struct stat named {};
  return fstat(fd, &held) == 0 && stat(path.c_str(), &named) == 0 && held.st_ino == named.st_ino &&
         held.st_dev == named.st_dev;
}

[[noreturn]] void fail_locked(const fs::path& folder, int fd) {
  char pid[16] = "";
  const ssize_t size = pread(fd, pid, sizeof pid - 1, 0);
  fail("{}: another recorder writes here{}; stop it or choose another folder", folder.string(),
       size > 0 ? fmt::format(" (process {})", one_line(pid)) : "");
}

}  // namespace

/// The folder, made if need be, and this recorder's own. When nothing was recorded, nothing is
/// left.
class RecordingFolder::Lock {
 public:
  explicit Lock(const fs::path& folder) : folder_(folder), path_((folder / kLockName).string()) {
    std::error_code error;
    was_made_ = fs::create_directories(folder, error);
    if (error) fail("{}: cannot create: {}", folder.string(), error.message());
    do {
      fd_.emplace(open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
      if (fd_->get() < 0) fail("{}: cannot write here: {}", path_, std::strerror(errno));
      if (flock(fd_->get(), LOCK_EX | LOCK_NB) == 0) continue;
      if (errno == EWOULDBLOCK) fail_locked(folder, fd_->get());
      fail("{}: cannot be locked: {}", path_, std::strerror(errno));
    } while (!is_still_there(fd_->get(), path_));
    const std::string pid = fmt::format("{}\n", getpid());
    // Only a message would miss it.
    [[maybe_unused]] const bool named =
        ftruncate(fd_->get(), 0) == 0 && pwrite(fd_->get(), pid.data(), pid.size(), 0) > 0;
  }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
  ~Lock() {
    unlink(path_.c_str());
    if (was_made_) rmdir(folder_.c_str());  // stays when a day is in it
  }

 private:
  fs::path folder_;
  std::string path_;
  bool was_made_ = false;
  std::optional<FileDescriptor> fd_;
};

/// One file, open for appending.
class RecordingFolder::Day {
 public:
  Day(const fs::path& folder, const LocalDate& date, const std::string& source)
      : path_(folder / (format_local_date(date) + ".csv")),
        end_utc_s_(local_midnight_utc_s(add_days(date, 1))),
        minutes_((end_utc_s_ - local_midnight_utc_s(date)) / 60) {
    const std::string text = fs::exists(path_) ? read_file(path_) : std::string();
    if (text.empty()) {
      write_file(path_, recorded_head(provenance_of(date, minutes_, source)));
      sync_folder(folder);
    } else if (!is_recorded_csv(text)) {
      fail("{}: is not a day of this recorder; move it away", path_.string());
    }
    for (const RecordedLine& line : parse_recorded_day(text, path_.string())) note(line);
    file_ = std::make_unique<FileDescriptor>(open(path_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC));
    if (file_->get() < 0) give_up("cannot write here", 0);
    size_ = static_cast<std::int64_t>(fs::file_size(path_));
    if (!text.empty()) mend(text);
  }

  [[nodiscard]] RecordedMinute recorded(std::int64_t minute_utc_s) const {
    const auto found = minutes_known_.find(minute_utc_s);
    return found == minutes_known_.end() ? RecordedMinute{} : found->second;
  }

  void append(std::span<const RecordedLine> lines) {
    std::string text;
    for (const RecordedLine& line : lines) text += format_recorded_line(line);
    write(text, lines.size());
    for (const RecordedLine& line : lines) note(line);
    appended_ = true;
  }

  [[nodiscard]] std::int64_t end_utc_s() const { return end_utc_s_; }
  [[nodiscard]] bool appended() const { return appended_; }
  [[nodiscard]] const std::string& mended() const { return mended_; }
  [[nodiscard]] RecordedDaySummary summary() const {
    RecordedDaySummary result{path_.filename().string(), 0, minutes_};
    for (const auto& [minute, known] : minutes_known_) result.minutes_with_price += known.had_price;
    return result;
  }

 private:
  void note(const RecordedLine& line) {
    RecordedMinute& minute = minutes_known_[line.minute_utc_s];
    if (line.price_eur_per_mwh) {
      minute.price_eur_per_mwh = line.price_eur_per_mwh->value;
      minute.quality = line.quality;
      minute.had_price = minute.had_price || is_published(line.price_eur_per_mwh->value);
    }
    if (line.system_imbalance_mw) minute.system_imbalance_mw = line.system_imbalance_mw->value;
  }

  /// Cuts a torn line off; whole ones stay.
  void mend(std::string_view text) {
    const WholePart whole = whole_part(text);
    if (whole.text.size() < text.size()) {
      cut(static_cast<std::int64_t>(whole.text.size()));
      mended_ = fmt::format("its last line was torn: {} cut off",
                            counted(text.size() - whole.text.size(), "byte"));
    }
    if (!whole.lacks_line_end) return;
    write("\n", 0);
    mended_ += mended_.empty() ? "its last line had no end: ended" : "; the line before it ended";
  }

  void cut(std::int64_t size) {
    if (ftruncate(file_->get(), size) != 0) give_up("cannot be mended", 0);
    size_ = size;
  }

  /// All of it on the disk, or nothing of it.
  void write(std::string_view text, std::size_t lines) {
    std::string_view rest = text;
    while (!rest.empty()) {
      const ssize_t written = ::write(file_->get(), rest.data(), rest.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) take_back("writing failed", lines);
      rest.remove_prefix(static_cast<std::size_t>(written));
    }
    if (fdatasync(file_->get()) != 0) take_back("writing failed", lines);
    size_ += static_cast<std::int64_t>(text.size());
  }

  [[noreturn]] void take_back(const char* what, std::size_t lines) {
    const int reason = errno;
    // If this fails too, the torn line is cut off at the next start.
    [[maybe_unused]] const int cut_off = ftruncate(file_->get(), size_);
    errno = reason;
    give_up(what, lines);
  }

  [[noreturn]] void give_up(const char* what, std::size_t lines) const {
    const char* reason = std::strerror(errno);
    fail(
        "{}: {}: {}; {}what it held is kept. Mend that and start the recorder again: it takes what "
        "the "
        "source still has of today",
        path_.string(), what, reason,
        lines == 0 ? "" : counted(lines, "new line") + " not recorded, ");
  }

  fs::path path_;
  std::int64_t end_utc_s_, minutes_;
  std::int64_t size_ = 0;  ///< of what is whole
  std::unique_ptr<FileDescriptor> file_;
  std::map<std::int64_t, RecordedMinute> minutes_known_;
  bool appended_ = false;
  std::string mended_;
};

RecordingFolder::RecordingFolder(
    fs::path folder, std::string source,
    std::function<void(const std::string&, const std::string&)> tell_mended)
    : folder_(std::move(folder)),
      source_(std::move(source)),
      tell_mended_(std::move(tell_mended)),
      lock_(std::make_unique<Lock>(folder_)) {}

RecordingFolder::~RecordingFolder() = default;

RecordingFolder::Day& RecordingFolder::day_of(std::int64_t minute_utc_s) {
  const LocalDate date = local_date_of(minute_utc_s);
  std::unique_ptr<Day>& day = days_[date];
  if (!day) {
    day = std::make_unique<Day>(folder_, date, source_);
    if (!day->mended().empty()) tell_mended_(format_local_date(date) + ".csv", day->mended());
  }
  return *day;
}

RecordedMinute RecordingFolder::recorded(std::int64_t minute_utc_s) {
  return day_of(minute_utc_s).recorded(minute_utc_s);
}

void RecordingFolder::append(std::span<const RecordedLine> lines) {
  while (!lines.empty()) {
    const LocalDate date = local_date_of(lines.front().minute_utc_s);
    std::size_t count = 1;
    while (count < lines.size() && local_date_of(lines[count].minute_utc_s) == date) ++count;
    day_of(lines.front().minute_utc_s).append(lines.first(count));
    lines = lines.subspan(count);
  }
}

std::vector<RecordedDaySummary> RecordingFolder::close_days_before(
    std::int64_t newest_minute_utc_s) {
  std::vector<RecordedDaySummary> closed;
  std::erase_if(days_, [&](const auto& entry) {
    if (newest_minute_utc_s < entry.second->end_utc_s() + kLateRows_s) return false;
    if (entry.second->appended()) closed.push_back(entry.second->summary());
    return true;
  });
  return closed;
}

}  // namespace bess
