#include "edge/app/storage/operator_files.h"

#include <sys/stat.h>

#include <cerrno>
#include <charconv>
#include <cstdio>

#include "edge/records/log/atomic_file.h"
#include "shared/scaled_clock.h"
#include "shared/utc_text.h"

namespace bess {

namespace {

constexpr std::string_view kBeforePower = "bess-hold 1 power_w=";
constexpr std::size_t kPowerCharacters = 10;
constexpr std::string_view kBeforeUntil = " until=";
constexpr std::size_t kUntilCharacters = 20;

constexpr Hold kUnreadable{.unreadable = true};

/// Hold of one place, with its time.
struct StoredHold {
  Hold hold;
  bool is_there = false;
  std::int64_t given_ns = 0;

  [[nodiscard]] bool counts() const { return is_there && !hold.unreadable; }
};

StoredHold read_stored_hold(const char* path) {
  struct stat facts {};
  if (lstat(path, &facts) != 0 && errno == ENOENT) return {};
  return {.hold = read_hold(path),
          .is_there = true,
          .given_ns = facts.st_mtim.tv_sec * kNanosecondsPerSecond + facts.st_mtim.tv_nsec};
}

}  // namespace

HoldText format_hold(const Hold& hold) {
  char text[160];
  const int length =
      std::snprintf(text, sizeof text, "%s%+010d%s%s", kBeforePower.data(), hold.power_w,
                    kBeforeUntil.data(), utc_text(std::int64_t{hold.until_utc_s}).c_str());
  const auto end = static_cast<std::size_t>(length);
  std::snprintf(text + end, sizeof text - end, "%s",
                checksum_end({text, end}, kLineChecksum).c_str());
  return {text};
}

Hold parse_hold(std::string_view text) {
  if (text.size() != kHoldFileBytes) return kUnreadable;
  const char* const power = text.data() + kBeforePower.size();
  const std::size_t sign_characters = *power == '+' ? 1 : 0;  // from_chars takes none
  Hold hold;
  std::int64_t until_utc_s = 0;
  const auto read =
      std::from_chars(power + sign_characters, power + kPowerCharacters, hold.power_w);
  const std::string_view until(power + kPowerCharacters + kBeforeUntil.size(), kUntilCharacters);
  if (read.ec != std::errc{} || !parse_utc(until, until_utc_s)) return kUnreadable;
  if (until_utc_s < 0 || until_utc_s >= UINT32_MAX) return kUnreadable;
  hold.until_utc_s = static_cast<std::uint32_t>(until_utc_s);
  // Checks all other characters and the checksum: formatting the hold must give the same text.
  return format_hold(hold) == text ? hold : kUnreadable;
}

Hold read_hold(const char* path) {
  char text[kHoldFileBytes + 1];  // one more, to detect a longer file
  const ssize_t size = read_beginning(path, text, SymlinkPolicy::kRefused);
  if (size < 0) return errno == ENOENT ? Hold{} : kUnreadable;
  return parse_hold({text, static_cast<std::size_t>(size)});
}

HoldReading read_newest_hold(const StateFilePaths& paths) {
  const StoredHold of_state = read_stored_hold(paths.state.c_str());
  const StoredHold of_run = paths.run.empty() ? StoredHold{} : read_stored_hold(paths.run.c_str());
  if (!of_state.counts() && !of_run.counts()) {
    return {.hold = {.unreadable = of_state.is_there || of_run.is_there}};
  }
  const bool run_is_newer =
      of_run.counts() && (!of_state.counts() || of_run.given_ns > of_state.given_ns);
  return {.hold = run_is_newer ? of_run.hold : of_state.hold,
          .state_is_lost = of_state.is_there && !of_state.counts(),
          .run_is_lost = of_run.is_there && !of_run.counts()};
}

Status LimitFile::read(OutsideLimit& limit, bool& is_set) const {
  is_set = false;
  char text[kLimitBytesMax + 1];
  const ssize_t size = read_beginning(path, text, SymlinkPolicy::kFollowed);
  if (size < 0 && errno == ENOENT) return Status::kOk;
  if (size < 0 || size > static_cast<ssize_t>(kLimitBytesMax)) return Status::kMalformed;
  const Status status = parse_outside_limit({text, static_cast<std::size_t>(size)}, limit);
  is_set = status == Status::kOk;
  return status;
}

}  // namespace bess
