// From a sweep to the machines: each class of sites gets a folder with its header, what a program
// with it decides, and its packages, all by tools/package; the sites get an inventory for
// tools/delivery/ansible: package, expected student, and with which share of the fleet it is rolled
// out.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "workstation/runs/sweep/collected.h"

namespace bess {

struct PackageRequest {
  std::filesystem::path source;  ///< a checkout: tools/package is in it
  std::filesystem::path out;
  std::vector<std::string> architectures;  ///< as Debian names them; the first is the inventory's
};

struct PackagedClass {
  std::string name;
  std::vector<CollectedSite> sites;  ///< each with a header
  std::string student;               ///< once packaged: under which hash its program tells it
  std::string version;
};

/// In the order of their first site. Throws UserError where a site has no proved student or its id
/// is no host's name; with `partial` those without a student are left out.
std::vector<PackagedClass> classes_to_package(const std::vector<CollectedTask>& tasks,
                                              const std::vector<CollectedSite>& sites,
                                              bool partial);

/// Makes its packages unless they are there; false: they were. Throws UserError with the last that
/// tools/package said.
bool package_class(const SweepFolder& sweep, const PackageRequest& request, PackagedClass& one);

/// 1, 10 or 100: by the id alone, so that a site stays in its share when others are added.
int rollout_percent(const std::string& id);

std::string format_inventory(const std::vector<PackagedClass>& classes,
                             const std::string& architecture);

}  // namespace bess
