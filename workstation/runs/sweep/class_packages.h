// Packages of a sweep: for each class of fleet members a folder with header, signature and Debian
// packages (tools/package); and an inventory for tools/delivery/ansible with package, expected
// student and rollout share.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "workstation/runs/sweep/collected.h"

namespace bess {

struct PackageRequest {
  std::filesystem::path source;  ///< source checkout with tools/package
  std::filesystem::path out;
  std::vector<std::string> architectures;  ///< Debian names; the first is used in the inventory
};

struct PackagedClass {
  std::string name;
  std::vector<CollectedSite> sites;  ///< each with a header
  std::string student;               ///< after packaging: hash reported by the program
  std::string version;
};

/// In the order of their first member. Throws UserError when a member has no proved student (with
/// `partial` it is skipped) or its id is not a host name.
std::vector<PackagedClass> classes_to_package(const std::vector<CollectedTask>& tasks,
                                              const std::vector<CollectedSite>& sites,
                                              bool partial);

/// Makes the packages; false if they existed. Throws UserError with the last line of
/// tools/package.
bool package_class(const SweepFolder& sweep, const PackageRequest& request, PackagedClass& one);

/// 1, 10 or 100, by the id only, so that added members do not change the share of others.
int rollout_percent(const std::string& id);

std::string format_inventory(const std::vector<PackagedClass>& classes,
                             const std::string& architecture);

}  // namespace bess
