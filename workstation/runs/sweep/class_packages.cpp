#include "workstation/runs/sweep/collected.h"

#include <fmt/format.h>

#include <string.h>

#include <algorithm>
#include <map>

#include "shared/host/child_process.h"
#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/base/binary_file.h"
#include "workstation/correction/student/export.h"
#include "workstation/runs/run/run_record.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

void require_host_name(const std::string& id) {
  constexpr const char* kOfAName =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_";
  if (id.find_first_not_of(kOfAName) == id.npos) return;
  fail("site \"{}\" is not a host name: use letters, digits, dots, hyphens and underscores", id);
}

/// Version of the newest package; empty: none.
std::string version_in(const fs::path& folder, const std::string& architecture) {
  const std::string begin = "bess-edge_", end = "_" + architecture + ".deb";
  std::string newest;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(begin) || !name.ends_with(end)) continue;
    std::string version = name.substr(begin.size(), name.size() - begin.size() - end.size());
    if (strverscmp(version.c_str(), newest.c_str()) > 0) newest = std::move(version);
  }
  return newest;
}

bool is_packaged(const fs::path& folder, const std::string& header,
                 const std::vector<std::string>& architectures) {
  const fs::path there = folder / run_file::kHeader;
  return fs::exists(there) && read_file(there) == header &&
         fs::exists(folder / kDecisionSignatureFile) &&
         std::ranges::none_of(architectures, [&](const std::string& architecture) {
           return version_in(folder, architecture).empty();
         });
}

void make_packages(const PackageRequest& request, const fs::path& folder, const std::string& name) {
  std::vector<std::string> command{(request.source / "tools/package").string(), "--student",
                                   folder.string(), "--class", name};
  command.insert(command.end(), request.architectures.begin(), request.architectures.end());
  ChildProcess program(command);
  std::string said = program.read_all();
  if (program.wait() == 0) return;
  while (said.ends_with('\n')) said.pop_back();
  fail("class {}: tools/package failed: {}", name, said.substr(said.rfind('\n') + 1));
}

}  // namespace

std::vector<PackagedClass> classes_to_package(const std::vector<CollectedTask>& tasks,
                                              const std::vector<CollectedSite>& sites,
                                              bool partial) {
  if (!tasks.empty() && !tasks.front().task.value(setting::kFold).empty())
    fail("a sweep with --folds has no student for a site: plan one without --folds");
  std::vector<PackagedClass> classes;
  std::map<std::string, std::size_t> place;
  for (const CollectedSite& site : sites) {
    const std::string& name = site.site.student;
    require_host_name(site.site.id);
    if (site.header.empty() && partial) continue;
    if (site.header.empty())
      fail("site \"{}\": none of {} tasks of its class {} is proved; skip it with --partial",
           site.site.id, site.tasks, name);
    const auto [at, is_new] = place.try_emplace(name, classes.size());
    if (is_new) classes.push_back({name, {}, {}, {}});
    classes[at->second].sites.push_back(site);
  }
  if (classes.empty())
    fail("no site has a proved student: run open tasks with bess-train sweep run");
  return classes;
}

bool package_class(const SweepFolder& sweep, const PackageRequest& request, PackagedClass& one) {
  const fs::path folder = request.out / one.name;
  const std::string header = read_file(sweep.path / one.sites.front().header);
  const bool is_due = !is_packaged(folder, header, request.architectures);
  if (is_due) {
    fs::remove_all(folder);  // never combine a header with other packages
    write_file(folder / run_file::kHeader, header);
    make_packages(request, folder, one.name);
  }
  const std::string signature =
      read_file(folder / kDecisionSignatureFile);  // "student=4d10ef93 decisions=..."
  one.student = signature.substr(signature.find('=') + 1, 8);
  one.version = version_in(folder, request.architectures.front());
  return is_due;
}

int rollout_percent(const std::string& id) {
  const auto drawn = fnv1a(id) % 100;
  return drawn < 1 ? 1 : drawn < 10 ? 10 : 100;
}

std::string format_inventory(const std::vector<PackagedClass>& classes,
                             const std::string& architecture) {
  std::string text = fmt::format(
      "# Written by bess-train sweep packages, for tools/delivery/ansible/roll_out.yml. Put "
      "addresses\n"
      "# and other bess_architecture into host_vars next to this file or into a second inventory.\n"
      "all:\n  vars: {{bess_architecture: {}}}\n  children:\n",
      architecture);
  std::map<int, std::string> shares{{1, ""}, {10, ""}, {100, ""}};
  for (const PackagedClass& one : classes) {
    text += fmt::format(
        "    class_{0}:\n      vars:\n        bess_class: \"{0}\"\n"
        "        bess_expected_student: \"{1}\"\n        bess_package: \"{{{{ inventory_dir }}}}"
        "/{0}/bess-edge_{2}_{{{{ bess_architecture }}}}.deb\"\n      hosts:\n",
        one.name, one.student, one.version);
    for (const CollectedSite& site : one.sites) {
      text += fmt::format("        \"{}\": {{bess_expected_eur_per_day: {:.4f}}}\n", site.site.id,
                          site.eur_per_day());
      shares[rollout_percent(site.site.id)] += fmt::format("        \"{}\":\n", site.site.id);
    }
  }
  for (const auto& [percent, hosts] : shares) {
    text += fmt::format("    rollout_{}:\n      hosts:{}\n{}", percent, hosts.empty() ? " {}" : "",
                        hosts);
  }
  return text;
}

}  // namespace bess
