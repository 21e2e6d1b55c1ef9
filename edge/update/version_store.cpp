#include "edge/update/version_store.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>

#include "edge/log/whole_file.h"
#include "edge/update/texts.h"
#include "shared/host/errno_text.h"
#include "shared/host/run_program.h"

namespace bess {
namespace {

constexpr std::int64_t kCopyS = 120;  ///< a slow card, two megabytes
constexpr std::size_t kReserveBytes = 256 * 1024;

void remove(const std::string& path) {
  std::error_code ignored;
  std::filesystem::remove_all(path, ignored);
}

}  // namespace

bool is_version_name(std::string_view version) {
  constexpr std::string_view kAllowed =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.+~:-";
  return !version.empty() && version.size() < 120 && version.front() != '.' &&
         version.find_first_not_of(kAllowed) == std::string_view::npos;
}

std::string VersionStore::folder_of(std::string_view version) const {
  return folder().append("/versions/").append(version);
}

std::string VersionStore::program_of(std::string_view version) const {
  return folder_of(version).append("/bin/bess-edge");
}

std::vector<std::string> VersionStore::kept() const {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder() + "/versions", ignored)) {
    names.push_back(entry.path().filename().string());
  }
  return names;
}

bool VersionStore::is_whole(const std::string& folder, std::string& error) {
  const std::string sums = text_of(folder + "/SUMS");
  for (const std::string_view file :
       {"  bin/bess-edge\n", "  share/certificate.json\n", "  share/student_weights.h\n"}) {
    if (sums.find(file) != std::string::npos) continue;
    return refuse(error, {folder, "/SUMS: does not name", file.substr(1, file.size() - 2)});
  }
  const ProgramResult run = run_and_hear(
      {"env", "-C", folder, "sha256sum", "--check", "--strict", "--quiet", "SUMS"}, kCopyS);
  if (run.is_well()) return true;
  const std::string first = run.output.substr(0, run.output.find('\n'));
  return refuse(error, {folder, ": ", first.empty() ? run.complaint() : first});
}

bool VersionStore::has_whole(std::string_view version) const {
  std::string ignored;
  return is_version_name(version) && is_whole(folder_of(version), ignored);
}

VersionStore::Kept VersionStore::keep(std::string_view version, const std::string& from,
                                      std::string& error) const {
  const auto no_room = [&](std::initializer_list<std::string_view> why) {
    refuse(error, why);
    return Kept::kNoRoom;
  };
  if (!is_version_name(version)) {
    refuse(error, {version, ": is no version of a package"});
    return Kept::kRefused;
  }
  if (!is_whole(from, error)) return Kept::kRefused;
  const std::string place = folder_of(version);
  const bool is_known = text_of(place + "/SUMS") == text_of(from + "/SUMS");
  if (is_known && is_whole(place, error)) return Kept::kWhole;
  const bool is_in_use = pointed("current") == version || pointed("confirmed") == version;
  if (is_in_use && !is_known) {
    refuse(error, {version, " is kept already, with other bytes: give it another version"});
    return Kept::kRefused;
  }
  const std::string copy = place + ".new";
  std::error_code failed;
  std::filesystem::create_directories(folder() + "/versions", failed);
  remove(copy);
  const ProgramResult copied = run_and_hear({"cp", "-a", "--", from, copy}, kCopyS);
  if (!copied.is_well() || !run_and_hear({"sync", "-f", copy}, kCopyS).is_well() ||
      !is_whole(copy, error)) {
    remove(copy);
    const std::string why(copied.is_well() ? std::string_view(error) : copied.complaint());
    return no_room({version, " cannot be kept: ", why});
  }
  remove(place);
  if (rename(copy.c_str(), place.c_str()) != 0) {
    return no_room({place, ": ", errno_text(errno)});
  }
  sync_folder_of(place.c_str());
  return Kept::kWhole;
}

std::string VersionStore::pointed(std::string_view link) const {
  std::array<char, 256> target{};
  const std::string path = folder().append("/").append(link);
  const ssize_t size = readlink(path.c_str(), target.data(), target.size());
  const std::string_view text(target.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  constexpr std::string_view kBefore = "versions/";
  return text.starts_with(kBefore) ? std::string(text.substr(kBefore.size())) : std::string();
}

bool VersionStore::point(std::string_view link, std::string_view version,
                         std::string& error) const {
  if (pointed(link) == version) return true;
  const std::string program = program_of(version);
  if (access(program.c_str(), X_OK) != 0) return refuse(error, {program, ": ", errno_text(errno)});
  const std::string path = folder().append("/").append(link);
  const std::string beside = path + ".new";
  const std::string target = std::string("versions/").append(version);
  unlink(beside.c_str());
  if (symlink(target.c_str(), beside.c_str()) != 0 || rename(beside.c_str(), path.c_str()) != 0) {
    return refuse(error, {path, ": ", errno_text(errno)});
  }
  sync_folder_of(path.c_str());
  return true;
}

void VersionStore::prune(const std::vector<std::string>& wanted) const {
  const std::string current = pointed("current");
  const std::string confirmed = pointed("confirmed");
  for (const std::string& name : kept()) {
    const bool is_wanted = name == current || name == confirmed ||
                           std::find(wanted.begin(), wanted.end(), name) != wanted.end();
    if (!is_wanted) remove(folder_of(name));
  }
}

void VersionStore::reserve() const {
  const std::string path = folder() + "/reserve";
  std::error_code ignored;
  if (std::filesystem::file_size(path, ignored) == kReserveBytes) return;
  static_cast<void>(replace_file(path.c_str(), std::string(kReserveBytes, '.')));
}

bool VersionStore::use_reserve() const { return unlink((folder() + "/reserve").c_str()) == 0; }

}  // namespace bess
